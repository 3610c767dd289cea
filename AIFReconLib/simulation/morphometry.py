"""Sizes of lumbar vertebrae as anatomists measure them, and what is typical of each level.

Vertebra frame: x to the patient's right, y anterior, z superior along the body's own axis; the origin is the spinolaminar junction, the
point in the midline where the back of the laminae becomes the spinous process. The middle of the body lies `BODY_LIFT` above it.

References
----------
.. [1] Clouthier et al. (2023), Morphable models of the lumbar spine to vary geometry based on pathology, demographics, and anatomical
   measurements, J Biomech 146:111421, doi:10.1016/j.jbiomech.2022.111421: the mean of 87 patients, and the ranges seen.
.. [2] Panjabi et al. (1992), Human lumbar vertebrae: quantitative three-dimensional anatomy, Spine 17:299-306,
   doi:10.1097/00007632-199203000-00010.
.. [3] Lien, Liou and Wu (2007), Analysis of anatomic morphometry of the pedicles and the safe zone for through-pedicle procedures in the
   thoracic and lumbar spine, Eur Spine J 16:1215-1222, PMC2200778.
.. [4] Panjabi et al. (1993), Articular facets of the human spine: quantitative three-dimensional anatomy, Spine 18:1298-1310.
"""

from __future__ import annotations

from dataclasses import dataclass

LAMINA_THICKNESS = 6.5
"""mm from the spinolaminar junction to the canal. CT of L1 to L5 shows 6.0 to 6.3 mm (Wang et al. 2024, World Neurosurgery); calipers on
dry bone show less, 5.0 mm at most (Xu et al. 1999, The quantitative anatomy of the laminas of the spine, Spine 24:107-113)."""

BODY_LIFT = 9.0
"""mm that the middle of the body lies above the spinolaminar junction: the pedicles leave from the body's upper half."""


@dataclass(frozen=True)
class VertebraSizes:
    """Sizes of one vertebra in mm and degrees; heights are z, and depths y, in the vertebra frame.

    Parameters
    ----------
    body_width, body_depth, body_height, body_wedge_deg : float
        Over the rims of the endplates; the wedge is positive where the body is higher in front [1]_, [2]_.
    canal_width, canal_depth : float
        Between the pedicles, and from the body to the laminae in the midline [1]_, [2]_.
    pedicle_width, pedicle_height : float
        7 to 18 mm wide, most at L5, and 14 to 17 mm high [3]_.
    superior_width, inferior_width : float
        Between the middles of the right and left articular processes [4]_.
    superior_height, inferior_height : float
        Of the middle of the superior facet, and of the inferior one's lower part.
    facet_angle_deg : float
        Of the flat of the superior articular processes to the sagittal plane; it grows downward [4]_.
    facet_depth : float
        How much farther forward than at L3 the articular processes and laminae stand.
    transverse_width, transverse_height, transverse_depth : float
        Between the tips of the transverse processes, and where their tips are.
    spinous_length : float
        From the spinolaminar junction to the tip.
    spinous_top, spinous_bottom : float
        Heights of the upper and the lower edge behind.
    """

    body_width: float
    body_depth: float
    body_height: float
    body_wedge_deg: float
    canal_width: float
    canal_depth: float
    pedicle_width: float
    pedicle_height: float
    superior_width: float
    superior_height: float
    inferior_width: float
    inferior_height: float
    facet_angle_deg: float
    facet_depth: float
    transverse_width: float
    transverse_height: float
    transverse_depth: float
    spinous_length: float
    spinous_top: float
    spinous_bottom: float


LEVELS = ("L2", "L3", "L4", "L5")

_BY_LEVEL = {
    "body_width": (49.0, 51.5, 50.5, 49.0),
    "body_depth": (35.5, 35.0, 37.0, 36.5),
    "body_height": (29.0, 29.5, 29.0, 27.0),
    "body_wedge_deg": (-3.0, -1.0, 1.0, 10.0),
    "canal_width": (22.5, 23.0, 24.0, 27.0),
    "canal_depth": (14.0, 15.0, 14.0, 15.0),
    "pedicle_width": (8.0, 9.0, 12.0, 17.0),
    "pedicle_height": (15.5, 15.0, 14.5, 13.5),
    "superior_width": (35.5, 37.0, 39.5, 45.5),
    "superior_height": (22.5, 21.0, 19.5, 17.0),
    "inferior_width": (22.0, 25.0, 31.5, 40.5),
    "inferior_height": (-13.5, -14.0, -12.0, -10.5),
    "facet_angle_deg": (22.0, 24.0, 30.0, 35.0),
    "facet_depth": (0.0, 0.0, 2.0, 5.5),
    "transverse_width": (78.0, 88.0, 83.0, 96.0),
    "transverse_height": (13.0, 12.5, 11.0, 10.0),
    "transverse_depth": (3.0, 3.0, 8.0, 12.5),
    "spinous_length": (31.0, 32.0, 29.0, 21.0),
    "spinous_top": (10.0, 9.0, 6.5, 0.5),
    "spinous_bottom": (-11.5, -13.0, -12.5, -13.5),
}

TYPICAL = {level: VertebraSizes(**{name: values[n] for name, values in _BY_LEVEL.items()}) for n, level in enumerate(LEVELS)}
"""Typical sizes by level, to half a millimeter: those with which the bars of `vertebra` lie nearest to the mean shape of 87 patients [1]_,
canal and pedicles as measured."""

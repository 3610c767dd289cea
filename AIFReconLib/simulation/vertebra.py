"""One lumbar vertebra: its sizes, and its shape as a signed distance function.

Vertebra frame: x to the patient's right, y anterior, z superior along the vertebra's own axis; the origin is the spinolaminar
junction, the point in the midline where the back of the laminae becomes the spinous process.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Matrix, Reals
from .implicit_shapes import ellipse, rounded_box, smooth_intersection, smooth_union, swept_ellipsoid

LAMINA_THICKNESS = 6.5
"""mm. CT of L1 to L5 shows 6.0 to 6.3 mm (Wang et al. 2024, World Neurosurgery); calipers on dry bone show less, 5.0 mm at most (Xu et al.
1999, The quantitative anatomy of the laminas of the spine, Spine 24:107-113)."""

BODY_LIFT = 9.0
"""mm that the middle of the body lies above the spinolaminar junction: the pedicles leave from the body's upper half."""

VERTEBRA_BOX = ((-52.0, -44.0, -38.0), (52.0, 66.0, 38.0))
"""mm, corners that contain any vertebra drawn here with 6 mm to spare."""


@dataclass(frozen=True)
class Vertebra:
    """Sizes and place of one vertebra.

    Parameters
    ----------
    label : int
        Its value in the label volume.
    name : str
        "L2" to "L5".
    vertebra_to_reference : (4, 4) float64 array
    scale : float
        Of everything but spinous process and gap.
    spinous_length : float
        From the spinolaminar junction to the tip.
    spinous_top, spinous_bottom : (at the junction, change per mm forward)
        Height of the process's upper and lower edge before `spinous_slope`.
    spinous_slope : float
        mm down per mm backward.
    spinous_deviation : float
        Sideways shift of the tip.
    """

    label: int
    name: str
    vertebra_to_reference: Matrix
    scale: float
    body_width: float
    body_depth: float
    body_height: float
    canal_width: float
    canal_depth: float
    transverse_width: float
    spinous_length: float
    spinous_top: tuple[float, float]
    spinous_bottom: tuple[float, float]
    spinous_slope: float
    spinous_deviation: float

    @property
    def body_center(self) -> tuple[float, float, float]:
        """Middle of the body in the vertebra frame."""
        return 0.0, (LAMINA_THICKNESS + self.canal_depth + self.body_depth / 2) * self.scale, BODY_LIFT * self.scale

    @property
    def spinous_tip(self) -> tuple[float, float, float]:
        """Middle of the process's hind edge in the vertebra frame."""
        middle = sum(edge[0] - edge[1] * self.spinous_length for edge in (self.spinous_top, self.spinous_bottom)) / 2
        return self.spinous_deviation, -self.spinous_length, middle - self.spinous_slope * self.spinous_length

    def distance(self, x: Reals, y: Reals, z: Reals) -> Reals:
        """Signed distance to the bone's surface, mm, for points of the vertebra frame given as float32 arrays that broadcast."""
        s = np.float32(self.scale)
        scaled = (x / s, y / s, z / s)
        bone = smooth_union(self._body(*scaled), self._arch(*scaled), 3.0)
        canal_y = LAMINA_THICKNESS + self.canal_depth / 2
        canal = ellipse(scaled[0], scaled[1] - canal_y, self.canal_width / 2, self.canal_depth / 2)
        bone = smooth_intersection(bone, -canal, 2.0) * s
        return smooth_union(bone, self._spinous_process(x, y, z), 4.0)

    def _body(self, x: Reals, y: Reals, z: Reals) -> Reals:
        """Elliptic drum with a waist, a flattened back wall and slightly hollow endplates."""
        _, center_y, center_z = self.body_center
        y, z = y - center_y / self.scale, z - center_z / self.scale
        half_height = self.body_height / 2
        waist = (1.045 - 0.1 * np.maximum(1.0 - (z / half_height) ** 2, 0.0)).astype(np.float32)
        wall = ellipse(x, y, self.body_width / 2 * waist, self.body_depth / 2 * waist)
        back = -(y + 0.5 * self.body_depth + 0.0022 * x * x)
        hollow = 1.5 * np.maximum(1.0 - (x / (0.42 * self.body_width)) ** 2 - (y / (0.42 * self.body_depth)) ** 2, 0.0)
        return smooth_intersection(smooth_intersection(wall, back, 5.0), np.abs(z) - half_height + hollow, 3.0)

    def _arch(self, x: Reals, y: Reals, z: Reals) -> Reals:
        """Pedicles, laminae, articular and transverse processes, both sides at once by symmetry."""
        x = np.abs(x)
        canal_half = self.canal_width / 2
        back_wall = LAMINA_THICKNESS + self.canal_depth
        pedicle = swept_ellipsoid(
            x, y, z, (canal_half + 4.5, back_wall + 3.0, 14.0), (canal_half + 5.0, 13.0, 13.0), (5.0, 6.0, 7.2), (5.2, 5.0, 7.0)
        )
        along = (0.86, 0.51)
        u, v = x - 8.5, y - (3.6 + 5.0) + 0.26 * (z - 1.0)
        lamina = 0.95 * rounded_box(
            u * along[0] + v * along[1], -u * along[1] + v * along[0], z - 1.0, 11.0, LAMINA_THICKNESS / 2, 10.5 - 0.12 * x, 2.8
        )
        superior = swept_ellipsoid(x, y, z, (18.0, 16.0, 10.0), (20.5, 14.5, 23.0), (5.0, 4.5, 5.0), (4.2, 4.6, 4.5))
        inferior = swept_ellipsoid(x, y, z, (12.5, 9.0, -2.0), (12.8, 6.5, -19.0), (5.2, 4.2, 5.0), (4.6, 4.2, 5.0))
        half_width = self.transverse_width / 2
        transverse = swept_ellipsoid(x, y, z, (20.0, 16.5, 12.5), (half_width - 4.0, 12.5, 15.0), (6.0, 3.8, 5.2), (4.0, 2.8, 5.4))
        arch = smooth_union(lamina, pedicle, 4.0)
        arch = smooth_union(arch, superior, 3.0)
        arch = smooth_union(arch, inferior, 3.0)
        return smooth_union(arch, transverse, 4.0)

    def _spinous_process(self, x: Reals, y: Reals, z: Reals) -> Reals:
        """A hatchet-shaped plate: thin in its middle, thicker at its hind and lower edges, sloping down."""
        backward = np.clip(-y / self.spinous_length, 0.0, 1.0)
        z = z + self.spinous_slope * np.clip(-y, -6.0, None)
        top = self.spinous_top[0] + self.spinous_top[1] * y
        bottom = self.spinous_bottom[0] + self.spinous_bottom[1] * y
        lower = np.clip((top - z) / (top - bottom), 0.0, 1.0)
        half_thickness = 2.9 + 1.3 * backward**3 + 0.9 * lower * backward
        front, hind = 4.0, -self.spinous_length
        return rounded_box(
            x - self.spinous_deviation * backward,
            y - (front + hind) / 2,
            z - (top + bottom) / 2,
            half_thickness,
            (front - hind) / 2,
            (top - bottom) / 2,
            2.6,
        )

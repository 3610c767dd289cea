"""Which brightness is the method's and not the patient's: a reconstruction beside the plain mean of the same echoes."""

from __future__ import annotations

import numpy as np

from ..arrays import Bytes, Numbers, Singles
from ..errors import GeometryError
from ..geometry.volume import Volume

BANDS = (0.1, 0.3, 0.5, 0.7)
"""Where each band of the share of brightness that was added begins; below the first nothing is marked."""

BRIGHT = 0.5
"""Of the brightest voxel. What is darker does not look like bone: it is raised where frames in a shadow count less, which are no echoes."""

PLANES_AT_ONCE = 16
"""Planes [k], to bound the memory that is needed beside the volumes."""


def raised_share(shown: Numbers, plain: Numbers) -> Singles:
    """The share of the brightness that a method added, 0 to 1.

    `shown` and `plain` are gray levels of the method and of the plain mean.
    (shown - plain) / shown comes back where that is positive, else 0: a voxel three times as bright as its echoes has 2/3.
    """
    bright = shown.astype(np.float32)
    added = bright - plain.astype(np.float32)
    share = np.zeros(bright.shape, dtype=np.float32)
    np.divide(added, bright, out=share, where=added > 0)
    return share


def raised_bands(shown: Volume, plain: Volume) -> Bytes:
    """For display: of what is as bright as bone 1 to 4, the number of its band in `BANDS`, where it is brighter than its echoes; else 0.

    Raises GeometryError when their voxels are not the same.

    Parameters
    ----------
    shown, plain : Volume
        The reconstruction, and its plain mean on the same voxels.
    """
    if shown.array.shape != plain.array.shape or not np.allclose(shown.ijk_to_reference, plain.ijk_to_reference, rtol=0.0, atol=1e-6):
        raise GeometryError("Input plain must lie on the voxels of the reconstruction; got another grid. Reconstruct both anew.")
    bands = np.empty(shown.array.shape, dtype=np.uint8)
    bright = BRIGHT * float(shown.array.max(initial=0))
    for first in range(0, len(bands), PLANES_AT_ONCE):
        some = slice(first, first + PLANES_AT_ONCE)
        bands[some] = np.digitize(raised_share(shown.array[some], plain.array[some]), BANDS)
        bands[some][shown.array[some] < bright] = 0
    return bands

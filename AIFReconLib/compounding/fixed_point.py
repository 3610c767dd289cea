"""Plus's Optimization=FULL: pixels are placed by whole numbers of 2^-14 voxel."""

from __future__ import annotations

import numpy as np

from ..arrays import Matrix

ONE = 2**14
"""What stands for 1."""


def in_fixed_point(image_to_ijk: Matrix) -> Matrix:
    """A (4, 4) matrix with its numbers rounded as IGSIO's fixed-point type holds them.

    Notes
    -----
    With whole columns and rows, places are then whole numbers of 2^-14 voxel, which doubles add up exactly: pixels fall into the voxels
    of IGSIO's integer arithmetic. A pixel moves by at most (columns + rows + 1) 2^-15 voxels along an axis.
    """
    rounded: Matrix = np.rint(image_to_ijk * ONE) / ONE
    return rounded

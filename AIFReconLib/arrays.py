"""What arrays hold, for editors and type checkers. Their shapes, units and frames stand in the docstrings of what takes them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
"""Points, times, weights: what is computed with."""

Matrix = Floats
"""A transform `a_to_b`, (4, 4), or several, (n, 4, 4); float64, on column vectors in mm."""

Singles = NDArray[np.float32]
"""What each voxel or pixel has one of, and memory counts."""

Reals = NDArray[np.floating]
"""Floating-point numbers of either precision."""

Integers = NDArray[np.integer]
"""Numbers of frames, pixels and voxels."""

Numbers = NDArray[np.number | np.bool_]
"""Images and volumes as files, scanners and methods give them: truth values, whole or floating-point numbers of whatever size."""

NumberType = np.dtype[np.number | np.bool_]
"""What each of `Numbers` is."""

Bytes = NDArray[np.uint8]
"""8-bit images, and masks with more than two values."""

Mask = NDArray[np.bool_]
"""Which pixels, voxels or frames are chosen."""

Array = NDArray[np.generic]
"""Whatever an array can hold."""

"""Whether the size of a pixel that a recording states is that of its poses."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Matrix
from ..geometry.transform_graph import TransformName

SIZES_DIFFER = 0.05
"""Part by which the size of a pixel that a recording states differs from that of its poses: calibrations find it more exactly."""


def about_pixel_size(stated: Floats, wanted: TransformName, image_to_reference: Matrix) -> list[str]:
    """A sentence where the size of a pixel that the recording states for each frame (n, 2), mm, is not that of the poses (n, 4, 4)."""
    found = np.linalg.norm(image_to_reference[:, :3, :2], axis=1)
    with np.errstate(all="ignore"):  # whatever numbers a header holds
        contradicted = np.flatnonzero((np.abs(found / stated - 1) > SIZES_DIFFER).any(axis=1))
    if not contradicted.size:
        return []
    first = contradicted[0]
    known = np.flatnonzero(np.isfinite(found + stated).all(axis=1))
    changed = known[(np.abs(stated[known] / stated[known[0]] - 1) > SIZES_DIFFER).any(axis=1)]
    why = "is the calibration that of another depth?"
    if changed.size:
        why = (
            f"the size changes in frame {changed[0]} from {_size(stated[known[0]])} to {_size(stated[changed[0]])} mm, and a "
            "calibration holds for one depth."
        )
    elif np.allclose(found[first], 1.0, rtol=0.0, atol=1e-3):
        why = "it is rigid, so it may lack the size of a pixel, which belongs into the calibration."
    return [
        (
            f"The recording says that a pixel of frame {first} is {_size(stated[first])} mm, but {wanted} places pixels "
            f"{_size(found[first])} mm apart, and so they are placed, as in Plus: {why}"
        )
    ]


def _size(spacing: Floats) -> str:
    return f"{spacing[0]:.4g} x {spacing[1]:.4g}"


SMALLEST_IMAGE, SMALLEST_SWEEP, FRAMES_THAT_MOVE = 1.0, 1.0, 20
"""mm across an image, and between the images of so many frames, below which poses are likely in meters."""


def about_extent(matrices: Matrix, frame_size: tuple[int, int]) -> list[str]:
    """A note on images or a sweep of hardly any size; `matrices` (frames, 4, 4), pixels to mm, NaN where there is no pose."""
    placed = matrices[np.isfinite(matrices).all(axis=(1, 2))]
    if not len(placed):
        return []
    across = np.median(np.linalg.norm(placed[:, :3, :2], axis=1), axis=0) * frame_size
    if across.max() < SMALLEST_IMAGE:
        return [f"WARNING: Images are {across[0]:.2g} x {across[1]:.2g} mm by their poses. If these are in meters, give them in mm."]
    apart = float(np.ptp(placed[:, :3, 3], axis=0).max())
    if 0 < apart < SMALLEST_SWEEP and len(placed) >= FRAMES_THAT_MOVE:
        return [f"WARNING: All {len(placed)} frames lie within {apart:.2g} mm. If their poses are in meters, give them in mm."]
    return []

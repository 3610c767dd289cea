"""Whether the size of a pixel that a recording states is that of its poses."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Integers, Matrix
from ..geometry.transform_graph import TransformName
from ..message import listed

SIZES_DIFFER = 0.05
"""Part by which the size of a pixel that a recording states differs from that of its poses: calibrations find it more exactly."""


LARGEST_IMAGE, SMALLEST_IMAGE = 400.0, 5.0
"""mm across or along, which no probe sees more or less of."""


LARGEST_SWEEP, SMALLEST_SWEEP = 2000.0, 1.0
"""mm that the images of a sweep move, at most and at least."""


def implausible_extent(image_to_mm: Matrix, frame_size: tuple[int, int]) -> str | None:
    """A sentence where the middles of more than five images, placed by (n, 4, 4), lie meters apart, or within a millimeter."""
    middle = (image_to_mm @ (frame_size[0] / 2, frame_size[1] / 2, 0.0, 1.0))[:, :3]
    extent = float(np.ptp(middle, axis=0).max())
    if len(middle) <= 5 or extent == 0.0 or SMALLEST_SWEEP <= extent <= LARGEST_SWEEP:
        return None
    return f"The sweep spans {extent:.3g} mm: are its lengths in another unit than mm (meters)?"


FEWEST_PIXELS, SMALLEST_OF_FEW_PIXELS = 64, 0.5
"""Along an image; smaller ones are cut out or made up, and may be as small as this, mm."""


ASTRAY, FEW, FEWEST_FRAMES = 50.0, 0.02, 20
"""mm off all other images along an axis of Reference, the share of images that may lie so by a wrong pose (two scanned places have more),
and images from which on that is told."""


def implausible_places(middles: Floats, numbers: Integers) -> str | None:
    """A sentence where a few of the images of these numbers (n,), with their middles at (n, 3) mm, lie far off all others."""
    astray = np.zeros(len(middles), bool)
    for along in middles.T:
        order = np.argsort(along)
        for before in np.flatnonzero(np.diff(along[order]) > ASTRAY) + 1:
            fewer = min(order[:before], order[before:], key=len)
            astray[fewer] |= len(fewer) <= max(FEW * len(middles), 1)
    if not astray.any() or len(middles) < FEWEST_FRAMES:
        return None
    which = f"Frame {numbers[astray][0]} lies" if astray.sum() == 1 else f"Frames {listed(numbers[astray][:10])} lie"
    return f"{which} more than {ASTRAY:g} mm off all others: by a wrong pose, probably. Leave out what the tracker did not see well."


def implausible_size(image_to_mm: Matrix, frame_size: tuple[int, int]) -> str | None:
    """A sentence where images of (columns, rows) pixels, placed by (n, 4, 4), are larger or smaller than any probe sees."""
    columns, rows = frame_size
    sides = np.linalg.norm(image_to_mm[:, :3, :2], axis=1).reshape(-1, 2) * (columns, rows)
    wide, high = np.median(sides, axis=0)
    largest = max(wide, high)
    least = SMALLEST_IMAGE if max(frame_size) >= FEWEST_PIXELS else SMALLEST_OF_FEW_PIXELS
    if least <= largest <= LARGEST_IMAGE:
        return None
    why = "larger" if largest > LARGEST_IMAGE else "smaller"
    return f"An image would be {wide:.4g} x {high:.4g} mm, {why} than any probe sees: is its pixel's size missing, or the unit meters?"


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

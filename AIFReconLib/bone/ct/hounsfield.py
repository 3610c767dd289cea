"""Where soft tissue lies in a CT, and the threshold of bone that follows from it."""

from __future__ import annotations

import numpy as np

from ...arrays import Floats, Numbers
from ...errors import GeometryError

AIR = -300.0
"""HU below which nothing is tissue, nor a table's foam."""

TISSUE = (-200.0, 300.0)
"""HU between which soft tissue lies, fat included."""

SOFT = (-60.0, 160.0)
"""HU between which muscle, organs or water make the peak that the threshold is found from."""

LEAST_TISSUE = 0.4
"""Share of what is no air that must be soft tissue."""

LEAST_LOW = -50.0
"""HU below which some voxels lie in every CT: fat, gas or the air around."""

ABOVE_SOFT, SIGMAS, HIGHEST = 150.0, 6.0, 500.0
"""HU by which bone is at least above soft tissue, in how many widths of its peak, and where the threshold ends at the latest."""

DENSE, MOST_DENSE = 600.0, 0.25
"""HU of what only bone and metal exceed, and the share of what is no air that they have at most."""

_STEP = 4.0


def soft_tissue(values: Numbers) -> tuple[float, float]:
    """The peak of soft tissue among the values of a CT [k, j, i], and above what voxels are dense enough for bone, HU.

    Raises GeometryError when they are no Hounsfield units: nothing is below fat, or most of what is no air is no soft tissue.
    """
    low, high = float(values.min()), float(values.max())
    if not (np.isfinite(low) and np.isfinite(high)):
        raise GeometryError("The CT holds values that are no numbers. Export it again.")
    counts, edges = np.histogram(values, np.arange(-1200.0, 3200.0 + _STEP, _STEP))
    middles = edges[:-1] + _STEP / 2
    solid = counts[middles > AIR].sum()
    tissue = counts[(middles > TISSUE[0]) & (middles < TISSUE[1])].sum()
    dense = counts[middles > DENSE].sum()
    if low > LEAST_LOW or tissue < LEAST_TISSUE * solid or dense > MOST_DENSE * solid or high <= ABOVE_SOFT:
        lies = f"its values run from {low:g} to {high:g}"
        if high > 1000 and (low > LEAST_LOW or dense > MOST_DENSE * solid):
            lies += ", which may be Hounsfield units with 1000 or 1024 added"
        raise GeometryError(
            f"The CT is not in Hounsfield units: {lies}.", "Give the CT as the scanner's DICOM files have it, or labels of its bone."
        )
    return _peak(middles, counts.astype(np.float64))


def _peak(middles: Floats, counts: Floats) -> tuple[float, float]:
    smooth = np.convolve(counts, np.array([1.0, 2.0, 3.0, 2.0, 1.0]) / 9, "same")
    within = (middles > SOFT[0]) & (middles < SOFT[1])
    top = int(np.flatnonzero(within)[smooth[within].argmax()])
    below = np.flatnonzero(smooth[top:] < smooth[top] / 2)
    half = (int(below[0]) if len(below) else 1) * _STEP
    level, spread = float(middles[top]), half / 1.177  # standard deviation of its upper side: noise, and what differs between tissues
    return level, round(min(level + max(ABOVE_SOFT, SIGMAS * spread), HIGHEST))

"""Whether two volumes can be of one patient in one place."""

from __future__ import annotations

import numpy as np
import scipy

from ..geometry.transforms import invert, transform_points
from ..geometry.volume import Volume

LEAST_SHARED, LEAST_ALIKE = 0.1, 0.6
"""The share of a volume that another must show too, and the correlation of their gray levels there. Methods on one sweep of the simulated
patients and of the fibula: 0.95 to 0.97. Patients laid on each other: 0.3 to 0.4."""

MOST_VOXELS = 20_000


def why_unlike(first: Volume, name: str, second: Volume, other: str) -> str | None:
    """What makes it doubtful that volumes of these names show the same, in a sentence; None for nothing."""
    nonzero = np.flatnonzero(first.array)
    shown = np.stack(np.unravel_index(nonzero[:: max(len(nonzero) // MOST_VOXELS, 1)], first.array.shape), axis=1)
    there = transform_points(invert(second.ijk_to_reference) @ first.ijk_to_reference, shown.astype(np.float64))
    values = scipy.ndimage.map_coordinates(second.array.astype(np.float32), there.T, order=0)
    both = values != 0
    if not len(shown) or both.mean() < LEAST_SHARED:
        return f"WARNING: {other} hardly shows any of what {name} shows. Check that both are in the same Reference."
    with np.errstate(invalid="ignore"):  # of one gray level nothing is known
        alike = np.corrcoef(first.array[tuple(shown[both].T)], values[both])[0, 1]
    if alike < LEAST_ALIKE:
        return (
            f"WARNING: {other} shows something else than {name} in the same place (correlation {alike:.2f}). Are both of the same patient?"
        )
    return None

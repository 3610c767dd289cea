"""The poses of one tool over time: where it was at any moment, and why that cannot be said."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..arrays import Matrix
from ..errors import GeometryError
from ..geometry.pose_interpolation import interpolate_pose
from ..geometry.transform_graph import MISSING, TransformSample, TransformStatus
from ..geometry.transforms import why_not_affine
from ..recipe.recipe import LONGEST_GAP

SAME_TIME = 1e-6
"""s. A pose this near in time is taken as it is."""

SLICERS_TIME = 1.1e-3
"""s. The same, where Slicer has rounded times to 1 ms, of images and transforms alike."""


class PoseTrack:
    """The usable poses of one transform, in order of time.

    Samples come in any order, each with its time in s. Poses that are not OK or not finite are left out, and none is made up between two
    others where one was; of several at one time, the first counts.
    """

    def __init__(self, samples: Iterable[tuple[float, TransformSample]]):
        usable, lost = [], []
        for time, sample in samples:
            if not np.isfinite(time):
                continue
            if sample.status is TransformStatus.OK and not why_not_affine(sample.matrix):
                usable.append((time, sample.matrix))
            else:
                lost.append(time)
        self._lost = np.unique(np.array(lost, dtype=np.float64))
        times = np.array([time for time, _ in usable], dtype=np.float64)
        self.times, first = np.unique(times, return_index=True)
        self._matrices = [usable[index][1] for index in first]

    def __len__(self) -> int:
        return len(self.times)

    def samples(self, times: Iterable[float], longest_gap: float = LONGEST_GAP, tolerance: float = SAME_TIME) -> list[TransformSample]:
        """The poses at these moments, MISSING where there is none; see `at`."""
        found = (self.at(time, longest_gap, tolerance)[0] for time in times)
        return [MISSING if matrix is None else TransformSample(matrix) for matrix in found]

    def at(self, time: float, longest_gap: float = LONGEST_GAP, tolerance: float = SAME_TIME) -> tuple[Matrix, None] | tuple[None, str]:
        """The pose at one moment, or why there is none.

        Parameters
        ----------
        time : float, s
        longest_gap : float, s
            Poses on either side that are farther apart from each other than this say nothing of the time between.
        tolerance : float, s
            A pose this near in time is returned bit for bit.

        Returns
        -------
        matrix : (4, 4) array or None
        problem : str or None
            ``"no valid pose between 1.200 and 2.450 s"``, ``"no pose after 2.450 s"``.
        """
        if not len(self.times):
            return None, "no valid pose at all"
        after = int(np.searchsorted(self.times, time))
        nearest = min((index for index in (after - 1, after) if 0 <= index < len(self.times)), key=lambda i: abs(self.times[i] - time))
        if abs(self.times[nearest] - time) <= tolerance:
            return self._matrices[nearest], None
        if after == 0:
            return None, f"no pose before {self.times[0]:.3f} s"
        if after == len(self.times):
            return None, f"no pose after {self.times[-1]:.3f} s"
        start, stop = self.times[after - 1], self.times[after]
        was_lost = np.searchsorted(self._lost, start, side="right") < np.searchsorted(self._lost, stop)
        if was_lost or stop - start > longest_gap + SAME_TIME:
            return None, f"no valid pose between {start:.3f} and {stop:.3f} s"
        fraction = (time - start) / (stop - start)
        try:
            return interpolate_pose(self._matrices[after - 1], self._matrices[after], float(fraction)), None
        except GeometryError:
            return None, f"poses at {start:.3f} and {stop:.3f} s that cannot be interpolated"

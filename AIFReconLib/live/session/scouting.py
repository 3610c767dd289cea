"""Frames that are kept before there is a volume: to find its box and to recognize the probe, then to be inserted after all."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterable, Iterator
from functools import partial

import numpy as np

from ...arrays import Floats, Matrix
from ...effective_settings import Imaging, asked_imaging, known_imaging, recognized_imaging
from ...errors import NoUsableFramesError
from ...geometry.transforms import pixel_spacing
from ...geometry.volume import VoxelGrid
from ...imaging.extent import grid_around_sweep
from ...imaging.sound_speed import depth_scale
from ...recipe.recipe import Recipe
from ...sweep.configuration import PlusConfiguration
from ...sweep.frames import FrameRecord, TrackedSequence
from ...sweep.multi_sweep import JoinedImages
from ...sweep.poses import SweepPoses
from ..pairing.pose_history import LARGEST_SPEED
from ..pairing.synchronizer import LiveFrame

SCOUTED = "seen while scouting"

FARTHEST_STEP = 100.0
"""mm from one frame to the next that are believed however soon it comes: clocks tremble, and recordings begin anew."""

LONGEST_REACH = 1.0
"""s after which a hand that was not seen is believed to be no farther away."""

MOST_TRACKS = 8
"""Places between which poses jump that are kept in mind."""

MOST_BYTES = 512 * 2**20
"""Of pixels that are kept; of later frames only the poses are, which is enough for the box."""


class ScoutedFrames:
    """Frames that wait for a volume, those that are given at first. Of those that cannot be used only the numbers are kept."""

    def __init__(self, frames: Iterable[LiveFrame] = ()) -> None:
        self.usable = 0
        self._kept: list[LiveFrame] = []
        self._others: dict[str, array[int]] = {}
        self._poses: list[Matrix] = []
        self._times: list[tuple[float, float]] = []
        self.notes: tuple[str, ...] = ()
        self._left = MOST_BYTES
        for frame in frames:
            self.add(frame)

    def add(self, frame: LiveFrame) -> None:
        """Keep a frame."""
        if frame.status == "OK":
            image, image_to_reference = frame.placed()
            self.usable += 1
            self._poses.append(image_to_reference)
            self._times.append((frame.timestamp, frame.received))
            self._left -= image.nbytes
        if frame.status == "OK" and self._left >= 0:
            self._kept.append(frame)
        else:
            # Hours may pass before there is a volume, so only their numbers are kept
            status = SCOUTED if frame.status == "OK" else frame.status
            self._others.setdefault(status, array("q")).append(frame.number)

    def _reachable(self, middles: Floats) -> list[int]:
        """Numbers of the poses of which each can be reached from the one before; of several such tracks, the longest. Middles are in mm."""
        tracks: list[list[int]] = []
        for number, middle in enumerate(middles):
            track = next((track for track in tracks if self._reaches(track[-1], number, math.dist(middles[track[-1]], middle))), None)
            if track is None:
                tracks = [*tracks[: MOST_TRACKS - 1], track := []]
            track.append(number)
            tracks.sort(key=lambda track: -len(track))
        return tracks[0]

    def _reaches(self, before: int, now: int, distance: float) -> bool:
        (stamped, received), (stamped_now, received_now) = self._times[before], self._times[now]
        elapsed = min(max(abs(stamped_now - stamped), received_now - received), LONGEST_REACH)
        return distance <= FARTHEST_STEP + LARGEST_SPEED * elapsed

    def __iter__(self) -> Iterator[LiveFrame]:
        """Every frame: first those without an image, by reason, then the usable ones in order of arrival."""
        for status, numbers in self._others.items():
            yield from (LiveFrame(None, None, status=status, number=number) for number in numbers)
        yield from self._kept

    def clear(self) -> None:
        """Keep no frame any longer."""
        self._kept.clear()
        self._others.clear()

    def sequence(self) -> tuple[TrackedSequence, SweepPoses]:
        """The usable frames of one size that were kept, as a recording and its poses.

        Raises NoUsableFramesError when there is none.
        """
        placed = [(*frame.placed(), frame.timestamp) for frame in self._kept]
        if not placed:
            raise NoUsableFramesError("Not one tracked frame was seen yet. Check that the probe and the reference are visible, then scan.")
        first, _, _ = placed[0]
        placed = [kept for kept in placed if kept[0].shape == first.shape and kept[0].dtype == first.dtype]
        images, matrices, times = zip(*placed, strict=True)
        poses = SweepPoses(np.stack(matrices), (None,) * len(placed), ())
        return TrackedSequence(JoinedImages([image[None] for image in images]), [FrameRecord(time) for time in times]), poses

    def grid(self, imaging: Imaging, settings: Recipe, bytes_per_voxel: int, margin: float = 0.0, fits_spacing: bool = False) -> VoxelGrid:
        """The box around the poses that were seen, `margin` mm larger on each side; the other arguments as in `grid_around_sweep`.

        A place that no hand reaches in the time between two frames does not count: one wrong pose would make it larger than any memory.

        Raises NoUsableFramesError, GeometryError or InsufficientMemoryError.

        Parameters
        ----------
        imaging : Imaging
            Which pixels count, and the probe where a speed of sound moves them.
        settings : Recipe
            Of which spacing and speed of sound count.
        margin : float, mm
        """
        (columns, rows), poses = self.sequence()[0].frame_size, np.stack(self._poses)
        poses = poses[self._reachable((poses @ (columns / 2, rows / 2, 0.0, 1.0))[:, :3])]
        if astray := self.usable - len(poses):
            lie = f"{astray} of {self.usable} frames seen while scouting lie where no hand reaches between two frames"
            self.notes = (f"{lie}: the box is that of others.",)
        scale = depth_scale(settings, imaging.region.mask(columns, rows), imaging.probe, pixel_spacing(poses[0]))
        spacing = settings.spacing_xyz()
        grid = grid_around_sweep(poses, (columns, rows), imaging.region, spacing, bytes_per_voxel, scale, fits_spacing)
        more = np.ceil(margin / grid.spacing).astype(int)
        size = [n + 2 * int(extra) for n, extra in zip(grid.size, more, strict=True)]
        return VoxelGrid.from_spacing(grid.origin - more * grid.spacing, size, grid.spacing)


class Recognition:
    """How the images of a stream are to be read: as given and configured, else as frames show it.

    Parameters
    ----------
    needs_probe : bool
        Whether a region alone is not enough.
    learns : bool
        Whether gray levels count, which frames must show where nobody has told them.
    """

    def __init__(self, asked: Recipe, configuration: PlusConfiguration, needs_probe: bool, learns: bool):
        region, probe = asked_imaging(asked, configuration)
        known = known_imaging(configuration, needs_probe, region, probe)
        self._recognized = partial(recognized_imaging, configuration=configuration, region=region, probe=probe, need_probe=needs_probe)
        self._asked = asked
        self.imaging = None if known is None else known.judging((), asked)
        self.is_over = known is not None and not (learns and asked.gray_levels is None)

    def look_at(self, frames: ScoutedFrames) -> Imaging:
        """What frames tell; raises BeamGeometryError where they do not, NoUsableFramesError where there is none."""
        sequence, poses = frames.sequence()
        known = self.imaging or self._recognized(sequence.images, poses)
        self.imaging, self.is_over = known.judging(sequence.images, self._asked).learned_now(), True
        return self.imaging

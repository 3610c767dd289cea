"""Frames that are kept before there is a volume: to find its box and to recognize the probe, then to be inserted after all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import NoUsableFramesError
from ..extent import grid_around_sweep
from ..frames import FrameRecord, TrackedSequence
from ..poses import SweepPoses
from ..region import ImageRegion
from ..volume import VoxelGrid
from .synchronizer import LiveFrame

SCOUTED = "seen while scouting"


class ScoutedFrames:
    """Frames in order of arrival.

    Parameters
    ----------
    byte_limit : int
        Bytes of pixels that are kept; of later frames only the poses are, which is enough for the box.
    """

    def __init__(self, byte_limit: int = 512 * 2**20):
        self.frames: list[tuple[LiveFrame, int]] = []
        self.usable = 0
        self._poses: list[np.ndarray] = []
        self._left = byte_limit

    def add(self, frame: LiveFrame, round_: int) -> None:
        """Keep a frame; `round_` is the count that it belongs to."""
        if frame.status == "OK":
            self.usable += 1
            self._poses.append(frame.image_to_reference)
            self._left -= frame.image.nbytes
            if self._left < 0:
                frame = replace(frame, image=None, status=SCOUTED)
        else:
            frame = replace(frame, image=None)
        self.frames.append((frame, round_))

    def sequence(self) -> tuple[TrackedSequence, SweepPoses]:
        """The usable frames of one size that were kept, as a recording and its poses.

        Raises
        ------
        NoUsableFramesError
        """
        kept = [frame for frame, _ in self.frames if frame.status == "OK"]
        kept = [frame for frame in kept if frame.image.shape == kept[0].image.shape and frame.image.dtype == kept[0].image.dtype]
        if not kept:
            raise NoUsableFramesError("Not one tracked frame was seen yet. Check that the probe and the reference are visible, then scan.")
        images = _Images([frame.image for frame in kept])
        poses = SweepPoses(np.stack([frame.image_to_reference for frame in kept]), (None,) * len(kept), ())
        return TrackedSequence(images, [FrameRecord(frame.timestamp) for frame in kept]), poses

    def grid(self, region: ImageRegion, spacing: tuple[float, float, float], bytes_per_voxel: int, margin: float) -> VoxelGrid:
        """The box around every pose that was seen, `margin` mm larger on each side.

        Raises
        ------
        NoUsableFramesError, GeometryError, InsufficientMemoryError
        """
        sequence, _ = self.sequence()
        grid = grid_around_sweep(np.stack(self._poses), sequence.frame_size, region, spacing, bytes_per_voxel)
        more = np.ceil(margin / grid.spacing).astype(int)
        size = tuple(int(n) for n in np.array(grid.size) + 2 * more)
        return VoxelGrid.from_spacing(grid.origin - more * grid.spacing, size, spacing)


class _Images:
    """Images in a list, as an `ImageStack` that copies none."""

    def __init__(self, images: list[np.ndarray]):
        self._images = images
        self.shape = (len(images), *images[0].shape)
        self.dtype = images[0].dtype

    def __len__(self) -> int:
        return len(self._images)

    def __getitem__(self, index: int) -> np.ndarray:
        return self._images[index]

"""Frames on their way into a volume: checked, placed, and copied together so that an engine can take several at once."""

from __future__ import annotations

import numpy as np

from ..arrays import Mask, Matrix, Numbers, NumberType, Singles
from ..geometry.transforms import image_plane_axes
from ..progress import Progress

BATCH_BYTES = 16 * 2**20
"""Most bytes of images that wait together."""

BATCH_FRAMES = 16
"""Most frames that wait together: more would not spread the cost of starting threads any thinner."""


class FrameBatch:
    """Frames that share a layout.

    Parameters
    ----------
    shape : (rows, columns) of an image
    dtype : dtype of an image
    frames : int
        Most frames to hold at once, as far as their size allows; at least 1.

    Attributes
    ----------
    images : (frames, rows, columns) uint8 or float32 array
        Finite everywhere.
    image_to_ijk : (frames, 4, 4) float64 array
    axes : (frames, 6) float32 array
        The image's x and y as unit vectors in Reference.
    numbers : list of int
        The frames' numbers in their recording.
    measured : dict of int to (rows, columns) bool array
        By position in the batch: which pixels of an image count, where not all do: those that are finite and were kept.
    progress : Progress or None
        Who hears of it while it is computed, and may cancel that.
    """

    def __init__(self, shape: tuple[int, int], dtype: NumberType, frames: int):
        # float32 is what every rule computes with; 8 bits are kept as they are because they are a quarter of that
        kept = np.dtype(np.uint8 if dtype == np.uint8 else np.float32)
        room = max(min(frames, BATCH_BYTES // (kept.itemsize * shape[0] * shape[1])), 1)
        self.images: Numbers = np.empty((room, *shape), kept)
        self.image_to_ijk = np.empty((room, 4, 4))
        self.axes: Singles = np.empty((room, 6), np.float32)
        self.numbers: list[int] = []
        self.measured: dict[int, Mask] = {}
        self.progress: Progress | None = None

    def __len__(self) -> int:
        return len(self.numbers)

    @property
    def full(self) -> bool:
        """Whether nothing more fits in."""
        return len(self.numbers) == len(self.images)

    def add(self, image: Numbers, pose: Matrix, image_to_ijk: Matrix, number: int, kept: Mask | None = None) -> None:
        """Copy a frame in; of its pixels only those `kept` (rows, columns) count, all by default."""
        place = len(self.numbers)
        if kept is not None:
            self.measured[place] = kept
        self.images[place] = image
        if self.images.dtype.kind == "f" and image.dtype.kind == "f":
            finite = np.isfinite(self.images[place])
            if not finite.all():
                self.images[place][~finite] = 0
                self.measured[place] = finite if kept is None else finite & kept
        self.image_to_ijk[place] = image_to_ijk
        self.axes[place] = np.concatenate(image_plane_axes(pose))
        self.numbers.append(number)

    def clear(self) -> None:
        """Make room for the next frames."""
        self.numbers = []
        self.measured = {}

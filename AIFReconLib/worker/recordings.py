"""Recordings, read where nobody waits for windows: what is told of their frames at once, their images some at a time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Numbers
from ..imaging.images import ImagesOnDemand, ImageStack
from ..io.foreign.options import ImportOptions
from ..io.sequence.files import read_sequence, recording_suffixes, require_recording_kind
from ..progress import Progress, report
from ..recipe.recipe import LONGEST_GAP
from ..sweep.frames import TrackedSequence
from ..sweep.time_offset import with_time_offset

if TYPE_CHECKING:
    from ..inspection.imported import ImportCheck, Imported
    from .calls import RemoteObject
    from .worker import Task, Worker


RECORDING, CONFIGURATION, VOLUME, SEGMENTATION, TRANSFORM = "recording", "configuration", "volume", "segmentation", "transform"
PREDICTIONS = "predictions"
"""What a network has said of a recording, as a scan records it."""

SUFFIXES = {
    ".xml": CONFIGURATION,
    **dict.fromkeys((".seg.nrrd", ".seg.nhdr"), SEGMENTATION),
    **dict.fromkeys((".nii", ".nii.gz"), VOLUME),
    **dict.fromkeys((".tfm", ".h5"), TRANSFORM),
}
"""What names tell; others are looked into."""


BYTES_AT_ONCE = 1 << 25
"""Of images that are fetched: they need memory twice."""


def read_recording(
    path: str | Path,
    config: str | Path | None = None,
    orientation: str | None = None,
    time_offset: float = 0.0,
    longest_gap: float = LONGEST_GAP,
) -> TrackedSequence:
    """A recording as `read_sequence` and `with_time_offset` make it, whose arguments these are."""
    return with_time_offset(read_sequence(path, config=config, orientation=orientation), time_offset, longest_gap)


def without_images(sequence: TrackedSequence) -> TrackedSequence:
    """The sequence, to be sent: `images_between` gives its images."""
    left_behind = ImagesOnDemand()
    left_behind.shape, left_behind.dtype = tuple(sequence.images.shape), np.dtype(sequence.images.dtype)
    return replace(sequence, images=left_behind)


def images_between(sequence: TrackedSequence, start: int, stop: int) -> Numbers:
    """Images from one number to before another, (frames, rows, columns)."""
    return np.stack([sequence.images[number] for number in range(start, stop)])


class FetchedImages(ImagesOnDemand):
    """Images of a recording that a worker has open, `file`: to be read in their order.

    Parameters
    ----------
    stack : ImageStack
        What the recording has in their place.
    progress : Progress or None
        Hears of waiting.
    """

    def __init__(self, worker: Worker, file: RemoteObject, stack: ImageStack, progress: Progress | None = None):
        self.shape, self.dtype = stack.shape, stack.dtype
        self._worker, self._file, self._progress = worker, file, progress
        self._count = max(1, BYTES_AT_ONCE // max(1, math.prod(stack.shape[1:]) * stack.dtype.itemsize))
        self._start, self._images = 0, np.empty(0)
        self._ahead: tuple[int, Task] | None = None

    def _image(self, index: int) -> Numbers:
        if not self._start <= index < self._start + len(self._images):
            self._fetch(index - index % self._count)
        image: Numbers = self._images[index - self._start]
        return image

    def _fetch(self, start: int) -> None:
        """Take what was asked for, and ask for what comes after it, which is read meanwhile."""
        task = self._ahead[1] if self._ahead is not None and self._ahead[0] == start else self._ask(start)
        # Before memory is taken for more
        self._images = np.empty(0)
        self._images, self._start = task.result(self._wait), start
        after = start + self._count
        self._ahead = (after, self._ask(after)) if after < len(self) else None

    def _ask(self, start: int) -> Task:
        return self._worker.begin(images_between, self._file, start, min(start + self._count, len(self)))

    def _wait(self, _fraction: float, _step: str) -> bool:
        return self._progress is None or self._progress(self._start / len(self), "Loading frames") is not False


def opened_suffixes() -> tuple[str, ...]:
    """Of all files that somebody opens together: a recording, its calibration, a CT, its segmentation, its place."""
    return (*SUFFIXES, *recording_suffixes())


def kind_of(path: Path) -> str:
    """What a file is, by its name, else by its header; a FileFormatError when it is none that is known, or cannot be read."""
    from ..bone.recorded_predictions import COVERS

    told = next((kind for suffix, kind in SUFFIXES.items() if path.name.lower().endswith(suffix)), None)
    if told is not None:
        return told
    of_frames = require_recording_kind(path).frame_fields(path)
    if of_frames is None:
        return VOLUME
    return PREDICTIONS if COVERS in of_frames else RECORDING


def read_import(images: Sequence[Path], poses: Path, options: ImportOptions, progress: Progress | None = None) -> Imported:
    """As `import_files`; to be kept in the worker."""
    from ..inspection.imported import import_files

    report(progress, 0.0, "Reading images and poses")
    return import_files(images, poses, options)


def seen_of(imported: Imported, name: str, progress: Progress | None = None) -> tuple[tuple[str, ...], ImportCheck]:
    """How images and poses were understood, and what `check_import` tells."""
    from ..inspection.imported import check_import

    report(progress, 0.0, "Looking at the sweep")
    return imported.understood, check_import(imported, name)


def sequence_in(imported: Imported) -> TrackedSequence:
    """The sequence itself."""
    return imported.sequence

"""Recordings, and images and poses of any origin, become sequence browsers: the worker reads the files, and images cross some at a time."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from AIFReconLib.progress import Progress, part, report
from AIFReconLib.worker.recordings import images_between, read_import, read_recording, seen_of, sequence_in, without_images

from ..work import inWorker, worker
from .sequenceNodes import browserFromSequence

BYTES_AT_ONCE = 1 << 25
"""Of images: they need memory twice."""


def openRecording(path, configuration=None, progress: Progress | None = None, **reading):
    """A new sequence browser of a recording; further arguments as for `read_recording`, errors as for `browserFromSequence`."""
    report(progress, 0.0, "Opening the recording")
    file = worker.keep(read_recording, path, configuration, progress=part(progress, 0.0, 0.05), **reading)
    return browserOf(file, Path(path).name.split(".")[0], part(progress, 0.05, 1.0))


def browserOf(file, name: str, progress: Progress | None = None, reference: str | None = None):
    """A new sequence browser of a sequence that is kept in the worker, which forgets it then; errors as for `browserFromSequence`."""
    try:
        sequence = inWorker(without_images, file, progress=part(progress, 0.0, 0.05))
        images = FetchedImages(file, sequence.images, part(progress, 0.05, 0.9))
        return browserFromSequence(replace(sequence, images=images), name, part(progress, 0.05, 1.0), reference=reference)
    finally:
        worker.forget(file)


class ForeignSweep:
    """What became of images and a file of poses with these `ImportOptions`, kept in the worker: seen before it is a sweep of the scene.

    `understood` and `checked`, a `Checked`, say how. An AIFReconError says what cannot be used, or asks what the files leave open.
    """

    def __init__(self, images, poses, options, progress=None):
        self.name = images.name.split(".")[0]
        self._imported = worker.keep(read_import, [images], poses, options, progress=part(progress, 0.0, 0.6))
        self.understood, self.checked = inWorker(seen_of, self._imported, self.name, progress=part(progress, 0.6, 1.0))

    def browser(self, progress=None):
        """A new sequence browser, in the frame of reference of the poses; errors as for `browserFromSequence`."""
        return browserOf(worker.keep(sequence_in, self._imported), self.name, progress, self.checked.reference)

    def forget(self) -> None:
        """Have the worker forget it."""
        worker.forget(self._imported)


class FetchedImages:
    """Images of a recording that the worker has open, an `ImageStack`: to be read in their order. `progress` hears of waiting."""

    def __init__(self, file, stack, progress=None):
        self.shape, self.dtype = stack.shape, stack.dtype
        self._file, self._progress = file, progress
        self._count = max(1, BYTES_AT_ONCE // max(1, math.prod(stack.shape[1:]) * stack.dtype.itemsize))
        self._start, self._images, self._ahead = 0, np.empty(0), None

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, index: int) -> np.ndarray:
        if not self._start <= index < self._start + len(self._images):
            self._fetch(index - index % self._count)
        return self._images[index - self._start]

    def _fetch(self, start: int) -> None:
        """Take what was asked for, and ask for what comes after it, which is read meanwhile."""
        task = self._ahead[1] if self._ahead is not None and self._ahead[0] == start else self._ask(start)
        # Before memory is taken for more
        self._images = np.empty(0)
        self._images, self._start = task.result(self._wait), start
        after = start + self._count
        self._ahead = (after, self._ask(after)) if after < len(self) else None

    def _ask(self, start: int):
        return worker.begin(images_between, self._file, start, min(start + self._count, len(self)))

    def _wait(self, _fraction: float, _step: str) -> bool:
        return self._progress is None or self._progress(self._start / len(self), "Loading frames") is not False

"""Recordings, and images and poses of any origin, become sequence browsers: the worker reads the files, and images cross some at a time."""

from dataclasses import replace
from pathlib import Path

from AIFReconLib.progress import Progress, part, report
from AIFReconLib.worker.recordings import FetchedImages, read_import, read_recording, seen_of, sequence_in, without_images

from ..work import inWorker, worker
from .sequenceNodes import browserFromSequence


def openRecording(path, configuration=None, progress: Progress | None = None, **reading):
    """A new sequence browser of a recording; further arguments as for `read_recording`, errors as for `browserFromSequence`."""
    report(progress, 0.0, "Opening the recording")
    file = worker.keep(read_recording, path, configuration, progress=part(progress, 0.0, 0.05), **reading)
    return browserOf(file, Path(path).name.split(".")[0], part(progress, 0.05, 1.0))


def browserOf(file, name: str, progress: Progress | None = None, reference: str | None = None):
    """A new sequence browser of a sequence that is kept in the worker, which forgets it then; errors as for `browserFromSequence`."""
    try:
        sequence = inWorker(without_images, file, progress=part(progress, 0.0, 0.05))
        images = FetchedImages(worker, file, sequence.images, part(progress, 0.05, 0.9))
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

"""Images and poses of any origin, which the worker reads: seen before they become a sweep of the scene."""

from AIFReconLib.progress import part
from AIFReconLib.worker.recordings import read_import, seen_of, sequence_in

from ..work import inWorker, worker
from .recordings import browserOf


class ForeignSweep:
    """What became of images and a file of poses with these `ImportOptions`, kept in the worker.

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

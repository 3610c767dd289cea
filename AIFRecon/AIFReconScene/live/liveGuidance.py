"""Guidance beside a scan: follows the bone that the parameters name, where it lies and what is drawn of it, while frames come."""

import time

import numpy as np

from AIFReconLib.errors import AIFReconError
from AIFReconLib.guidance.guidance import Guidance
from AIFReconLib.live.session.guidance_watch import GuidanceWatch
from AIFReconLib.message import said
from AIFReconLib.progress import part, report

from ..inputs.boneNodes import isLabeled
from ..inputs.inputs import Inputs
from ..registration.ctRegistration import rigidPlace

SETTLED = 1.0
"""s for which labels must stay as they are before they are read anew: while somebody draws, they would be read in vain."""

NO_BONE = "Select the bone of the CT, a segmentation or a labelmap: without it nobody can tell which bone was hit."


class LiveGuidance:
    """A `GuidanceWatch` for as long as the user wants one.

    Parameters
    ----------
    session : LiveSession
    parameters : AIFReconParameterNode

    Notes
    -----
    Everything here is called on the main thread and returns at once, but for the moments in which labels are read that have changed.
    """

    def __init__(self, session, parameters):
        self._session, self._parameters = session, parameters
        self._watch: GuidanceWatch | None = None
        self._problem: str | None = None
        self._place = np.eye(4)
        self._key = self._pending = None
        self._changed = 0.0
        self.bone = None

    def begin(self, progress=None) -> None:
        """Look at frames from now on; with `progress` it returns when the surface of bone is known."""
        self._take(_keyOf(self._parameters))
        while progress is not None and self._watch is not None and not self._watch.prepared.wait(0.05):
            report(progress, 0.0, "Finding the surface of bone")

    @property
    def state(self) -> Guidance:
        """What is known now."""
        if self._problem is not None:
            return Guidance(problem=self._problem)
        return Guidance() if self._watch is None else self._watch.state

    def follow(self) -> None:
        """Hear of bone that was moved, drawn anew, chosen or deleted; to be called often."""
        key = _keyOf(self._parameters)
        if key == self._key:
            self._pending = None
            self._followPlace()
        elif key != self._pending:
            self._pending, self._changed = key, time.monotonic()
        elif time.monotonic() - self._changed >= SETTLED or key is None or self._key is None:
            self._take(key)

    def stop(self, wait: bool = True) -> None:
        """Look at no more frames; what is known stays."""
        if self._watch is not None:
            self._watch.stop(wait)

    def _followPlace(self) -> None:
        if self._watch is None or self.bone is None or self.bone.GetScene() is None:
            return
        try:
            place = rigidPlace(self.bone)
        except AIFReconError as error:
            self._problem = said(error)
            return
        self._problem = None
        if (place != self._place).any():
            self._place = place
            self._watch.place(place)

    def _take(self, key) -> None:
        """Read the bone and look at it from now on."""
        self._key, self._pending, self.bone, self._problem = key, None, self._parameters.bone, None
        if key is None:
            self._problem = NO_BONE
            return
        try:
            self._place = rigidPlace(self.bone)
            labels = Inputs.fromParameters(self._parameters).labels()
        except AIFReconError as error:
            self._problem = said(error)
            return
        if self._watch is None:
            self._watch = GuidanceWatch(self._session, labels, self._place)
        else:
            self._watch.place(self._place, labels)


def _keyOf(parameters):
    """What changes when the labels of the chosen bone do; None without labels."""
    bone = parameters.bone
    if bone is None or bone.GetScene() is None or not isLabeled(bone):
        return None
    chosen = tuple(parameters.boneSegments)
    if not bone.IsA("vtkMRMLSegmentationNode"):
        image = bone.GetImageData()
        return bone.GetID(), 0 if image is None else image.GetMTime()
    segmentation = bone.GetSegmentation()
    name = segmentation.GetSourceRepresentationName()
    segments = [segmentation.GetNthSegment(number) for number in range(segmentation.GetNumberOfSegments())]
    drawn = (segment.GetRepresentation(name) for segment in segments)
    return bone.GetID(), chosen, tuple((0 if each is None else each.GetMTime()) for each in drawn)


def guidanceOfSweep(parameters, progress=None) -> Guidance:
    """What the chosen recorded sweeps have met, and the next move from where the last one ended.

    Raises
    ------
    AIFReconError
        With what cannot be used and what to do.
    """
    from AIFReconLib.guidance.guidance import guidance_of_sweep

    from ..background import inBackground
    from ..sweep.browserItems import checkRecorded

    inputs = Inputs.fromParameters(parameters)
    for sweep in inputs.sweeps:
        checkRecorded(sweep)
    place, sequence = np.asarray(rigidPlace(inputs.bone)), inputs.sequence()
    labels, progress = inputs.labels(part(progress, 0.0, 0.1)), part(progress, 0.1, 1.0)
    more = {"grid": inputs.grid(inputs.recipe), "recipe": inputs.recipe}
    return inBackground(lambda progress: guidance_of_sweep(sequence, labels, place, progress=progress, **more), progress)

"""The bone that a scan is told of: read from the scene, and again where it is drawn anew, chosen or moved."""

import time

import numpy as np

from AIFReconLib.errors import AIFReconError
from AIFReconLib.message import message_of

from ..inputs.boneNodes import isLabeled
from ..inputs.inputs import Inputs
from ..registration.ctRegistration import rigidPlace

SETTLED = 1.0
"""s for which labels must stay as they are before they are read anew: while somebody draws, they would be read in vain."""

NO_BONE = "Select the bone of the CT, or let the echoes tell it (“Bone told by”): without it nobody can tell which bone was hit."


class FollowedBone:
    """The chosen bone's labels and place, and what has become of them since they were last told.

    `labels`, a Volume or None, are in coordinates of their own, whose place in RAS world is `place`, (4, 4) mm; `problem` says why nobody
    can tell what is met of them.
    """

    def __init__(self, parameters, progress=None):
        self._parameters = parameters
        self._pending, self._changed = None, 0.0
        self.labels, self.place, self.problem = None, np.eye(4), NO_BONE
        self._read(_keyOf(parameters), progress)

    @property
    def node(self):
        """The bone's node; None where there is none any more."""
        bone = self._parameters.bone
        return bone if bone is not None and bone.GetScene() is not None else None

    def news(self):
        """The place, and the labels where these are others; None where all is as it was when this was last asked."""
        key = _keyOf(self._parameters)
        if key != self._pending:
            self._pending, self._changed = key, time.monotonic()
        if key != self._key and (time.monotonic() - self._changed >= SETTLED or None in (key, self._key)):
            self._read(key)
            return None if self.labels is None else (self.place, self.labels)
        before = self.place
        if key is None or not self._findPlace() or (before == self.place).all():
            return None
        return self.place, None

    def _read(self, key, progress=None) -> None:
        self._key, self.labels, self.problem = key, None, NO_BONE if key is None else None
        if key is None or not self._findPlace():
            return
        try:
            self.labels = Inputs.fromParameters(self._parameters).labels(progress)
        except AIFReconError as error:
            self.problem = message_of(error)

    def _findPlace(self) -> bool:
        try:
            self.place, self.problem = rigidPlace(self.node), None
        except AIFReconError as error:
            self.problem = message_of(error)
        return self.problem is None


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

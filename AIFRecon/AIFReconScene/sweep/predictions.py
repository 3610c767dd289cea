"""Bone as a network tells it in the frames of a sweep: predictions in a sequence of the scene."""

from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence

from .browserItems import timesOf
from .sequenceNodes import COVERS_ATTRIBUTE
from .sequenceReader import orientationFlips
from .sweepImages import SweepImages


def predictionsFromNode(sequenceNode) -> TrackedSequence:
    """The probabilities in a vtkMRMLSequenceNode of images, at its times in s where it has any, with what they cover if it says so.

    Raises
    ------
    SequenceFormatError
        When it holds no image.
    """
    count = sequenceNode.GetNumberOfDataNodes()
    flipColumns, flipRows = orientationFlips(sequenceNode)
    nodes = [sequenceNode.GetNthDataNode(number) for number in range(count)]
    images = SweepImages(nodes, sequenceNode.GetName(), flipColumns=flipColumns, flipRows=flipRows)
    covers = sequenceNode.GetAttribute(COVERS_ATTRIBUTE)
    fields = {COVERS_ATTRIBUTE: covers} if covers else {}
    times = timesOf(sequenceNode)
    return TrackedSequence(images, [FrameRecord(timestamp=times[number] if times else None, fields=fields) for number in range(count)])

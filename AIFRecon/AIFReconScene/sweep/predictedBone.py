"""Bone as a network tells it in the frames of a sweep: predictions in a sequence of the scene, or a model in a file."""

from typing import TYPE_CHECKING

from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence

from ..background import inBackground
from .browserItems import timesOf
from .sequenceNodes import COVERS_ATTRIBUTE
from .sequenceReader import orientationFlips
from .sweepImages import SweepImages

if TYPE_CHECKING:
    from pathlib import Path

    from AIFReconLib import BoneMap


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


def predictedBone(sequence: TrackedSequence, predictions=None, model: "Path | None" = None, recipe=None, progress=None) -> "BoneMap":
    """The `BoneMap` of what a network says of a sweep's frames, found on a thread of its own.

    Parameters
    ----------
    sequence : TrackedSequence
        As `sequenceFromBrowser` returns it.
    predictions : vtkMRMLSequenceNode or None
        What was predicted, one image for each frame or with their times.
    model : Path or None
        An ONNX file, where there are no predictions. It needs onnxruntime.
    recipe : Recipe or None
        As for a reconstruction; `bone_frames_px` says what a prediction covers.

    Raises
    ------
    AIFReconError
        With what does not fit and what to do.
    """
    from AIFReconLib.bone.model import OnnxModel
    from AIFReconLib.bone.predicted_bone import bone_from_frames
    from AIFReconLib.bone.recorded_predictions import RecordedPredictions
    from AIFReconLib.machine.threads import usable_cores

    # Nodes belong to the main thread: their pixels are copied here
    recorded = None if predictions is None else _inMemory(predictionsFromNode(predictions))

    def work(progress):
        estimator = (
            OnnxModel(model, usable_cores())
            if recorded is None
            else RecordedPredictions(sequence, recorded, recipe.bone_frames_px if recipe else None)
        )
        return bone_from_frames(sequence, estimator, recipe=recipe, progress=progress)

    return inBackground(work, progress)


def _inMemory(sequence: TrackedSequence) -> TrackedSequence:
    import numpy as np

    return TrackedSequence(np.stack([sequence.images[number] for number in range(len(sequence))]), sequence.records)

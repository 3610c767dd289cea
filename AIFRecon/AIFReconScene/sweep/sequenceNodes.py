"""A recorded sweep as a sequence browser: images that replay in place, with the status of every pose.

Frames keep their numbers. Images are in MF orientation with an identity IJKToRAS, so an image's own coordinates are its pixels (column,
row), and its parent transform ImageToReference puts it in place. Every transform of the recording has a sequence of its own beside that.
"""

from collections.abc import Sequence

import numpy as np
import slicer

from AIFReconLib.errors import AIFReconError, GeometryError, NoUsableFramesError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.io.sequence.slicer import index_values
from AIFReconLib.progress import Progress, part, report
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import SweepPoses, chain_ends, status_of_problem, sweep_poses
from AIFReconLib.sweep.record_text import record_from, record_of, record_text, usable_sample

from ..sceneNodes import freeName, newImage, removeNodes, showGrayLevels

IMAGE = "Image"
RECORD_ATTRIBUTE = "AIFRecon.Sweep"
"""Of the sequence browser node: what MRML files would round or drop, as a text of the library."""

STATUS_ATTRIBUTE = "TransformStatus"
"""Of a transform in a sequence: the tracker's word. SlicerOpenIGTLink keeps it under this name too."""

IMAGE_STATUS_ATTRIBUTE = "ImageStatus"
PROBLEM_ATTRIBUTE = "AIFRecon.Problem"
"""Of a pose that cannot be used: why, in the library's words."""

SOURCE_ATTRIBUTE = "Sequences.Source"
"""Of a sequence node: the name of the transform in the recording; Slicer's own importer keeps it there."""

COVERS_ATTRIBUTE = "BoneFramePx"
"""Of a sequence of predictions, as in its file: which rectangle of their frames they cover."""

ORIENTATION_ATTRIBUTE = "Sequences.UltrasoundImageOrientation"

FASTEST_REPLAY = 60.0
"""Frames per second."""

REPORTED_EVERY = 50
"""Transforms that are added between two reports of progress: some 20 ms."""


def browserFromSequence(sequence: TrackedSequence, name: str, progress: Progress | None = None, reference: str | None = None):
    """A new sequence browser node that replays `sequence`, whose images are read one after the other.

    Its master sequence holds the images. Items are numbered by time stamps rounded to 1 ms, unit s; by frame numbers where time stamps are
    missing, repeated, not in order or too close for that. A frame without a valid pose stays where the last valid one was, and says why it
    cannot be used. Where the recording has no chain from image to reference (no calibration), the images are there without a place, and
    `sequenceFromBrowser` says what is missing. `reference` is the frame that becomes RAS world (default: Reference).

    Raises AIFReconError when a frame cannot be read, or there is none; the scene is then as it was, as after a cancel.
    """
    if not len(sequence):
        raise NoUsableFramesError(f"{sequence.name}: it has no frames. Choose another recording.")
    name = freeName(name)
    poses, poseName = _poses(sequence, reference)
    index, unit = index_values(sequence.records)
    images = _sequenceNode(f"{name}-{IMAGE}", IMAGE, unit)
    images.SetAttribute(ORIENTATION_ATTRIBUTE, "MFA")
    images.SetAttribute(COVERS_ATTRIBUTE, sequence.records[0].fields.get(COVERS_ATTRIBUTE))
    _fillImages(images, sequence, index, part(progress, 0.0, 0.9))
    transforms = {}
    names = [each for each in sequence.transform_names() if each not in sequence.transforms]
    for number, transformName in enumerate(names):
        node = _sequenceNode(f"{name}-{transformName}", str(transformName), unit)
        share = part(progress, 0.9 + 0.08 * number / len(names), 0.9 + 0.08 * (number + 1) / len(names))
        _fillTransforms(node, transformName, sequence.records, index, share)
        transforms[transformName] = node
    if poses is not None and poseName not in transforms:
        node = _sequenceNode(f"{name}-{poseName}", str(poseName), unit)
        _fillPoses(node, poseName, poses, index)
        transforms = {poseName: node, **transforms}
    record = record_text(record_of(sequence, poses, poseName, index, part(progress, 0.98, 1.0)))
    report(progress, 1.0, "Added the sweep")
    browser = _addToScene(name, images, transforms, transforms.get(poseName) if poses is not None else None, record)
    if unit and len(index) > 1:
        browser.SetPlaybackRateFps(min(max((len(index) - 1) / (float(index[-1]) - float(index[0])), 1.0), FASTEST_REPLAY))
    return browser


def recordOf(browser) -> dict:
    """What was kept of the sweep; an empty dict for a browser that somebody else made, or whose record is damaged."""
    return record_from(browser.GetAttribute(RECORD_ATTRIBUTE))


def _poses(sequence: TrackedSequence, reference: str | None) -> tuple[SweepPoses | None, TransformName]:
    """Where the frames lie, None where no chain of transforms tells; and what that chain as a whole is called."""
    name, _ = chain_ends(sequence.configuration, None, reference)
    try:
        return sweep_poses(sequence, reference=reference), name
    except AIFReconError:
        # Such a sweep can be looked at all the same
        return None, name


def _sequenceNode(name: str, source: str, unit: str):
    """An empty sequence node that is in no scene yet."""
    node = slicer.vtkMRMLSequenceNode()
    node.SetName(name)
    node.SetAttribute(SOURCE_ATTRIBUTE, source)
    node.SetIndexName("time" if unit else "frame")
    node.SetIndexUnit(unit)
    node.SetIndexType(slicer.vtkMRMLSequenceNode.NumericIndex)
    return node


def _fillImages(node, sequence: TrackedSequence, index: list[str], progress: Progress | None) -> None:
    # One node and one image for all frames: setting an item copies both, and VTK gets slow with the number of images that Python has seen
    frame = slicer.vtkMRMLScalarVolumeNode()
    frame.SetName(IMAGE)
    like, pixels = None, np.empty(0)
    for number, record in enumerate(sequence.records):
        report(progress, number / len(sequence), "Loading frames")
        image = np.asarray(sequence.images[number])
        if image.ndim != 2:
            raise GeometryError(f"{sequence.name}: image {number} must have shape (rows, columns); got {image.shape}.")
        if like != (image.shape, image.dtype):
            like = image.shape, image.dtype
            imageData, pixels = newImage(image[None])
            frame.SetAndObserveImageData(imageData)
        pixels[0] = image
        frame.SetAttribute(IMAGE_STATUS_ATTRIBUTE, record.image_status.value)
        node.SetDataNodeAtValue(frame, index[number])


def _fillTransforms(node, name: TransformName, records: Sequence[FrameRecord], index: list[str], progress: Progress | None) -> None:
    """A transform as recorded. What has no matrix is the identity, and its status says so: MISSING where a frame lacks it."""
    missing = TransformSample(np.full((4, 4), np.nan), TransformStatus.MISSING)
    for number, record in enumerate(records):
        if number % REPORTED_EVERY == 0:
            report(progress, number / len(records), "Adding transforms")
        matrix, status = usable_sample(record.transforms.get(name, missing))
        _setTransform(node, index[number], name, matrix, status)


def _fillPoses(node, name: TransformName, poses: SweepPoses, index: list[str]) -> None:
    usable = poses.usable
    last = poses.image_to_reference[usable[0]] if usable.size else np.eye(4)
    for number, problem in enumerate(poses.problems):
        last = poses.image_to_reference[number] if problem is None else last
        item = _setTransform(node, index[number], name, last, status_of_problem(problem))
        if problem is not None:
            item.SetAttribute(PROBLEM_ATTRIBUTE, problem)


def _setTransform(node, indexValue: str, name: TransformName, matrix: np.ndarray, status: TransformStatus):
    transform = slicer.vtkMRMLLinearTransformNode()
    transform.SetName(str(name))
    transform.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(matrix))
    transform.SetAttribute(STATUS_ATTRIBUTE, status.value)
    return node.SetDataNodeAtValue(transform, indexValue)


def _addToScene(name: str, images, transforms: dict, pose, record: str):
    """Sequences, browser with its record and the nodes that it replays, the images under the pose; all or nothing."""
    added, scene = [], slicer.mrmlScene
    scene.SaveStateForUndo()
    try:
        for node in (images, *transforms.values()):
            added.append(scene.AddNode(node))
        browser = scene.AddNewNodeByClass("vtkMRMLSequenceBrowserNode", name)
        added.append(browser)
        browser.SetName(name)
        browser.SetAndObserveMasterSequenceNodeID(images.GetID())
        # At every change of a browser, Slicer looks through all that it replays
        with slicer.util.NodeModify(browser):
            browser.SetAttribute(RECORD_ATTRIBUTE, record)
            for node in transforms.values():
                browser.AddSynchronizedSequenceNode(node)
        proxies = {}
        for node in (images, *transforms.values()):
            item = node.GetNthDataNode(0)
            proxy = browser.GetProxyNode(node) or browser.AddProxyNode(item, node, True)
            added.append(proxy)
            browser.SetSaveChanges(node, False)
            browser.SetOverwriteProxyName(node, False)
            proxy.CopyContent(item)
            proxy.SetName(node.GetName())
            proxies[node] = proxy
        showGrayLevels(proxies[images])
        if pose is not None:
            proxies[images].SetAndObserveTransformNodeID(proxies[pose].GetID())
        browser.SetSelectedItemNumber(0)
    except Exception:
        removeNodes(added)
        raise
    return browser

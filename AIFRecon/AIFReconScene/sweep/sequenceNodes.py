"""A recorded sweep as a sequence browser: images that replay in place, with the status of every pose.

Frames keep their numbers. Images are in MF orientation with an identity IJKToRAS, so an image's own coordinates are its pixels (column,
row), and its parent transform ImageToReference puts it in place. Every transform of the recording has a sequence of its own beside that.
"""

import math
from collections.abc import Sequence

import numpy as np
import slicer

from AIFReconLib.errors import AIFReconError, GeometryError, NoUsableFramesError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.geometry.transforms import as_matrix
from AIFReconLib.progress import Progress, part, report
from AIFReconLib.sweep.configuration import NO_CONFIGURATION
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import SweepPoses, chain_ends, sweep_poses

from ..sceneNodes import freeName, newImage, removeNodes, showGrayLevels
from .sweepRecord import ATTRIBUTE, recordText

IMAGE = "Image"
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

CLOSEST_INDEX = 0.002
"""s. Times closer than this cannot number frames: Slicer's files keep times to 1 ms, and it takes values within 1 ms for equal."""


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
    index, unit = indexValues(sequence.records)
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
    record = recordText(_record(sequence, poses, poseName, index, part(progress, 0.98, 1.0)))
    report(progress, 1.0, "Added the sweep")
    browser = _addToScene(name, images, transforms, transforms.get(poseName) if poses is not None else None, record)
    if unit and len(index) > 1:
        browser.SetPlaybackRateFps(min(max((len(index) - 1) / (float(index[-1]) - float(index[0])), 1.0), FASTEST_REPLAY))
    return browser


def indexValues(records: Sequence[FrameRecord]) -> tuple[list[str], str]:
    """What numbers the items of a sequence, and its unit: times in s where they can tell frames apart, else frame numbers."""
    times = [record.timestamp for record in records]
    if all(time is not None and math.isfinite(time) for time in times):
        rounded = [f"{time:.3f}" for time in times]
        gaps = np.diff([float(text) for text in rounded])
        if not gaps.size or gaps.min() > CLOSEST_INDEX - 1e-9:
            return rounded, "s"
    return [str(number) for number in range(len(records))], ""


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
        matrix, status = _usable(record.transforms.get(name, missing))
        _setTransform(node, index[number], name, matrix, status)


def _usable(sample: TransformSample) -> tuple[np.ndarray, TransformStatus]:
    """Matrix and status as a transform node can hold them: INVALID and the identity for what is no invertible affine matrix."""
    try:
        return as_matrix(sample.matrix), sample.status
    except GeometryError:
        status = TransformStatus.INVALID if sample.status is TransformStatus.OK else sample.status
        return np.eye(4), status


def _fillPoses(node, name: TransformName, poses: SweepPoses, index: list[str]) -> None:
    usable = poses.usable
    last = poses.image_to_reference[usable[0]] if usable.size else np.eye(4)
    for number, problem in enumerate(poses.problems):
        last = poses.image_to_reference[number] if problem is None else last
        item = _setTransform(node, index[number], name, last, statusOf(problem))
        if problem is not None:
            item.SetAttribute(PROBLEM_ATTRIBUTE, problem)


def statusOf(problem: str | None) -> TransformStatus:
    """The status that a reason of `sweep_poses` ends with (``ProbeToTracker OUT_OF_VIEW``); INVALID for a reason without one."""
    if problem is None:
        return TransformStatus.OK
    status = TransformStatus.parse(problem.replace("(", " ").replace(")", " ").split()[-1])
    return TransformStatus.INVALID if status in (TransformStatus.UNKNOWN, TransformStatus.OK) else status


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
            browser.SetAttribute(ATTRIBUTE, record)
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


def _record(sequence: TrackedSequence, poses: SweepPoses | None, poseName: TransformName, index: list[str], progress) -> dict:
    """What `sequenceFromBrowser` needs and MRML does not keep, frame by frame under the text that numbers it."""
    names = [name for name in sequence.transform_names() if name not in sequence.transforms]
    frames = {}
    for number, record in enumerate(sequence.records):
        if number % REPORTED_EVERY == 0:
            report(progress, number / len(sequence), "Adding transforms")
        frame: dict[str, object] = {"time": record.timestamp}
        if record.unfiltered_timestamp is not None:
            frame["unfiltered"] = record.unfiltered_timestamp
        if record.image_status is not TransformStatus.OK:
            frame["image"] = record.image_status.value
        if record.fields:
            frame["fields"] = dict(record.fields)
        missing = TransformSample(np.full((4, 4), np.nan), TransformStatus.MISSING)
        statuses = {str(transform): _usable(record.transforms.get(transform, missing))[1].value for transform in names}
        statuses = {transform: status for transform, status in statuses.items() if status != TransformStatus.OK.value}
        if poses is not None:
            if poses.problems[number] is None:
                frame["pose"] = poses.image_to_reference[number]
            else:
                frame["problem"] = poses.problems[number]
                statuses[str(poseName)] = statusOf(poses.problems[number]).value
        if statuses:
            frame["statuses"] = statuses
        frames[index[number]] = frame
    return {
        "version": 1,
        "name": sequence.name,
        "poseName": str(poseName) if poses is not None else None,
        "fields": dict(sequence.fields),
        "notes": tuple(sequence.notes if poses is None else poses.notes),
        "transforms": dict(sequence.transforms),
        "configuration": None if sequence.configuration is NO_CONFIGURATION else sequence.configuration,
        "frames": frames,
    }

"""A sequence browser as the library's sweep: images read from the nodes when asked for, every frame with its place in RAS world."""

from dataclasses import replace

import numpy as np

from AIFReconLib.errors import AIFReconError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.inspection.summary import SweepSummary
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence

from .browserItems import BrowserItems, checkRecorded, timesOf
from .sequenceNodes import COVERS_ATTRIBUTE, IMAGE_STATUS_ATTRIBUTE, ORIENTATION_ATTRIBUTE, PROBLEM_ATTRIBUTE
from .sweepImages import SweepImages, hasImage
from .sweepPoses import FramePose, framePoses

IMAGE_TO_WORLD = TransformName("Image", "Reference")
"""What the poses are called in the sweep that is handed to the library: Reference is RAS world."""


def sequenceFromBrowser(browser, imageSequence=None, reference: str | None = None) -> TrackedSequence:
    """The sweep that a sequence browser holds, a frame for each item of its images.

    Its records hold ImageToReference, pixels to RAS world in mm, with the tracker's status. A sweep that was loaded from a Plus recording
    brings its times, fields and configuration along; the calibration is in the poses already.

    The images are in `imageSequence`, by default in the browser's master, else in its only sequence of images. `reference` is the frame to
    reconstruct in, where no parent transform places the images and transforms are found by their names. An AIFReconError says that the
    browser has no usable images, or that nothing tells where they are.

    A frame lies where the image's parent transforms put it, each at the time of the image (see `framePoses`), static ones (such as
    ReferenceToRAS) as they are now. Images without a parent are placed by the names of the browser's transforms (ImageToReference, or
    ImageToProbe and ProbeToReference, ...), else by their own matrices where these differ between frames. Images that somebody else
    loaded in another orientation (``Sequences.UltrasoundImageOrientation``) are brought to MF, which the poses are for.
    """
    items = BrowserItems(browser, imageSequence)
    nodes = [items.images.GetNthDataNode(number) for number in range(len(items))]
    flipColumns, flipRows = orientationFlips(items.images)
    images = SweepImages(nodes, items.path.name, flipColumns=flipColumns, flipRows=flipRows)
    poses = framePoses(items, reference)
    records = [_frameRecord(items, number, nodes[number], poses[number]) for number in range(len(items))]
    configuration = items.record.get("configuration")
    if configuration is not None:
        # The calibration and the frames' names have done their part
        configuration = replace(configuration, transforms={}, image_frame=None, reference_frame=None)
    return TrackedSequence(
        images,
        records,
        fields=dict(items.record.get("fields", {})),
        configuration=configuration,
        path=items.path,
        notes=tuple(items.record.get("notes", ())),
    )


def sweepSummary(browser, imageSequence=None, reference: str | None = None) -> SweepSummary:
    """How many frames of a sweep can be used, and why the others cannot; fast, because no pixel is read. Nothing is raised."""
    frames = 0
    try:
        checkRecorded(browser)
        items = BrowserItems(browser, imageSequence)
        frames = len(items)
        poses = framePoses(items, reference)
    except AIFReconError as error:
        return SweepSummary(frames, 0, {}, error.args[0])
    skipped: dict[str, list[int]] = {}
    for number, pose in enumerate(poses):
        status = _imageStatus(items, number, items.images.GetNthDataNode(number))
        problem = pose.problem if status is TransformStatus.OK else f"no image ({status.value})"
        if problem is not None:
            skipped.setdefault(problem, []).append(number)
    return SweepSummary.of_frames(items.path.name, frames, skipped)


def _frameRecord(items: BrowserItems, number: int, node, pose: FramePose) -> FrameRecord:
    recorded = items.recorded(number)
    matrix = np.full((4, 4), np.nan) if pose.matrix is None else pose.matrix
    fields = dict(recorded.get("fields", {}))
    if pose.problem:
        fields[PROBLEM_ATTRIBUTE] = pose.problem
    return FrameRecord(
        timestamp=recorded["time"] if "time" in recorded else items.times and items.times[number],
        unfiltered_timestamp=recorded.get("unfiltered"),
        image_status=_imageStatus(items, number, node),
        transforms={IMAGE_TO_WORLD: TransformSample(matrix, pose.status)},
        fields=fields,
    )


def _imageStatus(items: BrowserItems, number: int, node) -> TransformStatus:
    if not hasImage(node):
        return TransformStatus.MISSING
    word = node.GetAttribute(IMAGE_STATUS_ATTRIBUTE) or node.GetAttribute(f"OpenIGTLink.{IMAGE_STATUS_ATTRIBUTE}")
    return TransformStatus.parse(word or items.recorded(number).get("image") or TransformStatus.OK.value)


def orientationFlips(imageSequence) -> tuple[bool, bool]:
    """Whether columns, and whether rows are reversed against MF. An unknown orientation is taken as it is shown."""
    code = (imageSequence.GetAttribute(ORIENTATION_ATTRIBUTE) or "").upper()
    known = len(code) >= 2 and code[0] in "MU" and code[1] in "FN"
    return (code[0] == "U", code[1] == "N") if known else (False, False)


def predictionsFromNode(sequenceNode) -> TrackedSequence:
    """The probabilities in a vtkMRMLSequenceNode of images, at its times in s where it has any, with what they cover if it says so."""
    count = sequenceNode.GetNumberOfDataNodes()
    flipColumns, flipRows = orientationFlips(sequenceNode)
    nodes = [sequenceNode.GetNthDataNode(number) for number in range(count)]
    images = SweepImages(nodes, sequenceNode.GetName(), flipColumns=flipColumns, flipRows=flipRows)
    covers = sequenceNode.GetAttribute(COVERS_ATTRIBUTE)
    fields = {COVERS_ATTRIBUTE: covers} if covers else {}
    times = timesOf(sequenceNode)
    return TrackedSequence(images, [FrameRecord(timestamp=times[number] if times else None, fields=fields) for number in range(count)])

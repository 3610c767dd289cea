"""Where every frame of a sequence browser lies in RAS world, and why a frame cannot be used. No pixel is read.

An image lies where its own matrix and the transforms above it put it, each as it was at the time of the image, by the rule that sequences
in files follow too. (The browser replays the pose before it instead, however old.)
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import slicer

from AIFReconLib.errors import AIFReconError, TransformError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.geometry.transforms import why_not_an_image_pose
from AIFReconLib.recipe.recipe import LONGEST_GAP
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.pose_tracks import SLICERS_TIME, PoseTrack
from AIFReconLib.sweep.poses import status_of_problem, sweep_poses

from ..transforms import ijkToRAS, matrixToParent, parentTransforms
from .browserItems import BrowserItems, isTransformName, timesOf
from .sequenceNodes import IMAGE, STATUS_ATTRIBUTE

ROUNDED, TINY = 1e-5, 1e-9
"""How far numbers of a matrix move that Slicer writes with 6 digits: by this share of them, or this."""

_VALID_ATTRIBUTES = ("TransformValid", "OpenIGTLink.TransformValid")
_STATUS_ATTRIBUTES = (STATUS_ATTRIBUTE, "OpenIGTLink.TransformStatus", "Status")
"""Of transform nodes, as SlicerOpenIGTLink sets them from a message's metadata."""


@dataclass(frozen=True)
class FramePose:
    """Where a frame lies: (4, 4) pixels to RAS world in mm, or None and why it cannot be used."""

    matrix: np.ndarray | None
    problem: str | None = None
    status: TransformStatus = TransformStatus.OK


def framePoses(items: BrowserItems, reference: str | None = None) -> list[FramePose]:
    """One `FramePose` for every item of the browser.

    `reference` is the frame to reconstruct in, where images have no parent transform and the way is found by the names of transforms.

    Raises TransformError when nothing tells where the images are, for a transform that is not linear, and for one that another browser
    replays.
    """
    proxy = items.browser.GetProxyNode(items.images)
    if proxy is not None and proxy.GetParentTransformNode() is not None:
        links = [_Link.above(items, node) for node in parentTransforms(proxy)]
        return [_followed(items, links, number) for number in range(len(items))]
    named = _namedTransforms(items)
    if named or not _embedded(items):
        return _byName(items, named, reference)
    return [_embeddedPose(items, number) for number in range(len(items))]


class _Link:
    """One transform above the images: the same for all frames, or what a sequence says of the time of each of them."""

    def __init__(self, items: BrowserItems, node, sequenceNode):
        self.items, self.sequenceNode = items, sequenceNode
        self.name = items.nameOf(sequenceNode) if sequenceNode is not None else node.GetName()
        self.fixed = matrixToParent(node) if sequenceNode is None else None
        self.times = timesOf(sequenceNode) if sequenceNode is not None else None

    @classmethod
    def above(cls, items: BrowserItems, node) -> "_Link":
        sequenceNode = items.sequenceBehind(node)
        if sequenceNode is None:
            other = items.otherBrowserOf(node)
            if other is not None:
                raise TransformError(
                    f"Transform {node.GetName()!r} must be replayed by {items.browser.GetName()!r}, as the images are; it is replayed "
                    f"by {other.GetName()!r}. Add its sequence to the browser of the images (Sequences module, Synchronized nodes)."
                )
        return cls(items, node, sequenceNode)

    def at(self, number: int) -> tuple[np.ndarray | None, str | None, TransformStatus]:
        """Matrix to its parent, or what is wrong with it in this frame."""
        if self.fixed is not None:
            return self.fixed, None, TransformStatus.OK
        itemNumber = self.items.numberAt(self.sequenceNode, self.times, number)
        if itemNumber is None:
            timed = self.times is not None and self.items.times is not None
            matrix = self._track.at(self.items.times[number], LONGEST_GAP, SLICERS_TIME)[0] if timed else None
            if matrix is None:
                return None, f"{self.name} {TransformStatus.MISSING.value}", TransformStatus.MISSING
            return matrix, None, TransformStatus.OK
        item = self.sequenceNode.GetNthDataNode(itemNumber)
        status = self._statusOf(itemNumber)
        if status is not TransformStatus.OK:
            return None, self.items.recordedProblem(self.sequenceNode, item, number) or f"{self.name} {status.value}", status
        matrix = matrixToParent(item)
        exact = self.items.exactPose(self.sequenceNode, number)
        if exact is not None and (np.abs(matrix - exact) <= ROUNDED * np.abs(exact) + TINY).all():
            matrix = exact
        return matrix, None, status

    @cached_property
    def _track(self) -> PoseTrack:
        return PoseTrack(
            (time, TransformSample(matrixToParent(self.sequenceNode.GetNthDataNode(number)), self._statusOf(number)))
            for number, time in enumerate(self.times or ())
        )

    def _statusOf(self, itemNumber: int) -> TransformStatus:
        return transformStatus(self.sequenceNode.GetNthDataNode(itemNumber), self.items.recordedStatus(self.sequenceNode, itemNumber))


def transformStatus(node, recorded: str | None = None) -> TransformStatus:
    """What the tracker said of a transform in a sequence; OK where nobody says anything.

    `recorded` is the word that is known from elsewhere, for nodes that have lost their attributes in a file.
    """
    for name in _STATUS_ATTRIBUTES:
        word = node.GetAttribute(name)
        if word:
            return TransformStatus.parse(word)
    if any((node.GetAttribute(name) or "").strip().lower() in ("false", "0") for name in _VALID_ATTRIBUTES):
        return TransformStatus.INVALID
    return TransformStatus.parse(recorded) if recorded else TransformStatus.OK


def _followed(items: BrowserItems, links: list[_Link], number: int) -> FramePose:
    image = items.images.GetNthDataNode(number)
    matrix = ijkToRAS(image) if image is not None else np.eye(4)
    for link in links:
        toParent, problem, status = link.at(number)
        problem, status = (problem, status) if problem else _statedByImage(image, (link.name,))
        if toParent is None or problem is not None:
            return FramePose(None, problem, status)
        matrix = toParent @ matrix
    return _checked(matrix)


def _checked(matrix: np.ndarray) -> FramePose:
    problem = why_not_an_image_pose(matrix)
    return FramePose(None, f"image pose {problem}", TransformStatus.INVALID) if problem else FramePose(matrix)


def _statedByImage(image, names: tuple[str, ...]) -> tuple[str | None, TransformStatus]:
    """What the image message itself said of transforms with these names (SlicerOpenIGTLink keeps its fields as attributes)."""
    for name in names:
        word = image.GetAttribute(f"OpenIGTLink.{name}TransformStatus") if image is not None else None
        if word and TransformStatus.parse(word) is not TransformStatus.OK:
            return f"{name} {word}", TransformStatus.parse(word)
    return None, TransformStatus.OK


def _embedded(items: BrowserItems) -> bool:
    """Whether the images' own matrices place them: they move from frame to frame."""
    matrices = [ijkToRAS(image) for image in (items.images.GetNthDataNode(number) for number in range(len(items))) if image is not None]
    return len(matrices) > 1 and any(not np.array_equal(matrix, matrices[0]) for matrix in matrices[1:])


def _embeddedPose(items: BrowserItems, number: int) -> FramePose:
    image = items.images.GetNthDataNode(number)
    if image is None:
        return FramePose(None, f"no image ({TransformStatus.MISSING.value})", TransformStatus.MISSING)
    prefix, suffix = "OpenIGTLink.", "TransformStatus"
    attributes = [name for name in image.GetAttributeNames() if name.startswith(prefix) and name.endswith(suffix)]
    stated = [name.removeprefix(prefix).removesuffix(suffix) for name in attributes]
    # A stylus that is out of view does not concern the image
    about = [name for name in stated if name.startswith("ImageTo")]
    about = about or [name for name in stated if name.startswith(("ProbeTo", "ReferenceTo"))]
    problem, status = _statedByImage(image, tuple(about))
    return FramePose(None, problem, status) if problem else _checked(ijkToRAS(image))


def _namedTransforms(items: BrowserItems) -> dict[TransformName, object]:
    """The browser's transform sequences whose names say from where to where they lead."""
    found: dict[TransformName, object] = {}
    for sequenceNode in items.transformSequences():
        if isTransformName(name := items.nameOf(sequenceNode)):
            found.setdefault(TransformName.parse(name), sequenceNode)
    return found


def _byName(items: BrowserItems, named: dict, reference: str | None) -> list[FramePose]:
    """Poses by the library's search for a chain from Image to Reference; then static transforms of the scene may fill gaps."""
    links = {name: _Link(items, None, sequenceNode) for name, sequenceNode in named.items()}
    records = []
    for number in range(len(items)):
        transforms = {}
        for name, link in links.items():
            matrix, problem, status = link.at(number)
            transforms[name] = TransformSample(np.full((4, 4), np.nan) if matrix is None else matrix, status)
        records.append(FrameRecord(transforms=transforms))
    static = items.record.get("transforms", {})
    configuration = items.record.get("configuration")
    images = np.empty((len(items), 1, 1), np.uint8)
    sequence = TrackedSequence(images, records, transforms=static, configuration=configuration, path=items.path)
    try:
        poses = sweep_poses(sequence, reference=reference)
    except AIFReconError as error:
        ofScene = {name: TransformSample(matrixToParent(node)) for name, node in _staticTransforms(items, named).items()}
        more = {**ofScene, **static}
        if len(more) == len(static):
            raise
        try:
            poses = sweep_poses(replace(sequence, transforms=more), reference=reference)
        except AIFReconError:
            raise error from None
    above = _aboveReference(items, named, poses.path)
    result = []
    for number, problem in enumerate(poses.problems):
        if problem is None:
            pose = FramePose(poses.image_to_reference[number])
            for link in above:
                matrix, problem, status = link.at(number)
                pose = FramePose(None, problem, status) if problem or pose.matrix is None else FramePose(matrix @ pose.matrix)
            result.append(pose)
        else:
            result.append(FramePose(None, problem, status_of_problem(problem)))
    return result


def _staticTransforms(items: BrowserItems, named: dict) -> dict[TransformName, object]:
    """Linear transforms of the scene that no browser replays and whose names say where they lead: calibrations."""
    found = {}
    for node in slicer.util.getNodesByClass("vtkMRMLLinearTransformNode"):
        if not isTransformName(node.GetName() or ""):
            continue
        name = TransformName.parse(node.GetName())
        taken = name in named or name.inverse in named or name in found or name.inverse in found
        if not taken and items.sequenceBehind(node) is None and items.otherBrowserOf(node) is None:
            found[name] = node
    return found


def calibrationOf(items: BrowserItems):
    """The transform that calibrates the images; None where one is to be made between them and the transform that moves them.

    A TransformError says that none can: it is recorded with poses that are found by their names, or each image has its own.
    """
    proxy = items.browser.GetProxyNode(items.images)
    above = proxy.GetParentTransformNode() if proxy is not None else None
    if above is not None and not _embedded(items):
        return above if items.sequenceBehind(above) is None else None
    named = _namedTransforms(items)
    recorded = (*named, *items.record.get("transforms", ()), *getattr(items.record.get("configuration"), "transforms", ()))
    found = [node for name, node in _staticTransforms(items, named).items() if name.source == IMAGE]
    if above is None and len(found) == 1 and IMAGE not in (name.source for name in recorded):
        return found[0]
    raise TransformError(
        f"{items.path}: no transform of the scene can take a calibration of its images alone. In Slicer's Data module, drag the images "
        "onto the transform that moves them."
    )


def _aboveReference(items: BrowserItems, named: dict, path: tuple[TransformName, ...]) -> list[_Link]:
    """The transforms above the one that ends in the reference frame, such as a ReferenceToRAS that the user has put above the sweep."""
    last = named.get(path[-1])
    proxy = items.browser.GetProxyNode(last) if last is not None else None
    return [_Link.above(items, node) for node in parentTransforms(proxy)] if proxy is not None else []

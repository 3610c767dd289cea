"""The items of a sequence browser: its images, each once, and what its other sequences hold at their times."""

from bisect import bisect_left
from pathlib import Path

import numpy as np
import slicer

from AIFReconLib.errors import AIFReconError, SequenceFormatError, TransformError
from AIFReconLib.geometry.transform_graph import TransformName
from AIFReconLib.io.sequence.slicer import index_seconds
from AIFReconLib.sweep.pose_tracks import SLICERS_TIME

from ..sceneNodes import sequencesOf
from .sequenceNodes import PROBLEM_ATTRIBUTE, SOURCE_ATTRIBUTE, recordOf


class BrowserItems:
    """A browser's sequences, image by image: what is replayed twice, because another sequence leads, is one frame.

    The images are in `imageSequence`, by default in the master, else in the only sequence that has some. Raises SequenceFormatError when
    the browser has no items or no images, or several sequences of images and none is named.
    """

    def __init__(self, browser, imageSequence=None):
        self.browser = browser
        self.path = Path(browser.GetName() or "sweep")
        self.master = browser.GetMasterSequenceNode()
        if self.master is None or not self.master.GetNumberOfDataNodes():
            raise SequenceFormatError(f"{self.path}: this sequence browser has no items. Record or load a sweep first.")
        self.sequences = [self.master, *sequencesOf(browser, withMaster=False)]
        self.images = imageSequence or self._findImages()
        if self.images not in self.sequences:
            raise SequenceFormatError(
                f"{self.path}: sequence {self.images.GetName()!r} is not one of this browser's. Choose one of: "
                f"{self._names(self.sequences)}."
            )
        self.record = recordOf(browser)
        self._frames = self.record.get("frames", {})
        self.times = timesOf(self.images)

    def __len__(self) -> int:
        return self.images.GetNumberOfDataNodes()

    def recorded(self, number: int, sequenceNode=None) -> dict:
        """What the browser's record says of item `number` (of the images); empty for a browser of another maker, or an item added later."""
        return self._frames.get((sequenceNode or self.images).GetNthIndexValue(number), {})

    def numberAt(self, sequenceNode, times: "list[float] | None", number: int) -> int | None:
        """Which item of a sequence, with its `timesOf`, is of the very time of image `number`, or of its text where either has no times."""
        if times is None or self.times is None:
            found = sequenceNode.GetItemNumberFromIndexValue(self.images.GetNthIndexValue(number), True)
            return found if found >= 0 else None
        found = bisect_left(times, self.times[number])
        near = [at for at in (found - 1, found) if 0 <= at < len(times) and abs(times[at] - self.times[number]) <= SLICERS_TIME]
        return min(near, key=lambda at: abs(times[at] - self.times[number]), default=None)

    def shownImage(self):
        """The image of the item that the browser replays just now."""
        value = self.master.GetNthIndexValue(max(self.browser.GetSelectedItemNumber(), 0))
        return self.images.GetDataNodeAtValue(value, False) or self.images.GetNthDataNode(0)

    def sequenceBehind(self, node):
        """The sequence that this browser replays into `node`; None for any other node, and where replay is turned off."""
        sequenceNode = self.browser.GetSequenceNode(node)
        return sequenceNode if sequenceNode is not None and self.browser.GetPlayback(sequenceNode) else None

    def otherBrowserOf(self, node):
        """Another browser that replays into `node`, or None."""
        for browser in slicer.util.getNodesByClass("vtkMRMLSequenceBrowserNode"):
            if browser is not self.browser and browser.IsProxyNodeID(node.GetID()):
                return browser
        return None

    def transformSequences(self) -> list:
        """The browser's sequences of transforms."""
        return [node for node in self.sequences if _holds(node, "vtkMRMLTransformNode")]

    def nameOf(self, sequenceNode) -> str:
        """What a sequence is of: the first of its names that says from where to where it leads (ProbeToTracker), else the first.

        They are those of the recording, of the node that it is replayed into, of its items, and its own, whatever a user has made of some.
        """
        proxy = self.browser.GetProxyNode(sequenceNode)
        item = sequenceNode.GetNthDataNode(0) if sequenceNode.GetNumberOfDataNodes() else None
        names = [sequenceNode.GetAttribute(SOURCE_ATTRIBUTE), proxy and proxy.GetAttribute("Sequences.BaseName")]
        names += [node.GetName() for node in (proxy, item, sequenceNode) if node is not None]
        names = [name.removesuffix("Transform") or name for name in names if name]
        return next(filter(isTransformName, names), names[0] if names else "")

    def exactPose(self, sequenceNode, number: int) -> np.ndarray | None:
        """The pose of item `number` to the last digit, where `sequenceNode` is the sequence of poses that the record is of."""
        return self.recorded(number).get("pose") if self._isOfRecord(sequenceNode) else None

    def recordedStatus(self, sequenceNode, number: int) -> str | None:
        """The status that the record has for item `number` of a transform's sequence; None where it was OK or nothing is known."""
        return self.recorded(number, sequenceNode).get("statuses", {}).get(self.nameOf(sequenceNode))

    def recordedProblem(self, sequenceNode, item, number: int) -> str | None:
        """Why a pose cannot be used, in the words of the library when the sweep was loaded."""
        attribute = item.GetAttribute(PROBLEM_ATTRIBUTE)
        recorded = self.recorded(number).get("problem") if self._isOfRecord(sequenceNode) else None
        # Alike, they are the same text; that of the record can be translated
        return recorded if attribute in (None, "", recorded) else attribute

    def _isOfRecord(self, sequenceNode) -> bool:
        return bool(self.record.get("poseName")) and self.nameOf(sequenceNode) == self.record["poseName"]

    def _findImages(self):
        holding = [node for node in self.sequences if _holds(node, "vtkMRMLVolumeNode")]
        if not holding:
            raise SequenceFormatError(f"{self.path}: none of its sequences holds images. Choose the browser of a tracked sweep.")
        if len(holding) > 1 and holding[0] is not self.master:
            raise SequenceFormatError(f"{self.path}: several of its sequences hold images. Choose one of: {self._names(holding)}.")
        return holding[0]

    @staticmethod
    def _names(nodes: list) -> str:
        return ", ".join(node.GetName() or "" for node in nodes)


def timesOf(sequenceNode) -> list[float] | None:
    """Times of a sequence's items in s; None where they are not numbered by time, or not in its order."""
    unit, label = ((text or "").lower() for text in (sequenceNode.GetIndexUnit(), sequenceNode.GetIndexName()))
    seconds = index_seconds(unit, label)
    if seconds is None:
        return None
    try:
        times = [seconds * float(sequenceNode.GetNthIndexValue(number)) for number in range(sequenceNode.GetNumberOfDataNodes())]
    except ValueError:
        return None
    return times if np.isfinite(times).all() and (np.diff(times) > 0).all() else None


def isTransformName(name: str) -> bool:
    """Whether a name says from where to where a transform leads."""
    try:
        return bool(TransformName.parse(name))
    except TransformError:
        return False


def _holds(sequenceNode, className: str) -> bool:
    """Whether the first item of a sequence is of a class."""
    item = sequenceNode.GetNthDataNode(0) if sequenceNode.GetNumberOfDataNodes() else None
    return item is not None and item.IsA(className)


def checkRecorded(browser) -> None:
    """Raise an AIFReconError while a sweep is still being recorded: it would be looked through again for every frame that comes."""
    if browser.GetRecordingActive():
        raise AIFReconError(f"{browser.GetName()} is being recorded. Stop the recording to reconstruct it.")

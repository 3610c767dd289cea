"""The items of a sequence browser, found as the browser itself finds them when it replays."""

from pathlib import Path

import numpy as np
import slicer
import vtk

from AIFReconLib.errors import AIFReconError, SequenceFormatError

from ..sceneNodes import nodesOfClass
from .sequenceNodes import PROBLEM_ATTRIBUTE, SOURCE_ATTRIBUTE
from .sweepRecord import readRecord


class BrowserItems:
    """A browser's sequences, item by item of its master sequence.

    Parameters
    ----------
    browser : vtkMRMLSequenceBrowserNode
    imageSequence : vtkMRMLSequenceNode or None
        Which of its sequences holds the images. Default: the master, else the only one with images.

    Raises
    ------
    SequenceFormatError
        When the browser has no items or no images, or several sequences of images and none is named.
    """

    def __init__(self, browser, imageSequence=None):
        self.browser = browser
        self.path = Path(browser.GetName() or "sweep")
        self.master = browser.GetMasterSequenceNode()
        if self.master is None or not self.master.GetNumberOfDataNodes():
            raise SequenceFormatError("{path}: this sequence browser has no items. Record or load a sweep first.", path=self.path)
        self.sequences = [self.master, *_synchronized(browser)]
        self.images = imageSequence or self._findImages()
        if self.images not in self.sequences:
            raise SequenceFormatError(
                "{path}: sequence {node!r} is not one of this browser's. Choose one of: {names}.",
                path=self.path,
                node=self.images.GetName(),
                names=self._names(self.sequences),
            )
        self.record = readRecord(browser)
        self._frames = self.record.get("frames", {})
        self._index = [self.master.GetNthIndexValue(number) for number in range(self.master.GetNumberOfDataNodes())]

    def __len__(self) -> int:
        return len(self._index)

    def indexValue(self, number: int) -> str:
        """What numbers item `number` of the master sequence: a time in s, a frame number or a text."""
        return self._index[number]

    def recorded(self, number: int) -> dict:
        """What the browser's record says of item `number`; empty for a browser of another maker, or an item added later."""
        return self._frames.get(self._index[number], {})

    def itemAt(self, sequenceNode, number: int):
        """The data node of a sequence that the browser shows with item `number` of the master; None where it shows none.

        Notes
        -----
        A sequence without an item at that value continues with its previous one only in the mode "create from previous". In the
        other modes the browser shows a default or keeps what was there before, which is no measurement.
        """
        if sequenceNode is self.master:
            return sequenceNode.GetNthDataNode(number)
        previous = self.browser.GetMissingItemMode(sequenceNode) == slicer.vtkMRMLSequenceBrowserNode.MissingItemCreateFromPrevious
        return sequenceNode.GetDataNodeAtValue(self._index[number], not previous)

    def proxyOf(self, sequenceNode):
        """The node of the scene that the browser replays a sequence into, or None."""
        return self.browser.GetProxyNode(sequenceNode)

    def sequenceBehind(self, node):
        """The sequence that this browser replays into `node`; None for any other node, and where replay is turned off."""
        sequenceNode = self.browser.GetSequenceNode(node)
        return sequenceNode if sequenceNode is not None and self.browser.GetPlayback(sequenceNode) else None

    def otherBrowserOf(self, node):
        """Another browser that replays into `node`, or None."""
        for browser in nodesOfClass("vtkMRMLSequenceBrowserNode", self.browser.GetScene()):
            if browser is not self.browser and browser.IsProxyNodeID(node.GetID()):
                return browser
        return None

    def transformSequences(self) -> list:
        """The browser's sequences of transforms."""
        return [node for node in self.sequences if _holds(node, "vtkMRMLTransformNode")]

    def nameOf(self, sequenceNode) -> str:
        """What a sequence is of: the name in the recording (ProbeToTracker), else that of the node it is replayed into."""
        proxy = self.proxyOf(sequenceNode)
        name = sequenceNode.GetAttribute(SOURCE_ATTRIBUTE) or (proxy and proxy.GetAttribute("Sequences.BaseName"))
        name = name or (proxy and proxy.GetName()) or sequenceNode.GetName() or ""
        return name.removesuffix("Transform") or name

    def exactPose(self, sequenceNode, number: int) -> np.ndarray | None:
        """The pose of item `number` to the last digit, where `sequenceNode` is the sequence of poses that the record is of."""
        return self.recorded(number).get("pose") if self._isOfRecord(sequenceNode) else None

    def recordedStatus(self, sequenceNode, number: int) -> str | None:
        """The status that the record has for a transform, by its name; None where it was OK or nothing is known."""
        return self.recorded(number).get("statuses", {}).get(self.nameOf(sequenceNode))

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
            raise SequenceFormatError("{path}: none of its sequences holds images. Choose the browser of a tracked sweep.", path=self.path)
        if len(holding) > 1 and holding[0] is not self.master:
            raise SequenceFormatError(
                "{path}: several of its sequences hold images. Choose one of: {names}.", path=self.path, names=self._names(holding)
            )
        return holding[0]

    @staticmethod
    def _names(nodes: list) -> str:
        return ", ".join(node.GetName() or "" for node in nodes)


def _synchronized(browser) -> list:
    nodes = vtk.vtkCollection()
    browser.GetSynchronizedSequenceNodes(nodes, False)
    return [nodes.GetItemAsObject(index) for index in range(nodes.GetNumberOfItems())]


def _holds(sequenceNode, className: str) -> bool:
    """Whether the first item of a sequence is of a class."""
    item = sequenceNode.GetNthDataNode(0) if sequenceNode.GetNumberOfDataNodes() else None
    return item is not None and item.IsA(className)


def checkRecorded(browser) -> None:
    """Raise an AIFReconError while a sweep is still being recorded: it would be looked through again for every frame that comes."""
    if browser.GetRecordingActive():
        raise AIFReconError("{name} is being recorded. Stop the recording to reconstruct it.", name=browser.GetName())

"""What the panel knows of the chosen sweep, looked up again only when another is chosen or it has changed."""

import vtk

from AIFReconLib.message import listed

from ..sceneNodes import nodesOfClass
from ..transforms import parentTransforms
from . import sequenceReader


class SweepStatus:
    """Remembers the `SweepSummary` of the sweep that the parameters name: it is asked for whenever any parameter changes."""

    def __init__(self):
        self._key = None
        self._summary = None

    def summary(self, parameters):
        """The `SweepSummary`, or None where no sweep is chosen."""
        if parameters.sweep is None:
            return None
        key = sweepKey(parameters.sweep, parameters.imageSequence)
        if self._key != key:
            self._key, self._summary = key, sequenceReader.sweepSummary(parameters.sweep, parameters.imageSequence)
        return self._summary

    def text(self, parameters) -> str:
        """The findings in words, a line each."""
        summary = self.summary(parameters)
        return listed(summary.lines if summary is not None else (), "\n")


def sweepKey(browser, imageSequence=None) -> tuple:
    """What changes when a sweep gets other frames or another place, and not while it is replayed or recorded. No item is looked at.

    Parameters
    ----------
    browser : vtkMRMLSequenceBrowserNode
    imageSequence : vtkMRMLSequenceNode or None
        Default: the master.
    """
    chosen = browser.GetID(), imageSequence.GetID() if imageSequence is not None else None
    if browser.GetRecordingActive():
        return *chosen, "recording"
    found = vtk.vtkCollection()
    browser.GetSynchronizedSequenceNodes(found, True)
    sequences = [found.GetItemAsObject(index) for index in range(found.GetNumberOfItems())]
    held = tuple(
        (node.GetID(), node.GetNumberOfDataNodes(), browser.GetPlayback(node), browser.GetMissingItemMode(node)) for node in sequences
    )
    proxies = [proxy for proxy in (browser.GetProxyNode(node) for node in sequences) if proxy is not None]
    above = {parent.GetID(): parent for proxy in proxies for parent in parentTransforms(proxy)}
    image = browser.GetProxyNode(imageSequence or browser.GetMasterSequenceNode()) if sequences else None
    if image is None or image.GetParentTransformNode() is None:
        # Then the way is found by the names of transforms, calibrations of the scene among them
        above.update({node.GetID(): node for node in nodesOfClass("vtkMRMLLinearTransformNode", browser.GetScene())})
    replayed = {proxy.GetID() for proxy in proxies}
    placed = tuple((node.GetID(), node.GetTransformNodeID()) for node in (*proxies, *above.values()))
    moved = tuple((node.GetID(), node.GetName(), _matrixOf(node)) for node in above.values() if node.GetID() not in replayed)
    return *chosen, held, placed, moved


def _matrixOf(transformNode) -> tuple | None:
    """The numbers of a linear transform; None for any other, which cannot place a sweep whatever it is."""
    if not transformNode.IsLinear():
        return None
    matrix = vtk.vtkMatrix4x4()
    transformNode.GetMatrixTransformToParent(matrix)
    return tuple(matrix.GetElement(row, column) for row in range(4) for column in range(4))

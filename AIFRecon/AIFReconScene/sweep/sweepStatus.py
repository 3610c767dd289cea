"""What the panel knows of the chosen sweep, and how well it was tracked: looked up only when another is chosen or it has changed."""

import slicer

from AIFReconLib.inspection.tracking_report import tracking_report
from AIFReconLib.message import listed
from AIFReconLib.sweep.poses import sweep_poses

from ..sceneNodes import sequencesOf
from ..transforms import matrixToParent, parentTransforms
from .browserItems import checkRecorded
from .sequenceReader import sequenceFromBrowser, sweepSummary


class SweepStatus:
    """Remembers the `SweepSummary` of every sweep: they are asked for whenever any parameter changes."""

    def __init__(self):
        self._known = {}

    def of(self, browser, imageSequence=None):
        """The `SweepSummary` of a sequence browser."""
        key = sweepKey(browser, imageSequence)
        known, summary = self._known.get(key[:2], (None, None))
        if known != key:
            summary = sweepSummary(browser, imageSequence)
            self._known[key[:2]] = key, summary
        return summary

    def summary(self, parameters):
        """The `SweepSummary` of the first of the chosen sweeps that cannot be used, else of the first; None where none is chosen."""
        chosen = self._chosen(parameters)
        return next((summary for _name, summary in chosen if summary.problem), chosen[0][1] if chosen else None)

    def text(self, parameters) -> str:
        """The findings in words, a line each; of several sweeps with their names."""
        chosen = self._chosen(parameters)
        if len(chosen) < 2:
            return listed(chosen[0][1].lines if chosen else (), "\n")
        lines = [f"{name}: {line}" for name, summary in chosen for line in summary.lines]
        return listed(lines, "\n")

    def _chosen(self, parameters) -> list:
        if parameters.sweep is None:
            return []
        first = parameters.sweep.GetName(), self.of(parameters.sweep, parameters.imageSequence)
        return [first, *((other.GetName(), self.of(other)) for other in furtherSweeps(parameters))]


class SweepReport:
    """Remembers the `TrackingReport` of one sweep, and what was made of it."""

    def __init__(self):
        self._key = self._report = None
        self._title = ""

    def remember(self, inputs, method: str, report) -> None:
        """Keep the `TrackingReport` of what a method made of `Inputs`; of several sweeps that of the first."""
        self._key = sweepKey(inputs.sweep, inputs.imageSequence)
        self._title, self._report = f"{inputs.sweep.GetName()} {method}", report

    def of(self, parameters) -> tuple:
        """Title and `TrackingReport` of the chosen sweep; without a reconstruction of it, the coverage is not known.

        Raises AIFReconError when the sweep cannot be read, or is still being recorded.
        """
        checkRecorded(parameters.sweep)
        key = sweepKey(parameters.sweep, parameters.imageSequence)
        if self._key != key:
            sequence = sequenceFromBrowser(parameters.sweep, parameters.imageSequence)
            self._report, self._title, self._key = tracking_report(sequence, sweep_poses(sequence)), parameters.sweep.GetName(), key
        return self._title, self._report


def sweepKey(browser, imageSequence=None) -> tuple:
    """What changes when a sweep gets other frames or another place, and not while it is replayed or recorded. No item is looked at."""
    chosen = browser.GetID(), imageSequence.GetID() if imageSequence is not None else None
    if browser.GetRecordingActive():
        return *chosen, "recording"
    sequences = sequencesOf(browser)
    held = tuple((node.GetID(), node.GetName(), node.GetNumberOfDataNodes(), browser.GetPlayback(node)) for node in sequences)
    proxies = [proxy for proxy in (browser.GetProxyNode(node) for node in sequences) if proxy is not None]
    above = {parent.GetID(): parent for proxy in proxies for parent in parentTransforms(proxy)}
    image = browser.GetProxyNode(imageSequence or browser.GetMasterSequenceNode()) if sequences else None
    if image is None or image.GetParentTransformNode() is None:
        # Then the way is found by the names of transforms, calibrations of the scene among them
        above.update({node.GetID(): node for node in slicer.util.getNodesByClass("vtkMRMLLinearTransformNode")})
    replayed = {proxy.GetID() for proxy in proxies}
    placed = tuple((node.GetID(), node.GetName(), node.GetTransformNodeID()) for node in (*proxies, *above.values()))
    moving = [node for node in above.values() if node.GetID() not in replayed]
    # A transform that is not linear cannot place a sweep, whatever it is
    moved = tuple((node.GetID(), tuple(matrixToParent(node).ravel().tolist()) if node.IsLinear() else None) for node in moving)
    return *chosen, held, placed, moved


def furtherSweeps(parameters) -> tuple:
    """The sequence browsers that are chosen beside the first sweep, in their order; those that are gone are chosen no more."""
    first = parameters.sweep
    chosen = dict.fromkeys(node for node in parameters.otherSweeps if node is not None and node is not first)
    return tuple(node for node in chosen if node.GetScene() is not None) if first is not None else ()


def offered(parameters, status) -> list:
    """The sweeps of the scene that could be chosen beside the first, by the `SweepStatus`, and those that are."""
    if parameters.sweep is None:
        return []
    chosen = furtherSweeps(parameters)
    others = [node for node in slicer.util.getNodesByClass("vtkMRMLSequenceBrowserNode") if node is not parameters.sweep]
    return [node for node in others if node in chosen or not status.of(node).problem]

"""Several methods on one sweep: volumes to be seen side by side, and how well each shows bone."""

from dataclasses import dataclass

import slicer
import vtk

from AIFReconLib.evaluation.quantities import HEADINGS, QUANTITIES
from AIFReconLib.progress import part, report
from AIFReconLib.worker.reconstructing import compared_methods

from ..inputs.boneNodes import isLabeled, labelsFromNode
from ..panelWords import asControl
from ..sceneNodes import removeNodes
from ..work import inWorker
from .volumeNodes import COMPARED_ROLE, giveName, hasGivenName, intoFolder, outputNodes

BETTER = {"most": " \N{UPWARDS ARROW}", "least": " \N{DOWNWARDS ARROW}"}
"""Behind a heading: which way is better."""


@dataclass(frozen=True)
class Comparison:
    """What was made; there is no table where the bone is a probability, which has no surface to measure against."""

    volumes: dict
    table: object
    report: str


def compareMethods(inputs, progress=None) -> Comparison:
    """Reconstruct with every compared method and measure the volumes; nodes are made when all of it is done, else the scene is as before.

    The volumes and the table of the last comparison of this sweep are filled again, unless the user has given them another name,
    reconstructed into them, or chosen them as an input: those stay as they are, and new ones are made.
    """
    job, labels = inputs.job(part(progress, 0.0, 0.04)), _labels(inputs, part(progress, 0.04, 0.05))
    compared = inWorker(compared_methods, job, labels, asControl(), progress=part(progress, 0.05, 0.98))
    report(progress, 0.98, "Showing the volumes")
    volumes = _volumes(compared.results, inputs)
    _shareWindow(volumes.values())
    table = _table(compared.metrics, inputs) if compared.metrics else None
    return Comparison(volumes, table, "\n".join(compared.lines))


def _labels(inputs, progress):
    """The labels of the bone as it is when the comparison begins; None where it has no surface."""
    if inputs.bone is None or not isLabeled(inputs.bone):
        return None
    return labelsFromNode(inputs.bone, list(inputs.boneSegments) or None, referenceVolumeNode=inputs.ct, progress=progress)


def _shareWindow(nodes) -> None:
    """One window for all, so that gray levels can be compared: that of the brightest."""
    displays = [node.GetDisplayNode() for node in nodes]
    brightest = max(display.GetWindowLevelMax() for display in displays)
    for display in displays:
        display.SetWindowLevelMinMax(0.0, brightest)


def _volumes(results: dict, inputs) -> dict:
    """A volume node for each result, by method; new ones go again when one of them cannot be made."""
    earlier = {node.GetAttribute("AIFRecon.Method"): node for node in _earlier("vtkMRMLScalarVolumeNode", inputs)}
    slicer.mrmlScene.SaveStateForUndo()
    volumes = {}
    try:
        for method, result in results.items():
            given = {"intensity": earlier.get(method)}
            volumes[method] = outputNodes(result, _nameOf(inputs), nodes=given, inputs=inputs.nodes())["intensity"]
    except Exception:
        removeNodes([node for method, node in volumes.items() if node is not earlier.get(method)])
        raise
    finally:
        for node in volumes.values():
            node.SetNodeReferenceID(COMPARED_ROLE, inputs.sweep.GetID())
    return volumes


def _nameOf(inputs) -> str:
    """What a comparison is called, so that its volumes are told from reconstructions of the same sweep."""
    return f"{inputs.name} comparison"


def _earlier(className: str, inputs) -> list:
    """What the last comparison of this sweep has left and the user has not made his own."""
    nodes = [node for node in slicer.util.getNodesByClass(className) if node.GetNodeReference(COMPARED_ROLE) is inputs.sweep]
    return [node for node in nodes if hasGivenName(node) and not any(node is each for each in inputs.nodes())]


def _table(metrics: dict, inputs):
    node = next(iter(_earlier("vtkMRMLTableNode", inputs)), None)
    if node is None:
        node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLTableNode")
        giveName(node, f"{inputs.name} bone metrics")
        node.SetNodeReferenceID(COMPARED_ROLE, inputs.sweep.GetID())
    updateMetricsTable(node, metrics)
    intoFolder([node], _nameOf(inputs))
    return node


def updateMetricsTable(tableNode, metrics: dict) -> None:
    """Fill a table node anew with `BoneMetrics` by name: a row for each, a column for each number that `aifrecon evaluate` prints.

    Numbers are doubles with the digits that are printed, shares from 0 to 1; NaN where a number is not known.
    """
    rows = {name: result.to_dict() for name, result in metrics.items()}
    names = vtk.vtkStringArray()
    names.SetName("volume")
    for name in rows:
        names.InsertNextValue(name)
    with slicer.util.NodeModify(tableNode):
        tableNode.RemoveAllColumns()
        tableNode.AddColumn(names)
        for key, name in HEADINGS.items():
            heading = f"{name}{BETTER.get(QUANTITIES[key].best, '')}"
            column = vtk.vtkDoubleArray()
            column.SetName(heading)
            for row in rows.values():
                column.InsertNextValue(round(float(row[key]), QUANTITIES[key].digits))
            tableNode.AddColumn(column)
            tableNode.SetColumnDescription(heading, f"{QUANTITIES[key].label}: {QUANTITIES[key].definition}")
        tableNode.SetLocked(True)

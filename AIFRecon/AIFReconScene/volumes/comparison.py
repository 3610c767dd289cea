"""Several methods on one sweep: volumes to be seen side by side, and how well each shows bone."""

from dataclasses import dataclass, replace

import slicer

from AIFReconLib.compounding.methods.table import COMPARED_METHODS
from AIFReconLib.inspection.summary import summary_lines
from AIFReconLib.message import listed
from AIFReconLib.progress import part, report

from ..sceneNodes import nodesOfClass, removeNodes


@dataclass(frozen=True)
class Comparison:
    """What was made.

    Parameters
    ----------
    volumes : dict of str to vtkMRMLScalarVolumeNode
        By method.
    table : vtkMRMLTableNode or None
        Bone metrics; None where the bone is a probability, which has no surface to measure against.
    report : str
        What was done, in a few lines.
    """

    volumes: dict
    table: object
    report: str


def compareMethods(inputs, settings, progress=None) -> Comparison:
    """Reconstruct with every compared method and measure the volumes; nodes are made when all of it is done.

    Parameters
    ----------
    inputs : Inputs
    settings : Recipe
        Its method is replaced by each in turn.
    progress : callable or None

    Notes
    -----
    The volumes and the table of the last comparison of this sweep are filled again, unless the user has given them another name,
    reconstructed into them, or chosen them as an input: those stay as they are, and new ones are made.

    Raises
    ------
    AIFReconError
        As a reconstruction; OperationCanceled after a cancel. The scene is as before.
    """
    prepared, labels = inputs.prepared(settings, part(progress, 0.0, 0.04)), _labels(inputs, part(progress, 0.04, 0.05))
    results = {}
    for number, method in enumerate(COMPARED_METHODS):
        step = part(progress, 0.05 + 0.65 * number / len(COMPARED_METHODS), 0.05 + 0.65 * (number + 1) / len(COMPARED_METHODS))
        results[method] = prepared.reconstruct(replace(settings, method=method), step)
    metrics = _metrics(labels, prepared, results, part(progress, 0.7, 0.98))
    report(progress, 0.98, "Showing the volumes")
    volumes = _volumes(results, inputs)
    _shareWindow(volumes.values())
    table = _table(metrics, inputs) if metrics else None
    lines = [summary_lines(result, len(prepared.sequence))[0] for result in results.values()]
    return Comparison(volumes, table, listed(lines, "\n"))


def _labels(inputs, progress):
    """The labels of the bone as it is when the comparison begins; None where it has no surface."""
    from ..inputs.boneNodes import labelsFromNode

    if inputs.bone is None:
        return None
    if not inputs.bone.IsA("vtkMRMLSegmentationNode") and not inputs.bone.IsA("vtkMRMLLabelMapVolumeNode"):
        return None
    return labelsFromNode(inputs.bone, list(inputs.boneSegments) or None, referenceVolumeNode=inputs.ct, progress=progress)


def _metrics(labels, prepared, results, progress) -> dict:
    """Bone metrics of every volume, by method; none where the bone has no surface."""
    from .metricsTable import measureVolumes

    if labels is None:
        return {}
    # Every method fills the same voxels, so one mask tells for all of them
    mask = next(iter(results.values())).mask
    volumes = {method: result.intensity for method, result in results.items()}
    return measureVolumes(volumes, labels, prepared.sequence, mask=mask, recipe=prepared.recipe, progress=progress)


def _shareWindow(nodes) -> None:
    """One window for all, so that gray levels can be compared: that of the brightest."""
    displays = [node.GetDisplayNode() for node in nodes]
    brightest = max(display.GetWindowLevelMax() for display in displays)
    for display in displays:
        display.SetWindowLevelMinMax(0.0, brightest)


def _volumes(results: dict, inputs) -> dict:
    """A volume node for each result, by method; new ones go again when one of them cannot be made."""
    from .volumeNodes import COMPARED_ROLE, outputNodes

    scene = slicer.mrmlScene
    earlier = {node.GetAttribute("AIFRecon.Method"): node for node in _earlier("vtkMRMLScalarVolumeNode", inputs)}
    scene.SaveStateForUndo()
    volumes = {}
    try:
        for method, result in results.items():
            given = {"intensity": earlier.get(method)}
            volumes[method] = outputNodes(result, _nameOf(inputs), nodes=given, inputs=inputs.nodes())["intensity"]
    except Exception:
        removeNodes([node for method, node in volumes.items() if node is not earlier.get(method)], scene)
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
    from .volumeNodes import COMPARED_ROLE, hasGivenName

    nodes = [node for node in nodesOfClass(className, slicer.mrmlScene) if node.GetNodeReference(COMPARED_ROLE) is inputs.sweep]
    return [node for node in nodes if hasGivenName(node) and not any(node is each for each in inputs.nodes())]


def _table(metrics: dict, inputs):
    from .metricsTable import updateMetricsTable
    from .volumeNodes import COMPARED_ROLE, giveName, intoFolder

    node = next(iter(_earlier("vtkMRMLTableNode", inputs)), None)
    if node is None:
        node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLTableNode")
        giveName(node, f"{inputs.name} bone metrics", slicer.mrmlScene)
        node.SetNodeReferenceID(COMPARED_ROLE, inputs.sweep.GetID())
    updateMetricsTable(node, metrics)
    intoFolder([node], _nameOf(inputs), slicer.mrmlScene)
    return node

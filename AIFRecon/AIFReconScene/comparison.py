"""Several methods on one sweep: volumes to be seen side by side, and how well each shows bone."""

from dataclasses import dataclass, replace

import slicer

from AIFReconLib.progress import part, report
from AIFReconLib.summary import summary_lines

COMPARED = ("average", "aif", "aif-compensated", "weighted")
"""The baseline, the paper's two methods, and the recommended one."""


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
    settings : ReconstructionSettings
        Its method is replaced by each in turn.
    progress : callable or None

    Raises
    ------
    AIFReconError
        As a reconstruction; OperationCanceled after a cancel. The scene is as before.
    """
    from .volumeNodes import outputNodes

    prepared = inputs.prepared(part(progress, 0.0, 0.05))
    results = {}
    for number, method in enumerate(COMPARED):
        step = part(progress, 0.05 + 0.65 * number / len(COMPARED), 0.05 + 0.65 * (number + 1) / len(COMPARED))
        results[method] = prepared.reconstruct(replace(settings, method=method), step)
    metrics = _metrics(inputs, prepared, results, part(progress, 0.7, 0.98))
    report(progress, 0.98, "Showing the volumes")
    name = inputs.sweep.GetName()
    volumes = {method: outputNodes(result, name, inputs=inputs.nodes())["intensity"] for method, result in results.items()}
    _shareWindow(volumes.values())
    table = _table(metrics, name) if metrics else None
    lines = [summary_lines(result, len(prepared.sequence))[0] for result in results.values()]
    return Comparison(volumes, table, "\n".join(lines))


def _metrics(inputs, prepared, results, progress) -> dict:
    """Bone metrics of every volume, by method; none where the bone has no surface."""
    from .boneNodes import labelsFromNode
    from .metricsTable import measureVolumes

    if not inputs.bone.IsA("vtkMRMLSegmentationNode") and not inputs.bone.IsA("vtkMRMLLabelMapVolumeNode"):
        return {}
    labels = labelsFromNode(inputs.bone, list(inputs.boneSegments) or None, referenceVolumeNode=inputs.ct)
    # Every method fills the same voxels, so one mask tells for all of them
    mask = next(iter(results.values())).mask
    volumes = {method: result.intensity for method, result in results.items()}
    return measureVolumes(volumes, labels, prepared.sequence, mask=mask, probe=inputs.probe, progress=progress)


def _shareWindow(nodes) -> None:
    """One window for all, so that gray levels can be compared: that of the brightest."""
    displays = [node.GetDisplayNode() for node in nodes]
    brightest = max(display.GetWindowLevelMax() for display in displays)
    for display in displays:
        display.SetWindowLevelMinMax(0.0, brightest)


def _table(metrics: dict, sweepName: str):
    from .metricsTable import updateMetricsTable
    from .volumeNodes import intoFolder

    name = slicer.mrmlScene.GenerateUniqueName(f"{sweepName} bone metrics")
    node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLTableNode", name)
    updateMetricsTable(node, metrics)
    intoFolder([node], sweepName, slicer.mrmlScene)
    return node

"""How volumes show bone, as a table node: the numbers and words of `aifrecon evaluate`."""

import re

import slicer
import vtk

from AIFReconLib.evaluation.quantities import HEADINGS, QUANTITIES
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.progress import Progress
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.worker.evaluating import measured_volumes

from ..work import inWorker


def measureVolumes(
    volumes: dict[str, Volume],
    labels: Volume,
    sequence: TrackedSequence | None = None,
    *,
    mask: Volume | None = None,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
) -> dict:
    """Bone metrics of several volumes of one sweep, each a `BoneMetrics`, by name.

    Parameters
    ----------
    volumes : dict of str to Volume
    labels : Volume of integers, placed in RAS world
        As `labelsFromNode` gives them: a label per vertebra.
    sequence : TrackedSequence or None
        Decides which bone could be reached; without one all bone counts.
    mask : Volume or None
        Not 0 where something was measured.
    recipe : Recipe or None
        As for `reconstruct`.
    progress : Progress or None
    """
    return inWorker(measured_volumes, volumes, labels, sequence, mask, recipe, progress=progress)


def updateMetricsTable(tableNode, metrics: dict) -> None:
    """Fill a table node with bone metrics: a row for each volume, a column for each number that `aifrecon evaluate` prints.

    Parameters
    ----------
    tableNode : vtkMRMLTableNode
        What it held is replaced.
    metrics : dict of str to BoneMetrics

    Notes
    -----
    Numbers are doubles with the digits that are printed, shares from 0 to 1;
    NaN where a number is not known.
    """
    rows = {name: result.to_dict() for name, result in metrics.items()}
    names = vtk.vtkStringArray()
    names.SetName("volume")
    for name in rows:
        names.InsertNextValue(name)
    with slicer.util.NodeModify(tableNode):
        tableNode.RemoveAllColumns()
        tableNode.AddColumn(names)
        for key, heading in HEADINGS.items():
            column = vtk.vtkDoubleArray()
            column.SetName(heading)
            for row in rows.values():
                column.InsertNextValue(round(float(row[key]), _digits(QUANTITIES[key].form)))
            tableNode.AddColumn(column)
            tableNode.SetColumnDescription(heading, f"{QUANTITIES[key].label}: {QUANTITIES[key].definition}")
        tableNode.SetLocked(True)


def _digits(form: str) -> int:
    """Digits after the point that a format keeps; two more for a percentage, which is kept as a share."""
    [digits] = re.findall(r"\.(\d+)", form)
    return int(digits) + (2 if form.endswith("%") else 0)

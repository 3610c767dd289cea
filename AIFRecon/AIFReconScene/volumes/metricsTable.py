"""How volumes show bone, as a table node: the numbers and words of `aifrecon evaluate`."""

import re

import slicer
import vtk

from AIFReconLib.evaluation.quantities import HEADINGS, QUANTITIES


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

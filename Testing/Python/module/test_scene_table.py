"""Bone metrics as a table node."""

from __future__ import annotations

import numpy as np
import pytest

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")
import vtk  # noqa: E402

from AIFReconLib.evaluation.quantities import HEADINGS, BoneMetrics, SurfaceMetrics  # noqa: E402

SURFACE = SurfaceMetrics(812.3, 41.26, 2.3456, 0.871, np.nan, 0.1, 0.2345, 0.4567)
METRICS = BoneMetrics(SURFACE, SURFACE, SURFACE, 3.21, 1.0, 4.444, 0.9, 0.1)


def test_the_table_has_the_columns_and_digits_of_the_command_line_and_can_be_filled_again(scene):
    from AIFReconScene.volumes.comparison import updateMetricsTable

    node = scene.AddNewNodeByClass("vtkMRMLTableNode", "Metrics")
    updateMetricsTable(node, {"average": METRICS, "weighted": METRICS})
    table = node.GetTable()
    names = [table.GetColumnName(index) for index in range(node.GetNumberOfColumns())]
    assert [name.rstrip(" \u2191\u2193") for name in names] == ["volume", *HEADINGS.values()]
    assert isinstance(table.GetColumnByName("CNR \u2191"), vtk.vtkDoubleArray)
    assert (table.GetColumnByName("CNR \u2191").GetValue(0), table.GetColumnByName("coverage \u2191").GetValue(1)) == (2.35, 0.457)
    updateMetricsTable(node, {"aif": METRICS})
    assert (node.GetNumberOfRows(), node.GetNumberOfColumns()) == (1, 1 + len(HEADINGS))

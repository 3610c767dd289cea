"""Bone metrics as a table node, and the simulated patient as nodes."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")
import vtk  # noqa: E402
from scene_host import class_counts  # noqa: E402

from AIFReconLib.errors import OperationCanceled  # noqa: E402
from AIFReconLib.evaluation.quantities import (  # noqa: E402
    HEADINGS,
    BoneMetrics,
    SurfaceMetrics,
)
from AIFReconLib.sweep.poses import sweep_poses  # noqa: E402

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


# ---- the simulated patient


@pytest.fixture(scope="module")
def coarse_phantom():
    """What makes a phantom, but of coarse voxels and once: the real one takes seconds."""
    from AIFReconLib.simulation import anatomy

    made = anatomy.make_lumbar_phantom
    return cache(
        lambda seed, ct_to_reference: made(anatomy.LumbarAnatomy.from_seed(seed), spacing=2.5, ct_to_reference=np.array(ct_to_reference))
    )


@pytest.fixture
def quick(monkeypatch, coarse_phantom):
    from AIFReconLib.simulation import anatomy

    def make(person, *, spacing, ct_to_reference, progress=None):
        return coarse_phantom(person.seed, tuple(map(tuple, ct_to_reference)))

    monkeypatch.setattr(anatomy, "make_lumbar_phantom", make)


@pytest.fixture
def patient(scene, quick):
    from AIFReconScene.volumes.phantomSample import loadPhantom

    return loadPhantom(frames=9)


def test_the_simulated_patient_is_a_placed_sweep_with_a_ct_and_a_segment_on_each_vertebra_under_the_registration(patient):
    from AIFReconScene.inputs.boneNodes import labelsFromNode
    from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

    assert patient.ct.GetParentTransformNode() is patient.segmentation.GetParentTransformNode() is patient.ctToReference
    segmentation = patient.segmentation.GetSegmentation()
    assert [segmentation.GetNthSegment(index).GetName() for index in range(3)] == ["L2", "L3", "L4"]
    sequence = sequenceFromBrowser(patient.browser)
    assert len(sweep_poses(sequence).usable) == 9
    assert sequence.configuration.probe.kind == "sector"
    labels = labelsFromNode(patient.segmentation)
    hounsfield = slicer.util.arrayFromVolume(patient.ct)
    assert labels.array.shape == hounsfield.shape
    assert hounsfield[labels.array > 0].mean() > hounsfield[labels.array == 0].mean() + 200


@pytest.mark.parametrize("share", [0.5, 0.97])
def test_canceling_the_simulation_leaves_the_scene_as_it_was(scene, quick, share):
    from AIFReconScene.volumes.phantomSample import loadPhantom

    before = class_counts(scene)
    with pytest.raises(OperationCanceled):
        loadPhantom(lambda fraction, message: fraction < share, frames=9)
    assert class_counts(scene) == before

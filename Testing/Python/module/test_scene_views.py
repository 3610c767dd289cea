"""What the views are told to show: output over CT, volumes side by side, volume rendering, the probe and the frames' outlines."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from sweeps import rigid

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")
import tinyScene  # noqa: E402
import vtk  # noqa: E402

from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus  # noqa: E402
from AIFReconLib.geometry.transforms import transform_points  # noqa: E402
from AIFReconLib.imaging.beams import ProbeGeometry  # noqa: E402
from AIFReconLib.imaging.region import Fan, ImageRegion  # noqa: E402
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence  # noqa: E402

PLACE = rigid((20.0, -30.0, 40.0), (100.0, -50.0, 20.0)) @ np.diag([0.8, 0.9, 1.1, 1.0])


@pytest.fixture
def logic(scene, monkeypatch):
    # The application around a scene that is tested without windows
    drawn = {name: lambda: None for name in ("pauseRender", "resumeRender")}
    application = SimpleNamespace(applicationLogic=lambda: scene.host.applicationLogic, **drawn)
    monkeypatch.setattr(slicer, "app", application, raising=False)
    return scene.host.applicationLogic


@pytest.fixture
def ct(scene):
    return tinyScene.addVolume("vtkMRMLScalarVolumeNode", "CT", np.zeros((30, 30, 30), np.int16), np.diag([2.0, 2.0, 2.0, 1.0]))


@pytest.fixture
def output(scene):
    return made_output("Output")


def made_output(name):
    array = np.random.default_rng(0).integers(0, 200, (20, 21, 22)).astype(np.uint8)
    node = tinyScene.addVolume("vtkMRMLScalarVolumeNode", name, array, PLACE)
    node.GetDisplayNode().SetAutoWindowLevel(False)
    node.GetDisplayNode().SetWindowLevelMinMax(0, 200)
    return node


def composite(logic, view):
    return logic.GetSliceLogicByLayoutName(view).GetSliceCompositeNode()


# ---- over the CT


@pytest.mark.parametrize("view", ["Red", "Yellow", "Green"])
def test_the_output_covers_the_ct_and_views_go_to_it_in_millimeters(logic, ct, output, view):
    from AIFReconScene.display.sliceDisplay import showOverCT

    showOverCT(output, ct, 0.35)
    shown = composite(logic, view)
    assert (shown.GetBackgroundVolumeID(), shown.GetForegroundVolumeID()) == (ct.GetID(), output.GetID())
    assert shown.GetForegroundOpacity() == 0.35
    slice_node = logic.GetSliceLogicByLayoutName(view).GetSliceNode()
    assert np.allclose(tinyScene.placeOf(slice_node)[:3, 3], tinyScene.boundsOf(output).mean(axis=1), atol=0.01)
    assert 20 < max(slice_node.GetFieldOfView()[:2]) < 80


# ---- side by side


def side_by_side(scene, logic, ct, count=3):
    from AIFReconScene.display.sliceDisplay import showSideBySide

    nodes = [made_output(f"V{n}") for n in range(1, count + 1)]
    showSideBySide([(node, f"method {n}") for n, node in enumerate(nodes, 1)], ct)
    return nodes


def test_the_layout_of_before_comes_back(scene, logic, ct):
    from AIFReconScene.display.sliceDisplay import restoreLayout

    layout = scene.GetFirstNodeByClass("vtkMRMLLayoutNode")
    layout.SetViewArrangement(slicer.vtkMRMLLayoutNode.SlicerLayoutConventionalView)
    side_by_side(scene, logic, ct)
    side_by_side(scene, logic, ct, 4)
    assert layout.GetViewArrangement() > 4200
    views = [composite(logic, f"AIFRecon{n}") for n in (1, 2, 3, 4)]
    restoreLayout()
    assert layout.GetViewArrangement() == slicer.vtkMRMLLayoutNode.SlicerLayoutConventionalView
    assert [view.GetScene() for view in views] == [None] * 4
    assert composite(logic, "Red").GetScene() is scene


def test_a_layout_that_the_user_chose_meanwhile_stays(scene, logic, ct):
    from AIFReconScene.display.sliceDisplay import restoreLayout

    side_by_side(scene, logic, ct)
    layout = scene.GetFirstNodeByClass("vtkMRMLLayoutNode")
    layout.SetViewArrangement(slicer.vtkMRMLLayoutNode.SlicerLayoutOneUp3DView)
    restoreLayout()
    assert layout.GetViewArrangement() == slicer.vtkMRMLLayoutNode.SlicerLayoutOneUp3DView


# ---- volume rendering


def test_volume_rendering_hides_what_is_as_bright_as_skin_until_the_user_changes_it_and_can_be_turned_off(logic, output):
    from AIFReconScene.display.sliceDisplay import showVolumeRendering

    display = showVolumeRendering(output, True)
    assert display.GetVisibility()
    opacity = display.GetVolumePropertyNode().GetScalarOpacity()
    assert opacity.GetValue(0.74 * 200) == 0.0
    assert opacity.GetValue(200) > 0.5
    mine = vtk.vtkPiecewiseFunction()
    mine.AddPoint(0, 0.5)
    display.GetVolumePropertyNode().SetScalarOpacity(mine)
    assert showVolumeRendering(output, True).GetVolumePropertyNode().GetScalarOpacity().GetValue(10) == 0.5
    assert showVolumeRendering(output, False) is display
    assert not display.GetVisibility()


# ---- probe and outlines

FAN = ImageRegion(fan=Fan((30.0, -5.0), (-35.0, 35.0), (10.0, 50.0)))
SECTOR = ProbeGeometry("sector", (30.0, -5.0))


def pose(number: int) -> np.ndarray:
    return rigid((3.0 * number, 0.0, 0.0), (0.0, 2.0 * number, 5.0)) @ np.diag([0.5, 0.5, 0.5, 1.0])


@pytest.fixture
def browser(scene):
    from AIFReconScene.sweep.sequenceNodes import browserFromSequence

    name = TransformName("Image", "Reference")
    statuses = [TransformStatus.OK] * 5 + [TransformStatus.OUT_OF_VIEW]
    records = [FrameRecord(0.1 * n, None, TransformStatus.OK, {name: TransformSample(pose(n), s)}) for n, s in enumerate(statuses)]
    return browserFromSequence(TrackedSequence(np.full((6, 50, 61), 9, np.uint8), records), "Sweep")


@pytest.fixture
def overlay(scene):
    from AIFReconScene.display.probeOverlay import ProbeOverlay

    return ProbeOverlay()


def points_in_world(node) -> np.ndarray:
    return transform_points(tinyScene.worldOf(node), slicer.util.arrayFromModelPoints(node))


def test_beams_of_a_turned_image_are_turned_with_it(browser, overlay):
    browser.GetMasterSequenceNode().SetAttribute("Sequences.UltrasoundImageOrientation", "UFD")
    node = overlay.showProbe(browser, None, ProbeGeometry("sector", (20.0, -5.0)), FAN)
    apex = (pose(0) @ [60.0 - 20.0, -5.0, 0.0, 1.0])[:3]
    assert np.linalg.norm(points_in_world(node) - apex, axis=1).min() < 1e-5


def sequence_of(browser):
    from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

    return sequenceFromBrowser(browser)


def test_frames_with_a_pose_are_outlined_each_in_its_plane_and_others_are_not(browser, overlay):
    node = overlay.showOutlines(browser, sequence_of(browser), None)
    numbers = node.GetPolyData().GetCellData().GetArray("frame")
    assert [numbers.GetValue(index) for index in range(node.GetPolyData().GetNumberOfLines())] == [0, 1, 2, 3, 4]
    count = node.GetPolyData().GetCell(3).GetNumberOfPoints()
    points = points_in_world(node)[3 * count : 4 * count]
    pixels = (points - pose(3)[:3, 3]) @ np.linalg.inv(pose(3)[:3, :3]).T
    assert np.abs(pixels[:, 2]).max() < 1e-5
    assert (pixels[:, :2].min(axis=0), pixels[:, :2].max(axis=0))[0] == pytest.approx([0, 0], abs=1e-5)


def test_hiding_removes_everything_that_was_drawn(scene, browser, overlay):
    before = tinyScene.nodeIDs()
    overlay.showProbe(browser, None, SECTOR, FAN)
    overlay.showOutlines(browser, sequence_of(browser), FAN)
    overlay.hide()
    assert tinyScene.nodeIDs() == before


def test_the_probe_of_a_sweep_under_a_transform_lies_where_the_image_does_with_its_beams_from_the_apex(scene, browser, overlay):
    reference_to_ras = rigid((0.0, 90.0, 0.0), (7.0, 8.0, 9.0))
    master = browser.GetMasterSequenceNode()
    tinyScene.addTransform("ReferenceToRAS", reference_to_ras, browser.GetProxyNode(master).GetParentTransformNode())
    node = overlay.showProbe(browser, None, SECTOR, FAN)
    browser.SetSelectedItemNumber(3)
    apex = (reference_to_ras @ pose(3) @ [30.0, -5.0, 0.0, 1.0])[:3]
    assert (np.linalg.norm(points_in_world(node) - apex, axis=1) < 1e-5).sum() == 9

"""Pictures of views: what MRML places somewhere appears at the pixel where it belongs. Needs slicer-core, PySide6 and OpenGL offscreen."""

from __future__ import annotations

import numpy as np
import pytest

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")
vtk = pytest.importorskip("vtk", reason="vtk is not installed")

import tinyScene  # noqa: E402
from host import missing  # noqa: E402

if reason := missing():
    pytest.skip(reason, allow_module_level=True)

from host import view_frames, view_render  # noqa: E402

SIZE = 200
FIELD_OF_VIEW = 100.0


def test_a_transform_moves_a_volume_in_the_view(scene):
    """An axial view: the patient's right is left, anterior is up."""
    if reason := view_render.why_no_views():
        pytest.skip(reason)
    array, bright, moved = np.zeros((40, 40, 40), np.uint8), np.array([10.0, -5.0, 20.0]), np.eye(4)
    array[9, 17, 12] = 255
    place = np.eye(4)
    place[:3, 3] = bright - (12, 17, 9)
    moved[:3, 3] = -20.0, 6.0, 3.0
    node = tinyScene.addVolume("vtkMRMLScalarVolumeNode", "Moved", array, place)
    tinyScene.addTransform("Move", moved, node)
    node.GetDisplayNode().SetAutoWindowLevel(False)
    node.GetDisplayNode().SetWindowLevelMinMax(0, 255)
    center = np.add(bright, (-15.0, 8.0, 3.0))
    logic = scene.host.applicationLogic.GetSliceLogicByLayoutName("Red")
    logic.GetSliceCompositeNode().SetBackgroundVolumeID(node.GetID())
    with view_render.OffscreenSliceView(logic, scene.host.applicationLogic, (SIZE, SIZE)) as view:
        logic.GetSliceNode().SetFieldOfView(FIELD_OF_VIEW, FIELD_OF_VIEW, 1.0)
        logic.GetSliceNode().JumpSliceByCentering(*center)
        rows, columns = np.nonzero(view.image()[..., 0] > 128)
    right, anterior, _ = (bright + moved[:3, 3] - center) * SIZE / FIELD_OF_VIEW
    assert (columns.mean(), rows.mean()) == pytest.approx((SIZE / 2 - 0.5 - right, SIZE / 2 - 0.5 - anterior), abs=1.01)


@pytest.mark.parametrize(
    ("direction", "letters"),
    [((-2, 0, 0), "L"), ((0, 0, 1), "S"), ((0, -1, 0), "P"), ((0.9, 0.5, 0), "RA"), ((0.95, -0.3, 0), "R"), ((0.3, 0.5, -0.8), "IA")],
)
def test_a_direction_is_told_by_the_letters_of_the_patient(direction, letters):
    assert view_frames.direction_letters(direction) == letters


def test_an_axial_view_has_the_patient_s_right_on_its_left(scene):
    node = scene.host.applicationLogic.GetSliceLogicByLayoutName("Red").GetSliceNode()
    assert view_frames.slice_letters(node) == {"left": "R", "right": "L", "top": "A", "bottom": "P"}

"""Pictures of views: what MRML places somewhere appears at the pixel where it belongs. Needs slicer-core, PySide6 and OpenGL offscreen."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")
vtk = pytest.importorskip("vtk", reason="vtk is not installed")

import scene_host  # noqa: E402
from host import missing  # noqa: E402

if reason := missing():
    pytest.skip(reason, allow_module_level=True)

from host import view_frames, view_render  # noqa: E402

REPOSITORY = Path(__file__).resolve().parents[3]
SIZE = 200
FIELD_OF_VIEW = 100.0
BRIGHT_RAS = np.array([10.0, -5.0, 20.0])


@pytest.fixture(scope="module")
def opengl():
    """Skips where nothing can be drawn."""
    if reason := view_render.why_no_views():
        pytest.skip(reason)


@pytest.fixture
def one_voxel(scene):
    """A volume that is dark but for the voxel at BRIGHT_RAS."""
    array = np.zeros((40, 40, 40), np.uint8)
    place = np.eye(4)
    place[:3, 3] = BRIGHT_RAS - (12, 17, 9)
    array[9, 17, 12] = 255
    node = scene_host.volume_node(scene, array, place, "One voxel")
    node.CreateDefaultDisplayNodes()
    node.GetDisplayNode().SetAutoWindowLevel(False)
    node.GetDisplayNode().SetWindowLevelMinMax(0, 255)
    return node


def red_view(scene, center, volume=None) -> np.ndarray:
    """The red, axial view about a place, 0.5 mm per pixel."""
    logic = scene.host.applicationLogic.GetSliceLogicByLayoutName("Red")
    if volume is not None:
        logic.GetSliceCompositeNode().SetBackgroundVolumeID(volume.GetID())
    with view_render.OffscreenSliceView(logic, scene.host.applicationLogic, (SIZE, SIZE)) as view:
        logic.GetSliceNode().SetFieldOfView(FIELD_OF_VIEW, FIELD_OF_VIEW, 1.0)
        logic.GetSliceNode().JumpSliceByCentering(*center)
        return view.image()


def middle_of(mask: np.ndarray) -> tuple[float, float]:
    """Column and row of the middle of what is set."""
    rows, columns = np.nonzero(mask)
    return columns.mean(), rows.mean()


def pixel_of(place_ras, center_ras) -> tuple[float, float]:
    """Where an axial view shows a place: the patient's right is left, anterior is up."""
    right, anterior, _ = np.asarray(place_ras) - center_ras
    scale = SIZE / FIELD_OF_VIEW
    return SIZE / 2 - 0.5 - right * scale, SIZE / 2 - 0.5 - anterior * scale


@pytest.mark.usefixtures("opengl")
def test_a_transform_moves_a_volume_in_the_view(scene, one_voxel):
    moved = np.eye(4)
    moved[:3, 3] = -20.0, 6.0, 3.0
    one_voxel.SetAndObserveTransformNodeID(scene_host.transform_node(scene, moved).GetID())
    center = np.add(BRIGHT_RAS, (-15.0, 8.0, 3.0))
    shown = red_view(scene, center, one_voxel)
    assert middle_of(shown[..., 0] > 128) == pytest.approx(pixel_of(BRIGHT_RAS + moved[:3, 3], center), abs=1.01)


@pytest.mark.parametrize(
    ("direction", "letters"),
    [((-2, 0, 0), "L"), ((0, 0, 1), "S"), ((0, -1, 0), "P"), ((0.9, 0.5, 0), "RA"), ((0.95, -0.3, 0), "R"), ((0.3, 0.5, -0.8), "IA")],
)
def test_a_direction_is_told_by_the_letters_of_the_patient(direction, letters):
    assert view_frames.direction_letters(direction) == letters


def test_an_axial_view_has_the_patient_s_right_on_its_left(scene):
    node = scene.host.applicationLogic.GetSliceLogicByLayoutName("Red").GetSliceNode()
    assert view_frames.slice_letters(node) == {"left": "R", "right": "L", "top": "A", "bottom": "P"}


def test_the_picture_of_the_sample_data_has_the_size_that_slicer_asks():
    picture = REPOSITORY / "AIFRecon" / "Resources" / "Icons" / "AIFReconLumbarPhantom.png"
    assert struct.unpack(">II", picture.read_bytes()[16:24]) == (260, 280)

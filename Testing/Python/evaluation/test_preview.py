"""The picture of a volume: where its cuts go, which way they lie, and what it marks."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from AIFReconLib.evaluation import preview as room
from AIFReconLib.evaluation.figures import BONE_COLOR, NOT_SCANNED, cut_panel
from AIFReconLib.evaluation.preview import preview
from AIFReconLib.evaluation.slices import AXIAL, CORONAL, SAGITTAL, whole_cut
from AIFReconLib.geometry.volume import Volume, VoxelGrid

pytest.importorskip("matplotlib", reason="matplotlib is not installed")

GRID = VoxelGrid.from_spacing((-20.0, -15.0, -10.0), (41, 31, 21), 1.0)
RIGHT, ANTERIOR, SUPERIOR = (30, 15, 10), (20, 25, 10), (20, 15, 17)


def volume_with(*bright, background=40) -> Volume:
    """Gray, with these voxels (i, j, k) white."""
    array = np.full(GRID.shape, background, np.uint8)
    for i, j, k in bright:
        array[k, j, i] = 255
    return Volume(array, GRID.ijk_to_reference)


def panel_of(plane, volume, labels=None):
    center = room.middle_of_bone(volume, volume.array != 0, labels)
    return cut_panel("", volume, plane, whole_cut(volume.grid, plane, center), (0.0, 255.0), None, labels)


def where_brightest(picture) -> tuple[float, float]:
    """Share of the way from left to right, and from top to bottom, of the brightest pixels."""
    rows, columns = np.nonzero(picture >= np.nanmax(picture))
    return columns.mean() / picture.shape[1], rows.mean() / picture.shape[0]


@pytest.mark.parametrize(
    ("plane", "voxel", "left", "up"),
    [
        (AXIAL, RIGHT, True, None),
        (AXIAL, ANTERIOR, None, True),
        (CORONAL, RIGHT, True, None),
        (CORONAL, SUPERIOR, None, True),
        (SAGITTAL, ANTERIOR, True, None),
        (SAGITTAL, SUPERIOR, None, True),
    ],
)
def test_cuts_lie_as_radiologists_look_at_them(plane, voxel, left, up):
    across, down = where_brightest(panel_of(plane, volume_with(voxel)).picture)
    assert left is None or (across < 0.4) == left
    assert up is None or (down < 0.4) == up


@pytest.mark.parametrize("turned", [np.eye(4), np.diag([-1.0, 1.0, 1.0, 1.0]), np.diag([1.0, 1.0, -1.0, 1.0]), np.eye(4)[[1, 2, 0, 3]]])
def test_from_behind_what_lies_right_and_high_is_at_the_top_right_however_the_grid_runs(turned):
    place = GRID.ijk_to_reference @ (30, 5, 17, 1)
    matrix = GRID.ijk_to_reference @ turned
    grid = VoxelGrid(
        (45, 45, 45), np.block([[matrix[:3, :3], -matrix[:3, :3] @ np.full((3, 1), 22.0)], [np.zeros((1, 3)), np.ones((1, 1))]])
    )
    array = np.full(grid.shape, 10, np.uint8)
    i, j, k = np.rint(grid.reference_to_ijk @ place).astype(int)[:3]
    array[k, j, i] = 200
    panel = room._projection(Volume(array, grid.ijk_to_reference), array > 0, (0.0, 255.0), patient=True, beam=None)
    across, down = where_brightest(panel.picture)
    assert (panel.name, panel.edges) == ("bone, from behind", ("L", "R", "S", "I"))
    assert (across, down) == pytest.approx((0.5 + place[0] / 45, 0.5 - place[2] / 45), abs=0.03)


def bone_under_skin(axis: int, backward: bool) -> Volume:
    """Speckle, a bright sheet of skin over all of it, and a plate of bone behind that, as bright, with a shadow; beams go along an axis."""
    rng = np.random.default_rng(3)
    lines = rng.uniform(60, 100, (30, 30, 40))
    lines[..., 2:5] = 220
    lines[10:20, 10:20, 20:22] = 220
    lines[10:20, 10:20, 22:] = 5
    lines = lines[..., ::-1] if backward else lines
    return Volume(np.moveaxis(lines, 2, 2 - axis).astype(np.uint8), np.eye(4))


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("backward", [False, True])
def test_bone_is_seen_through_skin_that_is_as_bright_along_the_beams(axis, backward):
    volume = bone_under_skin(axis, backward)
    beam = (-1.0 if backward else 1.0) * np.eye(3)[axis] + 0.1
    panel = room._projection(volume, volume.array > 0, (0.0, 255.0), patient=False, beam=beam)
    assert panel.name == f"bone, seen along {'-' if backward else '+'}{'xyz'[axis]}"
    bone = np.zeros((30, 30), bool)
    bone[10:20, 10:20] = True
    assert panel.picture[bone].min() > 1.3 * panel.picture[~bone].max()


def test_where_neither_patient_nor_beams_are_known_the_brightest_along_y_is_shown():
    volume = bone_under_skin(1, False)
    panel = room._projection(volume, volume.array > 0, (0.0, 255.0), patient=False, beam=None)
    assert (panel.name, panel.edges) == ("brightest along y", ("-x", "+x", "+z", "-z"))
    assert (panel.picture == 220).all()


def test_a_projection_goes_through_what_the_score_stands_behind():
    volume = bone_under_skin(1, False)
    score = np.zeros(volume.array.shape, np.float32)
    score[:, 20:22, 10:15] = 3.0
    picture = room._projection(volume, volume.array > 0, (0.0, 255.0), False, np.array([0.0, 1.0, 0.0]), Volume(score, np.eye(4))).picture
    # Seen along +y with z up, +x is at the right
    assert picture[12:18, 11:14].min() > 0
    assert picture[:, 15:].max() == 0


@pytest.mark.parametrize(("more", "letters"), [({}, False), ({"labels": True}, True), ({"ct": True}, True), ({"patient": True}, True)])
def test_a_picture_has_letters_with_labels_a_ct_or_the_user_s_word(more, letters, monkeypatch):
    drawn = []
    monkeypatch.setattr(room, "_draw", lambda panels, *_: drawn.extend(panel.name for panel in panels))
    monkeypatch.setattr(room, "png_of", lambda _: b"")
    preview(volume_with(), **{name: volume_with() if name != "patient" else True for name in more})
    assert ("axial" in drawn) == letters


def test_cuts_go_through_the_middle_of_bone_that_shows():
    labels = np.zeros(GRID.shape, np.uint8)
    labels[5:16, 20:29, 5:14] = 1
    volume = volume_with(background=10)
    volume.array[labels > 0] = 200
    center = room.middle_of_bone(volume, volume.array > 0, Volume(labels, GRID.ijk_to_reference))
    np.testing.assert_allclose(center, np.add(GRID.origin, (9, 24, 10)), atol=0.51)


def test_bone_in_the_dark_does_not_draw_the_cuts_to_it():
    labels = np.zeros(GRID.shape, np.uint8)
    labels[:, 2:20, :] = labels[:, 28, :] = 1
    volume = volume_with(background=3)
    volume.array[:, 28, :] = 250
    center = room.middle_of_bone(volume, volume.array > 0, Volume(labels, GRID.ijk_to_reference))
    assert center[1] == pytest.approx(GRID.origin[1] + 28)


def pixels_of(picture) -> np.ndarray:
    from matplotlib.image import imread

    return imread(io.BytesIO(picture.png), format="png")[..., :3]


def has_color(pixels, color, tolerance=0.05) -> bool:
    from matplotlib.colors import to_rgb

    return bool((np.abs(pixels - to_rgb(color)).max(axis=-1) < tolerance).sum() > 20)


def test_what_was_not_scanned_is_tinted_and_what_was_is_not():
    scanned, partly = volume_with(), volume_with()
    partly.array[:, :10] = 0
    assert has_color(pixels_of(preview(partly)), NOT_SCANNED)
    mask = Volume(np.ones(GRID.shape, np.uint8), GRID.ijk_to_reference)
    assert not has_color(pixels_of(preview(partly, mask)), NOT_SCANNED)
    assert not has_color(pixels_of(preview(scanned)), NOT_SCANNED)


def test_the_outline_of_bone_is_drawn():
    labels = np.zeros(GRID.shape, np.uint8)
    labels[5:16, 8:20, 8:20] = 1
    assert has_color(pixels_of(preview(volume_with(), labels=Volume(labels, GRID.ijk_to_reference))), BONE_COLOR, tolerance=0.35)


@pytest.mark.parametrize("array", [np.zeros(GRID.shape, np.uint8), np.full(GRID.shape, np.nan, np.float32), np.ones((1, 1, 1), np.float32)])
def test_volumes_with_nothing_to_see_are_drawn_all_the_same(array):
    assert preview(Volume(array, GRID.ijk_to_reference)).png.startswith(b"\x89PNG")


def test_a_volume_plots_itself_for_a_notebook(tmp_path):
    picture = volume_with().plot(title="a volume")
    picture.write(tmp_path / "v.png")
    assert picture._repr_png_() == (tmp_path / "v.png").read_bytes()


# ---- a file matplotlibrc that came with a recording

DRAWS = """
import sys
import numpy as np
from AIFReconLib.evaluation.preview import preview
from AIFReconLib.geometry.volume import Volume
sys.stdout.buffer.write(preview(Volume(np.arange(8000, dtype=np.float32).reshape(20, 20, 20), np.eye(4)), title="a").png)
"""


def drawn_in(folder, settings):
    """What a program draws in a folder that holds such a file."""
    (folder / "matplotlibrc").write_bytes(settings)
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[3])}
    return subprocess.run([sys.executable, "-c", DRAWS], cwd=folder, env=environment, capture_output=True, check=False)


def test_a_matplotlibrc_of_the_working_folder_changes_no_picture(tmp_path):
    settings = b"text.usetex: True\nfont.size: 30\nsavefig.bbox: tight\nimage.interpolation: nearest\n"
    found = drawn_in(tmp_path, settings)
    assert found.stdout == drawn_in(tmp_path, b"").stdout
    assert found.stdout.startswith(b"\x89PNG"), found.stderr


def test_a_program_keeps_its_own_looks(monkeypatch):
    import matplotlib

    monkeypatch.setitem(matplotlib.rcParams, "font.size", 30.0)
    backend = matplotlib.rcParams._get("backend")
    preview(volume_with(RIGHT))
    assert matplotlib.rcParams["font.size"] == 30.0
    assert matplotlib.rcParams._get("backend") == backend

"""Lines from the skin past a wall of bone with holes, in an oblique volume of unequal voxels: what is free, tight, blocked, not seen."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from AIFReconLib.bone.canal import canal_between
from AIFReconLib.commands.parser import main
from AIFReconLib.errors import AIFReconError
from AIFReconLib.evaluation.visibility import SweepBeams
from AIFReconLib.geometry.labels import Labels
from AIFReconLib.geometry.transforms import LPS_FROM_RAS, affine, invert, transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.volume.models import read_model
from AIFReconLib.paths.free_paths import FreePaths, free_paths
from AIFReconLib.paths.path_export import markups, paths_figure, write_skin_map
from AIFReconLib.paths.path_query import PathQuery
from AIFReconLib.paths.states import BLOCKED, FREE, NOT_SEEN, TIGHT, states_of
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.terminal.remedies import in_options

BODY_TO_REFERENCE = affine(Rotation.from_euler("xyz", (25, -40, 70), degrees=True).as_matrix(), (30.0, -80.0, 15.0))
"""Body: the skin is y = 0, a wall of bone y = 20 to 22, the target (0, 40, 0)."""

GRID_TO_REFERENCE = BODY_TO_REFERENCE @ np.array([[0.0, 0, 0.8, -36], [0.5, 0, 0, 0], [0, 1.0, 0, -36], [0, 0, 0, 1]])
SHAPE = (91, 73, 101)
SPACING = 1.0  # the largest

HOLES = ((-8.0, 0.0, 4.0), (9.0, 0.0, 3.0))
"""x, z and radius, mm."""


def reference(*point: float) -> np.ndarray:
    return transform_points(BODY_TO_REFERENCE, np.array(point))


def in_body() -> np.ndarray:
    """Where the voxels are, (k, j, i, 3)."""
    ijk = np.indices(SHAPE).reshape(3, -1)[::-1].T.astype(float)
    return transform_points(invert(BODY_TO_REFERENCE) @ GRID_TO_REFERENCE, ijk).reshape(*SHAPE, 3)


def wall(holes=HOLES) -> np.ndarray:
    x, y, z = np.moveaxis(in_body(), -1, 0)
    bone = (y >= 20) & (y <= 22)
    for at, up, radius in holes:
        bone &= np.hypot(x - at, z - up) > radius
    return bone


def volume_of(bone: np.ndarray) -> Volume:
    tissue = 40 + 5 * np.random.default_rng(0).random(SHAPE)
    return Volume(np.where(bone, 230, tissue).astype(np.uint8), GRID_TO_REFERENCE)


@pytest.fixture(scope="module")
def volume() -> Volume:
    return volume_of(wall())


@pytest.fixture(scope="module")
def skin() -> np.ndarray:
    x, z = (axis.ravel() for axis in np.meshgrid(np.arange(-30, 31, 1.0), np.arange(-30, 31, 1.0)))
    return transform_points(BODY_TO_REFERENCE, np.stack([x, np.zeros_like(x), z], axis=1))


def mask_of(measured: np.ndarray, value: int = 0) -> Volume:
    return Volume(np.where(measured, 1, value).astype(np.uint8), GRID_TO_REFERENCE)


TARGET = reference(0, 40, 0)


@pytest.fixture(scope="module")
def found(volume, skin) -> FreePaths:
    return free_paths(volume, TARGET, skin)


def test_each_hole_is_one_window_and_its_line_passes_through_its_middle(found):
    free = [one for one in found.windows if one.is_free]
    assert len(free) == 2
    for one, (x, z, radius) in zip(free, HOLES):
        entry, end = (transform_points(invert(BODY_TO_REFERENCE), place) for place in (one.entry, one.end))
        through = entry + (21 - entry[1]) / (end[1] - entry[1]) * (end - entry)
        assert np.hypot(through[0] - x, through[2] - z) < 1.0
        # Of an oblique line through a wall 2 mm thick, whose distance is to the middles of its voxels
        assert one.clearance == pytest.approx(radius - found.surroundings.margin, abs=1.0)
        assert one.seen == 1.0
        assert one.width[0] <= one.width[1] <= 2 * radius
        assert one.depth == pytest.approx(np.linalg.norm(one.end - one.entry))


def test_clearance_is_the_distance_to_bone_less_the_margin(found):
    clearance, seen = found.along(reference(-8, 0, 0), reference(-8, 40, 0))
    assert clearance == pytest.approx(4.0 - 1.0 - SPACING / 2, abs=0.6)
    assert seen == 1.0
    assert found.along(reference(0, 0, 20), reference(0, 40, 20))[0] < 0
    before = found.along(reference(0, 0, 20), reference(0, 14, 20))[0]
    assert before == pytest.approx(6.0 - 1.0 - SPACING / 2, abs=0.6)


def test_a_program_with_windows_is_shown_the_same_and_loads_no_scipy(found, volume, skin):
    asked = PathQuery(volume, None, None, TARGET, skin, None, None, ReconstructionSettings())
    shown = asked.shown()
    assert [line.clearance for line in shown.lines] == [window.clearance for window in found.windows]
    assert [line.state for line in shown.lines[:2]] == [FREE, FREE]
    np.testing.assert_array_equal(shown.skin, found.entries)
    np.testing.assert_array_equal(shown.states, found.states)
    assert shown.triangles.max() < len(shown.skin)
    line = asked.along(reference(0, 0, 20), reference(0, 40, 20))
    assert (line.clearance, line.seen) == found.along(line.entry, line.end)
    assert (line.state, line.depth) == (BLOCKED, pytest.approx(40.0))
    code = "import sys, AIFReconLib.paths.path_query; sys.exit('scipy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_larger_margin_takes_as_much_off_all_clearances(found, volume, skin):
    more = free_paths(volume, TARGET, skin, margin=2.0)
    assert found.clearances.max() - more.clearances.max() == pytest.approx(1.0)


def test_what_was_not_measured_or_only_filled_is_not_seen(volume, skin):
    x, y, _z = np.moveaxis(in_body(), -1, 0)
    for value in (0, 2):
        hidden = mask_of(~((y > 26) & (y < 29) & (x < 0)), value)
        result = free_paths(volume, TARGET, skin, mask=hidden)
        seen, not_seen = ([one for one in result.windows if one.is_free is free] for free in (True, False))
        assert len(seen) == 1
        assert not_seen
        assert max(one.seen for one in not_seen) < 1.0
        clearance, share = result.along(reference(-8, 0, 0), reference(-8, 40, 0))
        assert clearance > 0
        assert share < 1.0


def test_the_places_that_were_not_seen_are_told(volume, skin):
    x, y, _z = np.moveaxis(in_body(), -1, 0)
    found = free_paths(volume, TARGET, skin, mask=mask_of(~((y > 26) & (y < 29) & (x < 0))))
    at = transform_points(invert(BODY_TO_REFERENCE), found.unseen)
    assert len(at) >= 4
    assert ((at[:, 1] > 25) & (at[:, 1] < 30) & (at[:, 0] < 1)).all()
    told = [place for one in found.to_dict()["windows"] if not one["free"] for place in one["unseen"]]
    np.testing.assert_allclose(told, found.unseen, atol=0.01)
    assert not any(len(one.unseen) for one in found.windows if one.is_free)


def test_lines_out_of_the_volume_are_not_seen(found):
    assert found.along(reference(0, 0, 0), reference(0, 60, 0))[1] == pytest.approx(46 / 56, abs=0.03)


def test_shadows_are_known_by_the_score_of_weighted_alone(volume, skin):
    x, y, _z = np.moveaxis(in_body(), -1, 0)
    lit = np.where((y > 30) & (x < 2), 0.5, 3.0).astype(np.float32) * 0.003
    score = Volume(lit, GRID_TO_REFERENCE, {"AIFRecon_method": "weighted", "AIFRecon_settings": "{}"})
    shadowed = free_paths(volume, TARGET, skin, mask=mask_of(np.ones(SHAPE, bool)), score=score)
    assert shadowed.along(reference(-8, 0, 0), reference(-8, 40, 0))[1] == pytest.approx(26 / 36, abs=0.05)
    assert shadowed.along(reference(9, 0, 0), reference(9, 40, 0))[1] == 1.0
    assert not any("Shadows are not known" in note for note in shadowed.notes)
    other = free_paths(volume, TARGET, skin, score=replace(score, fields={"AIFRecon_method": "average"}))
    assert other.along(reference(-8, 0, 0), reference(-8, 40, 0))[1] == 1.0
    assert any("Shadows are not known" in note for note in other.notes)


def test_the_floor_of_weights_that_a_score_was_made_with_is_heeded(volume, skin):
    fields = {"AIFRecon_method": "weighted", "AIFRecon_settings": '{"weight_floor": 0.03}'}
    few = Volume(np.full(SHAPE, 0.02, np.float32), GRID_TO_REFERENCE, fields)
    assert free_paths(volume, TARGET, skin, score=few).seen.max() == 0.0


def test_what_is_bright_at_the_skin_is_the_probe_and_no_bone(skin):
    y = in_body()[..., 1]
    found = free_paths(volume_of(wall() | (y < 2)), TARGET, skin)
    assert sum(one.is_free for one in found.windows) == 2


def test_bone_of_a_ct_counts_where_it_agrees_and_is_said_not_to_where_it_does_not(volume, skin):
    labels = Labels(wall(HOLES[:1]).astype(np.uint8), GRID_TO_REFERENCE)
    found = free_paths(volume, TARGET, skin, labels)
    assert found.ct_agrees
    assert found.along(reference(-8, 0, 0), reference(-8, 40, 0))[0] > 0
    assert found.along(reference(9, 0, 0), reference(9, 40, 0))[0] < 0
    wrong = free_paths(volume, TARGET, skin, labels, affine(np.eye(3), 4.0 * BODY_TO_REFERENCE[:3, 1]))
    assert wrong.ct_agrees is False
    assert any(note.startswith("WARNING: the CT does not lie on the volume's bone") for note in wrong.notes)
    assert any(line.endswith("Find the place of the CT with aifrecon register.") for line in wrong.text(in_options))
    assert wrong.along(reference(9, 0, 0), reference(9, 40, 0))[0] > 0


def test_blocked_goes_before_not_seen_and_tight_before_free():
    clearance, seen = np.array([-0.1, -0.1, 0.5, 0.5, 2.0, 2.0]), np.array([1.0, 0.2, 0.9, 1.0, 1.0, 0.99])
    assert states_of(clearance, seen).tolist() == [BLOCKED, BLOCKED, NOT_SEEN, TIGHT, FREE, NOT_SEEN]


def test_a_level_is_the_canal_between_its_two_vertebrae():
    grid = BODY_TO_REFERENCE @ np.diag([0.8, 0.8, 1.5, 1.0])
    k, j, i = np.indices((50, 40, 40))
    radius = np.hypot(0.8 * (i - 20), 0.8 * (j - 15))
    ring = (radius > 8) & (radius < 11)
    array = np.where(ring & (k > 5) & (k < 15), 4, np.where(ring & (k > 30) & (k < 40), 3, 0)).astype(np.uint8)
    labels = Labels(array, grid, names={3: "L3", 4: "L-4"})
    middle = transform_points(grid, np.array([20.0, 15.0, 22.5]))
    for level in ("L3-L-4", "l3 - l-4", "4-3"):
        assert canal_between(labels, level) == pytest.approx(middle, abs=0.7)
    moved = BODY_TO_REFERENCE
    assert canal_between(labels, "3-4", moved) == pytest.approx(transform_points(moved, middle), abs=0.7)
    for level in ("L3", "L3-L5", "L3-L3"):
        with pytest.raises(AIFReconError, match="two labels as in L3-L4"):
            canal_between(labels, level)
    with pytest.raises(AIFReconError, match="not closed"):
        canal_between(Labels(np.where(j > 15, array, 0), grid), "3-4")


def test_what_makes_no_sense_is_refused_in_one_sentence(volume, skin):
    with pytest.raises(AIFReconError, match="there are no labels"):
        free_paths(volume, "L3-L4", skin)
    with pytest.raises(AIFReconError, match="one Reference"):
        free_paths(volume, TARGET + 500.0, skin)
    with pytest.raises(AIFReconError, match="point X Y Z"):
        free_paths(volume, (1.0, 2.0), skin)
    with pytest.raises(AIFReconError, match="another grid"):
        free_paths(volume, TARGET, skin, mask=Volume(np.ones((3, 3, 3)), np.eye(4)))
    with pytest.raises(AIFReconError, match="shows no bone"):
        free_paths(Volume(np.full(SHAPE, 7), GRID_TO_REFERENCE), TARGET, skin)
    with pytest.raises(AIFReconError, match="margin must be 0 to 50"):
        free_paths(volume, TARGET, skin, margin=float("nan"))


def test_markups_are_lines_in_lps_and_numbers_are_json(found):
    lines = json.loads(json.dumps(markups(found)))["markups"]
    assert [line["type"] for line in lines] == ["Line"] * len(found.windows)
    entry = transform_points(LPS_FROM_RAS, found.windows[0].entry)
    assert lines[0]["controlPoints"][0]["position"] == pytest.approx(entry, abs=1e-3)
    assert {line["coordinateSystem"] for line in lines} == {"LPS"}
    one = found.windows[0]
    free, unseen = markups(replace(found, windows=(one, replace(one, is_free=False))))["markups"]
    assert free["display"] != unseen["display"]
    told = json.loads(json.dumps(found.to_dict()))
    assert told["use"].startswith("Research only: not for guiding a needle")
    assert sum(told["entries"].values()) == len(found.entries)


def test_the_map_faces_outward_and_the_picture_is_drawn(found, volume, tmp_path):
    write_skin_map(tmp_path / "map.vtp", found)
    model = read_model(tmp_path / "map.vtp")
    a, b, c = (model.points[model.triangles[:, n]] for n in range(3))
    assert model.space == "ras"
    assert (np.cross(b - a, c - a) @ BODY_TO_REFERENCE[:3, 1] < 0).all()
    paths_figure(tmp_path / "paths.png", volume, found)
    assert (tmp_path / "paths.png").stat().st_size > 10_000


def test_the_command_finds_the_same_and_needs_a_skin(found, volume, skin, tmp_path, capsys):
    volume.write(tmp_path / "volume.nrrd")
    write_skin_map(tmp_path / "skin.vtp", found)
    asked = ["paths", str(tmp_path / "volume.nrrd"), "--target", *map(str, TARGET), "--output", str(tmp_path / "paths.mrk.json")]
    assert main([*asked, "--skin", str(tmp_path / "skin.vtp"), "--report", str(tmp_path / "paths.json")]) == 0
    said = capsys.readouterr().out
    assert "Research only: not for guiding a needle" in said
    assert "Shadows are not known" in said
    told = json.loads((tmp_path / "paths.json").read_text("utf-8"))
    assert sum(one["free"] for one in told["windows"]) == 2
    assert told["windows"][0]["clearance_mm"] == pytest.approx(found.windows[0].clearance, abs=0.6)
    assert len(json.loads((tmp_path / "paths.mrk.json").read_text("utf-8"))["markups"]) == len(told["windows"])
    assert main(asked) == 2
    assert "Where the skin is must be given, once" in capsys.readouterr().err


def test_the_skin_of_a_sweep_is_where_the_face_of_the_probe_was():
    """Parallel beams in unequal pixels, images that lie obliquely: the top row of each; of a sector those at its first radius."""
    pose = BODY_TO_REFERENCE @ np.diag([0.3, 0.5, 0.4, 1.0])
    poses = np.stack([pose, pose])
    images = np.full((2, 40, 60), 90, np.uint8)
    sweep = TrackedSequence.from_arrays(images, poses, np.arange(2.0))
    linear = SweepBeams.of_sequence(sweep, ReconstructionSettings(probe="linear", clip_px=(5, 10, 50, 30))).skin()
    first = transform_points(invert(pose), linear[: len(linear) // 2])
    assert first[:, 1].max() <= 12
    assert first[:, 1].min() == pytest.approx(10)
    assert (first[:, 0].min(), first[:, 0].max()) == pytest.approx((5, 54), abs=1.01)
    fan = ReconstructionSettings(probe="sector", apex_px=(30.0, -10.0), fan_angles_deg=(-30.0, 30.0), fan_radius_px=(20.0, 60.0))
    sector = transform_points(invert(pose), SweepBeams.of_sequence(sweep, fan).skin()[:8])
    radii = np.hypot((sector[:, 0] - 30) * 0.3, (sector[:, 1] + 10) * 0.5)
    assert np.ptp(radii) <= 1.0
    assert np.ptp(sector[:, 0]) > 8

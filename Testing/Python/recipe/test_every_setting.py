"""Every setting, whatever it is: told by its option, by a cell of a table and by a settings file, and obeyed.

A setting that is declared and used nowhere fails here: the same sweep is reconstructed with two values of it, and something must differ.
"""

from __future__ import annotations

import argparse
import json

import numpy as np
import pytest
import SimpleITK as sitk
from files import tracked_sequence, write_patient

from AIFReconLib.batch.columns import Columns
from AIFReconLib.commands.parser import main
from AIFReconLib.commands.reconstruct import add_to
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.recipe.recipe import RULES, Recipe
from AIFReconLib.recipe.rules import FLAG
from AIFReconLib.terminal.one_line_parser import OneLineParser
from AIFReconLib.terminal.recipe_options import recipe_from

UP, ASIDE = np.diag([2.0, 2.0, 2.0, 1.0]).tolist(), [[2.0, 0, 0, -9], [0, 2.0, 0, -8], [0, 0, 2.0, -7], [0, 0, 0, 1.0]]
SECTOR, FAN = {"apex_px": [19.3, -30.1]}, {"fan_angles_deg": [-20, 25], "fan_radius_px": [31, 57]}

VALUES = {
    "image_to_reference": (None, "ImageToTracker", {}),
    "reference": (None, "Tracker", {}),
    "orientation": (None, "UN", {}),
    "time_offset": (0.0, 0.02, {}),
    "longest_gap": (0.5, 0.001, {"time_offset": 0.02}),
    "skip": (None, 2, {}),
    "probe": ("linear", "sector", {"method": "aif"}),
    "apex_px": ([19.3, -30.1], [3.0, -5.0], {"method": "aif"}),
    "clip_px": (None, [3.5, 2, 30, 21], {}),
    "fan_angles_deg": ([-20, 25], [-5, 5], SECTOR | FAN),
    "fan_radius_px": ([31, 57], [31, 45], SECTOR | FAN),
    "fan_apex_px": (None, [10.0, -30.0], SECTOR | FAN),
    "fan_pixel_size": (None, [0.8, 0.8], SECTOR | FAN),
    "fan_detection": (None, [254, 1], SECTOR | FAN),
    "pixel_rejection": (None, 100, {}),
    "intensity_maximum": (None, 50, {"method": "aif", "alpha": 5}),
    "gray_levels": ([0, 1, 13, 38, 85, 114, 141, 175], [0, 1, 2, 3, 4, 5, 6, 90], {"method": "weighted", "bone_sigma_mm": 1.6}),
    "speed_of_sound": (None, 1400, {}),
    "scanner_speed_of_sound": (1540, 1500, {"speed_of_sound": 1400}),
    "bone_sigma_voxels": (2.5, 5, {"method": "aif"}),
    "bone_sigma_mm": (1.6, 3, {"method": "aif"}),
    "bone_belief": (1, 0.5, {"method": "aif", "bone_sigma_mm": 1.6}),
    "bone_direction": ("gradient", "surface", {"method": "aif", "alpha": 5}),
    "spacing": (None, [2, 2, 3], {}),
    "grid_size": ([9, 8, 7], [9, 8, 6], {"grid_to_reference": ASIDE}),
    "grid_to_reference": (ASIDE, UP, {"grid_size": [9, 8, 7]}),
    "hole_limit": (0, 3, {}),
    "holes": ("nearest", "cube", {"hole_limit": 3}),
    "method": ("average", "latest", {}),
    "alpha": (0.1, 3, {"method": "aif"}),
    "beta": (0.1, 0.9, {"method": "aif-compensated", "alpha": 5}),
    "bone_gain": (4.0, 0.0, {"method": "weighted", "bone_sigma_mm": 1.6}),
    "weight_floor": (0.003, 0.5, {"method": "weighted", "bone_sigma_mm": 1.6}),
    "interpolation": ("nearest", "linear", {}),
    "output_type": ("uint8", "float32", {}),
}
"""Two values of a setting, and the settings beside which they make a difference; None: it is left open."""

ELSEWHERE = {
    "importance_mask": "an image, below",
    "bone_from_sweep": "a sweep that shows bone, below",
    "bone_frames_px": "a network's predictions, below",
    "engine": "every engine gives the same voxels",
    "best_cosine": "another volume, --cosine",
}
"""Settings that need more than a value, or change no voxel."""


def test_every_setting_is_tried():
    assert {*VALUES, *ELSEWHERE} == set(RULES)
    assert "every engine gives the same voxels" in RULES["engine"]["help"]


@pytest.fixture
def patient(tmp_path):
    """A patient whose images show bone early enough for a shadow to be told: tissue, an echo, next to nothing below."""
    images = np.random.default_rng(0).integers(40, 90, (6, 30, 40), dtype=np.uint8)
    images[:, 7:9] = 200
    images[:, 9:] //= 20
    folder = tmp_path / "inputs"
    folder.mkdir()
    return write_patient(folder, tracked_sequence(images=images))


@pytest.fixture
def outcome(patient, results):
    """What becomes of the sweep with these settings: the exit code, voxels and their place."""

    def made(settings, *words):
        path = results / "settings.json"
        path.write_text(json.dumps({name: value for name, value in settings.items() if value is not None}))
        bone = patient.bone if str(settings.get("method", "average")) in ("aif", "aif-compensated", "weighted") else []
        outputs = {name: results / f"{name}.nrrd" for name in ("intensity", "score")}
        words = [*patient.reconstruct, *_without_width(bone), "--settings", path, "-q", *words, "--score", outputs["score"]]
        code = main([str(word) for word in [*words, "-o", outputs["intensity"]]])
        if code:
            return (code,)
        volumes = [read_volume(path) for path in outputs.values()]
        return code, *((volume.array.tobytes(), volume.array.dtype, volume.ijk_to_reference.tobytes()) for volume in volumes)

    return made


def _without_width(words):
    """Bone without the width of its map, which settings give."""
    words = list(map(str, words))
    if "--bone-sigma-mm" in words:
        place = words.index("--bone-sigma-mm")
        del words[place : place + 2]
    return words


@pytest.mark.parametrize("name", VALUES)
def test_a_setting_makes_a_difference(name, outcome):
    one, other, beside = VALUES[name]
    assert outcome({**beside, name: one}) != outcome({**beside, name: other})


def test_an_importance_mask_makes_a_difference(outcome, tmp_path):
    mask = np.full((30, 40), 255, np.uint8)
    mask[:, :20] = 0
    sitk.WriteImage(sitk.GetImageFromArray(mask), str(tmp_path / "mask.png"))
    assert outcome({}) != outcome({}, "--importance-mask", tmp_path / "mask.png")


def test_bone_is_looked_for_in_the_sweep(outcome):
    assert outcome({}) != outcome({"bone_from_sweep": True})


def test_what_predictions_cover_makes_a_difference(outcome, tmp_path):
    write_sequence(tracked_sequence(seed=3), tmp_path / "predicted.mha")
    words = ["--bone-frames", tmp_path / "predicted.mha"]
    assert outcome({}, *words) != outcome({"bone_frames_px": [10, 5, 20, 15]}, *words)


# ---- doors


def _words(value):
    return [str(each) for each in value] if isinstance(value, list) else [str(value)]


OPTIONS = [name for name, rule in RULES.items() if rule["metavar"] and rule["kind"] != FLAG and name in VALUES]


@pytest.mark.parametrize("name", OPTIONS)
def test_an_option_says_it(name):
    parser = OneLineParser()
    commands = parser.add_subparsers(parser_class=OneLineParser)
    add_to(commands)
    value, beside = VALUES[name][1], VALUES[name][2]
    given = {each: known for each, known in {**beside, name: value}.items() if each in OPTIONS}
    words = [word for each, known in given.items() for word in (f"--{each.replace('_', '-')}", *_words(known))]
    recipe = recipe_from(commands.choices["reconstruct"].parse_args(["sweep.mha", "-o", "volume.nrrd", *words]))
    assert getattr(recipe, name) == getattr(Recipe(**{**beside, name: value}), name)


@pytest.mark.parametrize("name", OPTIONS)
def test_a_column_of_a_table_says_it(name, tmp_path):
    read = Columns().read(name, " ".join(_words(VALUES[name][1])), tmp_path)
    read = read[0] if name == "method" else read
    expected = getattr(recipe_from(argparse.Namespace(**{**VALUES[name][2], name: VALUES[name][1]})), name)
    assert np.array_equal(read, expected)


def test_every_setting_is_explained_in_the_docstring_and_only_given_ones_are_shown():
    page = Recipe.__doc__ or ""
    assert [name for name in RULES if f"    {name} : " not in page] == []
    assert repr(Recipe(spacing=0.5)) == "Recipe(spacing=0.5)"

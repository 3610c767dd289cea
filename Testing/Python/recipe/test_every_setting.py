"""Every setting, whatever it is: told by its option, by a cell of a table, by a settings file and in Python, and obeyed.

A setting that is declared and used nowhere fails here: the same sweep is reconstructed with two values of it, and something must differ, by
each engine and with each method that it concerns. Where it concerns nothing this is said, and what cannot be obeyed is refused.
"""

from __future__ import annotations

import json
from functools import lru_cache, partial

import numpy as np
import pytest
import SimpleITK as sitk
from files import tracked_sequence, write_patient
from live_messages import streamed

from AIFReconLib import BoneMap, LabeledBone, Reconstructor, VoxelGrid, read_labels, read_sequence, read_transform, reconstruct
from AIFReconLib.batch.columns import Columns
from AIFReconLib.commands.parser import main
from AIFReconLib.commands.reconstruct import _ReconstructOptions
from AIFReconLib.compounding.methods.table import BONE_METHODS, LINEAR_METHODS, METHODS
from AIFReconLib.errors import AIFReconError, GeometryError, SettingsError
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.wire.sources import QueueSource
from AIFReconLib.provenance.record import settings_of
from AIFReconLib.recipe.recipe import OF_LABELS, OF_READING, RULES, Recipe
from AIFReconLib.recipe.rules import FLAG
from AIFReconLib.sweep.poses import sweep_poses, tracked_frames
from AIFReconLib.terminal.arguments import OneLineParser
from AIFReconLib.worker.reconstructing import reconstructed
from AIFReconLib.workflows.job import ReconstructionJob

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
    "bone_from_sweep": "a sweep that shows bone, in Testing/Python/bone",
    "bone_frames_px": "a network's predictions, below",
    "engine": "every engine gives the same voxels",
    "motion": "a patient who moves, in Testing/Python/motion",
    "best_cosine": "another volume, --cosine",
}
"""Settings that need more than a value, or change no voxel."""


SOME_METHODS = {
    "alpha": ("aif", "aif-compensated"),
    "beta": ("aif-compensated", "weighted"),
    "bone_gain": ("weighted",),
    "weight_floor": ("weighted",),
    "gray_levels": ("weighted",),
    "intensity_maximum": BONE_METHODS,
    "interpolation": LINEAR_METHODS,
    "probe": BONE_METHODS,
    "apex_px": BONE_METHODS,
    "bone_direction": ("aif", "aif-compensated"),
    **dict.fromkeys(OF_LABELS, BONE_METHODS),
    "method": ("average",),
}
"""Methods that a setting concerns, where that is not every one."""


def test_every_setting_is_tried():
    assert {*VALUES, *ELSEWHERE} == set(RULES)
    assert "every engine gives the same voxels" in RULES["engine"]["help"]


@pytest.fixture(scope="module")
def patient(tmp_path_factory):
    """A patient whose images show bone early enough for a shadow to be told: tissue, an echo, next to nothing below."""
    images = np.random.default_rng(0).integers(40, 90, (6, 30, 40), dtype=np.uint8)
    images[:, 7:9] = 200
    images[:, 9:] //= 20
    return write_patient(tmp_path_factory.mktemp("inputs"), tracked_sequence(images=images))


@pytest.fixture(scope="module")
def read(patient):
    """The patient's sweep, labels, and their place."""
    return read_sequence(patient.sweep, config=patient.config), read_labels(patient.labels), read_transform(patient.transform)


def test_an_orientation_a_mask_and_what_predictions_cover_make_a_difference(patient, tmp_path):
    mask = np.full((30, 40), 255, np.uint8)
    mask[:, :20] = 0
    sitk.WriteImage(sitk.GetImageFromArray(mask), str(tmp_path / "mask.png"))
    write_sequence(tracked_sequence(seed=3), tmp_path / "predicted.mha")

    def made(*words):
        assert main([*map(str, [*patient.reconstruct, "-q", *words, "-o", tmp_path / "v.nrrd"])]) == 0
        return read_volume(tmp_path / "v.nrrd").array.tobytes()

    assert made() != made("--orientation", "UN")
    assert made() != made("--importance-mask", tmp_path / "mask.png")
    predicted = "--bone-frames", tmp_path / "predicted.mha"
    assert made(*predicted) != made(*predicted, "--bone-frames-px", 10, 5, 20, 15)


# ---- Python


def _labeled(read, settings):
    """Bone for the methods that need it."""
    _sequence, labels, place = read
    width = {} if {"bone_sigma_mm", "bone_sigma_voxels"} & set(settings) else {"bone_sigma_mm": 1.6}
    return LabeledBone(labels, place, recipe=Recipe(**width)) if settings["method"] in BONE_METHODS else None


@pytest.fixture(scope="module")
def in_python(read):
    """A reconstruction of the sweep by Python; the same settings run once."""

    @lru_cache
    def run(text):
        settings = json.loads(text)
        return reconstruct(read[0], Recipe(**settings), _labeled(read, settings))

    return lambda **settings: run(json.dumps({name: value for name, value in settings.items() if value is not None}, sort_keys=True))


NOTED = [name for name in SOME_METHODS if name in VALUES and name not in ("method", "interpolation", "probe", "apex_px")]
"""Linear interpolation is refused elsewhere, and a probe is a fact about the images, which the header keeps."""


def _voxels(result):
    volumes = result.intensity, result.score
    return [(volume.array.tobytes(), volume.array.dtype, volume.ijk_to_reference.tobytes()) for volume in volumes]


WITH_NOTHING_LEFT = {
    "longest_gap": "no pose is as near as a millisecond",
    "probe": "the configuration shows none of the other kind",
    "fan_detection": "no pixel is as bright",
}
"""Settings whose other value leaves nothing to reconstruct, which is an error."""


def _voxels_or_error(make, name):
    """What `make` gives; its error where a setting leaves nothing."""
    try:
        return _voxels(make())
    except AIFReconError as error:
        assert name in WITH_NOTHING_LEFT
        return str(error)


OF_ENGINES = {"pixel_rejection", "interpolation", "alpha", "beta", "bone_gain", "weight_floor", "gray_levels", "intensity_maximum"}
"""Settings whose arithmetic each engine has its own of; all others are decided before it or after it."""

TRIED = [
    (name, method, engine)
    for name in VALUES
    for method in SOME_METHODS.get(name, METHODS)
    for engine in (("numpy", "numba") if name in OF_ENGINES else ("numba",))
    if name != "bone_frames_px"
]


@pytest.mark.filterwarnings("ignore::AIFReconLib.errors.DisagreementWarning")
@pytest.mark.parametrize(("name", "method", "engine"), TRIED)
def test_each_method_and_engine_that_it_concerns_obeys_it(name, method, engine, in_python):
    one, other, beside = VALUES[name]
    beside = {**beside, "method": method, "engine": engine}
    if name == "orientation":
        with pytest.raises(SettingsError, match="orientation counts where a recording is read"):
            in_python(**beside, orientation=other)
        return
    ours, theirs = (_voxels_or_error(lambda value=value: in_python(**{**beside, name: value}), name) for value in (one, other))
    assert ours != theirs


@pytest.mark.filterwarnings("ignore::AIFReconLib.errors.DisagreementWarning")
@pytest.mark.parametrize(
    ("name", "method"),
    [(name, method) for name in NOTED for method in METHODS if method not in SOME_METHODS[name]],
)
def test_where_it_concerns_nothing_that_is_said_and_the_header_does_not_claim_it(name, method, in_python):
    result = in_python(**{"method": method, name: VALUES[name][1]})
    assert any(note.startswith(f"{name} is not used: ") for note in result.notes)
    assert name not in settings_of(result.intensity)
    assert _voxels(result) == _voxels(in_python(method=method))


def test_the_sweep_itself_says_where_bone_is_and_a_bone_map_how_it_was_made(read):
    sequence, labels, _place = read
    bone = BoneMap.from_labels(labels, 2.5)
    assert settings_of(reconstruct(sequence, Recipe(method="aif"), bone).intensity)["bone_sigma_voxels"] == 2.5
    of_sweep = Recipe(bone_from_sweep=True)
    for error, recipe, given, words in (
        (GeometryError, of_sweep, None, "bone echoes, bright with darkness behind them, are too few"),
        (SettingsError, of_sweep, bone, "Input bone_from_sweep looks for bone in the sweep, and a bone map is given"),
        (SettingsError, Recipe(method="aif", bone_sigma_voxels=5), bone, r"bone_sigma_voxels must be that of the bone map, 2\.5; got 5"),
    ):
        with pytest.raises(error, match=words):
            reconstruct(sequence, recipe, given)


GRID = VoxelGrid.from_spacing((-12.0, -12.0, -12.0), (25, 25, 25), 1.0)


def _beside(name, value):
    """A setting and those that it needs, for bone that is mapped already."""
    settings = {"method": SOME_METHODS.get(name, ("average",))[-1], **VALUES[name][2], name: value}
    return {each: known for each, known in settings.items() if known is not None and (each != "bone_sigma_mm" or each == name)}


def _mapped(read, settings):
    return BoneMap.from_labels(read[1].placed_by(read[2]), sigma_mm=1.6) if settings["method"] in BONE_METHODS else None


def _by_reconstructor(read, settings, engine):
    if settings.get("probe") == "sector":
        settings["apex_px"] = [19.3, -30.1]
    poses = sweep_poses(read[0])
    probe = None if {"probe", "apex_px"} & {*settings} else ProbeGeometry("linear")
    reconstructor = Reconstructor(GRID, Recipe(**{"engine": engine, **settings}), _mapped(read, settings), probe=probe)
    reconstructor.insert(tracked_frames(read[0], poses, poses.usable))
    return _voxels(reconstructor.reconstruction())


def _by_scan(read, settings):
    source = QueueSource(limit=10_000)
    for message in streamed(read[0]):
        source.put(message)
    bone, configuration = _mapped(read, settings), read[0].configuration
    session = LiveSession(source, Recipe(**settings), bone, GRID, configuration=configuration, longest_delay=None)
    session.start()
    result = session.finish()
    return None if result is None or not result.frames_inserted else _voxels(result)


GIVEN = ("spacing", "grid_size", "bone_sigma_mm")
DOORS = {
    # It reads no file, and its grid and bone map are made
    "reconstructor, numpy": (partial(_by_reconstructor, engine="numpy"), (*OF_READING, *GIVEN)),
    "reconstructor, numba": (partial(_by_reconstructor, engine="numba"), (*OF_READING, *GIVEN)),
    # A stream's server says how its images lie, and the configuration another probe
    "live": (_by_scan, ("orientation", "probe")),
}
"""What makes a volume of settings, and which it refuses."""

NOT_TRIED = {"bone_sigma_voxels", "bone_belief", "grid_to_reference", "method"}


@pytest.mark.parametrize("name", sorted({*VALUES} - NOT_TRIED))
@pytest.mark.parametrize("door", DOORS)
def test_a_door_obeys_it_or_refuses_it(door, name, read):
    make, refused = DOORS[door]
    if door == "live" and name in GIVEN:
        return  # those of its grid and bone map count
    one, other = (_beside(name, value) for value in VALUES[name][:2])
    if name in refused:
        with pytest.raises(SettingsError, match=name):
            make(read, other)
    else:
        assert make(read, one) != make(read, other)


@pytest.mark.filterwarnings("ignore::AIFReconLib.errors.DisagreementWarning")
@pytest.mark.parametrize("name", sorted({*VALUES} - {"orientation"}))
def test_a_window_s_job_is_that_of_python(name, read, in_python):
    """The panel's sequence is one that nobody has read as the recipe asks."""
    settings = {"method": SOME_METHODS.get(name, ("average",))[-1], **VALUES[name][2], name: VALUES[name][1]}
    job = ReconstructionJob(read[0], Recipe(**settings), _labeled(read, settings))
    ours = _voxels_or_error(lambda: reconstructed(job, ("score",)).result, name)
    assert ours == _voxels_or_error(lambda: in_python(**settings), name)


# ---- doors


def _words(value):
    return [str(each) for each in value] if isinstance(value, list) else [str(value)]


OPTIONS = [name for name, rule in RULES.items() if rule["metavar"] and rule["kind"] != FLAG and name in VALUES]


@pytest.mark.parametrize("name", OPTIONS)
def test_an_option_and_a_column_of_a_table_say_it(name, tmp_path):
    value, beside = VALUES[name][1], VALUES[name][2]
    given = {each: known for each, known in {**beside, name: value}.items() if each in OPTIONS}
    words = [word for each, known in given.items() for word in (f"--{each.replace('_', '-')}", *_words(known))]
    recipe = OneLineParser(_ReconstructOptions, "aifrecon reconstruct").parse(["sweep.mha", "-o", "volume.nrrd", *words]).recipe
    expected = getattr(Recipe(**{**beside, name: value}), name)
    assert getattr(recipe, name) == expected
    read = Columns().read(name, " ".join(_words(value)), tmp_path)
    assert np.array_equal(read[0] if name == "method" else read, expected)


def test_every_setting_is_explained_in_the_docstring_and_only_given_ones_are_shown():
    page = Recipe.__doc__ or ""
    assert [name for name in RULES if f"    {name} : " not in page] == []
    assert "motion : auto or off\n        Take out of the poses" in page
    assert repr(Recipe(spacing=0.5)) == "Recipe(spacing=0.5)"

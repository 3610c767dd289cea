"""A method of one's own: the built-in ones written as one are themselves again, and what cannot be added up is refused."""

from __future__ import annotations

import pickle
import sys

import numpy as np
import pytest
from files import refused, tracked_sequence, write_patient
from sweeps import compounded, image_pose, oblique_frames, sphere_bone, turned_grid

from AIFReconLib.commands.parser import main
from AIFReconLib.compounding.methods.table import method_named, registered_methods
from AIFReconLib.compounding.own.method import register_method
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.compounding.state import Reconstruction
from AIFReconLib.errors import BeamGeometryError, MethodError
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.beams import SECTOR, ProbeGeometry
from AIFReconLib.imaging.region import Fan, ImageRegion
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedFrame

PROBE = ProbeGeometry(SECTOR, (17.0, -12.0))
FAN = ImageRegion(fan=Fan((17.0, -12.0), (-35.0, 35.0), (14.0, 36.0)))
BONE = sphere_bone()


@register_method
def plain_mean(intensity):
    return 1.0, intensity


@register_method
def weighted_again(intensity, cosine, probability, reach, onset, floor=0.003, gain=4.0, beta=0.1):
    """`weighted` from its formulas on docs/method.md."""
    gate = onset * probability**2
    compensation = np.where(cosine > beta, np.minimum(1 / np.maximum(cosine, 1e-9), 3), 1)
    return (floor + gate) * reach, np.minimum(255, intensity * (1 + gain * gate * compensation))


@register_method
def onsets(intensity, onset):
    return 0.1 + onset, intensity


def reconstructed(method, frames=None, grid=None, bone=BONE, region=FAN, **others) -> Reconstruction:
    frames = oblique_frames(count=6) if frames is None else frames
    return compounded(frames, grid, bone, PROBE, region, method=getattr(method, "name", method), **others)


def assert_same_voxels(one: Reconstruction, other: Reconstruction) -> None:
    for name in ("intensity", "hits", "mask", "score"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)


# ---- the built-in methods once more


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float32])
def test_an_equal_weight_for_all_is_the_average_to_the_last_bit(kind):
    frames = oblique_frames(count=6, dtype=kind)
    if kind == np.float32:
        frames[2].placed()[0][4:9, 7:20] = np.nan
    assert_same_voxels(reconstructed(plain_mean, frames), reconstructed("average", frames))


def shadowed(method, bone=BONE, **others) -> Reconstruction:
    """Of frames with a bright line and darkness behind it, at the depth of the bone, so that shadows begin."""
    rng = np.random.default_rng(3)
    frames = oblique_frames(count=6, shape=(60, 34))
    for image in (frame.placed()[0] for frame in frames):
        image[:] = rng.integers(40, 90, image.shape)
        image[28:30], image[30:] = 250, 1
    return reconstructed(method, frames, bone=bone, region=ImageRegion(), **others)


def test_weighted_from_its_formulas_is_the_built_in_one_with_any_engine():
    ours, built_in = shadowed(weighted_again), shadowed("weighted")
    np.testing.assert_array_equal(ours.hits, built_in.hits)
    np.testing.assert_allclose(ours.intensity, built_in.intensity, rtol=2e-5, atol=1e-3)
    assert np.ptp(ours.score.array[ours.hits.array > 0]) > 1.0, "no shadow began: nothing was compared"
    assert_same_voxels(shadowed(weighted_again, engine="numpy"), shadowed(weighted_again, engine="auto"))


# ---- parts and whole, order, engines


def test_a_frame_without_any_weight_is_skipped_with_the_reason():
    @register_method
    def second_only(intensity):
        return float(intensity.max() == 7), intensity

    frames = [
        TrackedFrame(np.full((26, 34), gray, np.uint8), image_pose(translation=(-6, -9, 0)), number=n) for n, gray in enumerate((5, 7, 9))
    ]
    result = reconstructed(second_only, frames)
    assert result.skipped == {"no pixel in the volume has any weight": [0, 2]}
    assert set(np.unique(result.intensity)) == {0.0, 7.0}


def test_a_method_sees_the_whole_frame_wherever_the_volume_ends():
    seen = []

    @register_method
    def looking(intensity, reach, cosine):
        seen.append((intensity, reach, cosine))
        return 1.0, intensity

    frame = oblique_frames(count=1)[0]
    grid = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (3, 3, 3), 1.0)
    reconstructed(looking, [frame], grid)
    intensity, reach, cosine = seen[0]
    rows, columns = np.nonzero(FAN.mask(34, 26))
    window = np.s_[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
    np.testing.assert_array_equal(intensity, frame.placed()[0][window])
    assert ((reach > 0) == FAN.mask(34, 26)[window]).all()
    assert np.count_nonzero(cosine) < 0.5 * cosine.size


# ---- what is refused


def test_a_method_that_looks_for_shadows_needs_beams_and_no_bone():
    assert reconstructed(onsets, bone=None).frames_inserted == 6
    with pytest.raises(BeamGeometryError, match=r"Method \S+:onsets needs the direction of the beams"):
        Reconstructor(turned_grid(), ReconstructionSettings(method=onsets.name))


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (lambda p: (np.where(p == p.max(), np.nan, 1), p), "weights that are finite and at least 0; got nan for 1 of the"),
        (lambda p: (-1.0, p), "at least 0; got -1.0"),
        (lambda p: (1e300, p), "got inf"),
        (lambda p: (1.0, p / 0), "finite values where the weight is above 0; got"),
        (lambda p: p, "tuple of weight and value.*got ndarray"),
        (lambda p: (1.0, p, p), "tuple of weight and value"),
        (lambda p: (1.0, p[1:]), "tuple of weight and value"),
        (lambda p: ("much", p), "tuple of weight and value"),
        (lambda p: (1.0, p[999]), "failed in frame 0 .IndexError"),
    ],
)
def test_an_answer_that_cannot_be_added_up_is_refused_by_the_method_s_name(answer, words):
    @register_method
    def faulty(intensity):
        return answer(intensity)

    frame = oblique_frames(count=1)[0]
    frame.image[:] = np.minimum(frame.image, 254)
    frame.image[14, 17] = 255
    with pytest.raises(MethodError, match=rf"^Method \S+:faulty .*{words}") as found:
        reconstructed(faulty, [frame])
    assert "\n" not in str(found.value)


# ---- names


def test_a_method_registered_again_takes_the_place_of_the_first():
    def again(intensity):
        return 1, 2 * intensity

    first, second = register_method(again), register_method(again)
    assert method_named(first.name) is second
    assert registered_methods().count(first.name) == 1
    assert plain_mean(3) == (1.0, 3)
    assert pickle.loads(pickle.dumps(plain_mean)) is plain_mean


# ---- the command line


METHOD = """from AIFReconLib import register_method


@register_method
def {name}(intensity, probability):
    return 1 + probability, intensity
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A patient's files, and the current folder."""
    patient = write_patient(tmp_path, tracked_sequence(3))
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.chdir(tmp_path)
    return patient


def test_the_command_line_takes_a_method_of_the_folder_that_it_is_called_in(folder, tmp_path, capsys):
    (tmp_path / "mine_here.py").write_text(METHOD.format(name="sure_bone"))
    arguments = [*folder.reconstruct, *folder.bone, "--method", "mine_here:sure_bone", "--output", "volume.nrrd", "--report", "report.json"]
    assert main(arguments) == 0, capsys.readouterr().err
    assert capsys.readouterr().out.startswith("mine_here:sure_bone: 3 of 3 frames")
    assert '"method": "mine_here:sure_bone"' in (tmp_path / "report.json").read_text()
    assert "AIFRecon_method:=mine_here:sure_bone" in (tmp_path / "volume.nrrd").read_bytes()[:4000].decode("latin-1")
    assert read_volume(tmp_path / "volume.nrrd").array.any()


NOT_INSTALLED = "importing lacking fails (ModuleNotFoundError: No module named 'not_installed_at_all')"
OF_ANOTHER = "There is no method mine in another. It registers another:yours. Write @register_method"
UNREGISTERED = "def mine(intensity):\n    return 1, intensity"


@pytest.mark.parametrize(
    ("text", "method", "words"),
    [
        (None, "not_there:mine", "there is no module not_there here. Start where not_there.py is"),
        (None, "json.not_there:mine", "there is no module json.not_there here"),
        ("import not_installed_at_all", "lacking:mine", NOT_INSTALLED),
        ("1 / 0", "broken:mine", "importing broken fails (ZeroDivisionError: division by zero)"),
        ("raise SystemExit(0)", "ending:mine", "importing ending fails (SystemExit"),
        (METHOD.format(name="yours"), "another:mine", OF_ANOTHER),
        (UNREGISTERED, "forgotten:mine", "It registers no method. Write @register_method above def mine"),
        (None, "wieghted", "module:function"),
    ],
)
def test_a_method_that_cannot_be_had_is_one_sentence(folder, tmp_path, capsys, text, method, words):
    if text is not None:
        (tmp_path / f"{method.partition(':')[0]}.py").write_text(text)
    results = tmp_path / "results"
    results.mkdir()
    assert words in refused([*folder.reconstruct, "--method", method, "--output", results / "volume.nrrd"], capsys, results)

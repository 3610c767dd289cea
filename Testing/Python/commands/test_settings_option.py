"""A reconstruction is repeated from a volume, or from a settings file, to the same bytes of voxels."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from files import tracked_sequence

from AIFReconLib import __version__
from AIFReconLib.commands.parser import main
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.volume.files import read_volume

SUFFIXES = [".nrrd", ".mha", ".mhd", ".json", pytest.param(".toml", marks=pytest.mark.skipif(sys.version_info < (3, 11), reason="no TOML"))]
SIDES = ("mask", "score", "hits")


@pytest.fixture
def make(patient, results):
    """Runs `reconstruct` quietly; the answer is everything that was written, by kind."""

    def run(name, *options, words=None, suffix=".nrrd"):
        paths = {"intensity": results / f"{name}{suffix}", **{side: results / f"{name}-{side}.nrrd" for side in SIDES}}
        outputs = ["-o", paths["intensity"], *(f"--{side}={paths[side]}" for side in SIDES)]
        assert main([str(word) for word in [*(words or patient.reconstruct), "-q", *outputs, *options]]) == 0
        return {kind: read_volume(path) for kind, path in paths.items()}

    return run


def assert_same(once, again):
    for kind, volume in once.items():
        assert volume.array.tobytes() == again[kind].array.tobytes(), kind
        np.testing.assert_array_equal(volume.ijk_to_reference, again[kind].ijk_to_reference)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_was_chosen_is_repeated_whatever_is_chosen_now(suffix, make, patient, results):
    """Another spacing in the configuration, and a sweep that lies elsewhere: box, spacing and hole limit stay those of the first."""
    kept = results / f"kept{suffix}"
    of_volume = {"suffix": suffix} if suffix in SUFFIXES[:3] else {}
    once = make("kept", *([] if of_volume else ["--save-settings", kept]), **of_volume)
    assert_same(once, make("again", "--settings", kept))
    write_sequence(tracked_sequence(count=3), patient.sweep)
    patient.config.write_text(patient.config.read_text().replace('OutputSpacing="1 1 1"', 'OutputSpacing="2 2 2"'))
    fewer, anew = make("fewer", "--settings", kept), make("anew")
    assert fewer["mask"].grid.matches(once["mask"].grid)
    assert not anew["mask"].grid.matches(once["mask"].grid)
    assert fewer["intensity"].fields["AIFRecon_hole_limit_mm"] == once["intensity"].fields["AIFRecon_hole_limit_mm"]


@pytest.mark.parametrize("sigma", [["--bone-sigma-mm", "1.6"], ["--bone-sigma-voxels", "2.5"], []], ids=" ".join)
def test_how_the_bone_map_was_made_is_repeated(sigma, make, patient, results):
    files = ["--bone-labels", patient.labels, "--bone-transform", patient.transform]
    once = make("kept", *files, *sigma, "--alpha", "3", "--bone-direction", "surface")
    assert_same(once, make("again", *files, "--settings", results / "kept.nrrd"))


# ---- options given beside it


@pytest.mark.parametrize("options", [["--method", "latest"], ["--hole-limit", "0"], ["--clip-px", "2", "3", "30", "20"], ["--skip", "2"]])
def test_an_option_given_beside_it_wins_and_the_rest_stays(options, make, results):
    make("kept", "--spacing", "1.5", "--hole-limit", "1")
    settings = ["--settings", results / "kept.nrrd"]
    mixed = make("mixed", *(options + settings if options[0] == "--skip" else settings + options))
    expected = make(
        "expected", "--grid-like", results / "kept.nrrd", *([] if options[0] == "--hole-limit" else ["--hole-limit", "1"]), *options
    )
    assert_same(expected, mixed)


@pytest.mark.parametrize("kept", [["--reference", "Tracker"], ["--image-to-reference", "ImageToTracker"]], ids=" ".join)
@pytest.mark.parametrize("given", [["--image-to-reference", "ImageToReference"], ["--reference", "Reference"]], ids=" ".join)
def test_another_frame_of_reference_that_is_given_wins_however_it_is_named(kept, given, make, results):
    make("kept", *kept, "--spacing", "1.5", "--hole-limit", "1")
    settings = ["--settings", results / "kept.nrrd"]
    assert_same(make("expected", *given, "--spacing", "1.5", "--hole-limit", "1"), make("mixed", *settings, *given, "--spacing", "1.5"))


# ---- other inputs


def test_other_inputs_than_those_of_the_volume_are_named(make, patient, results, capsys):
    make("kept", *patient.bone)
    write_sequence(tracked_sequence(count=5), patient.sweep)
    words = [*patient.reconstruct, "--settings", str(results / "kept.nrrd"), "--method", "average", "-o", str(results / "v.nrrd")]
    assert main(words) == 0
    out = capsys.readouterr().out
    assert "kept.nrrd was made from labels.nrrd too, which is not given now." in out
    assert "sweep.igs.mha is not the file that kept.nrrd was made from: its size was" in out
    assert "PlusDeviceSet.xml" not in out


def test_settings_of_another_version_are_named(patient, results, tmp_path, capsys):
    settings = tmp_path / "s.json"
    settings.write_text('{"version": "0.0.9", "method": "latest"}')
    assert main([*patient.reconstruct, "--settings", str(settings), "-o", str(results / "v.nrrd")]) == 0
    assert f"The settings are of version 0.0.9, and this is {__version__}: voxels may differ." in capsys.readouterr().out


# ---- files that cannot be used

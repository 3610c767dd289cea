"""Settings files that cannot be used are refused in a sentence with file, setting and remedy; what Python makes says how it was made."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from files import tracked_sequence

from AIFReconLib import __version__
from AIFReconLib.effective_settings import asked_imaging, imaging_fields
from AIFReconLib.errors import FileFormatError
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, Fan, FanDetection, ImageRegion
from AIFReconLib.provenance.record import settings_of
from AIFReconLib.provenance.settings_files import read_settings, write_settings
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.configuration import PlusConfiguration

BAD = {
    "cut short": ("s.json", '{"method": "latest", "alp', r"s.json: it cannot be read as JSON .*or have it written anew"),
    "twice": ("s.json", '{"alpha": 1, "alpha": 2}', "'alpha' is there twice"),
    "twice of many": ("s.json", "{" + ",".join(f'"k{n}": 1' for n in range(70_000)) + ', "k69999": 1}', "'k69999' is there twice"),
    "a list": ("s.json", "[1, 2]", "s.json: settings are names and values"),
    "nested": ("s.json", "[" * 100_000, "s.json: it cannot be read as JSON"),
    "another text": ("s.json", "\u00fc".encode("latin-1"), "s.json: it is not text in UTF-8"),
    "mistyped": ("s.json", '{"alhpa": 1}', "s.json: there is no setting alhpa, perhaps alpha is meant"),
    "a file": ("s.json", '{"config": "x.xml"}', "s.json: there is no setting config. Remove it; files .* are given on the command line"),
    "too large": ("s.json", f'{{"longest_gap": 1{"0" * 400}}}', "s.json: Input longest_gap must be a finite number; got 1000"),
    "out of range": ("s.json", '{"beta": 2}', "s.json: Input beta must be at most 1; got 2"),
    "a flag": ("s.json", '{"bone_from_sweep": 1}', "s.json: Input bone_from_sweep must be True or False; got 1"),
    "half a box": ("s.json", '{"grid_size": [1, 2, 3]}', "s.json: Input grid_to_reference is missing, and grid_size needs it"),
    "an empty box": (
        "s.json",
        '{"grid_size": [0, 2, 3], "grid_to_reference": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}',
        "s.json: Input grid size",
    ),
    "half a fan": ("s.json", '{"fan_angles_deg": [-9, 9]}', "s.json: Input fan_radius_px is missing, and fan_angles_deg needs it"),
    "a probe": ("s.json", '{"probe": "curved"}', "s.json: Input probe must be one of auto, linear, sector; got 'curved'"),
    "damaged toml": ("s.toml", "method = ", r"s.toml: (it cannot be read as TOML|this Python reads no TOML)"),
    "another suffix": ("s.ini", "a = 1", "s.ini: settings are read from .json, .toml, .nrrd"),
    "no header": ("s.nrrd", "NRRD0004\n", "s.nrrd: the header ends without"),
}


@pytest.mark.parametrize(("name", "text", "said"), BAD.values(), ids=BAD)
def test_a_file_that_cannot_be_used_is_refused_with_its_name_and_what_is_wrong(name, text, said, tmp_path):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(FileFormatError, match=said) as refusal:
        read_settings(path)
    assert len(str(refusal.value)) < len(str(tmp_path)) + 300


# ---- from Python

REGIONS = [
    ImageRegion(),
    ImageRegion(ClipRectangle((1.5, 2.0), (30.0, 21.25))),
    ImageRegion(None, Fan((19.3, -30.1), (-20.0, 25.0), (12.0, 30.7), (0.4, 0.5))),
    ImageRegion(ClipRectangle((0.0, 2.0), (30.0, 20.0)), Fan((19.3, -30.1), (-20.0, 25.0), (31.0, 57.7)), FanDetection(20.0, 3)),
]


@pytest.mark.parametrize("suffix", [".json", ".nrrd"])
@pytest.mark.parametrize("region", REGIONS, ids=["whole", "clip", "fan in mm", "fan that is narrowed"])
def test_a_region_and_a_probe_come_back_as_they_were(region, suffix, tmp_path):
    """Whatever the configuration says: with the fan of another one in it, too."""
    probe = ProbeGeometry("sector", (18.0, -31.0))
    configured = PlusConfiguration(path=Path("made-up.xml"), region=replace(REGIONS[3], clip=None), probe=ProbeGeometry("linear"))
    result = reconstruct(replace(tracked_sequence(), configuration=configured), replace(PLACED, **imaging_fields(region, probe)))
    path = tmp_path / f"kept{suffix}"
    result.intensity.write(path) if suffix == ".nrrd" else write_settings(settings_of(result.intensity), path)
    kept = read_settings(path)
    assert asked_imaging(kept.recipe, configured) == (region, probe)
    assert kept.recipe.grid is not None
    assert kept.recipe.grid.size == result.grid.size
    np.testing.assert_array_equal(kept.recipe.grid.ijk_to_reference, result.grid.ijk_to_reference)


PLACED = ReconstructionSettings(spacing=2.0, hole_limit=0.0, method="latest", image_to_reference="ProbeToReference")


def test_what_python_makes_says_how(tmp_path):
    sequence = replace(tracked_sequence(), path=tmp_path / "sweep.mha")
    (tmp_path / "sweep.mha").write_bytes(b"1234")
    grid = VoxelGrid.from_spacing((-9.0, -8.0, -7.0), (7, 8, 9), (2.0, 2.5, 3.1))
    result = reconstruct(sequence, replace(PLACED, spacing=None), grid=grid)
    fields = result.mask.fields
    assert fields == result.intensity.fields
    assert (fields["AIFRecon_version"], fields["AIFRecon_method"]) == (__version__, "latest")
    assert json.loads(fields["AIFRecon_inputs"]) == [{"name": "sweep.mha", "bytes": 4}]
    settings = settings_of(result.intensity)
    assert (settings["image_to_reference"], settings["grid_size"]) == (PLACED.image_to_reference, [7, 8, 9])
    assert "best_cosine" not in settings

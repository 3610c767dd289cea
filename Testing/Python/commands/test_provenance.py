"""A volume says in its header where it comes from."""

from __future__ import annotations

import json

import numpy as np
import pytest

from AIFReconLib import __version__
from AIFReconLib.commands.parser import main
from AIFReconLib.errors import VolumeFormatError
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.metafile.opening import read_metafile
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.provenance.record import made_in_header

SUFFIXES = [".nrrd", ".mha", ".mhd"]


def fields_of(path) -> dict[str, str]:
    return {key: value for key, value in read_metafile(path, VolumeFormatError).fields.items() if key.startswith("AIFRecon")}


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_volume_names_version_method_settings_and_inputs(suffix, patient, results):
    sweep = patient.sweep.rename(patient.sweep.with_name("pass \u00fc %s {0}.igs.mha"))
    output, hits = results / f"v{suffix}", results / f"h{suffix}"
    words = ["reconstruct", str(sweep), "--config", str(patient.config), *patient.bone, "--method", "aif", "--alpha", "1.5"]
    assert main([*words, "-q", "-o", str(output), "--hits", str(hits)]) == 0
    fields = fields_of(output)
    assert fields["AIFRecon_version"] == __version__
    assert (fields["AIFRecon_method"], fields["AIFRecon_frames"]) == ("aif", "6")
    settings = json.loads(fields["AIFRecon_settings"])
    assert fields["AIFRecon_found"] == "hole_limit"
    assert "AIFRecon_simulated" not in fields
    assert (settings["method"], settings["alpha"], settings["bone_sigma_mm"]) == ("aif", 1.5, 1.6)
    assert not {"beta", "bone_gain"} & set(settings), "no concern of this method"
    assert "output" not in settings
    files = [sweep, patient.config, patient.labels, patient.transform]
    assert json.loads(fields["AIFRecon_inputs"]) == [{"name": path.name, "bytes": path.stat().st_size} for path in files]
    assert fields_of(hits) == fields


def test_an_average_names_no_file_of_bone_and_a_simulation_says_that_it_is_one(patient, results):
    text = patient.config.read_text("utf-8")
    devices = '<DataCollection><DeviceSet Name="AIFRecon simulation" /></DataCollection></PlusConfiguration>'
    patient.config.write_text(text.replace("</PlusConfiguration>", devices), "utf-8")
    words = ["reconstruct", str(patient.sweep), "--config", str(patient.config), *patient.bone[:4], "--method", "average"]
    assert main([*words, "-q", "-o", str(results / "v.nrrd")]) == 0
    fields = fields_of(results / "v.nrrd")
    assert [each["name"] for each in json.loads(fields["AIFRecon_inputs"])] == [patient.sweep.name, patient.config.name]
    assert fields["AIFRecon_simulated"] == "true"


def test_a_ct_beside_its_labels_is_an_input_of_which_no_voxel_is_made(patient, results, tmp_path):
    labels = read_volume(patient.labels)
    Volume(np.where(labels.array > 0, 400, -100).astype(np.int16), labels.ijk_to_reference).write(tmp_path / "ct.nrrd")
    words = [*patient.reconstruct, *patient.bone, "--ct", str(tmp_path / "ct.nrrd"), "--method", "aif"]
    assert main([*map(str, words), "-q", "-o", str(results / "v.nrrd")]) == 0
    assert [each["name"] for each in json.loads(fields_of(results / "v.nrrd")["AIFRecon_inputs"]) if each.get("shown")] == ["ct.nrrd"]
    named = made_in_header(read_volume(results / "v.nrrd").fields)["inputs"]
    assert patient.labels.name in named
    assert "ct.nrrd" not in named


def test_no_header_names_a_folder(patient, results):
    output = results / "v.nrrd"
    assert main([*patient.reconstruct, "-q", "-o", str(output)]) == 0
    assert str(patient.sweep.parent) not in "".join(fields_of(output).values())

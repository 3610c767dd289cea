"""`aifrecon calibrate --phantom`, on rendered N-wires."""

from __future__ import annotations

import json

import numpy as np
import pytest
from files import refused
from made_wires import IMAGE_TO_PROBE, SIZE, recording, write_phantom

from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.transform_graph import TransformName
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.plus.phantom import read_wire_phantom
from AIFReconLib.io.sequence.writer import write_sequence

NAME = TransformName("Image", "Probe")
CORNERS = np.array([(x, y, 0, 1) for x in (0, SIZE[0] - 1) for y in (0, SIZE[1] - 1)], dtype=float).T


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A recording, the phantom's configuration with its place and without, and one with another calibration and no phantom."""
    folder = tmp_path_factory.mktemp("wires")
    write_sequence(recording(read_wire_phantom(write_phantom(folder / "Phantom.xml")), 40, place=None), folder / "wires.igs.mha")
    write_phantom(folder / "Unplaced.xml", None)
    old = IMAGE_TO_PROBE.copy()
    old[:3, 3] += 2.0
    matrix = " ".join(f"{value:.9g}" for value in old.ravel())
    (folder / "Old.xml").write_text(
        f'<PlusConfiguration><CoordinateDefinitions><Transform From="Image" To="Probe" Matrix="{matrix}" /></CoordinateDefinitions>'
        "</PlusConfiguration>"
    )
    return folder


def calibrate(folder, *options) -> int:
    return main(["calibrate", *(str(folder / word) if "." in word else word for word in ("wires.igs.mha", *options))])


def corners_off(path) -> float:
    matrix = read_plus_configuration(path).transforms[NAME].matrix
    return float(np.linalg.norm(((matrix - IMAGE_TO_PROBE) @ CORNERS)[:3], axis=0).max())


def test_a_first_calibration_is_added_to_the_phantoms_configuration(folder, capsys):
    outputs = ("--output", "New.xml", "--report", "new.json", "--preview", "new.png")
    assert calibrate(folder, "--phantom", "Phantom.xml", *outputs) == 0
    assert corners_off(folder / "New.xml") < 0.05
    written = (folder / "New.xml").read_text()
    assert "ImageToProbe is new (aifrecon" in written
    assert written.startswith((folder / "Phantom.xml").read_text().split("</CoordinateDefinitions>")[0].rstrip())
    assert json.loads((folder / "new.json").read_text())["frames"]["tried"] == 40
    assert "the wires of the other half lie 0.0" in capsys.readouterr().out
    assert (folder / "new.png").stat().st_size > 10_000


def test_an_old_calibration_is_replaced_and_compared(folder, capsys):
    assert calibrate(folder, "--phantom", "Phantom.xml", "--config", "Old.xml", "--output", "Newer.xml") == 0
    assert corners_off(folder / "Newer.xml") < 0.05
    assert "image points 3.5 mm elsewhere" in capsys.readouterr().out


CANNOT = {
    ("--phantom", "Unplaced.xml", "--output", "No.xml"): "nothing says where the phantom is",
    ("--phantom", "Phantom.xml", "--check"): "With --phantom a calibration is found from wires alone.",
    ("--phantom", "Phantom.xml", "--output", "No.tfm"): "Give --output FILE.xml",
    ("--phantom", "Old.xml", "--output", "No.xml"): "a phantom needs 2 patterns of Type NWire",
    ("--phantom", "Phantom.xml", "--output", "Phantom.xml"): "would overwrite an input",
}


@pytest.mark.parametrize(("options", "words"), CANNOT.items())
def test_what_cannot_be_done_is_said_in_one_line(folder, tmp_path, monkeypatch, capsys, options, words):
    monkeypatch.chdir(folder)
    given = [str(tmp_path / each) if each.startswith("No") else each for each in options]
    assert words in refused(["calibrate", "wires.igs.mha", *given], capsys, tmp_path)

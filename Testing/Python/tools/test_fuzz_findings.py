"""Inputs that `make fuzz` found to break something, each with what it was: none may break it again."""

from __future__ import annotations

import re
import struct
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from sequence_samples import IDENTITY, metaimage, nrrd, ramp
from variant_files import slicer_images

from AIFReconLib.commands.parser import main
from AIFReconLib.errors import AIFReconError
from AIFReconLib.io.foreign.openers import natural_order
from AIFReconLib.io.foreign.options import ImportOptions
from AIFReconLib.io.foreign.poses.files import read_poses
from AIFReconLib.io.metafile.text_values import parse_number
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.transforms import read_transform_sequence
from AIFReconLib.io.transform.files import read_transform
from AIFReconLib.io.volume.files import read_volume

ITK_TEXT = b"#Insight Transform File V1.0\n#Transform 0\nTransform: "
AFFINE = b"Transform: AffineTransform_double_3_3\nParameters: 1e300 0 0 0 1e300 0 0 0 1e300 0 0 0\nFixedParameters: 0 0 0\n"
NO_PLACE = {"space": None, "space_directions": None, "space_origin": None}
ROW = '[{"time": 0, "translation": [1, 2, 3], "quaternion": {"x": 0, "y": 0, "z": 0, "w": 1}}]'


def sweep(**changes):
    return lambda path: metaimage(path, ramp(), **changes)


def nrrd_sweep(fields=None, **changes):
    return lambda path: nrrd(path, ramp(), fields or {}, **changes)


def volume(**changes):
    """An NRRD volume; underscores stand for spaces."""
    header = {"space": "left-posterior-superior", "space_directions": "(1,0,0) (0,1,0) (0,0,1)", "space_origin": "(0,0,0)"}
    return lambda path: nrrd(path, ramp(), {}, **{"kinds": "domain domain domain", **header, **changes})


def content(data):
    return lambda path: path.write_bytes(data.encode() if isinstance(data, str) else data)


def nifti(at, new):
    """NIfTI-1 of 4 x 3 x 2 voxels with some of its header replaced."""
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, 4, 3, 2, 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 2, 8)
    struct.pack_into("<8f", header, 76, 1, 0.5, 0.5, 2, 1, 0, 0, 0)
    struct.pack_into("<ff", header, 108, 352, 1)
    header[344:348] = b"n+1\0"
    header[at : at + len(new)] = new
    return content(bytes(header) + bytes(24))


def infinite_direction(path):
    slicer_images(path, compressed=False)
    path.write_bytes(re.sub(rb"directions: \(-?1.0", b"directions: (inf", path.read_bytes()))


def poses(path):
    return read_poses(path, ImportOptions())


REFUSED = {
    "a long value was repeated in the message": (read_sequence, "s.mha", sweep(BinaryData="True" * 2000)),
    "a long value of NRRD was repeated": (read_sequence, "s.nrrd", nrrd_sweep(encoding="raw" * 2000)),
    "numpy warned of an infinity times zero": (read_sequence, "s.seq.nrrd", infinite_direction),
    "keys of JSON went into the message as they were": (poses, "p.json", content(ROW.replace('"y": 0', '"\x7f": 0'))),
    "a list with keys": (poses, "p.json", content(ROW.replace('"quaternion": {', '"quater\x7fnion": [', 1))),
    "numpy warned of the square of 1e300": (poses, "p.csv", content("x,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,1e300\n")),
    "each word of a heading was tried with each other: minutes": (poses, "p.csv", content(f"time x y z rx {'x-' * 5000}\n0 1 2 3 4 5\n")),
    "numpy warned of an infinity in a composite": (
        read_transform,
        "t.tfm",
        content(ITK_TEXT.replace(b"#Transform 0\n", b"") + b"CompositeTransform_double_3_3\n" + 2 * AFFINE),
    ),
    "a type of voxels that is none made ITK complain": (read_volume, "v.nii", nifti(70, b"\x07\0")),
    "ITK's NRRD reader crashed on four sizes": (read_volume, "v.nrrd", volume(sizes="6 4 3 1", dimension="4", kinds=None)),
    "it made up a place where there is none": (read_volume, "v.nrrd", volume(space_directions="none none none")),
    "it crashed on a space with time": (read_volume, "v.nrrd", volume(space="left-posterior-superior-time")),
    "it took an infinite spacing": (read_volume, "v.nrrd", volume(spacings="1e400 nan -1", **NO_PLACE)),
    "it crashed on long units": (read_volume, "v.nrrd", volume(space_units="x" * 1000)),
}


@pytest.mark.parametrize(("read", "file", "write"), REFUSED.values(), ids=REFUSED)
def test_it_is_refused_in_one_line(tmp_path, read, file, write, capfd):
    write(tmp_path / file)
    with pytest.raises(AIFReconError) as refused:
        read(tmp_path / file)
    assert str(refused.value).isprintable()
    assert len(str(refused.value)) < 8000
    assert capfd.readouterr() == ("", "")


def test_control_characters_of_an_argument_do_not_go_to_the_terminal(capsys):
    assert main(["info", "--j\x1b[2Json", "s.mha"]) == 2
    said = capsys.readouterr().err
    assert said[:-1].isprintable()


@pytest.mark.parametrize("end", ["x", "", ".", "e", "e5"])
def test_a_long_run_of_digits_is_read_or_refused_at_once(end):
    """It took the square of its length: 16 s for 20,000 digits."""
    with pytest.raises(ValueError, match="is not a number") if end in ("x", "e") else np.errstate():
        parse_number("1" * 200_000 + end)


def test_a_whole_number_of_400_digits_is_an_infinity(tmp_path):
    """Python makes no float of it: OverflowError. In CSV it is an infinity too, and its pose is missing."""
    read = {}
    for name, text in (("poses.json", f"[[1{'0' * 400},0,0,0,0,1,0,0,0,0,1,0]]"), ("poses.csv", f"1{'0' * 400} 0 0 0 0 1 0 0 0 0 1 0")):
        (tmp_path / name).write_text(text)
        read[name] = read_poses(tmp_path / name).matrices
    np.testing.assert_array_equal(read["poses.json"], np.full((1, 4, 4), np.nan))
    np.testing.assert_array_equal(read["poses.json"], read["poses.csv"])


def test_a_superscript_in_a_file_s_name_is_no_number():
    """`str.isdigit` says it is one; `int` does not: ValueError."""
    assert sorted([Path("1²3.png"), Path("1a2.png")], key=natural_order) == [Path("1a2.png"), Path("1²3.png")]


@pytest.mark.parametrize(
    "text",
    [
        '[{"x": 1, "y": 2, "z": 3, "quaternion": {"x": 0, "y": 0, "z": 0, "w": 1}, "euler": [90, 0, 0]}]',
        '[{"x": 1, "y": 2, "z": 3, "quaternion": {"x": 0, "y": 0, "z": 0, "w": 1}, "rx": 90}]',
        '[{"x": 1, "y": 2, "z": 3, "quaternion": {"x": 0, "y": 0, "z": 0, "w": 1}, "m00": 5}]',
    ],
)
def test_a_row_with_a_quaternion_and_more_is_what_was_said_of_it(tmp_path, text):
    """Said to be a quaternion, it was read as Euler angles (TypeError, KeyError) or as a matrix of one number and zeros."""
    (tmp_path / "poses.json").write_text(text)
    table = read_poses(tmp_path / "poses.json", ImportOptions())
    assert "quaternion" in table.understood[0]
    np.testing.assert_array_equal(table.matrices[0], [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])


def test_a_transform_sequence_with_a_frame_far_away_takes_little_memory(tmp_path):
    """A million samples of their own took 400 MB."""
    path = metaimage(tmp_path / "s.mha", ramp(), {"Seq_Frame0000_ImageToReferenceTransform": IDENTITY, "Seq_Frame999999_Timestamp": "1"})
    tracemalloc.start()
    read_transform_sequence(path, "ImageToReference")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 200 * 2**20

"""Inputs that `make fuzz` found to break something, each with what it was: none may break it again."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest

TESTING = Path(__file__).resolve().parents[2]
if str(TESTING) not in sys.path:
    sys.path.insert(0, str(TESTING))

from fuzz import seeds  # noqa: E402
from fuzz.file_targets import SEQUENCES  # noqa: E402
from fuzz.registry import TARGETS  # noqa: E402
from fuzz.target import check  # noqa: E402

from AIFReconLib.io.foreign.openers import natural_order  # noqa: E402
from AIFReconLib.io.foreign.options import ImportOptions  # noqa: E402
from AIFReconLib.io.foreign.poses.files import read_poses  # noqa: E402
from AIFReconLib.io.metafile.text_values import parse_number  # noqa: E402
from AIFReconLib.io.sequence.files import KINDS  # noqa: E402

ITK_TEXT = b"#Insight Transform File V1.0\n#Transform 0\nTransform: "
HUGE_GRID = b"FixedParameters: 3000 3000 3000 0 0 0 1 1 1 1 0 0 0 1 0 0 0 1\n"
(JPEG,) = seeds.masks(".jpg")
NO_PLACE = {"space": None, "space_directions": None, "space_origin": None}

REFUSED = [
    # Python converts at most 4300 digits: ValueError
    ("sequence-metaimage", seeds.metaimage(**{"Seq_Frame" + "1" * 7000 + "_Note": "a"})),
    ("sequence-nrrd", seeds.nrrd(pairs=[("axis 3 index type", "numeric"), ("axis 3 item " + "1" * 7000 + " Note", "a")])),
    # A value of the header was repeated in the message, however long
    ("sequence-metaimage", seeds.metaimage(BinaryData="True" * 2000)),
    ("sequence-nrrd", seeds.nrrd(encoding="raw" * 2000)),
    # numpy warned of an infinity times zero
    ("sequence-nrrd", seeds.nrrd_sequences()[2].replace(b"(0.5,0,0)", b"(inf,0,0)")),
    # Keys of JSON went into the message as they were
    ("poses-json", seeds.pose_json()[1].replace(b'"y": 0', b'"\x7f": 0')),
    ("poses-json", seeds.pose_json()[1].replace(b'"quaternion": {', b'"quater\x7fnion": [', 1)),
    # numpy warned of the square of 1e300
    ("poses-csv", b"x,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,1e300\n"),
    # ITK's reader freed memory twice and ended the program
    ("transform-text", ITK_TEXT + b"BSplineTransform_double_3_3\nParameters: 0 0 0\n" + HUGE_GRID),
    ("transform-text", ITK_TEXT + b"DisplacementFieldTransform_double_3_3\nParameters:\n" + HUGE_GRID),
    # numpy warned of an infinity in the product of a composite
    (
        "transform-text",
        b"#Insight Transform File V1.0\nTransform: CompositeTransform_double_3_3\n"
        + 2 * b"Transform: AffineTransform_double_3_3\nParameters: 1e300 0 0 0 1e300 0 0 0 1e300 0 0 0\nFixedParameters: 0 0 0\n",
    ),
    # A header that promises 4000 million pixels was believed (100 million of a bitmap: 600 MB)
    ("importance-mask-jpg", re.sub(rb"(?s)(\xff[\xc0\xc2]...)....", lambda found: found[1] + b"\xea\x60" * 2, JPEG)),
    # An old Analyze header made ITK print warnings
    ("volume-nifti", seeds.nifti()[0][:344] + b"ni1\0" + seeds.nifti()[0][348:]),
    # A type of voxels that is none made ITK's reader print its own complaint
    ("volume-nifti", seeds.nifti()[0][:70] + b"\x07\x00" + seeds.nifti()[0][72:]),
    # Pillow would have started Ghostscript
    ("pictures", seeds.pictures()[-1]),
    # Control characters of an argument went to the terminal
    ("command-options", b"info\n--j\x1b[2Json\n"),
]


def test_every_require_recording_kind_is_fuzzed():
    assert all({Path(target.file_name).suffix for target in SEQUENCES} & set(kind.suffixes) for kind in KINDS)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "data.raw").write_bytes(bytes(range(24)) * 3)
    return tmp_path


@pytest.mark.parametrize(("name", "data"), REFUSED, ids=lambda value: value if isinstance(value, str) else "")
def test_it_is_refused_in_one_line(folder, name, data, capfd):
    assert not check(TARGETS[name], data, folder)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "changes",
    [
        # ITK's NRRD reader crashed on these, or made up a place
        {"sizes": "6 4 3 1", "dimension": "4", "kinds": None},
        {"space_directions": "none none none"},
        {"space": "left-posterior-superior-time"},
        {"spacings": "1e400 nan -1", **NO_PLACE},
        {"space_units": "x" * 1000},
    ],
    ids=lambda changes: " ".join(changes),
)
def test_an_nrrd_volume_that_itk_must_not_see_is_refused(folder, changes):
    assert not check(TARGETS["volume-nrrd"], seeds.nrrd(pairs=[], **{"kinds": "domain domain domain", **changes}), folder)


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


def test_a_transform_sequence_with_a_frame_far_away_takes_little_memory(folder):
    """A million samples of their own took 400 MB."""
    assert check(TARGETS["transform-sequence"], seeds.metaimage(Seq_Frame999999_Timestamp="1"), folder)

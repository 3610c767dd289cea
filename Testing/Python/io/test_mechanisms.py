"""Mechanisms: what their axes read, and a description of them, give poses."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from sweeps import rigid

from AIFReconLib import read_sequence
from AIFReconLib.commands.parser import main
from AIFReconLib.errors import FileFormatError
from AIFReconLib.io.foreign.mechanisms import read_joint_poses, read_mechanism
from AIFReconLib.io.foreign.openers import open_images
from AIFReconLib.io.foreign.options import ImportOptions
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence

HOME = rigid((20.0, -35.0, 80.0), (12.0, -7.0, 140.0))
SLIDE = {"name": "Slide", "kind": "shift", "direction": [1, 2, 2]}
TILT = {"name": "Tilt", "kind": "turn", "direction": [0.6, 0, 0.8], "point": [10, -20, 30]}
TABLE = "time,tilt,slide\n0,0,0\n0.1,12.5,3\n0.2,-40,7.5\n"


def described(tmp_path, **table):
    path = tmp_path / "mechanism.json"
    path.write_text(json.dumps(table))
    return read_mechanism(path)


def read(tmp_path, mechanism, text=TABLE, **form):
    (tmp_path / "joints.csv").write_text(text)
    return read_joint_poses(tmp_path / "joints.csv", mechanism, ImportOptions(**form))


def about(degrees, direction, point):
    """A turn about a line, point by point: Rodrigues' formula on the corners of a frame."""
    axis, angle = np.array(direction) / np.linalg.norm(direction), np.radians(degrees)

    def turned(p):
        v = p - point
        return point + v * np.cos(angle) + np.cross(axis, v) * np.sin(angle) + axis * (axis @ v) * (1 - np.cos(angle))

    matrix = np.eye(4)
    matrix[:3, 3] = turned(np.zeros(3))
    for column in range(3):
        matrix[:3, column] = turned(np.eye(3)[column]) - matrix[:3, 3]
    return matrix


def test_axes_carry_each_other_in_their_order(tmp_path):
    poses = read(tmp_path, described(tmp_path, axis=[SLIDE, TILT], home=HOME.tolist()))
    for (tilt, slide), found in zip(((0, 0), (12.5, 3), (-40, 7.5)), poses.matrices):
        shift = np.eye(4)
        shift[:3, 3] = slide * np.array([1, 2, 2]) / 3
        np.testing.assert_allclose(found, shift @ about(tilt, TILT["direction"], np.array(TILT["point"])) @ HOME, atol=1e-9)
    np.testing.assert_allclose(poses.times, [0, 0.1, 0.2])
    other = read(tmp_path, described(tmp_path, axis=[TILT, SLIDE], home=HOME.tolist()))
    assert np.abs(other.matrices[1] - poses.matrices[1]).max() > 0.1


def test_joints_of_urdf_and_axes_in_the_base_describe_the_same_arm(tmp_path):
    """A turn about the vertical, an upper arm of 0.3 m, a turn and a shift in frames that are turned themselves."""
    joints = [
        {"name": "yaw", "type": "revolute", "axis": [0, 0, 1], "xyz": [0, 0, 0.1]},
        {"name": "elbow", "type": "continuous", "axis": [0, 1, 0], "xyz": [0.3, 0, 0], "rpy": [0.4, -0.2, 1.1]},
        {"name": "plate", "type": "fixed", "xyz": [0, 0.05, 0], "rpy": [0, 0.7, 0]},
        {"name": "reach", "type": "prismatic", "axis": [1, 0, 1], "xyz": [0.02, 0, 0.03]},
    ]
    text = "yaw elbow reach\n0.3 -1.1 0.02\n-2 0.4 -0.1\n"
    arm = read(tmp_path, described(tmp_path, joint=joints), text, angle_unit="rad", units="m").matrices
    frames, frame = [], np.eye(4)
    for joint in joints:
        origin = np.eye(4)
        origin[:3, :3] = Rotation.from_euler("xyz", joint.get("rpy", [0, 0, 0])).as_matrix()
        origin[:3, 3] = 1000 * np.array(joint["xyz"])
        frame = frame @ origin
        frames.append(frame)
    axes = [
        {"name": j["name"], "kind": "shift", "direction": (f[:3, :3] @ j["axis"]).tolist()}
        if j["type"] == "prismatic"
        else {"name": j["name"], "kind": "turn", "direction": (f[:3, :3] @ j["axis"]).tolist(), "point": f[:3, 3].tolist()}
        for j, f in zip(joints, frames)
        if j["type"] != "fixed"
    ]
    same = read(tmp_path, described(tmp_path, axis=axes, home=frames[-1].tolist()), text, angle_unit="rad", units="m").matrices
    np.testing.assert_allclose(arm, same, atol=1e-9)
    # In meters, as the table says: by hand, the elbow is at 0.3 m from the yaw's axis, 0.1 m up
    expected = about(np.degrees(0.3), [0, 0, 1], np.zeros(3)) @ [300, 0, 100, 1]
    still = read(tmp_path, described(tmp_path, joint=joints[:2]), "yaw elbow\n0.3 0.9\n", angle_unit="rad").matrices[0]
    np.testing.assert_allclose(still[:3, 3], expected[:3], atol=1e-9)


def test_steps_of_a_motor_have_a_scale_and_a_zero(tmp_path):
    mechanism = described(tmp_path, axis=[{**SLIDE, "direction": [0, 0, 1], "scale": 0.005, "zero": 2000}])
    np.testing.assert_allclose(read(tmp_path, mechanism, "Slide\n2000\n2400\n").matrices[:, 2, 3], [0, 2])


def test_a_reading_that_is_missing_is_a_pose_that_is_missing(tmp_path):
    poses = read(tmp_path, described(tmp_path, axis=[SLIDE, TILT]), "slide,tilt,status\n1,2,OK\n,2,OK\n3,nan,MISSING\n")
    assert np.isfinite(poses.matrices).all(axis=(1, 2)).tolist() == [True, False, False]
    assert poses.statuses == ("OK", "OK", "MISSING")


def test_units_in_the_headings_come_before_those_that_are_said(tmp_path):
    mechanism = described(tmp_path, axis=[SLIDE, TILT])
    same = read(tmp_path, mechanism, "time_ms,slide [cm],tilt (rad)\n0,0.3,0.1\n50,0.3,0.1\n")
    plain = read(tmp_path, mechanism, f"time,slide,tilt\n0,3,{np.degrees(0.1)}\n0.05,3,{np.degrees(0.1)}\n")
    np.testing.assert_allclose(same.matrices, plain.matrices)
    np.testing.assert_allclose(same.times, plain.times)


@pytest.mark.parametrize("text", ["0 12.5 3\n1 12.5 3\n", "12.5 3\n12.5 3\n"])
def test_without_headings_the_columns_are_the_axes_in_order(tmp_path, text):
    poses = read(tmp_path, described(tmp_path, axis=[TILT, SLIDE]), text)
    named = read(tmp_path, described(tmp_path, axis=[TILT, SLIDE]), "slide,tilt\n3,12.5\n")
    np.testing.assert_allclose(poses.matrices[0], named.matrices[0])


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({}, "must have a list of axis or of joint"),
        ({"axis": [SLIDE], "joint": []}, "must have a list of axis or of joint"),
        ({"axis": [{**SLIDE, "kind": "slide"}]}, "axis 1: kind must be shift or turn; got 'slide'"),
        ({"axis": [SLIDE, {**TILT, "direction": [0, 0, 0]}]}, "axis 2: direction must not be 0 0 0"),
        ({"axis": [{**TILT, "point": [1, 2]}]}, "axis 1: point must be three numbers; got .1, 2."),
        ({"axis": [{**SLIDE, "point": [1, 2, 3]}]}, r"axis 1 \(Slide\): a turn must have a point .* a shift must have none"),
        ({"axis": [{**SLIDE, "limit": 3}]}, r"axis 1 \(Slide\): limit is not known"),
        ({"axis": [SLIDE, SLIDE]}, "its axes must have a name each"),
        ({"axis": [{**SLIDE, "name": "a b"}]}, "name must be a word"),
        (
            {"axis": [SLIDE], "home": np.diag([1, 1, -1, 1]).tolist()},
            "home must be a rotation and a translation; it is not rigid .mirrored.",
        ),
        ({"axis": [SLIDE], "home": [1, 2]}, "home must be 4 rows of 4 numbers"),
        ({"joint": [{"name": "a", "type": "planar"}]}, "joint 1: type must be prismatic or revolute"),
        ({"joint": [{"name": "a", "type": "fixed"}]}, "one must move"),
    ],
)
def test_a_description_that_cannot_be_used_says_where(tmp_path, table, message):
    with pytest.raises(FileFormatError, match=message):
        described(tmp_path, **table)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("slide,lift\n1,2\n", "must have one column tilt, for the axis of this name; got slide, lift"),
        ("slide,tilt,Tilt\n1,2,3\n", "must have one column tilt"),
        ("slide,tilt\n1,x\n", "line 2 .frame 0., column tilt must be a number; got 'x'"),
        ("slide,tilt\n1,2\n1\n", "line 3 .frame 1. must have 2 columns; got 1"),
        ("1,2,3,4\n", "without headings there must be 2 columns .slide, tilt., or the time in front; got 4"),
        ("slide,tilt\n", "holds no values of the axes"),
    ],
)
def test_a_table_that_does_not_fit_says_where(tmp_path, text, message):
    with pytest.raises(FileFormatError, match=message):
        read(tmp_path, described(tmp_path, axis=[SLIDE, TILT]), text)


def test_the_fields_of_a_recording_may_hold_what_the_axes_read(tmp_path):
    images = np.zeros((3, 4, 5), np.uint8)
    fields = [{"Slide": "0", "Tilt": "0"}, {"Slide": "3", "Tilt": "12.5"}, {"Slide": "7.5"}]
    records = [FrameRecord(0.1 * number, fields=each) for number, each in enumerate(fields)]
    write_sequence(TrackedSequence(images, records), tmp_path / "sweep.igs.mha")
    mechanism = described(tmp_path, axis=[SLIDE, TILT], home=HOME.tolist())
    found = read_joint_poses(tmp_path / "sweep.igs.mha", mechanism)
    expected = read(tmp_path, mechanism).matrices
    np.testing.assert_allclose(found.matrices[:2], expected[:2])
    assert np.isnan(found.matrices[2]).all()
    np.testing.assert_allclose(found.times, [0, 0.1, 0.2])
    assert len(open_images([tmp_path / "sweep.igs.mha"]).stack) == 3
    other = described(tmp_path, axis=[{**SLIDE, "name": "lift"}])
    with pytest.raises(FileFormatError, match=r"its frames must have a field lift, for the axis of this name; got slide, tilt"):
        read_joint_poses(tmp_path / "sweep.igs.mha", other)


@pytest.mark.skipif(sys.version_info < (3, 11), reason="Python 3.10 reads no TOML")
def test_a_swept_array_is_imported_with_its_drawing(tmp_path, capsys, monkeypatch):
    """The paper's device: a motor moves the array along, another tilts it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "array.toml").write_text(
        '[[axis]]\nname = "slide"\nkind = "shift"\ndirection = [0, 1, 0]\n\n'
        '[[axis]]\nname = "tilt"\nkind = "turn"\ndirection = [1, 0, 0]\npoint = [0, 0, -15]\n'
    )
    (tmp_path / "joints.csv").write_text("time,slide,tilt\n" + "".join(f"{n / 20},{n},{5 * n - 20}\n" for n in range(9)))
    np.save("images.npy", np.random.default_rng(0).integers(0, 255, (9, 12, 17), np.uint8))
    line = "import images.npy --poses joints.csv --mechanism array.toml --transform ImageToBase --spacing 0.2 0.3 -o sweep.mha"
    assert main(line.split()) == 0
    said = capsys.readouterr().out
    assert "poses: 9, of a mechanism: slide (shift, mm), tilt (turn, deg)" in said
    found = read_sequence("sweep.mha").records[8].transforms
    shift = np.eye(4)
    shift[1, 3] = 8
    expected = shift @ about(20, [1, 0, 0], np.array([0, 0, -15])) @ np.diag([0.2, 0.3, 0.25, 1])
    np.testing.assert_allclose(next(iter(found.values())).matrix, expected, atol=1e-9)
    drawing = (tmp_path / "sweep-sweep.svg").read_text()
    assert drawing.count(">slide</text>") == drawing.count(">tilt</text>") == 2

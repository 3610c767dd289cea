"""Poses in other people's files: every way to write one, read as meant; every convention that is left open is asked for."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from sweeps import rigid

from AIFReconLib.errors import AIFReconError, FileFormatError, SettingsError
from AIFReconLib.io.foreign.options import ImportOptions
from AIFReconLib.io.foreign.poses.files import read_poses

POSES = [rigid((10.0 * n - 20.0, 5.0, 30.0 + n), (1.5 * n, -20.0, 7.25)) for n in range(3)]


def quaternion(pose, order="xyzw") -> list[float]:
    by_axis = dict(zip("xyzw", Rotation.from_matrix(pose[:3, :3]).as_quat()))
    return [float(by_axis[axis]) for axis in order]


def table(rows, header=None, separator=",") -> str:
    return "\n".join([*([separator.join(header)] if header else []), *(separator.join(map(str, row)) for row in rows)]) + "\n"


def read(tmp_path, text, form=None, name="poses.csv"):
    (tmp_path / name).write_text(text, encoding="utf-8")
    return read_poses(tmp_path / name, form)


def assert_poses(found):
    np.testing.assert_allclose(found.matrices, POSES, atol=1e-9)
    assert found.times is None


BY_ROW = [pose.ravel().tolist() for pose in POSES]
M00 = [f"m{r}{c}" for r in range(4) for c in range(4)]


NAMED = ("x y z qx qy qz qw", "tx ty tz q_x q_y q_z q_w", "Pos_X Pos_Y Pos_Z Quat_X Quat_Y Quat_Z Quat_W")


@pytest.mark.parametrize("missing", [["nan"] * 7, [""] * 7, ["1", "2", "3", "0", "0", "0", "0"], None])
def test_a_row_without_a_pose_is_a_missing_pose(tmp_path, missing):
    rows = [[*pose[:3, 3], *quaternion(pose)] for pose in POSES]
    rows[1] = missing
    text = table(rows, NAMED[0].split()) if missing else ""
    items = json.dumps([{"matrix": POSES[0].tolist()}, {"note": "lost"}, {"matrix": POSES[2].tolist()}])
    found = read(tmp_path, text) if missing else read(tmp_path, items, name="poses.json")
    assert np.isnan(found.matrices[1]).all()
    np.testing.assert_allclose(found.matrices[[0, 2]], [POSES[0], POSES[2]])


JSON_POSES = {
    "list of matrices": [pose.tolist() for pose in POSES],
    "objects with matrices": [{"matrix": pose.tolist()} for pose in POSES],
    "under frames": {"frames": [{"transform": pose.tolist()} for pose in POSES], "units": "mm"},
    "named parts": [
        {"translation": dict(zip("xyz", pose[:3, 3].tolist())), "quaternion": dict(zip("xyzw", quaternion(pose)))} for pose in POSES
    ],
    "columns": [dict(zip(("x", "y", "z", "qx", "qy", "qz", "qw"), [*pose[:3, 3].tolist(), *quaternion(pose)])) for pose in POSES],
}


@pytest.mark.parametrize("name", JSON_POSES)
def test_poses_in_json(tmp_path, name):
    assert_poses(read(tmp_path, json.dumps(JSON_POSES[name]), name="poses.json"))


SHORT = table([row[:12] for row in BY_ROW]) + "1,2\n"
SPLIT_TIME = "sec,nanosec,x,y,z,qx,qy,qz,qw\n1,0,1,2,3,0,0,0,1\n1,abc,1,2,3,0,0,0,1\n"


@pytest.mark.parametrize(
    ("text", "form", "message"),
    [
        ("", None, "holds no poses"),
        ("x,y,z\n", None, "holds no poses"),
        ("0 : :", None, "poses.csv"),
        (SHORT, None, r"line 4 .frame 3. must have 12 columns; got 2"),
        (table(BY_ROW, M00).replace("-20.0", "left", 1), None, r"line 2 .frame 0., column m13 must be a number; got 'left'"),
        (SPLIT_TIME, None, r"line 3 .frame 1., column time must be a number; got 'abc'"),
        (table([[1, 2, 3, 4, 5, 6, 7]]), None, "7 columns without names can be many things.*columns"),
        (f"{NAMED[0]}\n1 2 3 0.5 0.5 0.5 0.1\n", None, r"frame 0. must have a quaternion of length 1"),
        ("x y z rx ry rz\n1 2 3 4 5 6\n", None, "order of the Euler angles is not known. Give euler_order"),
        ("x y z\n1 2 3\n", None, "must be 4x4 matrices .*known columns: x, y, z"),
        (table([pose.T.ravel().tolist() for pose in POSES]), None, r"0 0 0 1 as its last row; got .*column_major"),
        ("1 0 0 0\n0 1 0 0\n", None, "must come in fours or threes"),
        (table(BY_ROW), ImportOptions(columns="x y"), r"columns must name 16 columns; got 2"),
    ],
)
def test_a_file_that_cannot_be_used_is_explained(tmp_path, text, form, message):
    with pytest.raises(AIFReconError, match=message) as caught:
        read(tmp_path, text, form)
    assert "poses.csv" in str(caught.value)
    assert "\n" not in str(caught.value)


QUATERNION_ROWS = "\n".join([f"{time},1,2,3,0,0,0,1" for time in ("0.00", "{}", "0.10")])


@pytest.mark.parametrize("word", ["nan", "missing", "-", ""])
def test_a_row_without_a_time_is_told_and_times_are_not_used(tmp_path, word):
    found = read(tmp_path, "time,x,y,z,qx,qy,qz,qw\n" + QUATERNION_ROWS.format(word))
    assert found.times is None
    assert "time: time: not used, 1 of 3 rows have none" in found.understood


def test_an_hour_of_the_day_runs_over_midnight(tmp_path):
    rows = [f"{hour},{n},2,3,0,0,0,1" for n, hour in enumerate(("23:59:59.90", "00:00:00.00", "00:00:00.10"))]
    found = read(tmp_path, "\n".join(["time,x,y,z,qx,qy,qz,qw", *rows]))
    np.testing.assert_allclose(np.diff(found.times), 0.1, atol=1e-9)


NO_JSON = {
    "{": "this is not JSON",
    "3": "must hold a list of poses, .*; got int",
    '{"a": 1}': "object with one under frames, poses",
    '[{"matrix": [1, 2, 3]}]': "Headings: matrix 0, matrix 1, matrix 2",
    '[{"x": true, "y": 1, "z": 2, "quaternion": [0, 0, 0, 1]}]': "pose 0, column x must be a number; got 'True'",
    "[" * 100_000: "this is not JSON",
    "[" * 900 + "]" * 900: "this is not JSON|holds no poses|known columns",
}


@pytest.mark.parametrize(("text", "message"), NO_JSON.items())
def test_json_that_cannot_be_used_is_explained(tmp_path, text, message):
    with pytest.raises(AIFReconError, match=message):
        read(tmp_path, text, ImportOptions(quaternion_order="xyzw"), name="poses.json")


@pytest.mark.parametrize("options", [{"euler_order": "xXy"}, {"euler_order": "xxy"}, {"units": "inch"}], ids=str)
def test_a_convention_that_is_none_is_refused(options):
    with pytest.raises(SettingsError, match=r"three axes|one of mm, cm, m, in"):
        ImportOptions(**options)


@pytest.mark.parametrize("shape", [(3, 4, 4), (3, 16), (3, 12), (3, 3, 4)])
def test_an_array_of_matrices_is_read_as_it_is_and_nothing_else(shape, tmp_path):
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, :3, 3] = np.arange(9).reshape(3, 3) + 0.1
    np.save(tmp_path / "poses.npy", (poses[:, :3] if 3 in shape[1:] or shape[-1] == 12 else poses).reshape(shape))
    np.testing.assert_array_equal(read_poses(tmp_path / "poses.npy").matrices, poses)
    for array, words in ((np.zeros((3, 7)), r"got \(3, 7\)"), (np.array([{}], dtype=object), "array of numbers")):
        np.save(tmp_path / "poses.npy", array, allow_pickle=True)
        with pytest.raises(FileFormatError, match=words):
            read_poses(tmp_path / "poses.npy")


TURN = "r00,r01,r02,r10,r11,r12,r20,r21,r22"


DOUBLE = {
    "x,y,z,qx,qy,qz,qw,R_x,R_y,R_z,R_qx,R_qy,R_qz,R_qw": "The heading R_x can be read in several ways",
    "x_R,y_R,z_R,q_R_x,q_R_y,q_R_z,q_R_w,L_x,L_y,L_z,L_qx,L_qy,L_qz,L_qw": "First rows",
    "T X,Y,Z,qx,qy,qz,qw,P X,Y,Z,qx,qy,qz,qw": "2 columns mean x: T X .column 1., P X .column 8.",
    f"x,y,z,{TURN},x 1,y 1,z 1,rx 1,ry 1,rz 1": "2 tools side by side: unnamed 1, 1",
    f"x,y,z,{TURN},x2,y2,z2," + TURN.replace(",", "2,") + "2": "9 headings are not known",
    "x,y,z,qx,qy,qz,qw,status,valid,u,v,w,k,l": "2 columns mean status: status .column 8., valid .column 9.",
}


@pytest.mark.parametrize(("header", "message"), DOUBLE.items())
def test_columns_of_two_tools_and_two_that_mean_the_same_are_asked_about(tmp_path, header, message):
    with pytest.raises(SettingsError, match=message):
        read(tmp_path, f"{header}\n" + (",".join(["1"] * len(header.split(","))) + "\n") * 3)


MOTIVE = (
    "Format Version,1.23,Length Units,Millimeters\n\n,Type,"
    + ",".join(["Rigid Body"] * 7 + ["Rigid Body Marker"] * 3 + ["Rigid Body"] * 7)
    + "\n,Name," + ",".join(["USProbe"] * 7 + ["USProbe:Marker 001"] * 3 + ["PatientRef"] * 7)
    + "\n,ID," + ",".join([f"{8 * 'ABCD'}"] * 7 + [f"{8 * 'ABCE'}"] * 3 + [f"{8 * 'ABCF'}"] * 7)
    + "\n,," + ",".join([*["Rotation"] * 4, *["Position"] * 6, *["Rotation"] * 4, *["Position"] * 3])
    + "\nFrame,Time (Seconds),X,Y,Z,W,X,Y,Z,X,Y,Z,X,Y,Z,W,X,Y,Z\n"
    + "".join(f"{n},{0.1 * n:.1f},0,0,0,1,{n},2,3,9,9,9,0,0,0,1,7,7,7\n" for n in range(4))
)  # fmt: skip


@pytest.mark.parametrize("name", ["USProbe", "us probe", "probe", "PROBE", "rob", "1"])
def test_a_tool_is_known_by_any_part_of_its_name_that_no_other_has_and_what_was_used_is_told(tmp_path, name):
    poses = read(tmp_path, MOTIVE, ImportOptions(tool=name))
    assert poses.matrices[:, 0, 3].tolist() == [0, 1, 2, 3]
    assert "tool: USProbe, of USProbe, PatientRef (columns side by side)" in poses.understood
    assert "used: Frame, Time (Seconds), Rigid Body USProbe Rotation, Rigid Body USProbe Position" in poses.understood
    others = "Rigid Body Marker USProbe:Marker 001 Position, Rigid Body PatientRef Rotation, Rigid Body PatientRef Position"
    assert f"not used: {others}" in poses.understood


@pytest.mark.parametrize("name", ["re", "xyz", "Rigid Body", "r"])
def test_a_part_that_several_tools_have_or_none_is_asked_about(tmp_path, name):
    with pytest.raises(SettingsError, match=f"side by side: USProbe, PatientRef. There is none called '{name}'"):
        read(tmp_path, MOTIVE, ImportOptions(tool=name))


STILL = rigid((0, 0, 0), (1, 2, 3))
NAMED_COLUMNS = {
    "Fanuc": ("X,Y,Z,W,P,R\n1,2,3,0,0,90\n", None, rigid((0, 0, 90), (1, 2, 3))),
    "by heading": ("u,v,w,p,q,r,s\n1,2,3,0,0,0,1\n", "x=u y=v z=w qx=p qy=q qz=r qw=s", STILL),
    "a column twice": ("9,1,0,2,3,4\n9,1,0,5,6,7\n", "rz=3 x=4 y=5 z=6 rx=3 ry=3", None),
    "x twice": ("1,2,3,4,5,6,7,8\n", "x y z qx qy qz qw x", None),
}


@pytest.mark.parametrize(("text", "columns", "matrix"), NAMED_COLUMNS.values(), ids=NAMED_COLUMNS)
def test_makers_and_named_columns(tmp_path, text, columns, matrix):
    form = ImportOptions(columns=columns) if columns else ImportOptions()
    if matrix is None:
        with pytest.raises(SettingsError, match="First rows"):
            read(tmp_path, text, form)
        return
    found = read(tmp_path, text, form)
    scale = {"mm": 1.0, "m": 1000.0}[found.length_unit]
    np.testing.assert_allclose(found.matrices[0, :3, 3] * scale, matrix[:3, 3])
    np.testing.assert_allclose(found.matrices[0, :3, :3], matrix[:3, :3], atol=1e-12)


def test_the_columns_that_are_told_can_be_given_and_saved(tmp_path):
    text = "sec,nanosec,frame_id,x,y,z,qx,qy,qz,qw\n" + "".join(f"{n},500000000,tracker,{n},2,3,0,0,0,1\n" for n in range(3))
    found = read(tmp_path, text)
    told = next(line for line in found.understood if line.startswith("columns: ")).removeprefix("columns: ")
    (tmp_path / "lab.json").write_text(json.dumps({"maker": "our lab", "columns": told, "units": "m"}))
    again = read(tmp_path, text.partition("\n")[2], ImportOptions(columns=str(tmp_path / "lab.json")))
    np.testing.assert_array_equal(again.matrices, found.matrices)
    np.testing.assert_array_equal(again.times, [0.5, 1.5, 2.5])
    assert again.length_unit == "m"
    assert "as our lab writes" in again.understood


@pytest.mark.parametrize(("encoding", "unit"), [("utf-16", "mm"), ("cp1252", "°"), ("utf-8-sig", "°")])
def test_a_table_is_read_in_any_encoding(tmp_path, encoding, unit):
    (tmp_path / "poses.csv").write_bytes(f'x [mm];y [mm];z [mm];"A [{unit}]";B [deg];C [deg]\r\n1,5;2;3;0;0;0\r\n'.encode(encoding))
    assert read_poses(tmp_path / "poses.csv").matrices[0, :3, 3].tolist() == [1.5, 2.0, 3.0]

"""Tables of poses as trackers, robots and programs write them, made up: the truth, the file, and what a user would answer when asked."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

NAMES = [
    "Probe", "Reference", "Stylus", "left", "right", "pos", "rot", "pose", "ref", "tip", "tool", "quat",
    "tool1", "tool2", "body_1", "body_2", "left/probe", "right/probe", "rx", "qx", "tx", "az", "m0", "q1",
    "mm", "us", *"0123", "10", "12", *"LRABCDEOPQSTUVWXYZMNK",
]  # fmt: skip
"""Of tools; many are words that mean something of a pose."""


def shown(name: str) -> str:
    """A name as it is asked for: its words."""
    return " ".join(re.findall("[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+", name))


@dataclass
class Made:
    """A table: the poses of the tool that is meant (n, 4, 4) in mm, NaN where it has none; times in s from the first; the file; answers."""

    poses: np.ndarray
    times: np.ndarray | None
    text: str
    name: str = "poses.csv"
    answers: dict[str, dict[str, Any]] = field(default_factory=dict)
    layout: str = ""


@dataclass
class Recording:
    """What a tracker saw: poses of several tools (tools, n, 4, 4) in mm, times, and which poses are good."""

    poses: np.ndarray
    times: np.ndarray
    good: np.ndarray
    names: list[str]
    random: np.random.Generator


def recording(random: np.random.Generator, tools: int, names: Sequence[str] = NAMES) -> Recording:
    """A scan of 24 to 40 poses of a hand-held probe and of others that hardly move, 20 to 60 times a second, with some lost."""
    count = int(random.integers(24, 40))
    times = np.cumsum(1.0 / random.uniform(20, 60) * random.uniform(0.9, 1.1, count))
    poses = np.tile(np.eye(4), (tools, count, 1, 1))
    good = np.ones((tools, count), bool)
    for tool in range(tools):
        start, turn = random.uniform(-300, 300, 3), random.uniform(-100, 100, 3)
        speed = random.uniform(20, 60) if tool == 0 else 0.5
        along = np.cumsum(np.append(0, np.diff(times)))[:, None] * speed * np.array([0.6, 0.64, 0.48]) + random.normal(0, 0.05, (count, 3))
        swing = np.outer(np.linspace(-1, 1, count), random.uniform(5, 25, 3) if tool == 0 else (0.2, 0.1, 0.3))
        poses[tool, :, :3, :3] = (Rotation.from_rotvec(turn, degrees=True) * Rotation.from_rotvec(swing, degrees=True)).as_matrix()
        poses[tool, :, :3, 3] = start + along
        good[tool] = random.uniform(size=count) > random.choice([0.0, 0.1])
        good[tool, :2] = True
    return Recording(poses, times, good, [str(name) for name in random.choice(names, tools, replace=False)], random)


def numbers(values) -> list[str]:
    return [repr(round(float(value), 9)) for value in np.ravel(values)]


def quaternion(pose, order="wxyz") -> list[str]:
    return numbers([dict(zip("xyzw", Rotation.from_matrix(pose[:3, :3]).as_quat()))[axis] for axis in order])


def side_by_side(
    r: Recording, front: Callable, seen: Callable, lost: Sequence[str], beside: Callable | None = None, by: str = ","
) -> list[str]:
    """Lines of a table: what stands in front of frame n, and of each tool what is seen of its pose, or that it is lost.

    `beside` says what stands before that, a list, and what behind.
    """
    lines = []
    for n, time in enumerate(r.times):
        cells = [*front(n, time)]
        for tool, good in enumerate(r.good[:, n]):
            before, *behind = beside(tool, n, time, good) if beside else ([],)
            cells += [*before, *(seen(r.poses[tool, n]) if good else lost), *behind]
        lines.append(by.join(map(str, cells)))
    return lines


def placed(pose) -> list[str]:
    """Quaternion and place, as NDI has them."""
    return [*quaternion(pose), *numbers(pose[:3, 3])]


def made(r: Recording, lines: Sequence[str], name="poses.csv", poses=None, times=True, **answers: Any) -> Made:
    """The table of the first tool, and what a user answers; `poses` where each is known."""
    truth = np.where(r.good[0][:, None, None], r.poses[0], np.nan) if poses is None else poses
    given = {key: value if isinstance(value, dict) else {key: value} for key, value in answers.items()}
    return Made(truth, r.times - r.times[0] if times else None, "\n".join(lines), name, given)


def ndi_side_by_side(r: Recording) -> Made:
    """NDI's sample of the Combined API: headings again and again, markers beside tools."""
    marker = r.random.uniform() < 0.5
    tool = ",ToolInfo,Frame#,PortHandle,Face#,timespec_s,timespec_ns,TransformStatus,Q0,Qx,Qy,Qz,Tx,Ty,Tz,Error,#Markers"
    head = "ToolCount" + (tool + ",Marker0.Status,Tx,Ty,Tz" * marker) * len(r.names)

    def beside(tool, n, time, good):
        seconds = 1_700_000_000 + time
        stamp = [int(seconds), round((seconds % 1) * 1e9), "Enabled" if good else "ToolMissing"]
        return ["", n, f"0{tool + 1:X}", 0, *stamp], "0.12", 1, *(["OK", 1, 2, 3] * marker)

    lines = side_by_side(r, lambda n, time: [len(r.names)], placed, [""] * 7, beside)
    return made(r, [head, *lines], tool="01")


def ndi_track(r: Recording) -> Made:
    """What NDI Track exports: each tool's columns below its port, name and serial number, markers behind."""
    ports = [f"Port 0x{tool + 1:02X}: {name} tool  s/n:3E4C88{tool:02X}" for tool, name in enumerate(r.names)]
    columns = "Frame,Time [sec],Face,State,Q0,Qx,Qy,Qz,Tx,Ty,Tz,Error,Markers" + ",State,Tx,Ty,Tz" * 3

    def beside(tool, n, time, good):
        state = "OK" if good else "Too Few Markers"
        behind = ["0.2372032", 3, *["OK", "-54.047", "-355.147", "-1630.068"] * 3]
        return [ports[tool], 650512279 + 3 * n, f"{1778067471 + time:.9f}", 1, state], *behind

    lines = side_by_side(r, lambda n, time: [len(r.names)], placed, ["-3.697314E28"] * 7, beside)
    return made(r, ["Tools" + "".join(f",{port},{columns}" for port in ports), *lines], tool=ports[0])


def ndi_in_rows(r: Recording) -> Made:
    """One row for each tool and moment."""
    rows = ["Tool ID,Timestamp,Frame #,Tx,Ty,Tz,q0,qx,qy,qz,Tracking Quality"]
    for n, time in enumerate(r.times):
        for tool in range(len(r.names)):
            pose = r.poses[tool, n]
            values = [*numbers(pose[:3, 3]), *quaternion(pose)] if r.good[tool, n] else ["0"] * 7
            rows.append(",".join([str(tool), f"{time:.6f}", str(n), *values, "0.2"]))
    return made(r, rows, tool="0")


def motive(r: Recording) -> Made:
    unit, factor = [("Meters", 1e-3), ("Millimeters", 1.0), ("Centimeters", 0.1)][r.random.integers(3)]
    count = len(r.names)
    head = [
        f"Format Version,1.23,Take Name,Take 1,Capture Frame Rate,40.0,Rotation Type,Quaternion,Length Units,{unit}",
        "",
        ",," + ",".join(["Rigid Body"] * 8 * count),
        ",," + ",".join(name for name in r.names for _ in range(8)),
        ",," + ",".join(f"{17 + tool}" for tool in range(count) for _ in range(8)),
        ",," + ",".join((["Rotation"] * 4 + ["Position"] * 3 + ["Mean Marker Error"]) * count),
        "Frame,Time (Seconds)," + ",".join(["X", "Y", "Z", "W", "X", "Y", "Z", ""] * count),
    ]

    def seen(pose):
        return [*quaternion(pose, "xyzw"), *numbers(factor * pose[:3, 3]), "0.0002"]

    lines = side_by_side(r, lambda n, time: [n, f"{time:.6f}"], seen, [""] * 8)
    return made(r, [*head, *lines], tool=r.names[0])


def vicon(r: Recording) -> Made:
    r = replace(r, times=np.arange(len(r.times)) / 50)
    count = len(r.names)
    names = "," + "".join(f",{name}:{name},,,,," for name in r.names)
    head = ["Segments", "50", names, "Frame,Sub Frame" + ",RX,RY,RZ,TX,TY,TZ" * count, "," + ",deg,deg,deg,mm,mm,mm" * count]

    def seen(pose):
        return numbers([*Rotation.from_matrix(pose[:3, :3]).as_rotvec(degrees=True), *pose[:3, 3]])

    lines = side_by_side(r, lambda n, time: [n + 1, 0], seen, [""] * 6)
    after = ["", "Trajectories", "50", "," + ",Probe:M1,,", "Frame,Sub Frame,X,Y,Z", ",,mm,mm,mm", "1,0,1,2,3"]
    after = after if r.random.uniform() < 0.5 else []
    return made(r, [*head, *lines, *after], tool=f"{r.names[0]}:{r.names[0]}", euler_order="vector")


def qualisys(r: Recording) -> Made:
    turn = [f"Rot[{k}]" for k in range(9)]
    headings = [word for name in r.names for word in (f"{name} X", "Y", "Z", "Roll", "Pitch", "Yaw", "Residual", *turn)]
    head = [f"NO_OF_FRAMES\t{len(r.times)}", f"NO_OF_BODIES\t{len(r.names)}", "FREQUENCY\t40", "DATA_INCLUDED\t6D"]
    head += ["\t".join(["BODY_NAMES", *r.names]), "\t".join(["Frame", "Time", *headings])]

    def seen(pose):
        angles = Rotation.from_matrix(pose[:3, :3]).as_euler("XYZ", degrees=True)
        return numbers([*pose[:3, 3], *angles, 0.1, *pose[:3, :3].T.ravel()])

    lines = side_by_side(r, lambda n, time: [n + 1, f"{time:.6f}"], seen, [""] * 16, by="\t")
    columns = ("frame", "time", *"xyz", *"----", *(f"r{k}" for k in range(9)), *["-"] * 16 * (len(r.names) - 1))
    return made(r, [*head, *lines], "poses.tsv", tool=r.names[0], column_major=True, columns=" ".join(columns))


def robot(r: Recording, kuka: bool | None = None) -> Made:
    """Universal Robots: meters and rotation vectors under rx ry rz; KUKA: A B C; either with units in the headings or not."""
    said = kuka is None and r.random.uniform() < 0.5
    kuka = r.random.uniform() < 0.5 if kuka is None else kuka
    poses = r.poses[0]
    turned = Rotation.from_matrix(poses[:, :3, :3])
    if kuka:
        head = "Time [s];X [mm];Y [mm];Z [mm];A [deg];B [deg];C [deg]" if said else "time;X;Y;Z;A;B;C"
        turns, factor = turned.as_euler("ZYX", degrees=True), 1.0
    else:
        head = "time_s;x_m;y_m;z_m;rx_rad;ry_rad;rz_rad" if said else "time;x;y;z;rx;ry;rz"
        turns, factor = turned.as_rotvec(), 1e-3
    rows = [";".join(numbers([t, *(factor * pose[:3, 3]), *turn])) for t, pose, turn in zip(r.times, poses, turns)]
    return made(r, [head, *rows], poses=poses, euler_order="vector", angle_unit="rad", units="m")


def polhemus(r: Recording) -> Made:
    turns = Rotation.from_matrix(r.poses[0][:, :3, :3]).as_euler("ZYX", degrees=True)
    rows = [" ".join(numbers([t, *(0.1 * pose[:3, 3]), *turn])) for t, pose, turn in zip(r.times, r.poses[0], turns)]
    return made(r, ["# time x_cm y_cm z_cm azimuth elevation roll", *rows], "poses.txt", r.poses[0])


def ros(r: Recording) -> Made:
    start = 1_700_000_000_123_456_789
    stamps = [start + round(t * 1e9) for t in r.times - r.times[0]]
    if r.random.uniform() < 0.5:
        axes = [*(f"field.pose.position.{a}" for a in "xyz"), *(f"field.pose.orientation.{a}" for a in "xyzw")]
        head = ",".join(["%time,field.header.seq,field.header.stamp,field.header.frame_id", *axes])
        front = [f"{stamp + 900_000},{n},{stamp},tracker" for n, stamp in enumerate(stamps)]
    else:
        head = "sec,nanosec,frame_id,x,y,z,qx,qy,qz,qw"
        front = [f"{stamp // 10**9},{stamp % 10**9},tracker" for stamp in stamps]
    rows = [",".join([f, *numbers(1e-3 * pose[:3, 3]), *quaternion(pose, "xyzw")]) for f, pose in zip(front, r.poses[0])]
    return made(r, [head, *rows], poses=r.poses[0], units="m", tool={"units": "m"})


WAYS = [f"{first}{separator}{then}" for separator in ("_", ".", ":", "/", " ", "") for first, then in (("{0}", "{1}"), ("{1}", "{0}"))]
WAYS += ["arm_{0}_{1}", "{0}.arm.{1}", "{1}_{0}_raw"]
"""How a tool's name (0) and what a column holds (1) are put together."""

PLACES = (("tx", "ty", "tz"), ("x", "y", "z"), ("pos_x", "pos_y", "pos_z"))
TURNS: dict[tuple[str, ...], Callable[[np.ndarray], list[str]]] = {
    ("qw", "qx", "qy", "qz"): quaternion,
    ("q1", "q2", "q3", "q4"): quaternion,
    ("rx", "ry", "rz"): lambda pose: numbers(Rotation.from_matrix(pose[:3, :3]).as_euler("xyz", degrees=True)),
    ("A", "B", "C"): lambda pose: numbers(Rotation.from_matrix(pose[:3, :3]).as_euler("ZYX", degrees=True)),
    ("rotvec_x", "rotvec_y", "rotvec_z"): lambda pose: numbers(Rotation.from_matrix(pose[:3, :3]).as_rotvec()),
    tuple(f"r{i}{j}" for i in range(3) for j in range(3)): lambda pose: numbers(pose[:3, :3]),
}


def plain(r: Recording) -> Made:
    """What people write themselves: any name of a tool before or behind, any unit of time, statuses, separators, decimal commas."""
    random, tools = r.random, range(len(r.names))
    labels = [*r.names]
    if random.uniform() < (0.5 if len(labels) == 1 else 0.1):
        labels[0] = ""
    way = WAYS[random.integers(len(WAYS))]
    separator = [",", ";", "\t"][random.integers(3)]
    unit, scale = [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)][random.integers(4)]
    said = random.uniform() < 0.5
    start = [0.0, 1_700_000_000.0][random.integers(2)] if unit != "ns" else 0.0
    words = [("OK", "MISSING"), ("True", "False"), ("1", "0"), ("Valid", "Invalid"), ("tracking", "lost"), ("A", "B")][random.integers(6)]
    kinds = [list(TURNS)[kind] for kind in random.integers(len(TURNS), size=len(labels))]
    if random.uniform() < 0.7:  # most write all tools alike
        kinds = kinds[:1] * len(labels)
    places = PLACES[random.integers(len(PLACES))]
    order = random.permutation(len(labels)).tolist()
    fields = [(tool, name) for tool in order for name in (*places, *kinds[tool], "status")]
    if random.uniform() < 0.2 and len(set(kinds)) == 1:  # x of each tool, then y of each
        fields = [(tool, name) for name in (*places, *kinds[0], "status") for tool in order]
    head = [f"time_{unit}" if said else "timestamp", *(way.format(labels[t], name) if labels[t] else name for t, name in fields)]
    rows = []
    for n, time in enumerate(r.times):
        cells = [f"{(start + time) * scale:.6f}" if unit in ("s", "ms") else str(round((start + time) * scale))]
        values: dict[tuple[int, str], str] = {}
        for tool in tools:
            names, pose = (*places, *kinds[tool]), r.poses[tool, n]
            seen = [*numbers(pose[:3, 3]), *TURNS[kinds[tool]](pose)] if r.good[tool, n] else ["0"] * len(names)
            values |= {(tool, name): value for name, value in zip(names, seen)}
            values[tool, "status"] = words[0] if r.good[tool, n] else words[1]
        rows.append([*cells, *(values[field] for field in fields)])
    if separator == ";" and random.uniform() < 0.5:
        rows = [[cell.replace(".", ",") for cell in row] for row in rows]
    columns = [head[0], *(name if tool == 0 else "-" for tool, name in fields)]
    place = str(order.index(0) + 1)
    unnamed = f"unnamed {place}" if any(place == shown(way.format(label, "")) for label in labels) else place
    given: dict[str, Any] = {
        "time_unit": unit,
        "quaternion_order": "wxyz",
        "euler_order": "xyz",
        "angle_unit": "deg",
        "status_ok": (words[0],),
    }
    given["tool"] = shown(way.format(labels[0], "")) if labels[0] else unnamed
    given["columns"] = {"columns": " ".join(columns), "tool": None}
    return made(r, [separator.join(row) for row in [head, *rows]], **given)


def bare(r: Recording, kind: int | None = None) -> Made:
    """Matrices without headings, in rows of 12 or 16 or in lines of four, row by row or column by column; JSON."""
    poses = r.poses[0]
    kind = int(r.random.integers(4)) if kind is None else kind
    height = 3 + int(r.random.integers(2))
    if kind == 4:
        rows = [",".join([f"{t:.6f}", *numbers(pose[:3, 3]), *quaternion(pose, "xyzw")]) for t, pose in zip(r.times, poses)]
        return made(r, ["time,x,y,z,qx,qy,qz,qw", *rows], poses=poses)
    if kind == 1:
        return made(r, [",".join(numbers(pose.T)) for pose in poses], poses=poses, times=False, column_major=True)
    if kind == 3:
        items = []
        for t, pose in zip(r.times, poses):
            turn = dict(zip("xyzw", map(float, quaternion(pose, "xyzw"))))
            items.append({"timestamp": float(t), "pose": {"position": dict(zip("xyz", pose[:3, 3].tolist())), "orientation": turn}})
        return made(r, [json.dumps({"poses": items})], "poses.json", poses)
    if kind == 0:
        lines = [" ".join(numbers(pose[:height])) for pose in poses]
    else:
        lines = [" ".join(numbers(line)) for pose in poses for line in pose[:height]]
    return made(r, lines, "poses.txt", poses, times=False)


LAYOUTS: list[Callable[[Recording], Made]] = [
    *(ndi_side_by_side, ndi_track, ndi_in_rows, motive, vicon, qualisys, robot, polhemus, ros),
    *[plain] * 5,
    bare,
]


def made_table(seed: int) -> Made:
    """One of them."""
    random = np.random.default_rng(seed)
    layout = LAYOUTS[seed % len(LAYOUTS)]
    return replace(layout(recording(random, int(random.integers(1, 4)))), layout=layout.__name__)

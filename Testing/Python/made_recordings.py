"""Recordings as other programs write them, small: CustusX, bags of ROS, bundles of Slicer."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation
from sequence_samples import single_frame
from sweeps import rigid
from variant_files import slicer_images, slicer_transforms

COUNT, ROWS, COLUMNS = 6, 12, 17
IMAGES = np.random.default_rng(0).integers(0, 256, (COUNT, ROWS, COLUMNS), np.uint8)
SPACING = (0.2, 0.3)
TO_MM = np.diag([0.2, 0.3, 0.25, 1.0])


def pose(number: float) -> np.ndarray:
    """Oblique, and smooth in time."""
    return rigid((10.0 + 2.0 * number, 25.0, -40.0 + number), (3.0 * number, 40.0, -7.0))


POSES = np.array([pose(number) for number in range(COUNT)])

# ---- CustusX


def three_rows(matrices) -> str:
    return "".join(" ".join(f"{value:.12g}" for value in row) + "\n" for matrix in matrices for row in matrix[:3])


def acquisition(folder: Path, *, frame_poses=True, tool_times=None, probe=None) -> Path:
    """What CustusX writes: see its US Acquisition Data File Format."""
    folder.mkdir(exist_ok=True)
    base = folder / "US-Acq_1_20260101T120000_Probe"
    for number, image in enumerate(IMAGES):
        single_frame(Path(f"{base}_{number}.mhd"), image)
    Path(f"{base}.fts").write_text("".join(f"{1700000000000 + 50 * number}\n" for number in range(COUNT)))
    if frame_poses:
        Path(f"{base}.fp").write_text(three_rows(POSES))
    times = np.arange(-1, 2 * COUNT) / 2 if tool_times is None else np.array(tool_times)
    Path(f"{base}.tts").write_text("".join(f"{1700000000000 + 50 * time:.6f}\n" for time in times))
    Path(f"{base}.tp").write_text(three_rows([pose(time) for time in times]))
    if probe is not None:
        Path(f"{base}.probedata.xml").write_text(f"<!DOCTYPE navnet>\n<navnet><configuration>{probe}</configuration></navnet>\n")
    return folder


PROBE = '<image origin_p="8 -3 0" spacing="0.2 0.3 1" width="17" height="12"/>'

# ---- bags of ROS

START = 1_700_000_000
FIRST, SECOND = "ros1", "ros2"


def ros_types(version):
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if version == FIRST else Stores.ROS2_HUMBLE)
    if version == FIRST:
        store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
    return store


class Bag:
    """A bag, and what is written into it."""

    def __init__(self, path: Path, storage: str):
        self.version = FIRST if storage == "bag" else SECOND
        self.store = ros_types(self.version)
        if storage == "bag":
            from rosbags.rosbag1 import Writer

            self.path = path.with_suffix(".bag")
            self.writer = Writer(self.path)
        else:
            from rosbags.rosbag2 import StoragePlugin, Writer

            self.path = path
            plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
            self.writer = Writer(path, version=9, storage_plugin=plugin)
        self.connections: dict[str, Any] = {}

    def make(self, name, *values, **fields):
        kind = self.store.types[name]
        return kind(*values, **fields)

    def header(self, seconds, frame):
        whole, rest = divmod(round(seconds * 1e9), 10**9)
        stamp = self.make("builtin_interfaces/msg/Time", sec=START + whole, nanosec=rest)
        extra = {"seq": 0} if self.version == FIRST else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **extra)

    def write(self, topic, kind, seconds, message):
        if topic not in self.connections:
            self.connections[topic] = self.writer.add_connection(topic, kind, typestore=self.store)
        serialize = self.store.serialize_ros1 if self.version == FIRST else self.store.serialize_cdr
        # Written a while after it was measured, as networks do
        self.writer.write(self.connections[topic], round((START + seconds + 0.7) * 1e9), bytes(serialize(message, kind)))

    def moved(self, matrix, kind="Vector3"):
        x, y, z, w = Rotation.from_matrix(matrix[:3, :3]).as_quat()
        place = self.make(f"geometry_msgs/msg/{kind}", *(matrix[:3, 3] / 1000))
        return place, self.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)

    def image(self, number, topic="/us/image", encoding="mono8", pixels=None):
        pixels = IMAGES[number] if pixels is None else pixels
        message = self.make(
            "sensor_msgs/msg/Image",
            header=self.header(0.05 * number, "us_probe"),
            height=pixels.shape[0],
            width=pixels.shape[1],
            encoding=encoding,
            is_bigendian=0,
            step=pixels[0].nbytes,
            data=np.frombuffer(pixels.tobytes(), np.uint8),
        )
        self.write(topic, "sensor_msgs/msg/Image", 0.05 * number, message)

    def tree(self, seconds, child, parent, matrix, topic="/tf"):
        translation, rotation = self.moved(matrix)
        transform = self.make("geometry_msgs/msg/Transform", translation=translation, rotation=rotation)
        stamped = self.make(
            "geometry_msgs/msg/TransformStamped", header=self.header(seconds, parent), child_frame_id=child, transform=transform
        )
        self.write(topic, "tf2_msgs/msg/TFMessage", seconds, self.make("tf2_msgs/msg/TFMessage", transforms=[stamped]))

    def pose(self, seconds, frame, matrix, kind="geometry_msgs/msg/PoseStamped"):
        """A message that holds a pose, some among other things."""
        position, orientation = self.moved(matrix, "Point")
        at, header = self.make("geometry_msgs/msg/Pose", position=position, orientation=orientation), self.header(seconds, frame)
        fields: dict[str, Any] = {"header": header}
        if kind.endswith("Path"):
            fields["poses"] = [self.make("geometry_msgs/msg/PoseStamped", header=header, pose=at)]
        elif kind.endswith("PoseStamped"):
            fields["pose"] = at
        else:
            fields["pose"] = self.make("geometry_msgs/msg/PoseWithCovariance", pose=at, covariance=np.zeros(36))
        if kind.endswith("Odometry"):
            still = self.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
            twist = self.make("geometry_msgs/msg/Twist", linear=still, angular=still)
            fields["twist"] = self.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=np.zeros(36))
            fields["child_frame_id"] = "needle"
        self.write("/probe/pose", kind, seconds, self.make(kind, **fields))


CALIBRATION = rigid((5.0, 60.0, -4.0), (1.0, -2.0, 3.0)) @ TO_MM
TO_BASE = rigid((90.0, 0.0, 20.0), (100.0, 20.0, 30.0))

# ---- Slicer

SCENE = """<MRML>
<Sequence id="s1" name="ProbeToReference" references="storage:m1;"/><Sequence id="s2" name="Image" references="storage:v1;"/>
<SequenceBrowser id="b" references="dataNodeRef0:i;dataNodeRef1:p;sequenceNodeRef0:s2;sequenceNodeRef1:s1;"/>
<Volume id="i" name="Image" references="transform:c;"/><LinearTransform id="p" name="ProbeToReference" references="transform:w;"/>
<LinearTransform id="c" references="transform:p;" matrixTransformToParent="0.1 0 0 0 0 0.1 0 0 0 0 0.1 0 0 0 0 1"/>
<LinearTransform id="w" matrixTransformToParent="0 1 0 5 -1 0 0 0 0 0 1 0 0 0 0 1"/>
<VolumeSequenceStorage id="v1" fileName="Data/I.seq.nrrd"/><LinearTransformSequenceStorage id="m1" fileName="Data/P.seq.mha"/>
</MRML>"""


def bundle(path: Path, scene: bytes = SCENE.encode()) -> Path:
    """A scene with a sequence of images below moving transforms, and its files."""
    images, poses = path.with_name("I.seq.nrrd"), path.with_name("P.seq.mha")
    slicer_images(images)
    slicer_transforms(poses, "ProbeToReference")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("a/a.mrml", scene)
        for file in (images, poses):
            archive.write(file, f"a/Data/{file.name}")
            file.unlink()
    return path

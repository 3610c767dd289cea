"""Good recordings as other programs write them, small, made by code."""

from __future__ import annotations

import io
import tempfile
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from . import seeds

CUT = b"\n-----\n"
"""Between the files of an acquisition of CustusX."""
ACQUISITION = "US-Acq_1"
_POSES = "1 0 0 0\n0 0 -1 {0}\n0 1 0 5\n"
_SCENE = """<MRML>
<Sequence id="s1" name="ProbeToReference" references="storage:m1;"/><Sequence id="s2" name="Image" references="storage:v1;"/>
<SequenceBrowser id="b" references="dataNodeRef0:i;dataNodeRef1:p;sequenceNodeRef0:s2;sequenceNodeRef1:s1;"/>
<Volume id="i" name="Image" references="transform:c;"/><LinearTransform id="p" name="ProbeToReference" references="transform:w;"/>
<LinearTransform id="c" references="transform:p;" matrixTransformToParent="0.1 0 0 0 0 0.1 0 0 0 0 0.1 0 0 0 0 1"/>
<LinearTransform id="w" matrixTransformToParent="0 1 0 5 -1 0 0 0 0 0 1 0 0 0 0 1"/>
<VolumeSequenceStorage id="v1" fileName="Data/I.seq.nrrd"/><LinearTransformSequenceStorage id="m1" fileName="Data/P.seq.mha"/>
</MRML>"""


def archives() -> list[bytes]:
    """Arrays as they are, and compressed."""
    arrays: dict[str, Any] = {
        "images": np.arange(72, dtype=np.uint8).reshape(3, 4, 6),
        "image_to_reference": np.tile(np.diag([0.1, 0.1, 0.1, 1]), (3, 1, 1)),
    }
    made = []
    more: dict[str, Any] = {"timestamps": np.arange(3.0)}
    for save, own in ((np.savez, more), (np.savez_compressed, {})):
        file = io.BytesIO()
        save(file, **arrays, **own)
        made.append(file.getvalue())
    return made


def scenes() -> list[bytes]:
    """Slicer's, with the transforms above the images, and with none."""
    return [_SCENE.encode(), _SCENE.replace("transform:c;", "").encode()]


def bundled(scene: bytes) -> bytes:
    """A bundle of this scene and its files."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("a/a.mrml", scene)
        archive.writestr("a/Data/I.seq.nrrd", seeds.nrrd_sequences()[2])
        archive.writestr("a/Data/P.seq.mha", seeds.metaimage(b"", DimSize="0 0 3"))
    return file.getvalue()


def acquisitions() -> list[bytes]:
    """The files of an acquisition of CustusX: times, poses of frames, poses of the tool and their times, the probe."""
    times, poses = "0\n50\n100\n", "".join(_POSES.format(number) for number in range(3))
    probe = '<navnet><configuration><image origin_p="3 0 0" spacing="0.2 0.2 1"/></configuration></navnet>'
    return [CUT.join(map(str.encode, parts)) for parts in ((times, poses, poses, times, probe), (times, "", poses, times, probe))]


def spread(path: Path) -> None:
    """Write the parts of an acquisition beside `path`, which keeps the first; one that is empty is left out."""
    parts = path.read_bytes().split(CUT)
    path.write_bytes(parts[0])
    for suffix, part in zip((".fp", ".tp", ".tts", ".probedata.xml"), parts[1:]):
        file = path.with_name(f"{path.stem}{suffix}")
        file.unlink(missing_ok=True)
        if part:
            file.write_bytes(part)
    for number in range(3):
        path.with_name(f"{path.stem}_{number}.mhd").write_bytes(
            b"ObjectType = Image\nNDims = 3\nElementSpacing = 0.2 0.2 1\nDimSize = 6 4 1\n"
            b"ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + bytes(range(24))
        )


def bags(suffix: str) -> list[bytes]:
    """Two images and two poses."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if suffix == ".bag" else Stores.ROS2_HUMBLE)
    more = {"seq": 0} if suffix == ".bag" else {}
    kinds = store.types
    with tempfile.TemporaryDirectory() as folder:
        if suffix == ".bag":
            from rosbags.rosbag1 import Writer

            writer, serialize = Writer(Path(folder, "a.bag")), store.serialize_ros1
        else:
            from rosbags.rosbag2 import StoragePlugin, Writer

            plugin = StoragePlugin.MCAP if suffix == ".mcap" else StoragePlugin.SQLITE3
            writer, serialize = Writer(Path(folder, "a"), version=9, storage_plugin=plugin), store.serialize_cdr
        with writer:
            image, pose = "sensor_msgs/msg/Image", "geometry_msgs/msg/PoseStamped"
            topics = {kind: writer.add_connection(f"/{kind[-5:].lower()}", kind, typestore=store) for kind in (image, pose)}
            for number in range(2):
                stamp = kinds["builtin_interfaces/msg/Time"](sec=1 + number, nanosec=0)
                header = kinds["std_msgs/msg/Header"](stamp=stamp, frame_id="us", **more)
                data = np.arange(24, dtype=np.uint8)
                message = kinds[image](header=header, height=4, width=6, encoding="mono8", is_bigendian=0, step=6, data=data)
                writer.write(topics[image], 10**9 * (1 + number), bytes(serialize(message, image)))
                place = kinds["geometry_msgs/msg/Point"](x=0.1 * number, y=0.0, z=0.2)
                turned = kinds["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)
                message = kinds[pose](header=header, pose=kinds["geometry_msgs/msg/Pose"](position=place, orientation=turned))
                writer.write(topics[pose], 10**9 * (1 + number), bytes(serialize(message, pose)))
        return [next(Path(folder).rglob(f"*{suffix}")).read_bytes()]


def tiffs() -> list[bytes]:
    """Pages, tiles, and a stack of ImageJ in one directory."""
    import tifffile

    frames = np.arange(72, dtype=np.uint16).reshape(3, 4, 6)
    made = []
    for options in (
        {"photometric": "miniswhite"},
        {"tile": (16, 16), "compression": "zlib"},
        {"imagej": True, "metadata": {"axes": "TYX"}},
    ):
        file = io.BytesIO()
        tifffile.imwrite(file, frames, **{"photometric": "minisblack", **options})
        made.append(file.getvalue())
    return made

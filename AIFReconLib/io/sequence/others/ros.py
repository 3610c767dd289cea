"""Bags of ROS 1 (.bag) and 2 (a folder, .mcap, .db3): images with the poses and the tree of transforms that were recorded beside them.

The package rosbags reads them. Lengths are meters there (REP 103). A transform of tf takes points of its child frame to its header's frame,
and so does a pose, whose own frame is called as its topic. Frames of ROS are words of small letters: ``us_probe`` becomes ``UsProbe``.
"""

from __future__ import annotations

import io
import re
import weakref
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ....arrays import Numbers
from ....errors import SequenceFormatError
from ....geometry.transform_graph import MISSING, TransformName, TransformSample
from ....message import listed
from ....sweep.frames import FrameRecord
from ....sweep.pose_tracks import PoseTrack
from ...disk.regular_files import files_in, require_regular_file
from ..decoded_images import DecodedImages, Forward, decoding, library
from ..kinds import Recorded, RecordingKind

IMAGE, COMPRESSED_IMAGE = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
POSE, TRANSFORM = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TransformStamped"
POSES = (POSE, "geometry_msgs/msg/PoseWithCovarianceStamped", "nav_msgs/msg/Odometry")
TREES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
_READ = (IMAGE, COMPRESSED_IMAGE, *POSES, TRANSFORM, *TREES)
STILL = "tf_static"
MOST_TOLD = 8
"""Topics that are not read, of which a note tells."""

_MAY_PLACE = re.compile("Pose|Transform|Odometry|Path|Joint|Twist|tf")
"""Types of messages that may say where something is."""

_PURPOSE = "Bags of ROS"
MILLIMETERS = 1000.0
QUATERNION_TOLERANCE = 0.02
_GRAY = {"mono8": "u1", "8UC1": "u1", "mono16": "u2", "16UC1": "u2", "16SC1": "i2", "32SC1": "i4", "32FC1": "f4", "64FC1": "f8"}
"""Types of a pixel's number."""

_COLORS = {"rgb8": "RGB", "bgr8": "BGR", "8UC3": "BGR", "rgba8": "RGBA", "bgra8": "BGRA", "8UC4": "BGRA"}
"""The channels of a pixel, in order; 8UC3 is OpenCV's, which is blue first."""


@dataclass
class _Found:
    """What the messages of a bag say, each with its time in s."""

    times: list[float] = field(default_factory=list)  #: Of the images
    frame: str = ""
    tracks: dict[TransformName, list[tuple[float, TransformSample]]] = field(default_factory=dict)
    still: dict[TransformName, TransformSample] = field(default_factory=dict)

    @property
    def has_poses(self) -> bool:
        """Whether any can be used."""
        return bool(self.tracks or self.still)


def _read(path: Path, orientation: str | None) -> Recorded:
    if orientation is not None and not orientation.startswith("MF"):
        raise SequenceFormatError(f"{path}: images of a bag are taken as MF, the marked side on the right, the transducer at the top.")
    if not path.is_dir():
        require_regular_file(path, SequenceFormatError)
    types, highlevel = (library(f"rosbags.{name}", _PURPOSE) for name in ("typesys", "highlevel"))
    with decoding(f"{path}: it cannot be read as a bag of ROS", "Record or copy it again."), ExitStack() as stack:
        store = types.get_typestore(types.Stores.ROS2_HUMBLE)
        reader = stack.enter_context(highlevel.AnyReader([path], default_typestore=store))
        topics = [connection for connection in reader.connections if connection.msgtype in (IMAGE, COMPRESSED_IMAGE)]
        names = list(dict.fromkeys(connection.topic for connection in topics if connection.msgcount))
        if len(names) != 1:
            leave_out = f"Leave out others: rosbags-convert --src {path.name} --dst one --exclude-topic {' '.join(names[1:])}"
            raise SequenceFormatError(f"{path}: it must hold the images of one topic; got {listed(names) or 'none'}. {leave_out}.")
        found = _found(reader)
        stored = Forward(lambda: reader.messages(connections=topics))
        stack.callback(stored.close)

        def decode(number: int) -> Numbers:
            with decoding(f"{path}, image {number}: it cannot be decoded", "Record or copy the bag again."):
                connection, _, raw = stored[number]
                return _image_of(reader.deserialize(raw, connection.msgtype))

        images = DecodedImages(len(found.times), decode, lambda n: f"{path}, image {n}")
        weakref.finalize(images, stack.pop_all().close)
    tracks = {name: PoseTrack(samples).samples(found.times) for name, samples in found.tracks.items()}
    records = [FrameRecord(time, transforms={name: of[n] for name, of in tracks.items()}) for n, time in enumerate(found.times)]
    return Recorded(images, records, transforms=found.still, notes=_notes(found, reader.connections))


def _found(reader: Any) -> _Found:
    """What all messages say, in one pass."""
    found = _Found()
    for connection, written, raw in reader.messages(connections=[each for each in reader.connections if each.msgtype in _READ]):
        message = reader.deserialize(raw, connection.msgtype)
        if connection.msgtype in (IMAGE, COMPRESSED_IMAGE):
            found.times.append(_time(message.header, written))
            found.frame = found.frame or message.header.frame_id
        elif connection.msgtype in POSES:
            of_topic = re.sub("_?(pose|odom(etry)?|stamped|with_?covariance)", "", connection.topic.rstrip("/").lower())
            name = _name(getattr(message, "child_frame_id", "") or of_topic, message.header.frame_id)
            pose = message.pose if connection.msgtype == POSE else message.pose.pose
            found.tracks.setdefault(name, []).append((_time(message.header, written), _sample_of(pose.position, pose.orientation)))
        else:
            for item in [message] if connection.msgtype == TRANSFORM else message.transforms:
                name = _name(item.child_frame_id, item.header.frame_id)
                sample = _sample_of(item.transform.translation, item.transform.rotation)
                if connection.topic.strip("/").endswith(STILL):
                    found.still[name] = sample
                else:
                    found.tracks.setdefault(name, []).append((_time(item.header, written), sample))
    return found


def _notes(found: _Found, connections: list[Any]) -> tuple[str, ...]:
    frame = _frame_word(found.frame)
    notes = [f"Images of this bag are of frame {frame}: a calibration ImageTo{frame} places them."] if frame else []
    others = [each for each in connections if each.msgtype not in _READ and (_MAY_PLACE.search(each.msgtype) or not found.has_poses)]
    if others:
        told = [f"{each.msgcount} of {each.msgtype} on {each.topic}" for each in others[:MOST_TOLD]] + ["..."] * (len(others) > MOST_TOLD)
        kinds = listed(kind.rsplit("/", 1)[-1] for kind in (*POSES, TRANSFORM))
        notes.append(f"Messages of this bag that are not read: {listed(told)}. Poses are read as {kinds} and tf.")
    if not found.has_poses:
        notes.append("No pose of this bag could be used, so nothing says where the images are.")
    return tuple(notes)


def _time(header: Any, written: int) -> float:
    """When something was measured, in s; when it was written, where that was not said."""
    nanoseconds = int(header.stamp.sec) * 10**9 + int(header.stamp.nanosec)
    return (nanoseconds or written) / 1e9


def _name(child: str, parent: str) -> TransformName:
    return TransformName(_frame_word(child) or "Child", _frame_word(parent) or "World")


def _frame_word(frame: str) -> str:
    """``/us_probe`` as `UsProbe`."""
    return "".join(word[:1].upper() + word[1:] for word in re.findall("[A-Za-z0-9]+", frame))


def _image_of(message: Any) -> Numbers:
    """Pixels of a sensor_msgs/Image or CompressedImage, (rows, columns), or with three colors."""
    if not hasattr(message, "encoding"):
        picture = library("PIL.Image", "Compressed images of ROS").open(io.BytesIO(bytes(message.data)), formats=("PNG", "JPEG"))
        return np.asarray(picture if picture.mode in ("L", "I;16", "I", "RGB") else picture.convert("RGB"))
    channels = _COLORS.get(message.encoding, "")
    if not channels and message.encoding not in _GRAY:
        raise SequenceFormatError(f"images of the encoding {message.encoding!r} are not read. Record them as mono8, mono16 or rgb8.")
    dtype = np.dtype(_GRAY.get(message.encoding, "u1")).newbyteorder(">" if message.is_bigendian else "<")
    data = np.frombuffer(message.data, np.uint8, message.height * message.step).reshape(message.height, message.step)
    pixels = np.ascontiguousarray(data[:, : message.width * max(len(channels), 1) * dtype.itemsize]).view(dtype)
    return pixels.reshape(message.height, message.width, -1)[..., list(map(channels.index, "RGB"))] if channels else pixels


def _sample_of(translation: Any, rotation: Any) -> TransformSample:
    """Translation (m) and quaternion as a transform in mm; MISSING where they are no pose."""
    quaternion = np.array([rotation.x, rotation.y, rotation.z, rotation.w], dtype=np.float64)
    moved = np.array([translation.x, translation.y, translation.z], dtype=np.float64)
    with np.errstate(over="ignore", invalid="ignore"):
        length = float(np.linalg.norm(quaternion))
    if not np.isfinite([*quaternion, *moved]).all() or not abs(length - 1.0) <= QUATERNION_TOLERANCE:
        return MISSING
    # By hand: what Slicer's own process imports loads no SciPy
    (*vector, w), matrix = quaternion / length, np.eye(4)
    across = np.cross(np.eye(3), vector)
    matrix[:3, :3] += 2 * (w * across + across @ across)
    matrix[:3, 3] = MILLIMETERS * moved
    return TransformSample(matrix)


def _is_folder(path: Path) -> bool:
    return (path / "metadata.yaml").is_file() and any(files_in(path, f"*{suffix}*") for suffix in (".mcap", ".db3"))


BAGS = RecordingKind("a bag of ROS", (".bag", ".mcap", ".db3"), _read, is_folder=_is_folder)

"""Bags of ROS 1 (.bag) and 2 (a folder, .mcap, .db3): images with the poses and the tree of transforms that were recorded beside them.

The package rosbags reads the containers; messages are taken by the definitions of ROS itself, not by those that a bag brings along.
Lengths are meters there (REP 103). A transform of tf takes points of its child frame to its header's frame, and so does a pose, whose own
frame is called as its topic. Frames of ROS are words of small letters: ``us_probe`` becomes ``UsProbe``.
"""

from __future__ import annotations

import re
import weakref
from collections.abc import Generator, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

from ....arrays import Matrix, Numbers
from ....errors import SequenceFormatError
from ....geometry.transform_graph import MISSING, TransformName, TransformSample
from ....message import listed
from ....sweep.frames import FrameRecord
from ....sweep.pose_tracks import PoseTrack
from ...disk.regular_files import files_in, require_regular_file
from ..decoded_images import DecodedImages, decoding, library
from ..file_images import MAXIMUM_FRAME_BYTES, MAXIMUM_FRAMES
from ..kinds import Recorded, RecordingKind
from .ros_messages import compressed_image, image_of, matrix_of

IMAGES = {"sensor_msgs/msg/Image": image_of, "sensor_msgs/msg/CompressedImage": compressed_image}
POSE, TRANSFORM = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TransformStamped"
POSE_WITH_COVARIANCE, ODOMETRY = "geometry_msgs/msg/PoseWithCovarianceStamped", "nav_msgs/msg/Odometry"
TREES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
POSES = (POSE, POSE_WITH_COVARIANCE, ODOMETRY)
STILL = "tf_static"
MOST_TOLD = 8
"""Topics that are not read, of which a note tells."""

_MAY_PLACE = re.compile("Pose|Transform|Odometry|Path|Joint|Twist|tf")
"""Types of messages that may say where something is."""

_PURPOSE = "Bags of ROS"


@dataclass
class _Found:
    """What the messages of a bag say, each with its time in s."""

    times: list[float] = field(default_factory=list)
    """Of the images."""
    frame: str = ""
    tracks: dict[TransformName, list[tuple[float, TransformSample]]] = field(default_factory=dict)
    still: dict[TransformName, TransformSample] = field(default_factory=dict)


class _Bag:
    """A bag, its messages in order, and its images one at a time; open as long as it is used."""

    def __init__(self, path: Path):
        first = path.suffix.lower() == ".bag"
        self.path = path
        types = library("rosbags.typesys", _PURPOSE)
        store = types.get_typestore(types.Stores.ROS1_NOETIC if first else types.Stores.ROS2_HUMBLE)
        if TREES[0] not in store.types:
            store.register(types.get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TREES[0]))
        self._decode = store.deserialize_ros1 if first else store.deserialize_cdr
        self._reader = library("rosbags.rosbag1" if first else "rosbags.rosbag2", _PURPOSE).Reader(path)
        self._reader.open()
        self._images: list[Generator[Any, None, None]] = []
        weakref.finalize(self, _close, self._reader, self._images)
        self.by_type: dict[str, list[Any]] = {}
        for connection in self._reader.connections:
            self.by_type.setdefault(connection.msgtype, []).append(connection)
        self._next = 0

    def messages(self, connections: list[Any]) -> Iterator[tuple[Any, int, Any]]:
        """Connection, when it was written (ns), and message, from the first on."""
        for connection, written, raw in self._reader.messages(connections=connections):
            yield connection, written, self._decode(raw, TREES[0] if connection.msgtype in TREES else connection.msgtype)

    def image(self, connections: list[Any], number: int) -> Any:
        """The message of one image. They are read on from the one before; going back starts over."""
        if number < self._next or not self._images:
            self._images[:], self._next = [self._reader.messages(connections=connections)], 0
        connection, _, raw = next(islice(self._images[0], number - self._next, None))
        self._next = number + 1
        return self._decode(raw, connection.msgtype)


def _close(reader: Any, under_way: list[Generator[Any, None, None]]) -> None:
    while under_way:
        under_way.pop().close()
    reader.close()


def _read(path: Path, orientation: str | None) -> Recorded:
    if orientation is not None and not orientation.startswith("MF"):
        raise SequenceFormatError(f"{path}: images of a bag are taken as MF, the marked side on the right, the transducer at the top.")
    if not path.is_dir():
        require_regular_file(path, SequenceFormatError)
    readable = f"{path}: it cannot be read as a bag of ROS"
    with decoding(readable, "Record or copy it again."):
        bag = _Bag(path)
        topics = [connection for kind in IMAGES for connection in bag.by_type.get(kind, ())]
        names = list(dict.fromkeys(connection.topic for connection in topics))
        if len(names) != 1:
            others = " ".join(names[1:])
            remedy = (
                f"Leave out the others: rosbags-convert --src {path.name} --dst one --exclude-topic {others}." if names else "Record them."
            )
            raise SequenceFormatError(f"{path}: it must hold the images of one topic; got {listed(names) or 'none'}. {remedy}")
        decode = IMAGES[topics[0].msgtype]
        found = _found(bag, topics)

        def image(number: int) -> Numbers:
            with decoding(f"{path}, image {number}: it cannot be decoded", "Record or copy the bag again."):
                pixels: Numbers = decode(bag.image(topics, number), MAXIMUM_FRAME_BYTES)
                return pixels

        images = DecodedImages(len(found.times), image, lambda n: f"{path}, image {n}")
    tracks = {name: PoseTrack(samples) for name, samples in found.tracks.items()}
    records = [FrameRecord(time, transforms=_at(tracks, time)) for time in found.times]
    return Recorded(images, records, transforms=found.still, notes=_notes(found, bag))


def _found(bag: _Bag, topics: list[Any]) -> _Found:
    """What all messages say, in one pass."""
    found = _Found()
    poses = [connection for kind in (*POSES, TRANSFORM, *TREES) for connection in bag.by_type.get(kind, ())]
    for connection, written, message in bag.messages([*topics, *poses]):
        if connection.msgtype in IMAGES:
            found.times.append(_time(message.header, written))
            found.frame = found.frame or message.header.frame_id
            if len(found.times) > MAXIMUM_FRAMES:
                raise SequenceFormatError(f"{bag.path}: it holds more than {MAXIMUM_FRAMES} images. Split the recording.")
        elif connection.msgtype in POSES:
            of_topic = re.sub("_?(pose|odom(etry)?|stamped|with_?covariance)", "", connection.topic.rstrip("/").lower())
            name = _name(getattr(message, "child_frame_id", "") or of_topic, message.header.frame_id)
            pose = message.pose if connection.msgtype == POSE else message.pose.pose
            _add(found.tracks, name, _time(message.header, written), matrix_of(pose.position, pose.orientation))
        else:
            for item in [message] if connection.msgtype == TRANSFORM else message.transforms:
                name = _name(item.child_frame_id, item.header.frame_id)
                matrix = matrix_of(item.transform.translation, item.transform.rotation)
                if connection.topic.strip("/").endswith(STILL):
                    found.still[name] = _sample(matrix)
                else:
                    _add(found.tracks, name, _time(item.header, written), matrix)
    if not found.times:
        raise SequenceFormatError(f"{bag.path}: topic {topics[0].topic} holds no image. Record it again.")
    return found


def _add(tracks: dict[TransformName, list[tuple[float, TransformSample]]], name: TransformName, time: float, matrix: Matrix | None) -> None:
    tracks.setdefault(name, []).append((time, _sample(matrix)))


def _sample(matrix: Matrix | None) -> TransformSample:
    return MISSING if matrix is None else TransformSample(matrix)


def _at(tracks: Mapping[TransformName, PoseTrack], time: float) -> dict[TransformName, TransformSample]:
    return {name: _sample(track.at(time)[0]) for name, track in tracks.items()}


def _notes(found: _Found, bag: _Bag) -> tuple[str, ...]:
    frame = frame_word(found.frame)
    notes = [f"Images of this bag are of frame {frame}: a calibration ImageTo{frame} places them."] if frame else []
    read = (*IMAGES, *POSES, TRANSFORM, *TREES)
    others = [each for kind, of_kind in bag.by_type.items() if kind not in read for each in of_kind]
    if found.tracks or found.still:
        others = [each for each in others if _MAY_PLACE.search(each.msgtype)]
    if others:
        told = [f"{each.msgcount} of {each.msgtype} on {each.topic}" for each in others[:MOST_TOLD]] + ["..."] * (len(others) > MOST_TOLD)
        kinds = listed(kind.rsplit("/", 1)[-1] for kind in (*POSES, TRANSFORM))
        notes.append(f"Messages of this bag that are not read: {listed(told)}. Poses are read as {kinds} and tf.")
    if not found.tracks and not found.still:
        notes.append("No pose of this bag could be used, so nothing says where the images are.")
    return tuple(notes)


def _time(header: Any, written: int) -> float:
    """When something was measured, in s; when it was written, where that was not said."""
    nanoseconds = int(header.stamp.sec) * 10**9 + int(header.stamp.nanosec)
    return (nanoseconds or written) / 1e9


def _name(child: str, parent: str) -> TransformName:
    return TransformName(frame_word(child) or "Child", frame_word(parent) or "World")


def frame_word(frame: str) -> str:
    """``/us_probe`` as `UsProbe`."""
    return "".join(word[:1].upper() + word[1:] for word in re.findall("[A-Za-z0-9]+", frame))


def _is_folder(path: Path) -> bool:
    return (path / "metadata.yaml").is_file() and any(files_in(path, f"*{suffix}*") for suffix in (".mcap", ".db3"))


BAGS = RecordingKind("a bag of ROS", (".bag", ".mcap", ".db3"), _read, is_folder=_is_folder)

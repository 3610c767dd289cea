"""Whole messages -> images, transforms and statuses.

pyigtl's message classes decode IMAGE and TRANSFORM; the other poses (POSITION, TDATA, QTDATA) and STATUS are small enough to be decoded
here. A message that is whole and still makes no sense is the sender's mistake, and is refused with the reason.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import scipy

from ...arrays import Matrix
from ...errors import LiveConnectionError, LiveMessageError
from ...geometry.transform_graph import TransformStatus
from ...geometry.transforms import LPS_FROM_RAS
from ...imaging.images import luminance
from .framing import Frame, Header
from .messages import ImageMessage, StatusMessage, TransformMessage

MOST_TOOLS = 1000
"""Tools in one message of tracking data; each of them becomes a message of its own, far larger than its bytes."""

_TRACKED_TOOL, _TURNED_TOOL = struct.Struct(">20sBB12f"), struct.Struct(">20sBB7f")
_STATUS = struct.Struct(">Hq20s")
Decoded = ImageMessage | TransformMessage | StatusMessage

_COLOR_CHANNELS = (3, 4)
_LPS = "lps"


def codec() -> ModuleType:
    """The messages of pyigtl, which is imported when it is needed: everything but a live stream works without it.

    Raises
    ------
    LiveConnectionError
        When it is not installed.
    """
    try:
        from pyigtl import messages
    except ImportError:
        raise LiveConnectionError("A live stream needs the Python package pyigtl, which is not installed: pip install pyigtl") from None
    known: ModuleType = messages
    return known


def decode(frame: Frame, received: float = 0.0) -> tuple[Decoded, ...]:
    """The messages in a frame: one; none if its type is not used; several for TDATA and QTDATA, which hold a transform for each tool.

    Parameters
    ----------
    frame : Frame
    received : float, s of `time.monotonic`
        When its last byte arrived.

    Raises
    ------
    LiveMessageError
        When the body does not make sense, or is an image that is not 2D, gray or color.
    """
    decoder = _DECODERS.get(frame.header.kind)
    if decoder is None:
        return ()
    try:
        return decoder(frame, received)
    except LiveMessageError:
        raise
    except Exception as error:  # pyigtl judges no input: any error of Python's may come out of a body that does not make sense
        reason = str(error) or type(error).__name__
        raise LiveMessageError(f"{_describe(frame.header)} cannot be understood ({reason}); it is left out.") from None


def _describe(header: Header) -> str:
    return f"{header.kind} message of {header.device!r}"


def _unpack(frame: Frame) -> Any:
    """The message as pyigtl decodes it; of a type that it does not know, the metadata alone."""
    header = frame.header
    message = codec().MessageBase.create_message(header.kind) or codec().MessageBase()
    fields = {
        "header_version": header.version,
        "message_type": header.kind,
        "device_name": header.device,
        "timestamp": header.timestamp,
        "body_size": header.size,
    }
    message.unpack(fields, frame.body)
    return message


def _image(frame: Frame, received: float) -> tuple[ImageMessage]:
    header = frame.header
    message = _unpack(frame)
    slices, rows, columns, *channels = message.image.shape
    what = f"{_describe(header)} holds {columns} x {rows} x {slices} pixels"
    if slices != 1:
        raise LiveMessageError(f"{what}: frames must be 2D, of one slice. It is left out; send the 2D image of the scanner.")
    if rows == 0 or columns == 0:
        raise LiveMessageError(f"{what}: it is empty, and left out.")
    if channels and channels[0] not in _COLOR_CHANNELS:
        raise LiveMessageError(f"{what} of {channels[0]} channels: there must be 1, or 3 or 4 (color). It is left out; send gray images.")
    image = message.image[0]
    image = luminance(image) if channels else image.astype(image.dtype.newbyteorder("="), copy=False)
    image.flags.writeable = False
    matrix = np.array(message.ijk_to_world_matrix, dtype=np.float64)
    if message.world_coordinate_system == _LPS:
        matrix = LPS_FROM_RAS @ matrix
    return (ImageMessage(header.device, header.timestamp, image, matrix, message.metadata, received, header.version),)


def _transform(frame: Frame, received: float) -> tuple[TransformMessage]:
    header = frame.header
    message = _unpack(frame)
    matrix = np.array(message.matrix, dtype=np.float64)
    status = _status_of(matrix, message.metadata.get("TransformStatus"), message.metadata.get("TransformValid"))
    return (TransformMessage(header.device, header.timestamp, matrix, status, message.metadata, received, header.version),)


def _position(frame: Frame, received: float) -> tuple[TransformMessage]:
    header = frame.header
    content, metadata = _content(frame)
    if len(content) not in (24, 28):
        raise LiveMessageError(
            f"{_describe(header)} holds {len(content)} bytes, not a position and a quaternion (28, or 24). It is left out; send TRANSFORM."
        )
    numbers = struct.unpack(f">{len(content) // 4}f", content)
    matrix = _turned(*numbers) if len(numbers) == 7 else _turned(*numbers, max(0.0, 1.0 - sum(q * q for q in numbers[3:])) ** 0.5)
    status = _status_of(matrix, metadata.get("TransformStatus"), metadata.get("TransformValid"))
    return (TransformMessage(header.device, header.timestamp, matrix, status, metadata, received, header.version, turned=True),)


def _turned(x: float, y: float, z: float, *quaternion: float) -> Matrix:
    """The (4, 4) pose of a position in mm and a quaternion, its real part last; NaN where that is none."""
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    length = np.linalg.norm(quaternion)
    if not 0.5 < length < 2.0:
        return np.full((4, 4), np.nan)
    matrix[:3, :3] = scipy.spatial.transform.Rotation.from_quat(np.array(quaternion) / length).as_matrix()
    return matrix


def _tracking_data(frame: Frame, received: float) -> tuple[TransformMessage, ...]:
    header = frame.header
    tool = _TRACKED_TOOL if header.kind == "TDATA" else _TURNED_TOOL
    content, metadata = _content(frame)
    if len(content) % tool.size:
        raise LiveMessageError(f"{_describe(header)} holds {len(content)} bytes, not {tool.size} for each tool. It is left out.")
    if len(content) > MOST_TOOLS * tool.size:
        raise LiveMessageError(f"{_describe(header)} holds {len(content) // tool.size} tools, more than {MOST_TOOLS}. It is left out.")
    # The 20 bytes of a name may cut it; Plus tells the whole one by the place of the tool in the message
    full_names = {value.strip(): key.removesuffix("Index") for key, value in metadata.items() if key.endswith("Index")}
    messages = []
    for index, (name, _, _, *numbers) in enumerate(tool.iter_unpack(content)):
        turned = tool is _TURNED_TOOL
        if turned:
            matrix = _turned(*numbers)
        else:
            matrix = np.eye(4)
            matrix[:3] = np.reshape(numbers, (4, 3)).T
        device = full_names.get(str(index)) or name.partition(b"\0")[0].decode("utf-8", "replace").strip()
        status = _status_of(matrix, metadata.get(f"{device}Status"))
        messages.append(TransformMessage(device, header.timestamp, matrix, status, metadata, received, header.version, turned))
    return tuple(messages)


def _status(frame: Frame, received: float) -> tuple[StatusMessage]:
    header = frame.header
    content, _ = _content(frame)
    code, _, name = _STATUS.unpack_from(content)
    text = content[_STATUS.size :].partition(b"\0")[0].decode("utf-8", "replace").strip()
    label = name.partition(b"\0")[0].decode("utf-8", "replace").strip()
    return (StatusMessage(header.device, header.timestamp, code, text or label, received),)


def _content(frame: Frame) -> tuple[bytes, dict[str, str]]:
    """The body without its extended header and metadata, and the metadata."""
    message = _unpack(frame)
    if frame.header.version == 1:
        return frame.body, {}
    start, metadata_header, metadata_body = struct.unpack_from(">HHI", frame.body)
    return frame.body[start : len(frame.body) - metadata_header - metadata_body], message.metadata


def _status_of(matrix: Matrix, status: str | None, valid: str | None = None) -> TransformStatus:
    """What the sender says of a transform; a matrix that holds no numbers is invalid, whatever it says."""
    if not np.isfinite(matrix).all():
        return TransformStatus.INVALID
    if status is not None:
        return TransformStatus.parse(status)
    return TransformStatus.INVALID if valid is not None and valid.strip().upper() in ("0", "FALSE") else TransformStatus.OK


_DECODERS: dict[str, Callable[[Frame, float], tuple[Decoded, ...]]] = {
    "IMAGE": _image,
    "TRANSFORM": _transform,
    "POSITION": _position,
    "QTRANS": _position,
    "TDATA": _tracking_data,
    "QTDATA": _tracking_data,
    "STATUS": _status,
}

USED_TYPES = frozenset(_DECODERS)

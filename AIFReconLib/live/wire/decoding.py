"""Whole messages -> images and transforms.

pyigtl's message classes decode IMAGE and TRANSFORM; POSITION, TDATA and QTDATA are small enough to be decoded here. A
message that is whole and still makes no sense is the sender's mistake, and is refused with the reason.
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
from .framing import RawMessage
from .messages import ImageMessage, TransformMessage

MOST_TOOLS = 1000
"""Tools in one message of tracking data; each of them becomes a message of its own, far larger than its bytes."""

_MATRIX_TOOL, _QUATERNION_TOOL = struct.Struct(">20sBB12f"), struct.Struct(">20sBB7f")

Decoded = ImageMessage | TransformMessage


def codec() -> ModuleType:
    """The messages of pyigtl, which is imported when it is needed: everything but a live stream works without it.

    Raises LiveConnectionError when it is not installed.
    """
    try:
        from pyigtl import messages
    except ImportError:
        raise LiveConnectionError("A live stream needs the Python package pyigtl, which is not installed: pip install pyigtl") from None
    known: ModuleType = messages
    return known


def decode(raw: RawMessage, received: float = 0.0) -> tuple[Decoded, ...]:
    """What a message holds: one image or transform; nothing if it is not used; for TDATA and QTDATA a transform for each tool.

    Raises LiveMessageError when the body is damaged or does not make sense, or is an image that is not 2D, gray or color.

    Parameters
    ----------
    received : float, s of `time.monotonic`
        When its last byte arrived.
    """
    if raw.problem is not None:
        raise LiveMessageError(raw.problem)
    decoder = _DECODERS.get(raw.kind)
    if decoder is None:
        return ()
    try:
        return decoder(raw, received)
    except LiveMessageError:
        raise
    except Exception as error:  # pyigtl judges no input: any error of Python's may come out of a body that does not make sense
        reason = str(error) or type(error).__name__
        raise LiveMessageError(f"{_describe(raw)} cannot be understood ({reason}); it is left out.") from None


def _describe(raw: RawMessage) -> str:
    return f"{raw.kind} message of {raw.device!r}"


def _unpack(raw: RawMessage) -> Any:
    """The message as pyigtl decodes it; of a type that it does not know, the metadata alone."""
    message = codec().MessageBase.create_message(raw.kind) or codec().MessageBase()
    fields = {
        "header_version": raw.version,
        "message_type": raw.kind,
        "device_name": raw.device,
        "timestamp": raw.timestamp,
        "body_size": raw.size,
    }
    message.unpack(fields, raw.body)
    return message


def _image(raw: RawMessage, received: float) -> tuple[ImageMessage]:
    message = _unpack(raw)
    slices, rows, columns, *channels = message.image.shape
    what = f"{_describe(raw)} holds {columns} x {rows} x {slices} pixels"
    if slices != 1:
        raise LiveMessageError(f"{what}: frames must be 2D, of one slice. It is left out; send the 2D image of the scanner.")
    if rows == 0 or columns == 0:
        raise LiveMessageError(f"{what}: it is empty, and left out.")
    if channels and channels[0] not in (3, 4):
        raise LiveMessageError(f"{what} of {channels[0]} channels: there must be 1, or 3 or 4 (color). It is left out; send gray images.")
    image = message.image[0]
    image = luminance(image) if channels else image.astype(image.dtype.newbyteorder("="), copy=False)
    image.flags.writeable = False
    matrix = np.array(message.ijk_to_world_matrix, dtype=np.float64)
    if message.world_coordinate_system == "lps":
        matrix = LPS_FROM_RAS @ matrix
    return (ImageMessage(raw.device, raw.timestamp, image, matrix, message.metadata, received, raw.version),)


def _transform(raw: RawMessage, received: float) -> tuple[TransformMessage]:
    message = _unpack(raw)
    return (_pose(raw, received, np.array(message.matrix, dtype=np.float64), message.metadata),)


def _position(raw: RawMessage, received: float) -> tuple[TransformMessage]:
    content, metadata = _content(raw)
    if len(content) not in (24, 28):
        raise LiveMessageError(
            f"{_describe(raw)} holds {len(content)} bytes, not a position and a quaternion (28, or 24). It is left out; send TRANSFORM."
        )
    x, y, z, *quaternion = struct.unpack(f">{len(content) // 4}f", content)
    if len(quaternion) == 3:
        quaternion.append(max(0.0, 1.0 - sum(q * q for q in quaternion)) ** 0.5)
    return (_pose(raw, received, _matrix_of(x, y, z, *quaternion), metadata, from_quaternion=True),)


def _tracking_data(raw: RawMessage, received: float) -> tuple[TransformMessage, ...]:
    has_quaternions = raw.kind == "QTDATA"
    tool = _QUATERNION_TOOL if has_quaternions else _MATRIX_TOOL
    content, metadata = _content(raw)
    if len(content) % tool.size:
        raise LiveMessageError(f"{_describe(raw)} holds {len(content)} bytes, not {tool.size} for each tool. It is left out.")
    if len(content) > MOST_TOOLS * tool.size:
        raise LiveMessageError(f"{_describe(raw)} holds {len(content) // tool.size} tools, more than {MOST_TOOLS}. It is left out.")
    # The 20 bytes of a name may cut it; Plus tells the whole one by the number of the tool in the message
    full_names = {value.strip(): key.removesuffix("Index") for key, value in metadata.items() if key.endswith("Index")}
    messages = []
    for index, (name, _, _, *numbers) in enumerate(tool.iter_unpack(content)):
        device = full_names.get(str(index)) or name.partition(b"\0")[0].decode("utf-8", "replace").strip()
        if has_quaternions:
            matrix = _matrix_of(*numbers)
        else:
            matrix = np.eye(4)
            matrix[:3] = np.reshape(numbers, (4, 3)).T
        messages.append(_pose(raw, received, matrix, metadata, device, has_quaternions))
    return tuple(messages)


def _matrix_of(x: float, y: float, z: float, *quaternion: float) -> Matrix:
    """The (4, 4) pose of a position in mm and a quaternion, its real part last; NaN where that is none."""
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    length = np.linalg.norm(quaternion)
    if not 0.5 < length < 2.0:
        return np.full((4, 4), np.nan)
    matrix[:3, :3] = scipy.spatial.transform.Rotation.from_quat(np.array(quaternion) / length).as_matrix()
    return matrix


def _content(raw: RawMessage) -> tuple[bytes, dict[str, str]]:
    """The body without its extended header and metadata, and the metadata."""
    message = _unpack(raw)
    if raw.version == 1:
        return raw.body, {}
    start, metadata_header, metadata_body = struct.unpack_from(">HHI", raw.body)
    return raw.body[start : len(raw.body) - metadata_header - metadata_body], message.metadata


def _pose(
    raw: RawMessage, received: float, matrix: Matrix, metadata: dict[str, str], tool: str | None = None, from_quaternion: bool = False
) -> TransformMessage:
    """A transform and what the sender says of it; a matrix that holds no numbers is invalid, whatever it says."""
    word = metadata.get("TransformStatus" if tool is None else f"{tool}Status")
    valid = metadata.get("TransformValid", "") if tool is None else ""
    if not np.isfinite(matrix).all() or (word is None and valid.strip().upper() in ("0", "FALSE")):
        status = TransformStatus.INVALID
    else:
        status = TransformStatus.OK if word is None else TransformStatus.parse(word)
    device = raw.device if tool is None else tool
    return TransformMessage(device, raw.timestamp, matrix, status, metadata, received, raw.version, from_quaternion)


_DECODERS: dict[str, Callable[[RawMessage, float], tuple[Decoded, ...]]] = {
    "IMAGE": _image,
    "TRANSFORM": _transform,
    "POSITION": _position,
    "QTRANS": _position,
    "TDATA": _tracking_data,
    "QTDATA": _tracking_data,
}

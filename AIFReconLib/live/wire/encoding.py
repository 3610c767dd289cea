"""Images, transforms and statuses -> the bytes of whole messages, as a Plus server puts them on the wire."""

from __future__ import annotations

import struct

import numpy as np

from ...arrays import Matrix, Numbers, NumberType
from .crc64 import crc64
from .framing import HEADER, TIME_UNIT

NAME_BYTES = 20
LONGEST_SIDE = 2**16 - 1

_EXTENDED_HEADER = struct.Struct(">HHII")
_METADATA_ENTRY = struct.Struct(">HHI")
_IMAGE = struct.Struct(">HBBBB3H12f6H")
_UTF8, _ASCII = 106, 3
_LITTLE = 2
_RAS = 1
_OK = 1
_SCALARS = {"i1": 2, "u1": 3, "i2": 4, "u2": 5, "i4": 6, "u4": 7, "f4": 10, "f8": 11}


def why_not_sendable(dtype: NumberType, size: tuple[int, int]) -> str | None:
    """What keeps images of this type of pixel and size (columns, rows) from being sent; None for usable ones."""
    if np.dtype(dtype).str[1:] not in _SCALARS:
        return f"pixels must be integers of up to 32 bits or floats of 32 or 64; got {np.dtype(dtype).name}"
    if not 0 < min(size) <= max(size) <= LONGEST_SIDE:
        return f"images must have 1 to {LONGEST_SIDE} columns and rows; got {size[0]} x {size[1]}"
    return None


def encode_message(
    kind: str, device: str, timestamp: float, content: bytes = b"", *, version: int = 1, metadata: dict[str, str] | None = None
) -> bytes:
    """A whole message.

    Parameters
    ----------
    kind : str
        Its type, e.g. ``TRANSFORM``.
    device : str
        Cut to 20 bytes, as the header has no more.
    timestamp : float, s since 1970 (UTC)
    version : int
        1, or 2: with extended header and metadata.
    metadata : dict of str to str
        Left out in version 1, which has no place for it.
    """
    if version == 1:
        body = content
    else:
        index, texts = _encode_metadata(metadata or {})
        body = b"".join((_EXTENDED_HEADER.pack(_EXTENDED_HEADER.size, len(index), len(texts), 0), content, index, texts))
    name = device.encode("utf-8")[:NAME_BYTES]
    return HEADER.pack(version, kind.encode("ascii"), name, round(timestamp / TIME_UNIT), len(body), crc64(body)) + body


def encode_image(
    device: str,
    timestamp: float,
    image: Numbers,
    image_to_sender: Matrix,
    *,
    version: int = 1,
    metadata: dict[str, str] | None = None,
) -> bytes:
    """An IMAGE message of one slice, in RAS.

    Parameters
    ----------
    device, timestamp, version, metadata
        See `encode_message`.
    image : (rows, columns) array, or (rows, columns, 3 or 4) for colors
        Integers of up to 32 bits, or floats.
    image_to_sender : (4, 4) array, pixels to mm
        Sent in float32, as the protocol has it: scaled axes, and the position of the image's center, (size - 1) / 2.
    """
    rows, columns, *channels = image.shape
    matrix = np.asarray(image_to_sender, dtype=np.float64)
    center = matrix @ ((columns - 1) / 2, (rows - 1) / 2, 0.0, 1.0)
    little = image.dtype.newbyteorder("<")
    content = _IMAGE.pack(
        1,
        channels[0] if channels else 1,
        _SCALARS[image.dtype.str[1:]],
        _LITTLE,
        _RAS,
        *(columns, rows, 1),
        *matrix[:3, :3].T.ravel(),
        *center[:3],
        *(0, 0, 0),
        *(columns, rows, 1),
    )
    pixels = np.ascontiguousarray(image, dtype=little).tobytes()
    return encode_message("IMAGE", device, timestamp, content + pixels, version=version, metadata=metadata)


def encode_transform(device: str, timestamp: float, matrix: Matrix, *, version: int = 1, metadata: dict[str, str] | None = None) -> bytes:
    """A TRANSFORM message of a (4, 4) matrix, in mm."""
    content = struct.pack(">12f", *np.asarray(matrix, dtype=np.float64)[:3].T.ravel())
    return encode_message("TRANSFORM", device, timestamp, content, version=version, metadata=metadata)


def encode_status(device: str, timestamp: float, text: str = "", *, version: int = 1) -> bytes:
    """A STATUS message: all is well."""
    content = struct.pack(">Hq20s", _OK, 0, b"") + text.encode("utf-8") + b"\0"
    return encode_message("STATUS", device, timestamp, content, version=version)


def encode_status_request() -> bytes:
    """A GET_STATUS message of header version 2, which makes Plus send this client metadata and statuses."""
    return encode_message("GET_STATUS", "", 0.0, version=2)


def _encode_metadata(metadata: dict[str, str]) -> tuple[bytes, bytes]:
    """The index of a message's metadata, and the texts it points into."""
    entries, texts = [struct.pack(">H", len(metadata))], []
    for key, value in metadata.items():
        name, text = key.encode("utf-8"), value.encode("utf-8")
        entries.append(_METADATA_ENTRY.pack(len(name), _ASCII if value.isascii() else _UTF8, len(text)))
        texts += [name, text]
    return b"".join(entries), b"".join(texts)

"""Whether a NIfTI file (.nii, .nii.gz) holds all the voxels that its header promises."""

from __future__ import annotations

import math
import struct
from pathlib import Path

from ..errors import FileFormatError
from .metafile import require_regular_file
from .payload import Inflater, PayloadError

_HEADERS = {348: (40, "8h", 72, 108, "f"), 540: (16, "8q", 14, 168, "q")}
"""By length of the header (NIfTI-1, NIfTI-2): where the dimensions, the bits per voxel and the offset of the voxels stand."""


def check_nifti(path: Path, error: type[FileFormatError]) -> None:
    """Return if the file is complete, its checksum included if it is compressed. Keeps nothing in memory.

    Raises
    ------
    FileFormatError
        Of the class given.
    """
    require_regular_file(path, error)
    try:
        with open(path, "rb") as file:
            length = path.stat().st_size
            if path.suffix.lower() != ".gz":
                needed = _needed_bytes(file.read(max(_HEADERS)))
                if length < needed:
                    raise PayloadError(f"are cut short: the header promises {needed} bytes, there are {length}")
                return
            stream = Inflater(0, length)
            head = stream.read(file, min(_HEADERS))
            if _header_length(head) != len(head):
                head += stream.read(file, max(_HEADERS) - len(head))
            stream.skip(file, _needed_bytes(head) - len(head))
            stream.drain(file)
    except PayloadError as cause:
        raise error(f"{path}: the voxels {cause}. Copy or export the file again.") from cause
    except OSError as cause:
        raise error(f"{path}: the file cannot be read ({cause.strerror}). Check its permissions.") from cause


def _header_length(head: bytes) -> int:
    """348 or 540; the byte order is told by it."""
    return struct.unpack(_byte_order(head) + "i", head[:4])[0]


def _byte_order(head: bytes) -> str:
    for order in "<>":
        if len(head) >= 4 and struct.unpack(order + "i", head[:4])[0] in _HEADERS:
            return order
    raise PayloadError("are not those of a NIfTI file: it does not begin with 348 or 540")


def _needed_bytes(head: bytes) -> int:
    """Length of the whole file, decoded."""
    order = _byte_order(head)
    dimensions_at, dimensions_format, bits_at, offset_at, offset_format = _HEADERS[_header_length(head)]
    if len(head) < _header_length(head):
        raise PayloadError("are missing, and part of the header too")
    count, *sizes = struct.unpack_from(order + dimensions_format, head, dimensions_at)
    (bits,) = struct.unpack_from(order + "h", head, bits_at)
    (offset,) = struct.unpack_from(order + offset_format, head, offset_at)
    if not 1 <= count <= 7 or min(sizes[:count]) < 1 or bits < 1 or not math.isfinite(offset) or offset < 0:
        raise PayloadError(f"cannot be told from the header: dimensions {count} {sizes}, {bits} bits, offset {offset}")
    return int(offset) + (math.prod(sizes[:count]) * bits + 7) // 8

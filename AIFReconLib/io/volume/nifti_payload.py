"""Whether a NIfTI file (.nii, .nii.gz) holds all the voxels that its header promises, and where its two forms place them."""

from __future__ import annotations

import contextlib
import math
import struct
from pathlib import Path

import numpy as np
import scipy

from ...arrays import Matrix
from ...errors import FileFormatError
from ...machine.memory import available_memory, require_bytes
from ..disk.regular_files import require_regular_file
from ..metafile.payload import Inflater, PayloadError

_HEADERS = {348: (40, "8h", 72, 108, "f"), 540: (16, "8q", 14, 168, "q")}
"""By length of the header (NIfTI-1, NIfTI-2): where the dimensions, the bits per voxel and the offset of the voxels stand."""

_BITS = {2: 8, 4: 16, 8: 32, 16: 32, 32: 64, 64: 64, 128: 24, 256: 8, 512: 16, 768: 32, 1024: 64, 1280: 64, 1792: 128, 2304: 32}
"""By NIfTI's number of a type: bits of a voxel. SimpleITK's reader prints its own complaint about others."""


_PLACES = {348: (76, "8f", 123, "B", 252, "2h", 256, "6f", 280, "12f"), 540: (104, "8d", 500, "i", 344, "2i", 352, "6d", 400, "12d")}
"""By length of the header: pixdim, units, codes of qform and sform, quaternion and offset, and the rows of the sform."""

_UNIT_MM = {1: 1e3, 3: 1e-3}
"""By NIfTI's number of a unit: meters and microns; all others are taken as mm."""

ITK_COPIES = 2
"""SimpleITK's image, and the array that is made of it."""


def check_nifti(path: Path, error: type[FileFormatError]) -> bytes:
    """The header of the file, if it is complete, its checksum included if it is compressed. Keeps nothing else in memory.

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
                head = file.read(max(_HEADERS))
                needed = _needed_bytes(head)
                if length < needed:
                    raise PayloadError(f"are cut short: the header promises {needed} bytes, there are {length}")
                require_bytes(path, ITK_COPIES * needed, available_memory())
                return head
            stream = Inflater(0, length)
            head = stream.read(file, min(_HEADERS))
            if _header_length(head) != len(head):
                head += stream.read(file, max(_HEADERS) - len(head))
            needed = _needed_bytes(head)
            require_bytes(path, ITK_COPIES * needed, available_memory())
            stream.skip(file, needed - len(head))
            stream.drain(file)
            return head
    except PayloadError as cause:
        raise error(f"{path}: the voxels {cause}. Copy or export the file again.") from cause
    except OSError as cause:
        raise error(f"{path}: the file cannot be read ({cause.strerror}). Check its permissions.") from cause


def nifti_forms(head: bytes) -> dict[str, Matrix]:
    """Voxel (i, j, k) to RAS, (4, 4) in mm, by the forms that a header has: ``qform``, a rotation, and ``sform``, any matrix."""
    pixels_at, pixels, unit_at, unit, codes_at, codes, turn_at, turn, rows_at, rows = _PLACES[_header_length(head)]
    order = _byte_order(head)
    qform_code, sform_code = struct.unpack_from(order + codes, head, codes_at)
    forms: dict[str, Matrix] = {}
    if qform_code > 0:
        handed, *sizes = struct.unpack_from(order + pixels, head, pixels_at)[:4]
        b, c, d, *offset = struct.unpack_from(order + turn, head, turn_at)
        sizes[2] *= -1 if handed < 0 else 1
        with contextlib.suppress(ValueError):  # no numbers
            rotation = scipy.spatial.transform.Rotation.from_quat((b, c, d, math.sqrt(max(1 - b * b - c * c - d * d, 0.0))))
            forms["qform"] = np.column_stack([rotation.as_matrix() * sizes, offset])
    if sform_code > 0:
        forms["sform"] = np.reshape(struct.unpack_from(order + rows, head, rows_at), (3, 4))
    scale = _UNIT_MM.get(struct.unpack_from(order + unit, head, unit_at)[0] & 7, 1.0)
    return {name: np.vstack([scale * form, (0.0, 0.0, 0.0, 1.0)]) for name, form in forms.items()}


def _header_length(head: bytes) -> int:
    """348 or 540; the byte order is told by it."""
    return int(struct.unpack(_byte_order(head) + "i", head[:4])[0])


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
    if head[344:347] != b"n+1" and head[4:7] != b"n+2":
        raise PayloadError("are not in this file: it is the header of a pair, or an old Analyze file")
    count, *sizes = struct.unpack_from(order + dimensions_format, head, dimensions_at)
    kind, bits = struct.unpack_from(order + "2h", head, bits_at - 2)
    (offset,) = struct.unpack_from(order + offset_format, head, offset_at)
    if not 1 <= count <= 7 or min(sizes[:count]) < 1 or bits < 1 or not math.isfinite(offset) or offset < 0:
        raise PayloadError(f"cannot be told from the header: dimensions {count} {sizes}, {bits} bits, offset {offset}")
    if _BITS.get(kind) != bits:
        raise PayloadError(f"are of a type that is not read: {kind}, of {bits} bits")
    voxels: int = math.prod(sizes[:count])
    return int(offset) + (voxels * int(bits) + 7) // 8

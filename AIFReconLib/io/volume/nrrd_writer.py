"""Volumes as NRRD files, compressed block by block on all cores: no second copy of the voxels is made."""

from __future__ import annotations

import struct
import sys
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...arrays import Numbers
from ...geometry.transforms import LPS_FROM_RAS
from ...geometry.volume import Volume
from ...machine.threads import in_parts, usable_cores
from ..metafile.nrrd import escape

_KINDS = {"1": "char", "2": "short", "4": "int", "8": "long long"}
TYPE_NAMES = {
    "f4": "float",
    "f8": "double",
    "i1": "signed char",
    **{f"u{size}": f"unsigned {kind}" for size, kind in _KINDS.items()},
    **{f"i{size}": kind for size, kind in _KINDS.items() if size != "1"},
}
"""As SimpleITK calls them."""

BLOCK = 2**22
"""Bytes that are compressed together, about."""

LEVEL = 2
"""Of zlib; SimpleITK's for this format."""

GZIP_HEADER = bytes([0x1F, 0x8B, 8, 0, 0, 0, 0, 0, 0, 255])
LAST_BLOCK = b"\x03\x00"


def type_name(array: Numbers) -> str | None:
    """What NRRD calls the type of an array; None where it has none. Truth values are 8 bits."""
    return TYPE_NAMES.get("u1" if array.dtype.kind == "b" else f"{array.dtype.kind}{array.dtype.itemsize}")


def write_nrrd(volume: Volume, path: Path) -> None:
    """Write a volume whose voxels have a `type_name`, with its fields.

    Notes
    -----
    The payload is one gzip stream. Its blocks are compressed by themselves, each ending at a whole byte, so that threads share them.
    """
    threads = usable_cores()
    with path.open("wb") as file:
        file.write("".join(f"{line}\n" for line in (*_header(volume), "")).encode("utf-8", errors="surrogateescape"))
        file.write(GZIP_HEADER)
        checksum = count = 0
        for blocks in _blocks(volume.array, 2 * threads):
            packed = [b""] * len(blocks)

            def pack(number: int, blocks: list[memoryview] = blocks, packed: list[bytes] = packed) -> None:
                packer = zlib.compressobj(LEVEL, zlib.DEFLATED, -zlib.MAX_WBITS)
                packed[number] = packer.compress(blocks[number]) + packer.flush(zlib.Z_FULL_FLUSH)

            in_parts(pack, len(blocks), threads)
            file.writelines(packed)
            for block in blocks:
                checksum = zlib.crc32(block, checksum)
                count += len(block)
        file.write(LAST_BLOCK + struct.pack("<II", checksum, count % 2**32))


def _blocks(array: Numbers, together: int) -> Iterator[list[memoryview]]:
    """The bytes of an array [k, j, i] in C order, a few blocks of whole planes at a time."""
    planes = max(BLOCK // max(array[:1].nbytes, 1), 1)
    starts = range(0, len(array), planes)
    for first in range(0, len(starts), together):
        some = (array[start : start + planes] for start in starts[first : first + together])
        whole = [np.ascontiguousarray(part, dtype=array.dtype.newbyteorder("=")).reshape(-1) for part in some]
        yield [part.view(np.uint8).data for part in whole]


def _header(volume: Volume) -> Iterator[str]:
    """The lines before the data, as SimpleITK writes them; files hold left-posterior-superior coordinates."""
    ijk_to_lps = LPS_FROM_RAS @ volume.ijk_to_reference
    yield "NRRD0004"
    yield "# Complete NRRD file format specification at:"
    yield "# http://teem.sourceforge.net/nrrd/format.html"
    yield f"type: {type_name(volume.array)}"
    yield "dimension: 3"
    yield "space: left-posterior-superior"
    yield f"sizes: {' '.join(str(n) for n in volume.shape[::-1])}"
    yield f"space directions: {' '.join(_vector(axis) for axis in ijk_to_lps[:3, :3].T)}"
    yield "kinds: domain domain domain"
    if volume.array.dtype.itemsize > 1:
        yield f"endian: {sys.byteorder}"
    yield "encoding: gzip"
    yield f"space origin: {_vector(ijk_to_lps[:3, 3])}"
    for key, text in sorted(volume.fields.items()):
        yield f"{escape(key)}:={escape(text)}"


def _vector(numbers: Numbers) -> str:
    return f"({','.join(f'{float(number):.17g}' for number in numbers)})"

"""ITK transform files in HDF5 (.h5): the part of that format which ITK 5 writes, and nothing else of it.

The HDF5 library crashes on damaged files, so it never sees one. What is read here: version 2 and 3 superblocks, version 2 object headers,
groups that list their links, contiguous numbers, and text of variable length in the global heap. Each address is checked before it is
followed, and nothing is followed twice.

References
----------
The HDF Group, "HDF5 File Format Specification Version 3.0".
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator

import numpy as np

from .transform_parts import TransformPart, TransformPartError

MAGIC = b"\x89HDF\r\n\x1a\n"
MOST_NUMBERS = 64
"""A linear transform has at most 15."""
MOST_MESSAGES = 256

_LINK, _DATASPACE, _DATATYPE, _LAYOUT, _CONTINUATION = 0x06, 0x01, 0x03, 0x08, 0x10
_TEXT, _FLOAT = 9, 1


class _Damaged(ValueError):
    """An address or length that leads nowhere."""


def read_transform_hdf5(data: bytes) -> list[TransformPart]:
    """The transforms of a file, in order of their numbers.

    Parameters
    ----------
    data : bytes
        The whole file.

    Raises
    ------
    TransformPartError
        When it is damaged, or arranged as ITK 5 does not.
    """
    try:
        if len(data) < 48 or data[8] not in (2, 3) or data[9:11] != b"\x08\x08":
            raise TransformPartError("is in a layout of HDF5 that is not read here. Save it from Slicer as .tfm.")
        base, _, end, root = struct.unpack_from("<4Q", data, 12)
        if base != 0 or end > len(data):
            raise _Damaged
        group = _links(data, _links(data, root)["TransformGroup"])
        return [_part(data, _links(data, group[name])) for name in sorted(group, key=_number)]
    except (_Damaged, KeyError, struct.error):
        raise TransformPartError(
            "is damaged, or in a layout of HDF5 that is not read here. Save it from Slicer again, or as .tfm."
        ) from None


def _number(name: str) -> int:
    if not re.fullmatch("[0-9]{1,6}", name):
        raise _Damaged
    return int(name)


def _part(data: bytes, members: dict[str, int]) -> TransformPart:
    """One group of TransformGroup."""
    numbers = {key: address for key, address in members.items() if key != "TransformType"}
    # ITK wrote "Paramters" before version 5.0
    parameters = next((numbers[key] for key in ("TransformParameters", "TranformParameters") if key in numbers), None)
    fixed = next((numbers[key] for key in ("TransformFixedParameters", "TranformFixedParameters") if key in numbers), None)
    return TransformPart(_text(data, members["TransformType"]), _numbers(data, parameters), _numbers(data, fixed))


def _messages(data: bytes, address: int) -> Iterator[tuple[int, bytes]]:
    """Kind and content of the messages in an object header and its continuations."""
    head = _piece(data, address, 6)
    if head[:5] != b"OHDR\x02":
        raise _Damaged
    flags = head[5]
    start = address + 6 + (16 if flags & 0x20 else 0) + (4 if flags & 0x10 else 0)
    width = 1 << (flags & 3)
    length = int.from_bytes(_piece(data, start, width), "little")
    blocks = [(start + width, length)]
    extra = 2 if flags & 4 else 0
    seen = 0
    while blocks:
        start, length = blocks.pop(0)
        block = _piece(data, start, length)
        place = 0
        while place + 4 + extra <= len(block):
            kind, size = block[place], int.from_bytes(block[place + 1 : place + 3], "little")
            content = block[place + 4 + extra : place + 4 + extra + size]
            place += 4 + extra + size
            seen += 1
            if len(content) != size or seen > MOST_MESSAGES:
                raise _Damaged
            if kind == _CONTINUATION:
                start, length = struct.unpack_from("<QQ", content)
                if _piece(data, start, 4) != b"OCHK" or length < 8:
                    raise _Damaged
                blocks.append((start + 4, length - 8))
            yield kind, content


def _links(data: bytes, address: int) -> dict[str, int]:
    """Names in a group, and the addresses of what they name."""
    links = {}
    for kind, content in _messages(data, address):
        if kind == _LINK:
            name, target = _link(content)
            links[name] = target
    return links


def _link(content: bytes) -> tuple[str, int]:
    version, flags = struct.unpack_from("<BB", content)
    place = 2
    if version != 1 or (flags & 8 and content[place : place + 1] != b"\0"):
        raise _Damaged  # not a hard link
    place += (1 if flags & 8 else 0) + (8 if flags & 4 else 0) + (1 if flags & 16 else 0)
    width = 1 << (flags & 3)
    length = int.from_bytes(content[place : place + width], "little")
    name = content[place + width : place + width + length]
    (target,) = struct.unpack_from("<Q", content, place + width + length)
    return name.decode("utf-8", "replace"), target


def _dataset(data: bytes, address: int, kind: int, size: int) -> tuple[int, bytes]:
    """Number of elements, and the bytes of a contiguous dataset of this class and size of element."""
    messages = dict(_messages(data, address))
    space, datatype, layout = (messages[key] for key in (_DATASPACE, _DATATYPE, _LAYOUT))
    if struct.unpack_from("<BB", layout) != (3, 1) or datatype[0] & 15 != kind:
        raise _Damaged
    count = _count(space)
    if struct.unpack_from("<I", datatype, 4) != (size,):
        raise _Damaged
    start, length = struct.unpack_from("<QQ", layout, 2)
    return count, _piece(data, start, count * size) if count and length >= count * size else b""


def _count(space: bytes) -> int:
    """Number of elements of a dataspace."""
    version, rank = struct.unpack_from("<BB", space)
    if version != 2 or rank > 1:
        raise _Damaged
    return struct.unpack_from("<Q", space, 4)[0] if rank else 1


def _numbers(data: bytes, address: int | None) -> tuple[float, ...]:
    if address is None:
        return ()
    messages = dict(_messages(data, address))
    size = struct.unpack_from("<I", messages[_DATATYPE], 4)[0]
    if _count(messages[_DATASPACE]) > MOST_NUMBERS:
        return ()  # no linear transform, so nobody will ask for them
    if size not in (4, 8) or messages[_DATATYPE][1] & 1:
        raise _Damaged  # another type or byte order
    count, content = _dataset(data, address, _FLOAT, size)
    if len(content) != count * size:
        raise _Damaged
    return tuple(np.frombuffer(content, f"<f{size}").astype(np.float64).tolist())


def _text(data: bytes, address: int) -> str:
    """One string, in the global heap."""
    count, content = _dataset(data, address, _TEXT, 16)
    if count != 1:
        raise _Damaged
    length, heap, wanted = struct.unpack("<IQI", content)
    head = _piece(data, heap, 16)
    size = int.from_bytes(head[8:], "little")
    if head[:5] != b"GCOL\x01":
        raise _Damaged
    place, stop = heap + 16, heap + size
    while place + 16 <= stop:
        index, _, _, bytes_there = struct.unpack("<HHIQ", _piece(data, place, 16))
        if index == wanted and index:
            if bytes_there < length:
                raise _Damaged
            return _piece(data, place + 16, length).split(b"\0")[0].decode("utf-8", "replace")
        if index == 0:
            break
        place += 16 + (bytes_there + 7) // 8 * 8
    raise _Damaged


def _piece(data: bytes, start: int, length: int) -> bytes:
    """`length` bytes that must be there."""
    if start + length > len(data):
        raise _Damaged
    return data[start : start + length]

"""Groups and datasets of HDF5 files: as much of that format as ITK 4 and ITK 5 use for transforms, and nothing else of it.

The HDF5 library crashes on damaged files, so it never sees one. What is read here: superblocks, object headers and groups of the older kind
(HDF5 1.8, Slicer 4) and of the newer one (Slicer 5), and datasets of at most one dimension, in one piece or in one compressed chunk. Each
address is checked before it is followed, and nothing is followed twice.

References
----------
The HDF Group, "HDF5 File Format Specification Version 3.0".
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator

MOST_MESSAGES = 256
MOST_LINKS = 256

DATASPACE, DATATYPE = 0x01, 0x03
_LINK_INFO, _LINK, _LAYOUT, _FILTERS, _CONTINUATION, _SYMBOL_TABLE = 0x02, 0x06, 0x08, 0x0B, 0x10, 0x11
_DEFLATE = 1
_GROUP_TREE, _CHUNK_TREE = 0, 1
_NOWHERE = 2**64 - 1


class DamagedError(ValueError):
    """An address or length that leads nowhere, or a part of the format that is not read here."""


def root_group(data: bytes) -> int:
    """Address of the first group's object header.

    Raises
    ------
    DamagedError
    struct.error
        When the file ends before.
    """
    version = data[8] if len(data) > 48 else -1
    if version in (2, 3):
        sizes, (base, _, end, root) = data[9:11], struct.unpack_from("<4Q", data, 12)
    elif version == 0:
        sizes, (base, _, end, _, _, root) = data[13:15], struct.unpack_from("<6Q", data, 24)
    else:
        raise DamagedError
    if sizes != b"\x08\x08" or base != 0 or end > len(data):
        raise DamagedError
    return int(root)


def piece(data: bytes, start: int, length: int) -> bytes:
    """`length` bytes that must be there."""
    if start + length > len(data):
        raise DamagedError
    return data[start : start + length]


def messages(data: bytes, address: int) -> Iterator[tuple[int, bytes]]:
    """Kind and content of the messages in an object header and its continuations."""
    is_newer = piece(data, address, 4) == b"OHDR"
    blocks, head = _newer_header(data, address) if is_newer else _older_header(data, address)
    seen = 0
    while blocks:
        start, length = blocks.pop(0)
        block = piece(data, start, length)
        place = 0
        while place + head <= len(block):
            kind, size = struct.unpack_from("<BH" if is_newer else "<HH", block, place)
            content = block[place + head : place + head + size]
            place += head + size
            seen += 1
            if len(content) != size or seen > MOST_MESSAGES:
                raise DamagedError
            if kind == _CONTINUATION:
                blocks.append(_continuation(data, content, is_newer))
            yield kind, content


def _newer_header(data: bytes, address: int) -> tuple[list[tuple[int, int]], int]:
    """Start and length of the messages in a version 2 header, and how long the head of each message is."""
    version, flags = piece(data, address, 6)[4:]
    if version != 2:
        raise DamagedError
    start = address + 6 + (16 if flags & 0x20 else 0) + (4 if flags & 0x10 else 0)
    width = 1 << (flags & 3)
    length = int.from_bytes(piece(data, start, width), "little")
    return [(start + width, length)], 6 if flags & 4 else 4


def _older_header(data: bytes, address: int) -> tuple[list[tuple[int, int]], int]:
    """The same of a version 1 header."""
    version, _, _, _, length = struct.unpack("<BBHII", piece(data, address, 12))
    if version != 1:
        raise DamagedError
    return [(address + 16, length)], 8


def _continuation(data: bytes, content: bytes, is_newer: bool) -> tuple[int, int]:
    """Start and length of further messages."""
    start, length = struct.unpack_from("<QQ", content)
    if not is_newer:
        return start, length
    if piece(data, start, 4) != b"OCHK" or length < 8:
        raise DamagedError
    return start + 4, length - 8  # without the checksum


def links(data: bytes, address: int) -> dict[str, int]:
    """Names in a group, and the addresses of what they name."""
    named: dict[str, int] = {}
    for kind, content in messages(data, address):
        if kind == _LINK:
            name, target = _link(content)
            named[name] = target
        elif kind == _SYMBOL_TABLE:
            if named:
                raise DamagedError  # a group has one
            named.update(_symbols(data, *struct.unpack_from("<QQ", content)))
        elif kind == _LINK_INFO and struct.unpack_from("<Q", content, 10 if content[1] & 1 else 2) != (_NOWHERE,):
            raise DamagedError  # many links, in a heap of their own
    return named


def _link(content: bytes) -> tuple[str, int]:
    version, flags = struct.unpack_from("<BB", content)
    place = 2
    if version != 1 or (flags & 8 and content[place : place + 1] != b"\0"):
        raise DamagedError  # not a hard link
    place += (1 if flags & 8 else 0) + (8 if flags & 4 else 0) + (1 if flags & 16 else 0)
    width = 1 << (flags & 3)
    length = int.from_bytes(content[place : place + width], "little")
    name = content[place + width : place + width + length]
    (target,) = struct.unpack_from("<Q", content, place + width + length)
    return name.decode("utf-8", "replace"), target


def _symbols(data: bytes, tree: int, heap: int) -> dict[str, int]:
    """The links of a group of the older kind: a tree of symbol tables, and a heap of names."""
    signature, length, _, start = struct.unpack("<4s4xQQQ", piece(data, heap, 32))
    if signature != b"HEAP":
        raise DamagedError
    names = piece(data, start, length)
    named: dict[str, int] = {}
    seen = 0
    for _, table in _leaves(data, tree, _GROUP_TREE, 8):
        signature, count = struct.unpack("<4s2xH", piece(data, table, 8))
        seen += count
        if signature != b"SNOD" or seen > MOST_LINKS:
            raise DamagedError
        for place, target in struct.iter_unpack("<QQ24x", piece(data, table + 8, 40 * count)):
            named[names[place : place + 255].split(b"\0")[0].decode("utf-8", "replace")] = target
    return named


def _leaves(data: bytes, address: int, kind: int, key_bytes: int) -> list[tuple[bytes, int]]:
    """Keys and addresses in a version 1 B-tree, which must have one level."""
    signature, found, level, used = struct.unpack("<4sBBH", piece(data, address, 8))
    if (signature, found, level) != (b"TREE", kind, 0) or used > MOST_LINKS:
        raise DamagedError
    content = piece(data, address + 24, used * (key_bytes + 8))
    return list(struct.iter_unpack(f"<{key_bytes}sQ", content))


def count_of(space: bytes) -> int:
    """Number of elements, from the message of kind DATASPACE."""
    version, rank = struct.unpack_from("<BB", space)
    if version not in (1, 2) or rank > 1:
        raise DamagedError
    return struct.unpack_from("<Q", space, 8 if version == 1 else 4)[0] if rank else 1


def elements(data: bytes, found: dict[int, bytes], count: int, size: int) -> bytes:
    """The bytes of a dataset of `count` elements of `size` bytes, whose messages are `found`."""
    if not count:
        return b""
    layout = found[_LAYOUT]
    version, kind = struct.unpack_from("<BB", layout)
    if (version, kind) == (3, 1):
        start, length = struct.unpack_from("<QQ", layout, 2)
        if length < count * size:
            raise DamagedError
        return piece(data, start, count * size)
    if (version, kind) != (3, 2):
        raise DamagedError
    axes, tree, along, bytes_each = struct.unpack_from("<BQII", layout, 2)
    chunks = _leaves(data, tree, _CHUNK_TREE, 24) if axes == 2 else []
    if along < count or bytes_each != size or len(chunks) != 1:
        raise DamagedError
    key, start = chunks[0]
    length, left_out, *place = struct.unpack("<IIQQ", key)
    if any(place) or struct.unpack_from("<BBH", found[_FILTERS]) != (2, 1, _DEFLATE):
        raise DamagedError
    content = piece(data, start, length)
    if not left_out:  # the filter, where it would have made the chunk longer
        content = _inflated(content, count * size)
    if len(content) < count * size:
        raise DamagedError
    return content[: count * size]


def _inflated(content: bytes, most: int) -> bytes:
    try:
        return zlib.decompressobj().decompress(content, most)
    except zlib.error:
        raise DamagedError from None

"""What the chunks of a bag may become when they are unpacked: a small file can ask for all memory, and rosbags has no limit."""

from __future__ import annotations

import bz2
import struct
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from ....errors import SequenceFormatError
from ..decoded_images import library

MOST_BYTES = 2**29
"""Of a chunk; recorders make them of 1 to 4 MB, or of one message."""
_MAGIC = 8
_CHUNK = 6


def check_mcap(path: Path) -> None:
    """Return if every chunk of a file of MCAP unpacks to what it says, and no more (the specification's "Chunk (op=0x06)").

    Raises SequenceFormatError otherwise.
    """
    with open(path, "rb") as file:
        file.seek(_MAGIC)
        while len(head := file.read(9)) == 9:
            kind, length = struct.unpack("<BQ", head)
            if kind != _CHUNK:
                file.seek(length, 1)
                continue
            start = file.tell()
            (size,) = struct.unpack("<Q", file.read(24)[16:])
            _, words = struct.unpack("<II", file.read(8))
            compression = file.read(min(words, 16)).decode("ascii", "replace")
            (packed,) = struct.unpack("<Q", file.read(8))
            unpacked = _unpacker(compression)
            if size > MOST_BYTES or packed > length or (unpacked is not None and len(unpacked(file.read(packed), size + 1)) != size):
                raise _too_large(path, start)
            file.seek(start + length)


def bound_chunks(reader: Any, path: Path) -> None:
    """Let a reader of ROS 1 unpack no chunk beyond the limit."""

    def bounded(unpack: Callable[[bytes, int], bytes], place: int) -> Callable[[bytes], bytes]:
        def read(data: bytes) -> bytes:
            unpacked = unpack(data, MOST_BYTES + 1)
            if len(unpacked) > MOST_BYTES:
                raise _too_large(path, place)
            return unpacked

        return read

    packed = {bz2.decompress: "bz2", library("lz4.frame", "Bags of ROS").decompress: "lz4"}
    for place, chunk in reader.chunks.items():
        unpack = _unpacker(packed.get(chunk.decompressor, ""))
        if unpack is not None:
            reader.chunks[place] = chunk._replace(decompressor=bounded(unpack, place))


def _unpacker(compression: str) -> Callable[[bytes, int], bytes] | None:
    """What unpacks so many bytes at most; None for what is not packed, or not known."""
    if compression == "bz2":
        return lambda data, most: bz2.BZ2Decompressor().decompress(data, most)
    if compression == "lz4":
        return lambda data, most: library("lz4.frame", "Bags of ROS").LZ4FrameDecompressor().decompress(data, most)
    if compression == "zstd":
        return _unpacked_zstd
    return None


def _unpacked_zstd(data: bytes, most: int) -> bytes:
    try:
        zstd = import_module("compression.zstd")
    except ImportError:
        zstd = library("backports.zstd", "Bags of ROS")
    unpacker = zstd.ZstdDecompressor()
    unpacked: bytes = unpacker.decompress(data, most)
    # Another frame would be unpacked too
    return unpacked if unpacker.eof and not unpacker.unused_data else b""


def _too_large(path: Path, place: int) -> SequenceFormatError:
    return SequenceFormatError(
        f"{path}: its chunk at byte {place} unpacks to another size than it says, or to more than {MOST_BYTES} bytes. Record it again."
    )

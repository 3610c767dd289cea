"""ITK transform files in HDF5 (.h5): a group of transforms, each with its type and its numbers."""

from __future__ import annotations

import re
import struct

import numpy as np

from .hdf5_objects import DATASPACE, DATATYPE, DamagedError, count_of, elements, links, messages, piece, root_group
from .parts import TransformPart, TransformPartError

MAGIC = b"\x89HDF\r\n\x1a\n"
MOST_NUMBERS = 64
"""A linear transform has at most 15."""
MOST_TEXTS = 4096

_TEXT, _FLOAT = 9, 1


def read_transform_hdf5(data: bytes) -> list[TransformPart]:
    """The transforms of a file, in order of their numbers.

    Parameters
    ----------
    data : bytes
        The whole file.

    Raises
    ------
    TransformPartError
        When it is damaged, or arranged as ITK does not.
    """
    try:
        group = links(data, links(data, root_group(data))["TransformGroup"])
        return [_part(data, links(data, group[name])) for name in sorted(group, key=_number)]
    except (DamagedError, KeyError, IndexError, struct.error):
        raise TransformPartError(
            "is damaged, or in a layout of HDF5 that is not read here. Save it from Slicer again, or as .tfm."
        ) from None


def _number(name: str) -> int:
    if not re.fullmatch("[0-9]{1,6}", name):
        raise DamagedError
    return int(name)


def _part(data: bytes, members: dict[str, int]) -> TransformPart:
    """One group of TransformGroup."""
    numbers = {key: address for key, address in members.items() if key != "TransformType"}
    # ITK 4 left out a letter
    parameters = next((numbers[key] for key in ("TransformParameters", "TranformParameters") if key in numbers), None)
    fixed = next((numbers[key] for key in ("TransformFixedParameters", "TranformFixedParameters") if key in numbers), None)
    return TransformPart(_text(data, members["TransformType"]), _numbers(data, parameters), _numbers(data, fixed))


def _described(data: bytes, address: int, kind: int) -> tuple[dict[int, bytes], int, int]:
    """What is said of a dataset whose elements are of this class: its messages, and number and size of its elements."""
    found = dict(messages(data, address))
    datatype = found[DATATYPE]
    if datatype[0] & 15 != kind:
        raise DamagedError
    return found, count_of(found[DATASPACE]), struct.unpack_from("<I", datatype, 4)[0]


def _numbers(data: bytes, address: int | None) -> tuple[float, ...]:
    if address is None:
        return ()
    found, count, size = _described(data, address, _FLOAT)
    if count > MOST_NUMBERS:
        return ()  # no linear transform, so nobody will ask for them
    if size not in (4, 8) or found[DATATYPE][1] & 1:
        raise DamagedError  # another type or byte order
    return tuple(np.frombuffer(elements(data, found, count, size), f"<f{size}").astype(np.float64).tolist())


def _text(data: bytes, address: int) -> str:
    """One string, in the global heap."""
    found, count, size = _described(data, address, _TEXT)
    if (count, size) != (1, 16):
        raise DamagedError
    length, heap, wanted = struct.unpack("<IQI", elements(data, found, count, size))
    head = piece(data, heap, 16)
    size = int.from_bytes(head[8:], "little")
    if head[:5] != b"GCOL\x01":
        raise DamagedError
    place, stop = heap + 16, heap + size
    for _ in range(MOST_TEXTS):
        if place + 16 > stop:
            break
        index, _, _, bytes_there = struct.unpack("<HHIQ", piece(data, place, 16))
        if index == wanted and index:
            if bytes_there < length:
                raise DamagedError
            return piece(data, place + 16, length).split(b"\0")[0].decode("utf-8", "replace")
        if index == 0:
            break
        place += 16 + (bytes_there + 7) // 8 * 8
    raise DamagedError

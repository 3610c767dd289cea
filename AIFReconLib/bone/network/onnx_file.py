"""What an ONNX file holds, as far as has to be known before anything opens it: whether all of it is in the file."""

from __future__ import annotations

from collections.abc import Iterator

MOST_NESTED = 100

_MODEL, _GRAPH, _NODE, _ATTRIBUTE, _TENSOR, _SPARSE, _FUNCTION, _TRAINING = range(8)

_FIELDS_OF = {
    _MODEL: {7: _GRAPH, 20: _TRAINING, 25: _FUNCTION},
    _GRAPH: {1: _NODE, 5: _TENSOR, 15: _SPARSE},
    _NODE: {5: _ATTRIBUTE},
    _ATTRIBUTE: {5: _TENSOR, 6: _GRAPH, 10: _TENSOR, 11: _GRAPH, 22: _SPARSE, 23: _SPARSE},
    _TENSOR: {},
    _SPARSE: {1: _TENSOR, 2: _TENSOR},
    _FUNCTION: {7: _NODE, 11: _ATTRIBUTE},
    _TRAINING: {1: _GRAPH, 2: _GRAPH},
}
"""Which fields of each message hold which: all through which a tensor can be reached (onnx.proto)."""

_GRAPH_OF_MODEL, _EXTERNAL_DATA, _DATA_LOCATION = 7, 13, 14
_VARINT, _EIGHT_BYTES, _LENGTH, _FOUR_BYTES = 0, 1, 2, 5


class _Damaged(ValueError):
    """Bytes that are no message of the kind."""


def why_not_self_contained(data: bytes) -> str | None:
    """Why a file is no ONNX model that has all of its data within; None when it is one."""
    try:
        model = list(_fields(memoryview(data)))
        if not any(number == _GRAPH_OF_MODEL for number, *_ in model):
            raise _Damaged
        if _names_other_files(memoryview(data), _MODEL, 0):
            return "the model takes data from other files, which are not opened. Export it as one file."
    except _Damaged:
        return "this is no ONNX model. Export the network as ONNX."
    return None


def _names_other_files(data: memoryview, kind: int, depth: int) -> bool:
    if depth > MOST_NESTED:
        raise _Damaged
    for number, wire, value in _fields(data):
        if kind == _TENSOR and (number == _EXTERNAL_DATA or (number == _DATA_LOCATION and value != 0)):
            return True
        message = _FIELDS_OF[kind].get(number)
        if message is None:
            continue
        if wire != _LENGTH or not isinstance(value, memoryview):
            raise _Damaged
        if _names_other_files(value, message, depth + 1):
            return True
    return False


def _fields(data: memoryview) -> Iterator[tuple[int, int, int | memoryview]]:
    """Number, wire type and value of every field of a message (Protocol Buffers encoding)."""
    at = 0
    while at < len(data):
        key, at = _varint(data, at)
        number, wire = key >> 3, key & 7
        value: int | memoryview
        if wire == _VARINT:
            value, at = _varint(data, at)
        else:
            if wire == _LENGTH:
                length, at = _varint(data, at)
            elif wire in (_EIGHT_BYTES, _FOUR_BYTES):
                length = 8 if wire == _EIGHT_BYTES else 4
            else:
                raise _Damaged
            value, at = data[at : at + length], at + length
            if at > len(data):
                raise _Damaged
        if number == 0:
            raise _Damaged
        yield number, wire, value


def _varint(data: memoryview, at: int) -> tuple[int, int]:
    value = 0
    for shift in range(0, 70, 7):
        if at >= len(data):
            raise _Damaged
        byte = data[at]
        at += 1
        value |= (byte & 127) << shift
        if byte < 128:
            return value, at
    raise _Damaged

"""A Plus configuration with another calibration, and every other byte as it was."""

from __future__ import annotations

import re
from pathlib import Path
from xml.parsers import expat

from ...arrays import Matrix
from ...errors import ConfigurationError
from ...geometry.transform_graph import TransformName, capitalized
from ..disk.atomic import atomic_output
from ..disk.small_files import read_bytes
from .configuration import read_plus_configuration

_MATRIX = re.compile(rb"""(\bMatrix\s*=\s*)(["'])(.*?)\2""", re.DOTALL)
_LAST = b"</CoordinateDefinitions>"


def write_calibrated(configuration: Path, output: Path, name: TransformName, matrix: Matrix, note: str) -> None:
    """Write a configuration in which the transform `name` has another matrix; the old one stays beside it in a comment with the note.

    A transform that the configuration does not hold yet becomes the last of CoordinateDefinitions.

    Raises ConfigurationError when the configuration does not hold it exactly so, OutputError when it cannot be written.
    """
    known = read_plus_configuration(configuration).transforms
    data = read_bytes(configuration, None, ConfigurationError)
    if name not in known and name.inverse not in known and data.count(_LAST) == 1:
        _write_added(configuration, data, output, name, matrix, note)
        return
    start, stop = _element(configuration, data, name)
    found = _MATRIX.search(data, start, stop)
    if found is None:
        raise ConfigurationError(f"{configuration}: the transform {name} has no Matrix to replace. Write a .tfm instead.")
    # Two hyphens would end a comment
    old = f"{name} before ({note}): {' '.join(found[3].decode('ascii', 'replace').split())}".replace("--", "- -")
    comment = f"<!-- {old} -->"
    written = data[: found.start(3)] + _rows(matrix) + data[found.end(3) : stop] + comment.encode("ascii", "replace")
    with atomic_output(output) as temporary:
        temporary.write_bytes(written + data[stop:])


def _write_added(configuration: Path, data: bytes, output: Path, name: TransformName, matrix: Matrix, note: str) -> None:
    comment = f"<!-- {name} is new ({note.replace('--', '- -')}) -->".encode("ascii", "replace")
    element = f'  <Transform From="{name.source}" To="{name.target}" Matrix="'.encode() + _rows(matrix) + b'" />'
    with atomic_output(output) as temporary:
        temporary.write_bytes(data.replace(_LAST, element + comment + b"\n  " + _LAST))
        if name not in read_plus_configuration(temporary).transforms:
            raise ConfigurationError(f"{configuration}: it has no CoordinateDefinitions to which {name} could be added. Add that element.")


def _rows(matrix: Matrix) -> bytes:
    """A matrix as an attribute holds it, a line a row."""
    return "".join("\n        " + " ".join(f"{value:.9g}" for value in row) for row in matrix.tolist()).encode("ascii")


def _element(path: Path, data: bytes, name: TransformName) -> tuple[int, int]:
    """From which to which byte the element of a transform goes, its end tag included."""
    spans: list[tuple[int, int]] = []
    stack: list[tuple[str, int, bool]] = []
    parser = expat.ParserCreate()

    def begin(tag: str, attributes: dict[str, str]) -> None:
        inside = [one[0] for one in stack] == ["PlusConfiguration", "CoordinateDefinitions"] and tag == "Transform"
        own = inside and capitalized(TransformName(attributes.get("From", ""), attributes.get("To", ""))) == name
        stack.append((tag, parser.CurrentByteIndex, own))

    def end(_tag: str) -> None:
        _, first, own = stack.pop()
        if own:
            # Of an empty element both events stand at its beginning
            last = parser.CurrentByteIndex
            spans.append((first, data.index(b">", _after_attributes(data, max(first, last))) + 1))

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.Parse(data, True)
    if len(spans) != 1:
        raise ConfigurationError(f"{path}: it does not hold {name} in CoordinateDefinitions. Write a .tfm instead.")
    return spans[0]


def _after_attributes(data: bytes, first: int) -> int:
    """Where a tag that begins at `first` can end: behind its last quoted value."""
    place, quote = first, b""
    while place < len(data):
        letter = data[place : place + 1]
        if quote:
            quote = b"" if letter == quote else quote
        elif letter in (b'"', b"'"):
            quote = letter
        elif letter == b">":
            return place
        place += 1
    return first

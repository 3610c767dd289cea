"""A Plus configuration with another calibration, and every other byte as it was."""

from __future__ import annotations

import re
from pathlib import Path

from ...arrays import Matrix
from ...errors import ConfigurationError
from ...geometry.transform_graph import TransformName, capitalized
from ..disk.atomic import atomic_output
from ..disk.small_files import read_bytes
from .configuration import read_plus_configuration

_TAGS = re.compile(rb"""<!--.*?-->|<!\[CDATA\[.*?\]\]>|</?(Transform|CoordinateDefinitions)\b(?:"[^"]*"|'[^']*'|[^"'>])*>""", re.DOTALL)
_ERROR = re.compile(rb"""\s\bError\s*=\s*(["']).*?\1""", re.DOTALL)
_MATRIX = re.compile(rb"""(\bMatrix\s*=\s*)(["'])(.*?)\2""", re.DOTALL)


def write_calibrated(configuration: Path, output: Path, name: TransformName, matrix: Matrix, note: str) -> None:
    """Write a configuration in which the transform `name` has another matrix; the old one stays beside it in a comment with the note.

    A transform that the configuration does not hold yet becomes the last of CoordinateDefinitions.

    Raises ConfigurationError when the configuration does not hold it exactly so, OutputError when it cannot be written.
    """
    known = read_plus_configuration(configuration).transforms
    data = read_bytes(configuration, None, ConfigurationError)
    rows = "".join("\n        " + " ".join(f"{value:.9g}" for value in row) for row in matrix.tolist()).encode("ascii")
    tags = [tag for tag in _TAGS.finditer(data) if tag[1]]
    begin, end = (next((tag.start() for tag in tags if tag[0].startswith(mark)), -1) for mark in (b"<Coord", b"</Coord"))
    if end < begin or begin < 0:
        raise ConfigurationError(f"{configuration}: it has no CoordinateDefinitions that could hold {name}. Add that element.")
    if name not in known and name.inverse not in known:
        element = f'  <Transform From="{name.source}" To="{name.target}" Matrix="'.encode() + rows + b'" />'
        written = data[:end] + element + _comment(f"{name} is new ({note})") + b"\n  " + data[end:]
    else:
        found = [tag for tag in tags if begin < tag.start() < end and _is_of(tag[0], name)]
        old = _MATRIX.search(data, found[0].start(), found[0].end()) if len(found) == 1 else None
        if old is None:
            raise ConfigurationError(f"{configuration}: it does not hold {name} in CoordinateDefinitions. Write a .tfm instead.")
        # What the file said of the old one's error does not hold for the new one
        data = data[: found[0].start()] + _ERROR.sub(lambda match: b" " * len(match[0]), found[0][0]) + data[found[0].end() :]
        stop = found[0].end()
        comment = _comment(f"{name} before ({note}): {' '.join(old[3].decode('ascii', 'replace').split())}")
        written = data[: old.start(3)] + rows + data[old.end(3) : stop] + comment + data[stop:]
    with atomic_output(output) as temporary:
        temporary.write_bytes(written)
        if name not in read_plus_configuration(temporary).transforms:
            raise ConfigurationError(f"{configuration}: {name} cannot be put into it. Write a .tfm instead.")


def _comment(text: str) -> bytes:
    # Two hyphens would end a comment
    return f"<!-- {text.replace('--', '- -')} -->".encode("ascii", "replace")


def _is_of(tag: bytes, name: TransformName) -> bool:
    """Whether this is the tag of that transform."""
    ends = {key: text.decode("utf-8", "replace") for key, text in re.findall(rb"""\b(From|To)\s*=\s*["']\s*(.*?)\s*["']""", tag)}
    return capitalized(TransformName(ends.get(b"From", ""), ends.get(b"To", ""))) == name

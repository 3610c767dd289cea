"""The lines of a MetaImage or NRRD header, what differs between the two formats, and the rules that both share."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from ...arrays import NumberType
from ...errors import FileFormatError
from ...message import shorten

FORMATS: dict[str, Any] = json.loads(Path(__file__).with_name("formats.json").read_text("utf-8"))
"""Types, keys and the header of a sequence, as each format spells them."""

RAW = "raw"
COMPRESSED = "compressed"
"""Either zlib or gzip: decoders tell them apart."""

MAXIMUM_LINE = 2**20
"""Bytes. A line of a header holds a matrix or a note; a file without line ends is no header."""


class HeaderLines:
    """The lines of a header, one at a time, with a limit on their length."""

    def __init__(self, file: BinaryIO, path: Path, error: type[FileFormatError]):
        self.file = file
        self.path = path
        self.error = error

    def failure(self, problem: str, advice: str = "") -> FileFormatError:
        """The error to raise for this header."""
        return self.error(f"{self.path}: {problem}", advice)

    def next(self) -> str | None:
        """The next line without its end; None at the end of the file."""
        line = self.file.readline(MAXIMUM_LINE + 1)
        if len(line) > MAXIMUM_LINE or b"\0" in line:
            raise self.failure("this is not a text header. Give a MetaImage or NRRD file.")
        return line.rstrip(b"\r\n").decode("utf-8", errors="surrogateescape") if line else None


Pixels = tuple[NumberType, str, int, "int | None"]
"""What a header says of the pixels in the way of its format: type, encoding, channels, and bytes of compressed ones where it says that."""


@dataclass(frozen=True)
class Format:
    """MetaImage or NRRD: what it calls what both have, and how it says the rest.

    Parameters
    ----------
    suffixes : tuple of str
    dimension, size, kinds, data_file, skip : str
        Its keys.
    most_dimensions : int
    read : callable of HeaderLines
        Entries that the format defines, and all other fields, up to the end of the header.
    pixels : callable of HeaderLines and these entries
    """

    suffixes: tuple[str, ...]
    dimension: str
    size: str
    kinds: str
    data_file: str
    skip: str
    most_dimensions: int
    read: Callable[[HeaderLines], tuple[dict[str, str], dict[str, str]]]
    pixels: Callable[[HeaderLines, dict[str, str]], Pixels]


def parse_count(lines: HeaderLines, key: str, text: str, lowest: int, highest: int) -> int:
    """One whole number within limits."""
    if not re.fullmatch(r"[0-9]{1,18}", text) or not lowest <= int(text) <= highest:
        raise lines.failure(f"{key} must be a whole number from {lowest} to {highest}; got {shorten(text)!r}.")
    return int(text)


def require(lines: HeaderLines, entries: Mapping[str, str], key: str) -> str:
    """The value of a header key that must be there."""
    if key not in entries:
        raise lines.failure(f"the header has no {key}. It is damaged, or this is not an image file.")
    return entries[key]


def store(lines: HeaderLines, entries: dict[str, str], key: str, value: str) -> None:
    """Add an entry; two different values under one key leave it open which of them holds."""
    if entries.setdefault(key, value) != value:
        raise lines.failure(f"{key} is given twice, as {shorten(entries[key])!r} and as {shorten(value)!r}. Remove one of the two lines.")

"""The lines of a MetaImage or NRRD header, and the rules that both formats share.

Everything that a header can get wrong is found here, before anyone allocates memory for what it promises.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import BinaryIO

from ...arrays import NumberType
from ...errors import FileFormatError
from ...machine.memory import available_memory
from ...message import shorten
from ...remedies import TRANSFORM_SEQUENCES
from ..disk.regular_files import stamp
from .frame_lines import FRAME_KEY, LONG_HEADER, FrameLines
from .metafile import RAW, UNFINISHED, Metafile

TO_THE_END = -1
"""How both formats say that the pixels are the last bytes of a file, whatever comes before."""

MAXIMUM_LINE = 2**20
"""Bytes. A line of a header holds a matrix or a note; a file without line ends is no header."""

_STEP = 2**26
"""Bytes of a header after which it is asked anew whether there is memory for as many again."""

_TIMES_IN_MEMORY = 8
"""Bytes that a byte of fields takes in memory, at most about."""

LARGEST_DEFLATE_RATIO = 1032
"""No deflate stream expands by more, so a header that promises more is wrong whatever the stream holds."""


class HeaderLines:
    """The lines of a header, one at a time, with limits on their length.

    Parameters
    ----------
    file, path, error
    in_memory : bool
        Whether the fields of frames are kept in memory however long the header is.
    """

    def __init__(self, file: BinaryIO, path: Path, error: type[FileFormatError], in_memory: bool = True):
        self._file = file
        self._start = self._asked = 0
        self.position = file.tell()
        """Offset of the first byte behind the lines that were read."""
        self._in_memory = in_memory
        self._lines: FrameLines | None = None
        self.frames: FrameLines | None = None
        self.path = path
        self.error = error

    def failure(self, problem: str, advice: str = "") -> FileFormatError:
        """The error to raise for this header."""
        return self.error(f"{self.path}: {problem}", advice)

    def next(self) -> str | None:
        """The next line without its end; None at the end of the file."""
        line = self._file.readline(MAXIMUM_LINE + 1)
        self._start, self.position = self.position, self.position + len(line)
        if not line:
            return None
        if len(line) > MAXIMUM_LINE or b"\0" in line:
            raise self.failure("this is not a text header. Give a MetaImage or NRRD file.")
        if self._start - self._asked > _STEP:
            self._asked, available = self._start, available_memory()
            if available is not None and available < _TIMES_IN_MEMORY * _STEP:
                raise self.failure(f"there is no memory for a header of more than {self._start} bytes. Free some memory.")
        return line.rstrip(b"\r\n").decode("utf-8", errors="surrogateescape")

    def keep(self, fields: dict[str, str], key: str, value: str, split: Callable[[str], tuple[str, str]]) -> None:
        """Add the field of the last line to the others, as `store` does; that of a frame is left in the file where the header is long.

        Raises OutOfOrder when the header is long, and frames do not follow each other in it.
        """
        match = None if self._in_memory else FRAME_KEY.match(key)
        if match is None:
            store(self, fields, key, value)
            return
        self._lines = self._lines or FrameLines(split)
        self._lines.add(int(match[1]), self._start, self.position)
        if self.frames is None and self.position > LONG_HEADER:
            self.frames = self._lines
            for name in [name for name in fields if FRAME_KEY.match(name)]:
                del fields[name]
        if self.frames is None:
            store(self, fields, key, value)


def build_metafile(
    lines: HeaderLines,
    *,
    size_key: str,
    size: tuple[int, ...],
    channels: int,
    dtype: NumberType,
    kinds: tuple[str, ...],
    encoding: str,
    data_file: str | None,
    stored_length: int | None,
    fields: dict[str, str],
    entries: dict[str, str] | None = None,
    skip: int = 0,
) -> Metafile:
    """The `Metafile` of a parsed header, after checking that the payload is there.

    Its many parameters are what the two formats say in keys of their own.

    Parameters
    ----------
    size_key : str
        What the format calls the size, for messages.
    data_file : str or None
        Name of a detached data file; None when the data follow the header.
    stored_length : int or None
        Length of the compressed data that the header declares, if any.
    skip : int
        Bytes of the data file before the pixels; `TO_THE_END` where the pixels are its last bytes.
    """
    data_path = lines.path if data_file is None else _beside(lines, data_file)
    if not data_path.is_file():
        raise lines.failure(f"data file {data_path.name} is missing. Put it beside the header.")
    status = data_path.stat()
    offset = lines.position if data_file is None else skip
    if skip == TO_THE_END:
        offset = max(status.st_size - math.prod(size) * channels * dtype.itemsize, 0)
    metafile = Metafile(
        lines.path,
        lines.error,
        size,
        channels,
        dtype,
        kinds,
        encoding,
        data_path,
        offset,
        max(status.st_size - offset, 0),
        fields,
        stamp(status),
        entries or {},
        lines.frames,
    )
    _check_length(metafile, size_key, stored_length)
    return metafile


def parse_skip(lines: HeaderLines, key: str, text: str, possible: bool) -> int:
    """How many bytes to skip before the pixels, or `TO_THE_END`; 0 unless that is `possible`: in a raw file of their own."""
    if text == str(TO_THE_END) and possible:
        return TO_THE_END
    if text not in ("", "0") and not possible:
        raise lines.failure(
            f"{key} must be 0 where pixels are compressed or follow the header; got {shorten(text)!r}. Write the file again."
        )
    return parse_count(lines, key, text or "0", 0, 2**62)


def parse_sizes(lines: HeaderLines, key: str, text: str, count: int) -> tuple[int, ...]:
    """The `count` positive whole numbers of a size entry."""
    words = text.split()
    if len(words) != count or not all(re.fullmatch(r"[0-9]{1,12}", word) for word in words):
        raise lines.failure(f"{key} must be {count} whole numbers; got {shorten(text)!r}. The header is damaged.")
    sizes = tuple(int(word) for word in words)
    if min(sizes) < 1:
        raise lines.failure(
            f"{key} must be positive; got {text!r}. The file holds no image: record or export it again; or it is Slicer's sequence "
            "of a transform, which goes with the images.",
            TRANSFORM_SEQUENCES,
        )
    return sizes


def parse_count(lines: HeaderLines, key: str, text: str, lowest: int, highest: int) -> int:
    """One whole number within limits."""
    if not re.fullmatch(r"[0-9]{1,18}", text) or not lowest <= int(text) <= highest:
        raise lines.failure(
            f"{key} must be a whole number from {lowest} to {highest}; got {shorten(text)!r}. Such files are not supported."
        )
    return int(text)


def require(lines: HeaderLines, entries: Mapping[str, str], key: str) -> str:
    """The value of a header key that must be there."""
    if key not in entries:
        raise lines.failure(f"the header has no {key}. It is damaged, or this is not an image file.")
    return entries[key]


def store(lines: HeaderLines | Metafile, entries: dict[str, str], key: str, value: str) -> None:
    """Add an entry; two different values under one key leave it open which of them holds."""
    if entries.setdefault(key, value) != value:
        raise lines.failure(
            f"{key} is given twice, as {shorten(entries[key])!r} and as {shorten(value)!r}. Remove one of the two lines from the header."
        )


def _beside(lines: HeaderLines, name: str) -> Path:
    """The data file `name` in the header's folder. Nothing else is opened because a header says so."""
    if not name or name in (".", "..") or re.search(r"[/\\:\0]", name):
        raise lines.failure(
            f"its data file must lie beside it and be given by its bare name; got {shorten(name)!r}. Move it there and correct the header."
        )
    return lines.path.parent / name


def _check_length(metafile: Metafile, size_key: str, stored_length: int | None) -> None:
    """Compare the length of the payload with what the header promises."""
    size = " ".join(str(n) for n in metafile.size)
    there, needed = metafile.data_length, metafile.pixel_bytes
    if metafile.encoding == RAW:
        if there < needed:
            complete = there // (needed // metafile.size[-1])
            raise metafile.failure(
                f"the pixel data are cut short: {size_key} {size} needs {needed} bytes, there are {there} ({complete} of "
                f"{metafile.size[-1]} frames or slices). Copy the file again, or correct {size_key}."
            )
        if there > needed and UNFINISHED not in metafile.fields:
            raise metafile.failure(
                f"there are {there - needed} bytes more than {size_key} {size} needs ({needed}). Correct {size_key}, or write the file "
                "again."
            )
        return
    if stored_length is not None and there != stored_length:
        what = "are cut short" if there < stored_length else "go on behind their end"
        raise metafile.failure(
            f"the pixel data {what}: CompressedDataSize is {stored_length} bytes, there are {there}. Copy the file again, or write it "
            "again."
        )
    if needed > LARGEST_DEFLATE_RATIO * there + 4096:
        raise metafile.failure(
            f"{size_key} {size} needs {needed} bytes, more than {there} compressed bytes can hold. Copy the file again, or correct "
            f"{size_key}."
        )

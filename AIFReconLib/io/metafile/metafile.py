"""Headers of MetaImage (.mha, .mhd) and NRRD (.nrrd, .nhdr) files: what the pixels are and where their bytes lie.

Everything that a header can get wrong is found here, before anyone allocates memory for what it promises.
"""

from __future__ import annotations

import contextlib
import math
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import BinaryIO

import numpy as np

from ...errors import FileFormatError
from ...message import Message
from .text_values import shorten

RAW = "raw"
COMPRESSED = "compressed"
"""Either zlib or gzip: decoders tell them apart."""

METAIMAGE_SUFFIXES = (".mha", ".mhd")
NRRD_SUFFIXES = (".nrrd", ".nhdr")

TO_THE_END = -1
"""How both formats say that the pixels are the last bytes of a file, whatever comes before."""

MAXIMUM_LINE = 2**20
"""Bytes. A line of a header holds a matrix or a note; a file without line ends is no header."""

MAXIMUM_HEADER = 2**28
"""Bytes. 10,000 frames of ten transforms each take 20 MB."""

UNFINISHED = "RecordingUnfinished"
"""A field of recordings that were cut off by a crash: their pixels may go on behind the frames that the header lists."""

LARGEST_DEFLATE_RATIO = 1032
"""No deflate stream expands by more, so a header that promises more is wrong whatever the stream holds."""


@dataclass(frozen=True, eq=False)
class Metafile:
    """A header that was understood, and its payload, whose length fits as far as that can be told without decoding it.

    Parameters
    ----------
    path : Path
    error : type of FileFormatError
        What to raise for this file.
    size : tuple of int
        Pixels along each axis, fastest first, without the channels.
    channels : int
    dtype : numpy.dtype
        With the file's byte order.
    kinds : tuple of str
        One per entry of `size`, lower case; empty when the header does not say.
    encoding : "raw" or "compressed"
    data_path, data_offset, data_length
        File, first byte and number of bytes of the payload as stored.
    fields : dict of str to str
        What the format itself does not define, by name: custom and per-frame fields.
    entries : dict of str to str
        What the format defines, as written: units of axes, place in space.
    """

    path: Path
    error: type[FileFormatError]
    size: tuple[int, ...]
    channels: int
    dtype: np.dtype
    kinds: tuple[str, ...]
    encoding: str
    data_path: Path
    data_offset: int
    data_length: int
    fields: dict[str, str] = field(repr=False)
    data_stamp: tuple[int, int] = (0, 0)
    entries: dict[str, str] = field(default_factory=dict, repr=False)

    @property
    def pixel_bytes(self) -> int:
        """Bytes of all pixels, decoded."""
        return math.prod(self.size) * self.channels * self.dtype.itemsize

    def failure(self, problem: str, /, **values: object) -> FileFormatError:
        """The error to raise for this file: a sentence with its values, on one line whatever the file holds."""
        return self.error("{path}: {problem}", path=self.path, problem=Message(problem, **values))

    @contextlib.contextmanager
    def open_payload(self) -> Iterator[BinaryIO]:
        """The data file, open for reading, provided that it is still the one whose header was read.

        Raises
        ------
        FileFormatError
            `error`, for every OSError of the block too: a network disk that goes away shows even when the file is closed.
        """
        try:
            file = open(self.data_path, "rb")  # noqa: SIM115 (closed below)
        except OSError as error:
            raise self.failure(
                "data file {file} cannot be read ({reason}). Put it back beside the header.",
                file=self.data_path.name,
                reason=error.strerror,
            ) from error
        try:
            with file:
                self.require_unchanged(file)
                yield file
        except OSError as error:
            raise self.failure("the pixel data cannot be read ({reason}). Copy the file again.", reason=error.strerror) from error

    def require_unchanged(self, file: BinaryIO) -> None:
        """Raise `error` unless the open data file is still as it was when the header was read."""
        if stamp(os.fstat(file.fileno())) != self.data_stamp:
            raise self.failure("data file {file} has changed since it was opened. Read the file again.", file=self.data_path.name)


class HeaderLines:
    """The lines of a header, one at a time, with limits on their length."""

    def __init__(self, file: BinaryIO, path: Path, error: type[FileFormatError]):
        self._file = file
        self.path = path
        self.error = error

    def failure(self, problem: str, /, **values: object) -> FileFormatError:
        """The error to raise for this header: a sentence with its values, on one line whatever the file holds."""
        return self.error("{path}: {problem}", path=self.path, problem=Message(problem, **values))

    @property
    def position(self) -> int:
        """Offset of the first byte behind the lines that were read."""
        return self._file.tell()

    def next(self) -> str | None:
        """The next line without its end; None at the end of the file."""
        line = self._file.readline(MAXIMUM_LINE + 1)
        if not line:
            return None
        if len(line) > MAXIMUM_LINE or b"\0" in line:
            raise self.failure("this is not a text header. Give a MetaImage or NRRD file.")
        if self._file.tell() > MAXIMUM_HEADER:
            raise self.failure("the header is longer than {maximum} bytes. Give a MetaImage or NRRD file.", maximum=MAXIMUM_HEADER)
        return line.rstrip(b"\r\n").decode("utf-8", errors="surrogateescape")


def read_metafile(path: str | Path, error: type[FileFormatError]) -> Metafile:
    """The header of a MetaImage or NRRD file, by its suffix.

    Parameters
    ----------
    path : str or Path
    error : type of FileFormatError
        What to raise when the file cannot be used.
    """
    from .metaimage import parse_metaimage
    from .nrrd import parse_nrrd

    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in METAIMAGE_SUFFIXES + NRRD_SUFFIXES:
        raise error(
            "{path}: its suffix must be one of {suffixes}. Give a MetaImage or NRRD file; aifrecon import makes one of pictures, DICOM "
            "or video.",
            path=path,
            suffixes=", ".join(METAIMAGE_SUFFIXES + NRRD_SUFFIXES),
        )
    require_regular_file(path, error)
    try:
        with open(path, "rb") as file:
            return (parse_metaimage if suffix in METAIMAGE_SUFFIXES else parse_nrrd)(HeaderLines(file, path, error))
    except OSError as cause:
        raise error("{path}: the file cannot be read ({reason}). Check its permissions.", path=path, reason=cause.strerror) from cause


def data_files(path: Path) -> list[Path]:
    """Where a header keeps its data beside itself, resolved; nothing for files that hold their own or cannot be understood."""
    if path.suffix.lower() not in (*METAIMAGE_SUFFIXES, *NRRD_SUFFIXES):
        return []
    try:
        return [Path(os.path.realpath(read_metafile(path, FileFormatError).data_path))]
    except FileFormatError:
        return []


def require_regular_file(path: Path, error: type[FileFormatError]) -> None:
    """Raise `error` unless `path` is a file: reading a pipe would wait forever."""
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError, ValueError):
        raise error("{path}: there is no such file. Check the path.", path=path) from None
    except OSError as cause:
        raise error("{path}: the file cannot be read ({reason}). Check the path.", path=path, reason=cause.strerror) from cause
    if S_ISDIR(mode):
        raise error("{path}: this is a folder. Give the name of a file.", path=path)
    if not S_ISREG(mode):
        raise error("{path}: this is not a regular file. Give the name of a file.", path=path)


def build_metafile(
    lines: HeaderLines,
    *,
    size_key: str,
    size: tuple[int, ...],
    channels: int,
    dtype: np.dtype,
    kinds: tuple[str, ...],
    encoding: str,
    data_file: str | None,
    stored_length: int | None,
    fields: dict[str, str],
    entries: dict[str, str] | None = None,
    skip: int = 0,
) -> Metafile:
    """The `Metafile` of a parsed header, after checking that the payload is there.

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
        raise lines.failure("data file {file} is missing. Put it beside the header.", file=data_path.name)
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
    )
    _check_length(metafile, size_key, stored_length)
    return metafile


def parse_skip(lines: HeaderLines, key: str, text: str, possible: bool) -> int:
    """How many bytes to skip before the pixels, or `TO_THE_END`; 0 unless that is `possible`: in a raw file of their own."""
    if text == str(TO_THE_END) and possible:
        return TO_THE_END
    if text not in ("", "0") and not possible:
        raise lines.failure(
            "{key} must be 0 where pixels are compressed or follow the header; got {text!r}. Write the file again.",
            key=key,
            text=shorten(text),
        )
    return parse_count(lines, key, text or "0", 0, 2**62)


def parse_sizes(lines: HeaderLines, key: str, text: str, count: int) -> tuple[int, ...]:
    """The `count` positive whole numbers of a size entry."""
    words = text.split()
    if len(words) != count or not all(re.fullmatch(r"[0-9]{1,12}", word) for word in words):
        raise lines.failure(
            "{key} must be {count} whole numbers; got {text!r}. The header is damaged.", key=key, count=count, text=shorten(text)
        )
    sizes = tuple(int(word) for word in words)
    if min(sizes) < 1:
        raise lines.failure(
            "{key} must be positive; got {text!r}. The file holds no image: record or export it again, or, "
            "if it is Slicer's sequence of a transform, give it with the images as --transform-sequence NAME=FILE.",
            key=key,
            text=text,
        )
    return sizes


def parse_count(lines: HeaderLines, key: str, text: str, lowest: int, highest: int) -> int:
    """One whole number within limits."""
    if not re.fullmatch(r"[0-9]{1,18}", text) or not lowest <= int(text) <= highest:
        raise lines.failure(
            "{key} must be a whole number from {lowest} to {highest}; got {text!r}. Such files are not supported.",
            key=key,
            lowest=lowest,
            highest=highest,
            text=shorten(text),
        )
    return int(text)


def require(lines: HeaderLines, entries: Mapping[str, str], key: str) -> str:
    """The value of a header key that must be there."""
    if key not in entries:
        raise lines.failure("the header has no {key}. It is damaged, or this is not an image file.", key=key)
    return entries[key]


def store(lines: HeaderLines, entries: dict[str, str], key: str, value: str) -> None:
    """Add an entry; two different values under one key leave it open which of them holds."""
    if entries.setdefault(key, value) != value:
        raise lines.failure(
            "{key} is given twice, as {first!r} and as {second!r}. Remove one of the two lines from the header.",
            key=key,
            first=shorten(entries[key]),
            second=shorten(value),
        )


def file_stamp(path: Path) -> tuple[int, int] | None:
    """`stamp` of the file at `path`; None where there is none."""
    try:
        return stamp(path.stat())
    except OSError:
        return None


def stamp(status: os.stat_result) -> tuple[int, int]:
    """Size and time of a file, which tell whether it is still the same."""
    return status.st_size, status.st_mtime_ns


def _beside(lines: HeaderLines, name: str) -> Path:
    """The data file `name` in the header's folder. Nothing else is opened because a header says so."""
    if not name or name in (".", "..") or re.search(r"[/\\:\0]", name):
        raise lines.failure(
            "its data file must lie beside it and be given by its bare name; got {file!r}. Move it there and correct the header.",
            file=shorten(name),
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
                "the pixel data are cut short: {size_key} {size} needs {needed} bytes, there are {there} "
                "({complete} of {total} frames or slices). Copy the file again, or correct {size_key}.",
                size_key=size_key,
                size=size,
                needed=needed,
                there=there,
                complete=complete,
                total=metafile.size[-1],
            )
        if there > needed and UNFINISHED not in metafile.fields:
            raise metafile.failure(
                "there are {excess} bytes more than {size_key} {size} needs ({needed}). Correct {size_key}, or write the file again.",
                excess=there - needed,
                size_key=size_key,
                size=size,
                needed=needed,
            )
        return
    if stored_length is not None and there != stored_length:
        what = Message("are cut short") if there < stored_length else Message("go on behind their end")
        raise metafile.failure(
            "the pixel data {what}: CompressedDataSize is {stored} bytes, there are {there}. Copy the file again, or write it again.",
            what=what,
            stored=stored_length,
            there=there,
        )
    if needed > LARGEST_DEFLATE_RATIO * there + 4096:
        raise metafile.failure(
            "{size_key} {size} needs {needed} bytes, more than {there} compressed bytes can hold. Copy the file again, "
            "or correct {size_key}.",
            size_key=size_key,
            size=size,
            needed=needed,
            there=there,
        )

"""A MetaImage or NRRD file is opened by its suffix.

Everything that a header can get wrong is found here, before anyone allocates memory for what it promises.
"""

from __future__ import annotations

import contextlib
import math
import os
import re
from collections.abc import Iterator
from pathlib import Path

from ...errors import FileFormatError
from ...message import shorten
from ...remedies import TRANSFORM_SEQUENCES
from ..disk.regular_files import file_stamp, reading, stamp
from .header import RAW, Format, HeaderLines, parse_count, require
from .metafile import UNFINISHED, Metafile
from .metaimage import METAIMAGE
from .nrrd import NRRD

METAIMAGE_SUFFIXES, NRRD_SUFFIXES = METAIMAGE.suffixes, NRRD.suffixes

_TO_THE_END = "-1"
"""How both formats say that the pixels are the last bytes of a file, whatever comes before."""

_CHANNEL_KINDS = re.compile("([234]-)?vector|(rgba?|hsv|xyz|3|4)-color")
"""Kinds that make the first axis the channels of a pixel."""


def format_of(path: Path) -> Format:
    """NRRD by its suffix, else MetaImage."""
    return NRRD if path.suffix.lower() in NRRD.suffixes else METAIMAGE


@contextlib.contextmanager
def opened_header(path: Path, error: type[FileFormatError]) -> Iterator[HeaderLines]:
    """The lines of a file's header, as long as the block runs; an OSError of the block becomes `error`."""
    with reading(error, path), open(path, "rb") as file:
        yield HeaderLines(file, path, error)


def read_metafile(path: str | Path, error: type[FileFormatError]) -> Metafile:
    """The header of a MetaImage file, or by its suffix of an NRRD file.

    Parameters
    ----------
    path : str or Path
    error : type of FileFormatError
        What to raise when the file cannot be used.
    """
    path = Path(path)
    with opened_header(path, error) as lines:
        metafile = _understood(lines, format_of(path))
        # The data were looked up after the header was opened: they belong together if its name still leads to the same file
        if stamp(os.fstat(lines.file.fileno())) != file_stamp(path) and UNFINISHED not in metafile.fields:
            raise metafile.failure("the file changed while it was read. Read it again when it is complete.")
        return metafile


def data_files(path: Path) -> list[Path]:
    """Where a header keeps its data beside itself, resolved; nothing for files that hold their own or cannot be understood."""
    if path.suffix.lower() not in (*METAIMAGE_SUFFIXES, *NRRD_SUFFIXES):
        return []
    try:
        return [Path(os.path.realpath(read_metafile(path, FileFormatError).data_path))]
    except FileFormatError:
        return []


def _understood(lines: HeaderLines, form: Format) -> Metafile:
    """The `Metafile` of a header, after checking that the payload is there."""
    entries, fields = form.read(lines)
    dimensions = parse_count(lines, form.dimension, require(lines, entries, form.dimension), 2, form.most_dimensions)
    size = _sizes(lines, form.size, require(lines, entries, form.size), dimensions)
    dtype, encoding, channels, stored_length = form.pixels(lines, entries)
    kinds = tuple(entries.get(form.kinds, "").lower().split())
    if kinds and len(kinds) != dimensions:
        raise lines.failure(f"{form.kinds} must have {dimensions} words, one for each dimension; got {entries[form.kinds]!r}.")
    if kinds and _CHANNEL_KINDS.fullmatch(kinds[0]):
        channels, size, kinds = size[0], size[1:], kinds[1:]
    data_path = _data_path(lines, form.data_file, entries.get(form.data_file, "LOCAL"))
    skip, may_skip = entries.get(form.skip) or "0", data_path != lines.path and encoding == RAW
    if skip != "0" and not may_skip:
        raise lines.failure(f"{form.skip} must be 0 where pixels are compressed or follow the header; got {shorten(skip)!r}.")
    status = data_path.stat()
    offset = lines.file.tell() if data_path == lines.path else 0
    if skip == _TO_THE_END:
        offset = max(status.st_size - math.prod(size) * channels * dtype.itemsize, 0)
    elif may_skip:
        offset = parse_count(lines, form.skip, skip, 0, 2**62)
    pixels = size, channels, dtype, kinds if not {"???", "none"} & set(kinds) else (), encoding
    place = data_path, offset, max(status.st_size - offset, 0)
    metafile = Metafile(lines.path, lines.error, *pixels, *place, fields, stamp(status), entries)
    _check_length(metafile, form.size, stored_length)
    return metafile


def _sizes(lines: HeaderLines, key: str, text: str, count: int) -> tuple[int, ...]:
    """The `count` positive whole numbers of a size entry."""
    words = text.split()
    if len(words) != count or not all(re.fullmatch(r"[0-9]{1,12}", word) for word in words):
        raise lines.failure(f"{key} must be {count} whole numbers; got {shorten(text)!r}. The header is damaged.")
    sizes = tuple(int(word) for word in words)
    if min(sizes) < 1:
        told = "The file holds no image: export it again; or it is Slicer's sequence of a transform, which goes with the images."
        raise lines.failure(f"{key} must be positive; got {text!r}. {told}", TRANSFORM_SEQUENCES)
    return sizes


def _data_path(lines: HeaderLines, key: str, text: str) -> Path:
    """The file of the pixels: the header's own, or one in its folder. Nothing else is opened because a header says so."""
    if text.upper() == "LOCAL":
        return lines.path
    if text.split()[:1] == ["LIST"] or "%" in text:
        raise lines.failure(f"{key} must be one file; got {text!r}. Lists of files are not supported: write it again as one file.")
    name = text.removeprefix("./")
    if not name or name in (".", "..") or re.search(r"[/\\:\0]", name):
        raise lines.failure(f"its data file must lie beside it and be given by its bare name; got {shorten(name)!r}. Move it there.")
    if not (lines.path.parent / name).is_file():
        raise lines.failure(f"data file {name} is missing. Put it beside the header.")
    return lines.path.parent / name


def _check_length(metafile: Metafile, size_key: str, stored_length: int | None) -> None:
    """Compare the length of the payload with what the header promises."""
    there, needed = metafile.data_length, metafile.pixel_bytes
    size = f"{size_key} {' '.join(str(n) for n in metafile.size)} needs {needed} bytes"
    if metafile.encoding == RAW and there < needed:
        whole = f"{there // (needed // metafile.size[-1])} of {metafile.size[-1]} frames or slices"
        raise metafile.failure(f"the pixel data are cut short: {size}, there are {there} ({whole}). Copy the file again.")
    if metafile.encoding == RAW and there > needed and UNFINISHED not in metafile.fields:
        raise metafile.failure(f"{size}, there are {there - needed} bytes more. Correct {size_key}, or write the file again.")
    if metafile.encoding != RAW and stored_length not in (None, there):
        what = "are cut short" if there < (stored_length or 0) else "go on behind their end"
        raise metafile.failure(f"the pixel data {what}: CompressedDataSize is {stored_length} bytes, there are {there}. Copy it again.")

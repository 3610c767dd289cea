"""Writing tracked sequences so that Plus, Slicer, SimpleITK and this library read them back."""

from __future__ import annotations

import contextlib
import zlib
from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ...errors import OutputError, SettingsError
from ...imaging.images import ImageStack
from ...message import shorten
from ...progress import Progress, report
from ...sweep.frames import TrackedSequence
from ..disk.atomic import atomic_outputs
from ..metafile.header import MAXIMUM_LINE
from ..metafile.metaimage import ELEMENT_TYPES, FORMAT_KEYS, check_pair_name
from ..metafile.nrrd import TYPES, escape
from .fields import IMAGE_STATUS, IMAGE_STATUS_IN_NRRD, frame_entries, header_entries
from .orientation import BRIGHTNESS, IN_MEMORY, is_image_key

SUFFIXES = (".mha", ".mhd", ".nrrd")

_COMPRESSION_LEVEL = 4
"""Speckle compresses hardly better at higher levels, which take several times as long."""

_ELEMENT_TYPE_OF = {code: name for name, code in reversed(ELEMENT_TYPES.items())}
_NRRD_TYPE_OF = {code: name for name, code in reversed(TYPES.items())}

_SIZE, _SIZE_DIGITS = "CompressedDataSize = ", 20
"""Its places are kept free, for it is known last and written first."""

Entries = Iterable[tuple[str, str]]


def write_sequence(sequence: TrackedSequence, path: str | Path, compress: bool = True, progress: Progress | None = None) -> None:
    """Write a sequence to a file, completely or not at all.

    Parameters
    ----------
    sequence : TrackedSequence
        Its images are read and written one at a time. Its configuration is not part of the file.
    path : str or Path
        .mha, .nrrd, or .mhd, which gets a .raw or .zraw file beside it.
    compress : bool
    progress : Progress or None

    Raises
    ------
    OutputError
        When it cannot be written.
    SettingsError
        When a field cannot be put into a header, or the images are of a type that files do not have.
    OperationCanceled
        When `progress` asks to stop.

    Notes
    -----
    Images are written in MF orientation as gray levels. Fields are kept without white space around them, statuses as the words
    of `TransformStatus`, and numbers with every digit they need to read back equal.
    """
    path = Path(path)
    check_sequence_name(path)
    suffix = path.suffix.lower()
    code, is_nrrd = _pixel_code(sequence.images), suffix == ".nrrd"
    # One at a time: there may be a million
    entries = chain(
        checked(header_entries(sequence.fields, sequence.transforms), reserved=not is_nrrd),
        checked(frame_entries(sequence.records, IMAGE_STATUS_IN_NRRD if is_nrrd else IMAGE_STATUS)),
    )
    beside = [path.with_suffix(".zraw" if compress else ".raw")] if suffix == ".mhd" else []
    encoder = zlib.compressobj(_COMPRESSION_LEVEL, wbits=zlib.MAX_WBITS + 16 * is_nrrd) if compress else None
    with contextlib.ExitStack() as stack:
        *data, header = (stack.enter_context(open(each, "wb")) for each in stack.enter_context(atomic_outputs(*beside, path)))
        pixels = data[0] if data else header
        names = "LOCAL" if pixels is header else Path(pixels.name).name
        lines = _nrrd_lines(sequence, code, entries, compress) if is_nrrd else _metaimage_lines(sequence, code, entries, compress, names)
        place = _write_lines(header, lines)
        start = pixels.tell()
        _write_pixels(pixels, sequence.images, code, encoder, lambda fraction: report(progress, fraction, f"Writing {path.name}"))
        length = pixels.tell() - start
        if place:
            header.seek(place)
            header.write(str(length).ljust(_SIZE_DIGITS).encode("ascii"))


def check_sequence_name(path: Path) -> None:
    """Return if a sequence can have this name; to be asked before long work.

    Raises OutputError otherwise.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise OutputError(f"Cannot write {path}: its suffix must be one of {', '.join(SUFFIXES)}. Choose another name.")
    if path.suffix.lower() == ".mhd":
        check_pair_name(path)


def _metaimage_lines(sequence: TrackedSequence, code: str, entries: Entries, compress: bool, data_file: str) -> Iterator[str]:
    columns, rows = sequence.frame_size
    yield "ObjectType = Image"
    yield "NDims = 3"
    yield "AnatomicalOrientation = RAI"
    yield "BinaryData = True"
    yield "BinaryDataByteOrderMSB = False"
    yield "CenterOfRotation = 0 0 0"
    yield f"CompressedData = {compress}"
    if compress:
        yield _SIZE + " " * _SIZE_DIGITS
    yield f"DimSize = {columns} {rows} {len(sequence)}"
    yield "Kinds = domain domain list"
    yield "ElementNumberOfChannels = 1"
    yield "ElementSpacing = 1 1 1"
    yield f"ElementType = {_ELEMENT_TYPE_OF[code]}"
    yield "Offset = 0 0 0"
    yield "TransformMatrix = 1 0 0 0 1 0 0 0 1"
    yield f"UltrasoundImageOrientation = {IN_MEMORY}"
    yield f"UltrasoundImageType = {BRIGHTNESS}"
    for key, value in entries:
        yield f"{key} = {value}"
    yield f"ElementDataFile = {data_file}"


def _nrrd_lines(sequence: TrackedSequence, code: str, entries: Entries, compress: bool) -> Iterator[str]:
    columns, rows = sequence.frame_size
    yield "NRRD0004"
    yield "# Complete NRRD file format specification at:"
    yield "# http://teem.sourceforge.net/nrrd/format.html"
    yield "dimension: 3"
    yield f"encoding: {'gzip' if compress else 'raw'}"
    yield "endian: little"
    yield "kinds: domain domain list"
    yield f"sizes: {columns} {rows} {len(sequence)}"
    yield "space dimension: 2"
    yield "space directions: (1,0) (0,1) none"
    yield "space origin: (0,0)"
    yield f"type: {_NRRD_TYPE_OF[code]}"
    yield f"ultrasound image orientation:={IN_MEMORY}"
    yield f"ultrasound image type:={BRIGHTNESS}"
    for key, value in entries:
        yield f"{escape(key)}:={escape(value)}"
    yield ""


def _write_lines(file: BinaryIO, lines: Iterable[str]) -> int:
    """Write the lines; the answer is where the size of compressed data can be put in later, 0 where it need not be said."""
    place = 0
    for line in lines:
        if line.startswith(_SIZE):
            place = file.tell() + len(_SIZE)
        file.write(line.encode("utf-8", errors="surrogateescape") + b"\n")
    return place


def _write_pixels(file: BinaryIO, images: ImageStack, code: str, encoder: zlib._Compress | None, tell: Callable[[float], None]) -> None:
    shape = tuple(images.shape[1:])
    tell(0.0)
    for index in range(len(images)):
        image = np.asarray(images[index])
        if image.shape != shape:
            raise SettingsError(f"Input image of frame {index} must have shape {shape}; got {image.shape}.")
        data = np.ascontiguousarray(image, dtype=np.dtype("<" + code)).data
        file.write(data if encoder is None else encoder.compress(data))
        tell((index + 1) / len(images))
    if encoder is not None:
        file.write(encoder.flush())


def _pixel_code(images: ImageStack) -> str:
    """Kind and size of the pixel type, as in ``u1``; checks that the stack has frames at all."""
    if len(images.shape) != 3 or min(images.shape) < 1:
        raise SettingsError(f"Input images must have shape (frames, rows, columns), none of them 0; got {tuple(images.shape)}.")
    dtype = np.dtype(images.dtype)
    code = "u1" if dtype.kind == "b" else f"{dtype.kind}{dtype.itemsize}"
    if code not in _NRRD_TYPE_OF:
        raise SettingsError(f"Input images must be whole numbers of 8 to 64 bits, float32 or float64; got {dtype}. Convert them.")
    return code


def checked(entries: Entries, reserved: bool = False) -> Iterator[tuple[str, str]]:
    """The entries, after making sure that no name or value can turn into another line of the header."""
    for key, value in entries:
        value = str(value).strip()
        if not key or key != key.strip() or any(c in key for c in "=:#\\") or not _is_one_line(key):
            raise SettingsError(
                f"Input field name must be one line without = : # or a backslash, not empty; got {shorten(key)!r}. Rename the field."
            )
        if (reserved and key in FORMAT_KEYS) or is_image_key(key):
            raise SettingsError(f"Input field name must not be a key of the file format; got {key!r}. Rename the field.")
        if not _is_one_line(value):
            raise SettingsError(
                f"Input field {shorten(key)} must have a value of one short line of text; got {shorten(value)!r}. Change the value."
            )
        yield key, value


def _is_one_line(text: str) -> bool:
    """Whether a header line can hold `text`."""
    try:
        length = len(text.encode("utf-8", errors="surrogateescape"))
    except UnicodeEncodeError:
        return False
    return length < MAXIMUM_LINE // 4 and not any(c in text for c in "\r\n\0")

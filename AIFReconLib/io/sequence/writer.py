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
from ..metafile.header import FORMATS, MAXIMUM_LINE
from ..metafile.metaimage import ELEMENT_TYPES, FORMAT_KEYS, LAST_KEY, check_pair_name
from ..metafile.nrrd import TYPES
from .fields import IMAGE_STATUS, IMAGE_STATUS_IN_NRRD, frame_entries, header_entries
from .orientation import BRIGHTNESS, IN_MEMORY, is_image_key

SUFFIXES = (".mha", ".mhd", ".nrrd")

_COMPRESSION_LEVEL = 4
"""Speckle compresses hardly better at higher levels, which take several times as long."""

_TYPE_OF = {form: {code: name for name, code in reversed(types.items())} for form, types in (("metaimage", ELEMENT_TYPES), ("nrrd", TYPES))}

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
    code, form = _pixel_code(sequence.images), "nrrd" if suffix == ".nrrd" else "metaimage"
    is_nrrd = form == "nrrd"
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
        said = {"type": _TYPE_OF[form][code], "compress": compress, "encoding": "gzip" if compress else "raw"}
        size = _SIZE + " " * _SIZE_DIGITS if compress else ""
        place = 0
        for line in _lines(sequence, form, entries, names, size_line=size, **said):
            place = header.tell() + len(_SIZE) if line.startswith(_SIZE) else place
            header.write(line.encode("utf-8", errors="surrogateescape") + b"\n")
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


def _lines(sequence: TrackedSequence, form: str, entries: Entries, data_file: str, **said: object) -> Iterator[str]:
    """The lines of a header."""
    columns, rows = sequence.frame_size
    said |= {"columns": columns, "rows": rows, "frames": len(sequence), "orientation": IN_MEMORY, "kind": BRIGHTNESS}
    yield from filter(None, (line.format(**said) for line in FORMATS[form]["header"]))
    for key, value in entries:
        # Of what NRRD escapes, only a backslash may be here
        yield f"{key}:={value}".replace("\\", "\\\\") if form == "nrrd" else f"{key} = {value}"
    yield "" if form == "nrrd" else f"{LAST_KEY} = {data_file}"


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
    if code not in _TYPE_OF["nrrd"]:
        raise SettingsError(f"Input images must be whole numbers of 8 to 64 bits, float32 or float64; got {dtype}. Convert them.")
    return code


def checked(entries: Entries, reserved: bool = False) -> Iterator[tuple[str, str]]:
    """The entries, after making sure that no name or value can turn into another line of the header."""
    for key, value in entries:
        value = str(value).strip()
        if not key or key != key.strip() or set(key) & set("=:#\\") or not _is_one_line(key):
            raise SettingsError(f"Input field name must be one line without = : # or a backslash, not empty; got {shorten(key)!r}.")
        if (reserved and key in FORMAT_KEYS) or is_image_key(key):
            raise SettingsError(f"Input field name must not be a key of the file format; got {key!r}. Rename the field.")
        if not _is_one_line(value):
            raise SettingsError(f"Input field {shorten(key)} must have a value of one short line of text; got {shorten(value)!r}.")
        yield key, value


def _is_one_line(text: str) -> bool:
    """Whether a header line can hold `text`."""
    try:
        length = len(text.encode("utf-8", errors="surrogateescape"))
    except UnicodeEncodeError:
        return False
    return length < MAXIMUM_LINE // 4 and not any(c in text for c in "\r\n\0")

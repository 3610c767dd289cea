"""NRRD headers: a magic word, ``field: value`` and ``key:=value`` lines, and an empty line before attached data."""

from __future__ import annotations

import re

import numpy as np

from .header import COMPRESSED, RAW, Format, HeaderLines, Pixels, parse_count, require, store

_TYPE_NAMES = {
    "i1": "int8, int8_t, signed char",
    "u1": "uint8, uint8_t, uchar, unsigned char",
    "i2": "int16, int16_t, short, short int, signed short, signed short int",
    "u2": "uint16, uint16_t, ushort, unsigned short, unsigned short int",
    "i4": "int32, int32_t, int, signed int",
    "u4": "uint32, uint32_t, uint, unsigned int",
    "i8": "int64, int64_t, longlong, long long, long long int, signed long long, signed long long int",
    "u8": "uint64, uint64_t, ulonglong, unsigned long long, unsigned long long int",
    "f4": "float",
    "f8": "double",
}
TYPES = {name: code for code, names in _TYPE_NAMES.items() for name in names.split(", ")}
"""Every spelling of a pixel type in the NRRD definition."""

ENCODINGS = {"raw": RAW, "gzip": COMPRESSED, "gz": COMPRESSED}

_FORMAT_FIELDS = """
dimension, type, encoding, endian, sizes, kinds, block size, content, min, max, old min, old max, data file, line skip, byte skip, number,
spacings, thicknesses, axis mins, axis maxs, centers, centerings, labels, units, sample units, space, space dimension, space units,
space origin, space directions, measurement frame
"""
SPELLINGS = {spelled: name for name in _FORMAT_FIELDS.replace("\n", " ").strip().split(", ") for spelled in (name, name.replace(" ", ""))}
"""Fields that the format defines, which may also be written as one word; every other ``name: value`` is somebody's own, as Plus writes."""

_WRITTEN_TWICE = ("ultrasound image orientation", "ultrasound image type")
"""Plus writes these as key/value pairs, beside the ``name: value`` of the file that it edited: the pair is that of the pixels."""


def unescape(text: str) -> str:
    r"""Key or value as meant: NRRD writes a line feed as ``\n`` and a backslash as ``\\``."""
    return re.sub(r"\\([n\\])", lambda match: "\n" if match[1] == "n" else "\\", text)


def escape(text: str) -> str:
    r"""Key or value as written. Only the backslash needs it here; line feeds are refused before."""
    return text.replace("\\", "\\\\")


def _read(lines: HeaderLines) -> tuple[dict[str, str], dict[str, str]]:
    """Fields are key/value pairs, and lines ``name: value`` of other names than the format's."""
    magic = lines.next() or ""
    if not re.fullmatch(r"NRRD000[1-5]\s*", magic):
        raise lines.failure("this is not an NRRD file: it does not begin with NRRD0001 to NRRD0005. Give a MetaImage or NRRD file.")
    entries: dict[str, str] = {}
    fields: dict[str, str] = {}
    others: dict[str, str] = {}
    while line := lines.next():
        if line.startswith("#"):
            continue
        key, colon, value = line.partition(":")
        if not colon or not key.strip():
            raise lines.failure("this is not an NRRD header: a line is neither 'field: value' nor 'key:=value'. Copy the file again.")
        if value.startswith("="):
            store(lines, fields, unescape(key.strip()), unescape(value[1:]).strip())
        else:
            name = SPELLINGS.get(key.strip().lower(), "")
            store(lines, entries if name else others, name or key.strip(), value.strip())
            if name == "data file" and value.split()[:1] == ["LIST"]:
                break
    if line is None and "data file" not in entries:
        raise lines.failure("the header ends without the empty line before the data: the file is cut short. Copy it again.")
    for key, value in others.items():
        if key not in fields or key not in _WRITTEN_TWICE:
            store(lines, fields, key, value)
    return entries, fields


def _pixels(lines: HeaderLines, entries: dict[str, str]) -> Pixels:
    pixel_type = require(lines, entries, "type").lower()
    if pixel_type not in TYPES:
        raise lines.failure(f"type must be a whole-number or floating-point type; got {pixel_type!r}. Convert the file.")
    code = TYPES[pixel_type]
    endian = entries.get("endian", "little" if code.endswith("1") else "").lower()
    if endian not in ("little", "big"):
        raise lines.failure(f"endian must be little or big; got {endian!r}. Correct the header.")
    encoding = require(lines, entries, "encoding").lower()
    if encoding not in ENCODINGS:
        reason = "ASCII data are not supported" if encoding in ("ascii", "txt", "text") else "no other encoding is supported"
        raise lines.failure(f"encoding must be raw or gzip; got {encoding!r}: {reason}. Write the file again with one of these.")
    parse_count(lines, "line skip", entries.get("line skip", "0"), 0, 0)
    return np.dtype(("<" if endian == "little" else ">") + code), ENCODINGS[encoding], 1, None


NRRD = Format((".nrrd", ".nhdr"), "dimension", "sizes", "kinds", "data file", "byte skip", 5, _read, _pixels)

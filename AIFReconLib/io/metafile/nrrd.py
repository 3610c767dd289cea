"""NRRD headers: a magic word, ``field: value`` and ``key:=value`` lines, and an empty line before attached data."""

from __future__ import annotations

import re

import numpy as np

from .header import COMPRESSED, FORMATS, RAW, Format, HeaderLines, Pixels, parse_count, require, store

TYPES = {name: code for code, names in FORMATS["nrrd"]["types"].items() for name in names.split(", ")}
"""Every spelling of a pixel type in the NRRD definition."""

ENCODINGS = {"raw": RAW, "gzip": COMPRESSED, "gz": COMPRESSED}

SPELLINGS = {spelled: name for name in FORMATS["nrrd"]["fields"].split(", ") for spelled in (name, name.replace(" ", ""))}
"""Fields that the format defines, which may also be written as one word; every other ``name: value`` is somebody's own, as Plus writes."""

_WRITTEN_TWICE = ("ultrasound image orientation", "ultrasound image type")
"""Plus writes these as key/value pairs, beside the ``name: value`` of the file that it edited: the pair is that of the pixels."""


def unescape(text: str) -> str:
    r"""Key or value as meant: NRRD writes a line feed as ``\n`` and a backslash as ``\\``."""
    return re.sub(r"\\([n\\])", lambda match: "\n" if match[1] == "n" else "\\", text)


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
        raise lines.failure(f"encoding must be raw or gzip; got {encoding!r}. Write the file again with one of these.")
    parse_count(lines, "line skip", entries.get("line skip", "0"), 0, 0)
    return np.dtype(("<" if endian == "little" else ">") + code), ENCODINGS[encoding], 1, None


NRRD = Format((".nrrd", ".nhdr"), "dimension", "sizes", "kinds", "data file", "byte skip", 5, _read, _pixels)

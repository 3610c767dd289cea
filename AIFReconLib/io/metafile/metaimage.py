"""MetaImage headers: lines of ``Key = value``, the last of which is ElementDataFile."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...errors import OutputError
from .header import COMPRESSED, FORMATS, RAW, Format, HeaderLines, Pixels, parse_count, require, store
from .metafile import UNFINISHED

ELEMENT_TYPES = FORMATS["metaimage"]["types"]
"""MetaIO keeps MET_LONG at 4 bytes on every system."""

FORMAT_KEYS = frozenset(FORMATS["metaimage"]["keys"].split())
"""Keys that the format defines. They describe the pixels and are written anew with them; every other key is a field."""

LAST_KEY = "ElementDataFile"


def check_pair_name(path: Path) -> None:
    """Return if a header and a data file of this name can be read by others.

    Raises OutputError otherwise.
    """
    if "%" in path.name:
        raise OutputError(f"Cannot write {path}: a percent sign would be read as a pattern of names. Choose another name.")


WHOLE = re.compile(rb"(?s).*^DimSize = [0-9 ]+\n", re.MULTILINE)
"""What is listed behind the header of an unfinished recording, up to the last size: of a frame that was being added there is a part."""


def _read(lines: HeaderLines) -> tuple[dict[str, str], dict[str, str]]:
    entries: dict[str, str] = {}
    fields: dict[str, str] = {}
    for key, value in _keys(lines):
        store(lines, entries if key in FORMAT_KEYS else fields, key, value)
        if key == LAST_KEY:
            break
    else:
        raise lines.failure(f"the header ends without {LAST_KEY}: the file is cut short or is no MetaImage. Copy it again.")
    if UNFINISHED in fields and entries[LAST_KEY].upper() != "LOCAL" and (whole := WHOLE.match(lines.file.read())):
        for key, value in _keys(HeaderLines(io.BytesIO(whole[0]), lines.path, lines.error)):
            if key == "DimSize":
                entries[key] = value
            else:
                store(lines, fields, key, value)
    return entries, fields


def _keys(lines: HeaderLines) -> Iterator[tuple[str, str]]:
    while (line := lines.next()) is not None:
        key, equals, value = (word.strip() for word in line.partition("="))
        if line.strip() and not (key and equals):
            raise lines.failure("this is not a MetaImage header: a line is not 'Key = value'. Give a MetaImage or NRRD file.")
        if key:
            yield key, value


def _pixels(lines: HeaderLines, entries: dict[str, str]) -> Pixels:
    if entries.get("ObjectType", "Image") != "Image":
        raise lines.failure(f"ObjectType must be Image; got {entries['ObjectType']!r}. Give an image file.")
    if not _is_true(lines, entries, "BinaryData", default=True):
        raise lines.failure("BinaryData must be True: ASCII data are not supported. Write the file again as binary.")
    element_type = require(lines, entries, "ElementType")
    if element_type not in ELEMENT_TYPES:
        raise lines.failure(f"ElementType must be one of {', '.join(ELEMENT_TYPES)}; got {element_type!r}. Convert the file.")
    byte_order_key = "ElementByteOrderMSB" if "ElementByteOrderMSB" in entries else "BinaryDataByteOrderMSB"
    byte_order = ">" if _is_true(lines, entries, byte_order_key) else "<"
    compressed = _is_true(lines, entries, "CompressedData")
    # 0 or nothing: a recorder left its place empty
    length = parse_count(lines, "CompressedDataSize", entries.get("CompressedDataSize") or "0", 0, 2**62) if compressed else 0
    channels = parse_count(lines, "ElementNumberOfChannels", entries.get("ElementNumberOfChannels", "1"), 1, 2**16)
    return np.dtype(byte_order + ELEMENT_TYPES[element_type]), COMPRESSED if compressed else RAW, channels, length or None


def _is_true(lines: HeaderLines, entries: dict[str, str], key: str, default: bool = False) -> bool:
    text = entries.get(key) or str(default)
    if text.lower() not in ("true", "t", "1", "false", "f", "0"):
        raise lines.failure(f"{key} must be True or False; got {text!r}. Correct the header.")
    return text.lower() in ("true", "t", "1")


METAIMAGE = Format((".mha", ".mhd"), "NDims", "DimSize", "Kinds", LAST_KEY, "HeaderSize", 4, _read, _pixels)

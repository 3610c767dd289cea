"""MetaImage headers: lines of ``Key = value``, the last of which is ElementDataFile."""

from __future__ import annotations

import numpy as np

from .header import HeaderLines, build_metafile, parse_count, parse_sizes, parse_skip, require
from .metafile import COMPRESSED, RAW, Metafile

ELEMENT_TYPES = {
    "MET_CHAR": "i1",
    "MET_UCHAR": "u1",
    "MET_SHORT": "i2",
    "MET_USHORT": "u2",
    "MET_INT": "i4",
    "MET_UINT": "u4",
    "MET_LONG": "i4",
    "MET_ULONG": "u4",
    "MET_LONG_LONG": "i8",
    "MET_ULONG_LONG": "u8",
    "MET_FLOAT": "f4",
    "MET_DOUBLE": "f8",
}
"""MetaIO keeps MET_LONG at 4 bytes on every system."""

_FORMAT_KEYS = """
ObjectType ObjectSubType NDims AnatomicalOrientation BinaryData BinaryDataByteOrderMSB ElementByteOrderMSB CenterOfRotation
CompressedData CompressedDataSize CompressionLevel DimSize Kinds HeaderSize ElementNumberOfChannels ElementSpacing ElementSize
ElementType ElementMin ElementMax Offset Position Origin TransformMatrix Rotation Orientation ElementDataFile
"""
FORMAT_KEYS = frozenset(_FORMAT_KEYS.split())
"""Keys that the format defines. They describe the pixels and are written anew with them; every other key is a field."""

LAST_KEY = "ElementDataFile"


def parse_metaimage(lines: HeaderLines) -> Metafile:
    """The header and where its payload lies."""
    entries = read_entries(lines)
    if entries.get("ObjectType", "Image") != "Image":
        raise lines.failure(f"ObjectType must be Image; got {entries['ObjectType']!r}. Give an image file.")
    dimensions = parse_count(lines, "NDims", require(lines, entries, "NDims"), 2, 4)
    size = parse_sizes(lines, "DimSize", require(lines, entries, "DimSize"), dimensions)
    if not _is_true(lines, entries, "BinaryData", default=True):
        raise lines.failure("BinaryData must be True: ASCII data are not supported. Write the file again as binary.")
    element_type = require(lines, entries, "ElementType")
    if element_type not in ELEMENT_TYPES:
        raise lines.failure(
            f"ElementType must be one of {', '.join(ELEMENT_TYPES)}; got {element_type!r}. Convert the file to one of them."
        )
    byte_order_key = "ElementByteOrderMSB" if "ElementByteOrderMSB" in entries else "BinaryDataByteOrderMSB"
    byte_order = ">" if _is_true(lines, entries, byte_order_key, default=False) else "<"
    kinds = tuple(entries.get("Kinds", "").lower().split())
    if kinds and len(kinds) != dimensions:
        raise lines.failure(f"Kinds must have {dimensions} words, one for each of NDims; got {entries['Kinds']!r}. Correct the header.")
    compressed = _is_true(lines, entries, "CompressedData", default=False)
    data_file = _data_file(lines, entries[LAST_KEY])
    return build_metafile(
        lines,
        size_key="DimSize",
        size=size,
        channels=parse_count(lines, "ElementNumberOfChannels", entries.get("ElementNumberOfChannels", "1"), 1, 2**16),
        dtype=np.dtype(byte_order + ELEMENT_TYPES[element_type]),
        kinds=kinds,
        encoding=COMPRESSED if compressed else RAW,
        data_file=data_file,
        stored_length=_stored_length(lines, entries) if compressed else None,
        fields={key: value for key, value in entries.items() if key not in FORMAT_KEYS},
        entries={key: value for key, value in entries.items() if key in FORMAT_KEYS},
        skip=parse_skip(lines, "HeaderSize", entries.get("HeaderSize", ""), data_file is not None and not compressed),
    )


def read_entries(lines: HeaderLines) -> dict[str, str]:
    """Every key and value up to ElementDataFile."""
    entries: dict[str, str] = {}
    while (line := lines.next()) is not None:
        if not line.strip():
            continue
        key, value = _split(line)
        if "=" not in line or not key:
            raise lines.failure("this is not a MetaImage header: a line is not 'Key = value'. Give a MetaImage or NRRD file.")
        lines.keep(entries, key, value, _split)
        if key == LAST_KEY:
            return entries
    raise lines.failure(f"the header ends without {LAST_KEY}: the file is cut short or is no MetaImage. Copy it again.")


def _split(line: str) -> tuple[str, str]:
    """Key and value."""
    key, _, value = line.partition("=")
    return key.strip(), value.strip()


def _is_true(lines: HeaderLines, entries: dict[str, str], key: str, default: bool) -> bool:
    text = entries.get(key, "")
    if not text:
        return default
    if text.lower() in ("true", "t", "1"):
        return True
    if text.lower() in ("false", "f", "0"):
        return False
    raise lines.failure(f"{key} must be True or False; got {text!r}. Correct the header.")


def _data_file(lines: HeaderLines, text: str) -> str | None:
    if text.upper() == "LOCAL":
        return None
    if text.split()[:1] == ["LIST"] or "%" in text:
        raise lines.failure(
            f"ElementDataFile must be LOCAL or one file; got {text!r}. Lists of files are not supported: write it again as one file."
        )
    return text


def _stored_length(lines: HeaderLines, entries: dict[str, str]) -> int | None:
    """The declared length of the compressed data; None where a recorder left the place for it empty."""
    text = entries.get("CompressedDataSize", "")
    return parse_count(lines, "CompressedDataSize", text, 0, 2**62) or None if text else None

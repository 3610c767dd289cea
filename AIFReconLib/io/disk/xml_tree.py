"""Parsing XML that may come from anywhere: no document types, no entities, limits on size and depth."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from ...errors import ConfigurationError, FileFormatError
from .small_files import read_bytes

MAXIMUM_BYTES = 16 * 2**20
MAXIMUM_DEPTH = 64


def parse_xml(
    path: Path,
    error: type[FileFormatError] = ConfigurationError,
    wanted: str = "Give a Plus configuration file.",
    most: int = MAXIMUM_BYTES,
    bare_doctype: bool = False,
) -> Element:
    """The root element of an XML file. With `bare_doctype` it may say the name of its document type, and nothing else of it.

    Raises
    ------
    FileFormatError
        The given one, with what is wanted instead, when the file cannot be read, is not well-formed, too large or nested too
        deeply, or declares a document type (that is where entities are defined that grow without bound or fetch other files).
    """
    text = read_bytes(path, most + 1, error)
    if len(text) > most:
        raise error(f"{path}: the file is larger than {most} bytes. {wanted}")

    builder = TreeBuilder()
    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MAXIMUM_DEPTH:
            raise error(f"{path}: elements are nested more than {MAXIMUM_DEPTH} deep. {wanted}")
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    def refuse_doctype(_name: str, *more: object) -> None:
        if any(more) or not bare_doctype:
            raise error(f"{path}: it declares a DOCTYPE, which no such file does. {wanted}")

    parser = expat.ParserCreate()
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = builder.data
    parser.StartDoctypeDeclHandler = refuse_doctype
    try:
        parser.Parse(text, True)
    except expat.ExpatError as cause:
        raise error(f"{path}: this is not well-formed XML ({cause}). Correct it. {wanted}") from cause
    except (LookupError, ValueError) as cause:
        if isinstance(cause, FileFormatError):
            raise
        raise error(f"{path}: its text encoding is not supported ({cause}). Save it as UTF-8.") from cause
    return builder.close()

"""Parsing XML that may come from anywhere: no document types, no entities, limits on size and depth."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from ...errors import ConfigurationError
from ..disk.small_files import read_bytes

MAXIMUM_BYTES = 16 * 2**20
MAXIMUM_DEPTH = 64


def parse_xml(path: Path, bare_doctype: bool = False) -> Element:
    """The root element of an XML file. With `bare_doctype` it may say the name of its document type, and nothing else of it.

    Raises
    ------
    ConfigurationError
        When the file cannot be read, is not well-formed, too large or nested too deeply, or declares a document type (that is
        where entities are defined that grow without bound or fetch other files).
    """
    text = read_bytes(path, MAXIMUM_BYTES + 1, ConfigurationError)
    if len(text) > MAXIMUM_BYTES:
        raise ConfigurationError(f"{path}: the file is larger than {MAXIMUM_BYTES} bytes. Give a Plus configuration file.")

    builder = TreeBuilder()
    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MAXIMUM_DEPTH:
            raise ConfigurationError(f"{path}: elements are nested more than {MAXIMUM_DEPTH} deep. Give a Plus configuration file.")
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    def refuse_doctype(_name: str, *more: object) -> None:
        if any(more) or not bare_doctype:
            raise ConfigurationError(f"{path}: it declares a DOCTYPE, which no configuration of Plus does. Give a Plus configuration file.")

    parser = expat.ParserCreate()
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.StartDoctypeDeclHandler = refuse_doctype
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise ConfigurationError(
            f"{path}: this is not well-formed XML ({error}). Correct it, or give a Plus configuration file."
        ) from error
    except (LookupError, ValueError) as error:
        if isinstance(error, ConfigurationError):
            raise
        raise ConfigurationError(f"{path}: its text encoding is not supported ({error}). Save it as UTF-8.") from error
    return builder.close()

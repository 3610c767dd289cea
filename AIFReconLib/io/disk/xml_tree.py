"""Parsing XML that may come from anywhere: Python's parser fetches nothing, and bounds what entities may become."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, ParseError, XMLParser

from ...errors import ConfigurationError
from .small_files import read_bytes


def parse_xml(path: Path) -> Element:
    """The root element of an XML file.

    Raises
    ------
    ConfigurationError
        When the file cannot be read or is not well-formed.
    """
    parser = XMLParser()
    try:
        parser.feed(read_bytes(path, None, ConfigurationError))
        root: Element = parser.close()
    except ParseError as cause:
        raise ConfigurationError(f"{path}: this is not well-formed XML ({cause}). Correct it, or give another file.") from cause
    except LookupError as cause:
        raise ConfigurationError(f"{path}: its text encoding is not supported ({cause}). Save it as UTF-8.") from cause
    return root

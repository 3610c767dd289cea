"""Parsing XML that may come from anywhere: document types are refused, since entities are defined there."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, ParseError, TreeBuilder, XMLParser

from ...errors import ConfigurationError
from .small_files import read_bytes


class _NoDocumentType(TreeBuilder):
    """Refuses a document that says more of its type than the name, if that."""

    def __init__(self, path: Path, bare: bool):
        super().__init__()
        self._path, self._bare = path, bare

    def doctype(self, name: str, public: str | None, system: str | None) -> None:
        """Called by the parser before anything of the document type is used."""
        if public or system or not self._bare:
            raise ConfigurationError(f"{self._path}: it declares a DOCTYPE, which no such file does. Give a Plus configuration file.")


def parse_xml(path: Path, bare_doctype: bool = False) -> Element:
    """The root element of an XML file. With `bare_doctype` it may say the name of its document type, and nothing else of it.

    Raises
    ------
    ConfigurationError
        When the file cannot be read, is not well-formed, or declares a document type.
    """
    text = read_bytes(path, None, ConfigurationError)
    parser = XMLParser(target=_NoDocumentType(path, bare_doctype))
    try:
        parser.feed(text)
        root: Element = parser.close()
    except ParseError as cause:
        raise ConfigurationError(
            f"{path}: this is not well-formed XML ({cause}). Correct it, or give a Plus configuration file."
        ) from cause
    except (LookupError, ValueError) as cause:
        if isinstance(cause, ConfigurationError):
            raise
        raise ConfigurationError(f"{path}: its text encoding is not supported ({cause}). Save it as UTF-8.") from cause
    return root

"""Paths as SimpleITK takes them."""

from __future__ import annotations

import os
from pathlib import Path

from ...errors import FileFormatError, OutputError


def itk_path(path: Path, error: type[FileFormatError] | type[OutputError]) -> str:
    """The path as UTF-8 text, whatever encoding Python takes file names to be in.

    Raises
    ------
    FileFormatError or OutputError
        When it cannot be said in UTF-8. SimpleITK would end the program at such a name.
    """
    try:
        text = os.fsencode(path).decode("utf-8")
        text.encode("utf-8")
    except UnicodeError:
        raise error("{path}: its name, or that of a folder, is not text in UTF-8. Rename it.", path=path) from None
    return text

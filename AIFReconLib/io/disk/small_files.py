"""Files that are read as a whole, and only if they stay as they are meanwhile."""

from __future__ import annotations

from pathlib import Path

from ...errors import FileFormatError
from .regular_files import unchanged


def read_bytes(path: Path, limit: int | None, error: type[FileFormatError]) -> bytes:
    """The first `limit` bytes of a file, or all; None: all.

    Raises
    ------
    FileFormatError
        The given one, when the file is not there, cannot be read, or changes while it is read.
    """
    with unchanged(error, path), open(path, "rb") as file:
        return file.read(limit)

"""A path that is to be read must be a regular file, and the same one as long as it is being read."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from stat import S_ISREG

from ...errors import FileFormatError


def require_regular_file(path: Path, error: type[FileFormatError]) -> None:
    """Raise `error` unless `path` is a file that may be read: reading a pipe would wait forever.

    It is opened once, so that the guard at the door knows of it: compiled libraries open files without a word to Python.
    """
    with reading(error, path):
        pass


@contextlib.contextmanager
def reading(error: type[FileFormatError], path: Path) -> Iterator[None]:
    """Raise `error` unless `path` is a file that may be read, and for every OSError of the block."""
    try:
        if not S_ISREG(path.stat().st_mode):
            raise error(f"{path}: this is {'a folder' if path.is_dir() else 'not a regular file'}. Give the name of a file.")
        open(path, "rb").close()
        yield
    except (FileNotFoundError, NotADirectoryError):
        raise error(f"{path}: there is no such file. Check the path.") from None
    except OSError as cause:
        raise error(f"{path}: the file cannot be read ({cause.strerror}). Check its permissions.") from cause


@contextlib.contextmanager
def unchanged(error: type[FileFormatError], path: Path, *beside: Path) -> Iterator[None]:
    """Raise `error` for every OSError of the block, and unless files are at its end what they were at its beginning.

    What has no marks of its own end, as a table, would else be taken for whole while somebody writes it.
    """
    with reading(error, path):
        before = [file_stamp(each) for each in (path, *beside)]
        yield
    if [file_stamp(each) for each in (path, *beside)] != before:
        raise error(f"{path}: the file changed while it was read. Read it again when it is complete.")


def files_in(folder: Path, pattern: str = "*") -> list[Path]:
    """The files in a folder, by name, but for hidden ones: a Mac lays ``._scan.mha`` beside what it copies to other disks."""
    return sorted(file for file in folder.glob(pattern) if file.is_file() and not file.name.startswith("."))


def size_of(path: Path) -> int:
    """Bytes of a file, or of the files in a folder."""
    return sum(file.stat().st_size for file in (files_in(path) if path.is_dir() else [path]))


def file_stamp(path: Path) -> tuple[int, int] | None:
    """`stamp` of the file at `path`; None where there is none."""
    try:
        return stamp(path.stat())
    except OSError:
        return None


def stamp(status: os.stat_result) -> tuple[int, int]:
    """Size and time of a file, which tell whether it is still the same."""
    return status.st_size, status.st_mtime_ns

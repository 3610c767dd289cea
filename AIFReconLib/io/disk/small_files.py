"""Files that are read as a whole, and only if they stay as they are meanwhile."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from ...errors import FileFormatError
from .regular_files import file_stamp, require_regular_file, stamp
from .workspace import workspace


def read_bytes(path: Path, limit: int | None, error: type[FileFormatError]) -> bytes:
    """The first `limit` bytes of a file, or all; None: all.

    Raises
    ------
    FileFormatError
        The given one, when the file is not there, cannot be read, or ends before its length or changes while it is read: what has no
        marks of its own end, as a table, would be taken for whole.
    """
    require_regular_file(path, error)
    try:
        with open(path, "rb") as file:
            before = os.fstat(file.fileno())
            data = file.read(limit)
            after = os.fstat(file.fileno())
    except OSError as cause:
        raise error(f"{path}: the file cannot be read ({cause.strerror}). Check its permissions.") from cause
    if stamp(before) != stamp(after) or len(data) < min(before.st_size if limit is None else limit, before.st_size):
        raise changed(path, error)
    return data


@contextlib.contextmanager
def local_copy(path: Path, error: type[FileFormatError], seen: tuple[int, int] | None, beside: Path | None = None) -> Iterator[Path]:
    """A whole copy of the file on this computer's own disk, while the block runs; its name has the same suffixes.

    Parameters
    ----------
    path : Path
    error : type of FileFormatError
    seen : tuple or None
        `file_stamp` of the file before it was looked at: the copy is of that one.
    beside : Path or None
        The data file that it names, copied under its own name.

    Raises
    ------
    FileFormatError
        The given one, when the file cannot be read or copied, or changes meanwhile.
    """
    require_regular_file(path, error)
    with contextlib.ExitStack() as stack:
        try:
            folder = stack.enter_context(workspace(Path(tempfile.gettempdir())))
            copy = Path(folder, "copy").with_suffix("".join(path.suffixes[-2:]).lower())
            shutil.copyfile(path, copy)
            if beside is not None:
                shutil.copyfile(beside, Path(folder, beside.name))
        except OSError as cause:
            raise error(
                f"{path}: the file cannot be copied to be read ({cause.strerror}). Copy it to another disk, or free some space for "
                "temporary files."
            ) from cause
        if seen is None or file_stamp(path) != seen or copy.stat().st_size != seen[0]:
            raise changed(path, error)
        yield copy


def changed(path: Path, error: type[FileFormatError]) -> FileFormatError:
    """The error to raise for a file that is not what it was."""
    return error(f"{path}: the file changed while it was read. Read it again when it is complete.")

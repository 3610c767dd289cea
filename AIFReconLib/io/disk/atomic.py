"""Output files that are either complete or not there: written under another name, then renamed.

The other name is a folder beside the target that holds files of the same names. So libraries that choose a format by the
suffix see the right one, a header that names its data file names the right one, and the rename stays on one disk.
"""

from __future__ import annotations

import contextlib
import errno
import glob
import os
import re
import shutil
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

from ...errors import OutputError
from .workspace import PREFIX, workspace

_DATA_FILE = re.compile(rb"^ElementDataFile\s*=[ \t]*([^\r\n]*)[\r\n]*\Z", re.MULTILINE)
_LAST_BYTES = 2**16
"""Bytes at the end of a header, more than its last line has."""

_NO_PERMISSION = "there is no permission to write there. Choose another folder, or close programs that hold the file open."
_FULL = "the disk is full. Free some space, or choose a folder on another disk."
_REMEDIES = {
    errno.EACCES: _NO_PERMISSION,
    errno.EPERM: _NO_PERMISSION,
    errno.ENOSPC: _FULL,
    errno.EMFILE: "too many files are open. Raise the limit on open files (ulimit -n).",
}
"""For others the system's words are clear, and another path helps."""


@contextlib.contextmanager
def atomic_output(path: str | Path) -> Iterator[Path]:
    """A path to write to; it becomes `path` when the block ends without an exception.

    Raises OutputError for every OSError of the block. Whatever the exception, Ctrl-C included, nothing is left and an older file is
    untouched.

    Parameters
    ----------
    path : str or Path
        The file to write. It is replaced if it exists.

    Yields
    ------
    Path
        Same file name, in a folder of its own on the same disk.
    """
    with atomic_outputs(path) as (temporary,):
        yield temporary


@contextlib.contextmanager
def atomic_outputs(*paths: str | Path) -> Iterator[tuple[Path, ...]]:
    """`atomic_output` for files that belong together, all in the folder of the last.

    Notes
    -----
    They are renamed in the order given: data first, the header that names it last. A file that the block did not write is left out, but
    for the last, without which nothing was written. A file keeps the permissions of the one that it replaces.

    A MetaImage header (.mhd) names its data file, and two files cannot be renamed at once. So data whose name is taken get one that no
    other version has, the rename of the header is the moment at which the new pair holds, and then the older data go. The header must
    name the data file as it is called here.
    """
    last = _target(paths[-1])
    beside = [last.with_name(Path(path).name) for path in paths[:-1]]
    is_pair = last.suffix.lower() == ".mhd"
    older: str | None = None
    renamed: list[Path] = []
    try:
        with output_errors(paths[-1]), workspace(last.parent) as folder:
            if is_pair:
                beside = [data.with_name(f"{data.stem}{folder.name}{data.suffix}") if data.exists() else data for data in beside]
            targets = {folder / target.name: target for target in (*beside, last)}
            yield tuple(targets)
            if not (folder / last.name).exists():
                # A library that swallows an interrupt, or a disk that loses a file, must not look like success
                raise OutputError(f"Cannot write {paths[-1]}: the file did not come about. Try again, or choose another folder.")
            written = [(temporary, target) for temporary, target in targets.items() if temporary.exists()]
            for temporary, target in written:
                # A rename must not overtake the data, and a full disk may show only now
                with open(temporary, "rb+") as file:
                    os.fsync(file.fileno())
                # The clock of files ticks every few ms, and readers tell versions apart by their times: no two may share one
                with contextlib.suppress(OSError):
                    os.utime(temporary, ns=(time.time_ns(),) * 2)
                if target.exists():
                    shutil.copymode(target, temporary)
            older = named_data_file(last) if is_pair else None
            for temporary, target in written:
                renamed.append(target)
                os.replace(temporary, target)
    finally:
        if is_pair:
            _remove_unnamed(last, [*renamed, *last.parent.glob(f"{glob.escape(last.stem)}{PREFIX}*")], older)


def named_data_file(header: Path) -> str | None:
    """The name of the data file in the last line of a MetaImage header; None where it names none or is not there."""
    try:
        with open(header, "rb") as file:
            file.seek(max(file.seek(0, os.SEEK_END) - _LAST_BYTES, 0))
            found = _DATA_FILE.search(file.read())
    except FileNotFoundError:
        return None
    return found[1].strip().decode("utf-8", errors="surrogateescape") if found else None


def _remove_unnamed(header: Path, data: Iterable[Path], older: str | None) -> None:
    """Remove what the header does not name: of some data files those that nobody writes, and the `older` data if they are ours.

    Nothing goes where the header cannot be read now.
    """
    with contextlib.suppress(OSError):
        named = named_data_file(header)
        # What a .nhdr of the same name keeps there is not ours
        if older in (f"{header.stem}.raw", f"{header.stem}.zraw") and not header.with_suffix(".nhdr").exists():
            data = [*data, header.with_name(older)]
        for path in data:
            folder = path.stem.removeprefix(header.stem)  # that they are called after, and that is there while they are written
            if path.name not in (named, header.name) and not (folder and header.with_name(folder).is_dir()):
                path.unlink(missing_ok=True)


def write_text(path: str | Path, text: str) -> None:
    """Write `text` to `path`, UTF-8 with line feeds, completely or not at all.

    Raises OutputError when it cannot be written.
    """
    with atomic_output(path) as temporary:
        temporary.write_bytes(text.encode("utf-8", errors="replace"))


def check_writable(path: str | Path) -> None:
    """Return if a file can be created at `path`; to be asked before a long computation. Leaves nothing behind.

    Raises OutputError when its folder does not exist or cannot be written to, its name is impossible, or it is no regular file.
    """
    target = _target(path)
    with output_errors(path), workspace(target.parent) as folder:
        (folder / target.name).touch()


def _target(path: str | Path) -> Path:
    """Where `path` leads to, links followed, so that a link stays a link; only a regular file may be replaced."""
    target = Path(os.path.realpath(path))
    problem = ""
    with output_errors(path):
        if target.exists() and not target.is_file():
            problem = "it is a folder, a device or a pipe. Give the name of a regular file."
        elif target.exists() and not os.access(target, os.W_OK):
            problem = "it is write-protected. Remove the protection, or choose another name."
        elif not target.parent.exists():
            problem = f"the folder {target.parent} does not exist. Create it, or choose another path."
    if problem:
        raise OutputError(f"Cannot write {path}: {problem}")
    return target


@contextlib.contextmanager
def output_errors(path: str | Path) -> Iterator[None]:
    """Turn an OSError into an `OutputError` of one sentence on the cause and one on the remedy."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        cause = _REMEDIES.get(error.errno or 0, f"{error.strerror or error}. Choose another path.")
        raise OutputError(f"Cannot write {path}: {cause}") from error

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

_REMEDIES = {
    "ENOENT": "its folder does not exist. Create the folder, or choose another path.",
    "ENOTDIR": "a part of its path is a file, not a folder. Choose another path.",
    "EACCES": "there is no permission to write there. Choose another folder, or close programs that hold the file open.",
    "EPERM": "there is no permission to write there. Choose another folder, or close programs that hold the file open.",
    "EROFS": "the disk is read-only. Choose another folder.",
    "ENOSPC": "the disk is full. Free some space, or choose a folder on another disk.",
    "EDQUOT": "the disk quota is used up. Free some space, or choose a folder on another disk.",
    "EFBIG": "the file would be larger than the system allows. Choose a larger spacing, or another disk.",
    "EISDIR": "it is a folder. Give the name of a file.",
    "ENAMETOOLONG": "its name is too long. Choose a shorter one.",
    "EMFILE": "too many files are open. Raise the limit on open files (ulimit -n).",
    "ENFILE": "too many files are open. Close other programs.",
    "EIO": "the disk does not answer. Choose a folder on another disk.",
    "ESTALE": "the network disk does not answer. Connect it again, or choose a folder on another disk.",
}


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
    with output_errors(paths[-1]), workspace(last.parent) as folder:
        beside = [last.with_name(Path(path).name) for path in paths[:-1]]
        is_pair = last.suffix.lower() == ".mhd"
        if is_pair:
            beside = [data.with_name(f"{data.stem}{folder.name}{data.suffix}") if data.exists() else data for data in beside]
        targets = [*beside, last]
        temporaries = tuple(folder / target.name for target in targets)
        yield temporaries
        if not temporaries[-1].exists():
            # A library that swallows an interrupt, or a disk that loses a file, must not look like success
            raise OutputError(f"Cannot write {paths[-1]}: the file did not come about. Try again, or choose another folder.")
        written = [(temporary, target) for temporary, target in zip(temporaries, targets) if temporary.exists()]
        for temporary, target in written:
            _flush_to_disk(temporary)
            # The clock of files ticks every few ms, and readers tell versions apart by their times: no two may share one
            with contextlib.suppress(OSError):
                os.utime(temporary, ns=(time.time_ns(),) * 2)
            if target.exists():
                shutil.copymode(target, temporary)
        older = named_data_file(last) if is_pair else None
        try:
            for temporary, target in written:
                os.replace(temporary, target)
        except BaseException:
            _remove_unnamed(last, beside if is_pair else [])
            raise
    if is_pair:
        gone = [path for path in last.parent.glob(f"{glob.escape(last.stem)}{PREFIX}*") if not _is_written(path, last.stem)]
        # What a .nhdr of the same name keeps there is not ours
        if older in (f"{last.stem}.raw", f"{last.stem}.zraw") and not last.with_suffix(".nhdr").exists():
            gone.append(last.with_name(older))
        _remove_unnamed(last, gone)


def named_data_file(header: Path) -> str | None:
    """The name of the data file in the last line of a MetaImage header; None where it names none or is not there."""
    try:
        with open(header, "rb") as file:
            file.seek(max(file.seek(0, os.SEEK_END) - _LAST_BYTES, 0))
            found = _DATA_FILE.search(file.read())
    except FileNotFoundError:
        return None
    return found[1].strip().decode("utf-8", errors="surrogateescape") if found else None


def _is_written(data: Path, stem: str) -> bool:
    """Whether data of a name of their own are still being written: as long as the folder of that name is there."""
    return data.with_name(data.name.removeprefix(stem).removesuffix(data.suffix)).exists()


def _remove_unnamed(header: Path, data: Iterable[Path]) -> None:
    """Remove those of some data files that the header does not name, and none where it cannot be read now."""
    with contextlib.suppress(OSError):
        named = named_data_file(header)
        for path in data:
            if path.name != named:
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
    with output_errors(path):
        if target.is_dir():
            raise OutputError(f"Cannot write {path}: it is a folder. Give the name of a file.")
        if target.exists() and not target.is_file():
            raise OutputError(f"Cannot write {path}: it is a device or a pipe. Give the name of a regular file.")
        if target.exists() and not os.access(target, os.W_OK):
            raise OutputError(f"Cannot write {path}: it is write-protected. Remove the protection, or choose another name.")
        if not target.parent.exists():
            raise OutputError(f"Cannot write {path}: the folder {target.parent} does not exist. Create it, or choose another path.")
    return target


@contextlib.contextmanager
def output_errors(path: str | Path) -> Iterator[None]:
    """Turn an OSError into an `OutputError` of one sentence on the cause and one on the remedy."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        other = f"{error.strerror or str(error)}. Choose another path."
        cause = _REMEDIES.get(errno.errorcode.get(error.errno or 0, ""), other)
        raise OutputError(f"Cannot write {path}: {cause}") from error


def _flush_to_disk(path: Path) -> None:
    """Wait until the file is on the disk: a rename must not overtake the data, and a full disk may show only now."""
    with open(path, "rb+") as file:
        os.fsync(file.fileno())

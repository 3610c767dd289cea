"""Folders to write in, beside the file that is to come.

While one is in use it is locked; so those that a killed program has left behind can be told, and are removed the next time. Locks of other
computers are not seen on every disk, so the name of a folder says whose it is, and only the same computer removes it.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
import re
import secrets
import shutil
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from .locks import hold

PREFIX = ".aifrecon-"
_NAME = re.compile(re.escape(PREFIX) + r"(?:([0-9a-f]{8})-)?[a-z0-9_]{8}")
"""Its computer, which older versions did not say."""

_MACHINE_ID = Path("/etc/machine-id")

LEFT_BEHIND = 24 * 3600.0
"""s without a change after which a folder counts as left behind where folders cannot be locked: Windows, some network disks."""

_TRIES = 10


@contextlib.contextmanager
def workspace(parent: Path) -> Iterator[Path]:
    """A new folder in `parent`, removed at the end; before, the folders that killed programs left in `parent` are removed.

    Raises OSError when no folder can be made.
    """
    remove_left_behind(parent)
    folders: list[Path] = []
    lock = None
    try:
        lock = _create(parent, folders)
        yield folders[-1]
    finally:
        try:
            # First, because removing takes a descriptor too, and there may be no more; who takes it for left behind now removes it for us
            _release(lock)
            _remove(folders)
        except (KeyboardInterrupt, OSError) as error:
            # Ctrl-C, just now; within rmtree it may have a descriptor closed twice
            _remove(folders)
            interrupt = error.__context__
            raise (interrupt if isinstance(interrupt, KeyboardInterrupt) else error) from None


def _remove(folders: list[Path]) -> None:
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)


def remove_left_behind(parent: Path) -> None:
    """Remove the folders of this kind in `parent` that no running program uses; what cannot be removed stays."""
    try:
        with os.scandir(parent) as entries:
            found = [Path(entry.path) for entry in entries if _may_be_left(entry.name) and entry.is_dir(follow_symlinks=False)]
    except OSError:
        return
    for folder in found:
        try:
            lock = _lock(folder)
        except OSError:  # in use, just gone, or somebody else's
            continue
        if lock is not None or _untouched(folder):
            shutil.rmtree(folder, ignore_errors=True)
        _release(lock)


def _may_be_left(name: str) -> bool:
    """Whether a name is of a folder of this kind that no other computer has made."""
    found = _NAME.fullmatch(name)
    return found is not None and found[1] in (None, _this_computer())


@cache
def _this_computer() -> str:
    """What tells this computer from others that see the same disk."""
    try:
        of_system = _MACHINE_ID.read_bytes()
    except OSError:
        of_system = b""
    return hashlib.sha256(platform.node().encode() + of_system).hexdigest()[:8]


def _create(parent: Path, folders: list[Path]) -> int | None:
    """Make a new folder, the last of `folders`, and return what holds its lock.

    It is put down there before it is made: a Ctrl-C that comes while it is made leaves nothing behind.
    """
    for _ in range(_TRIES):
        folders.append(parent / f"{PREFIX}{_this_computer()}-{secrets.token_hex(4)}")
        folders[-1].mkdir(0o700)
        try:
            lock = _lock(folders[-1])
        except (BlockingIOError, FileNotFoundError):
            continue  # another program took it for one left behind before it was locked
        if lock is None or folders[-1].is_dir():
            return lock
        _release(lock)
    raise FileNotFoundError(f"folders made in {parent} vanish at once")


def _lock(folder: Path) -> int | None:
    """A descriptor that locks the folder until it is closed or the program ends in any way; None where that is not possible.

    Raises BlockingIOError when the folder is in use; OSError when it cannot be opened.
    """
    if os.name == "nt":
        return None  # where folders cannot be opened
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        if hold(descriptor):
            return descriptor
    except BlockingIOError:
        os.close(descriptor)
        raise
    os.close(descriptor)
    return None


def _release(lock: int | None) -> None:
    if lock is not None:
        os.close(lock)


def _untouched(folder: Path) -> bool:
    """Whether nothing in the folder has changed for long."""
    try:
        newest = max(path.stat().st_mtime for path in [folder, *folder.iterdir()])
    except OSError:
        return False
    return time.time() - newest > LEFT_BEHIND


def flush_to_disk(path: Path) -> None:
    """Wait until the file is on the disk: a rename must not overtake the data, and a full disk may show only now."""
    with open(path, "rb+") as file:
        os.fsync(file.fileno())

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


@contextlib.contextmanager
def workspace(parent: Path) -> Iterator[Path]:
    """A new folder in `parent`, removed at the end; before, the folders that killed programs left in `parent` are removed.

    Raises OSError when no folder can be made.
    """
    remove_left_behind(parent)
    with contextlib.ExitStack() as after:
        yield _create(parent, after)


def _create(parent: Path, after: contextlib.ExitStack) -> Path:
    """A new folder that is ours: another program may take one for left behind before it is locked."""
    while True:
        folder = parent / f"{PREFIX}{_this_computer()}-{secrets.token_hex(4)}"
        # Before it is made: a Ctrl-C that comes meanwhile leaves nothing behind
        after.callback(shutil.rmtree, folder, ignore_errors=True)
        folder.mkdir(0o700)
        try:
            # Let go first, because removing takes a descriptor too, and there may be no more
            after.callback(_release, _lock(folder))
        except (BlockingIOError, FileNotFoundError):
            continue
        if folder.is_dir():
            return folder


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

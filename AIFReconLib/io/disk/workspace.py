"""Folders to write in, beside the file that is to come.

While one is in use it is locked; so those that a killed program has left behind can be told, and are removed the next time. Locks of other
computers are not seen on every disk, so the name of a folder says whose it is, and only the same computer removes it.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
import time
import uuid
from collections.abc import Iterator
from pathlib import Path

from .locks import hold

PREFIX = ".aifrecon-"

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
        folder = parent / f"{_prefix()}{secrets.token_hex(4)}"
        # Before it is made: a Ctrl-C that comes meanwhile leaves nothing behind
        after.callback(_remove, folder)
        folder.mkdir(0o700)
        # Let go first, because removing takes a descriptor too, and there may be no more
        with contextlib.suppress(BlockingIOError, FileNotFoundError):
            after.enter_context(_locked(folder))
            if folder.is_dir():
                return folder


def _remove(folder: Path) -> None:
    try:
        shutil.rmtree(folder, ignore_errors=True)
    finally:  # once more, where a Ctrl-C came in the middle of it
        shutil.rmtree(folder, ignore_errors=True)


def remove_left_behind(parent: Path) -> None:
    """Remove the folders of this kind in `parent` that no running program uses; what cannot be removed stays."""
    for folder in parent.glob(f"{_prefix()}*"):
        # In use, just gone, or somebody else's
        with contextlib.suppress(OSError), _locked(folder) as is_ours:
            newest = max(path.stat().st_mtime for path in [folder, *folder.iterdir()])
            if is_ours or time.time() - newest > LEFT_BEHIND:
                shutil.rmtree(folder, ignore_errors=True)


def _prefix() -> str:
    """How the folders of this computer are called, which others may see on the same disk."""
    return f"{PREFIX}{uuid.getnode():012x}-"


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[bool]:
    """Whether the folder is locked now, until the block or the program ends in any way: not everywhere folders can be.

    Raises BlockingIOError when it is in use; OSError when it cannot be opened.
    """
    if os.name == "nt":  # where folders cannot be opened
        yield False
        return
    descriptor = os.open(folder, os.O_RDONLY | os.O_NOFOLLOW)
    try:
        yield hold(descriptor)
    finally:
        os.close(descriptor)

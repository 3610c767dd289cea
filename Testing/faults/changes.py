"""Places that cannot be written to, or not for long, and files that change while they are read."""

from __future__ import annotations

import os
import random
import resource
import shutil
import signal
from collections.abc import Callable
from functools import partial
from pathlib import Path

from .children import RENAMING, at_line, attempt
from .kills import versions
from .ledger import Fault, Lost, Trial
from .samples import READ, WRITTEN, FileKind, left_in

NOBODY = 65534


def refused(sample: FileKind, folder: Path, write: Callable[[], object], *, may_work: bool = False) -> str:
    """A write that meets a fault: refused in a sentence, with what was there as it was; or done and whole, where that may be."""
    there = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    before = _digest(sample, folder)
    answer, said = attempt(write)
    after, strangers = _digest(sample, folder), left_in(folder, sample.file, *there) if folder.is_dir() else []
    if answer == "raised" or strangers:
        raise Lost(f"{said}, left {strangers}")
    if answer == "done":
        if not may_work or after in (before, "damaged"):
            raise Lost(f"written in spite of it, {after}")
        return "written, whole"
    if after != before:
        raise Lost("the older file was changed")
    return "refused in a sentence, " + ("nothing left" if before == "absent" else "older file as it was")


def _digest(sample: FileKind, folder: Path) -> object:
    path = folder / sample.file
    return attempt(partial(sample.digest, path))[1] if path.is_file() else "absent"


def as_nobody(sample: FileKind, folder: Path) -> None:
    """Write as a user without rights; as ourselves where we are no root."""
    if os.getuid() == 0:
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)
    sample.write(folder, 1)


def no_permission(sample: FileKind, folder: Path, _chance: random.Random) -> str:
    """The folder has no permission, as another user."""
    attempt(partial(sample.write, folder, 0))
    folder.chmod(0o555)
    try:
        return refused(sample, folder, partial(as_nobody, sample, folder))
    finally:
        folder.chmod(0o755)


def protected(sample: FileKind, folder: Path, _chance: random.Random) -> str:
    """The older file is write-protected, as another user."""
    attempt(partial(sample.write, folder, 0))
    folder.chmod(0o777)
    for path in folder.iterdir():
        path.chmod(0o444)
    return refused(sample, folder, partial(as_nobody, sample, folder))


def at_a_folder(sample: FileKind, folder: Path, _chance: random.Random) -> str:
    """The target is a folder."""
    (folder / sample.file).mkdir()
    return refused(sample, folder, partial(sample.write, folder, 1))


def at_a_pipe(sample: FileKind, folder: Path, _chance: random.Random) -> str:
    """The target is a pipe."""
    os.mkfifo(folder / sample.file)
    return refused(sample, folder, partial(sample.write, folder, 1))


def nowhere(sample: FileKind, folder: Path, _chance: random.Random) -> str:
    """The folder does not exist."""
    return refused(sample, folder, partial(sample.write, folder / "missing", 1))


def too_long(sample: FileKind, folder: Path, _chance: random.Random) -> str:
    """The name has 300 letters."""
    return refused(sample, folder, partial(sample.write, folder / ("n" * 300), 1))


def disk_full(sample: FileKind, folder: Path, chance: random.Random) -> str:
    """No file may become longer than a part of what it needs (RLIMIT_FSIZE)."""
    attempt(partial(sample.write, folder, 0))
    limit = int(chance.random() * max(path.stat().st_size for path in folder.iterdir()))

    def write() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
        sample.write(folder, 1)

    return refused(sample, folder, write, may_work=True)


def vanishes(sample: FileKind, folder: Path, chance: random.Random) -> str:
    """The folder is taken away, with all that is in it, before some line of the writing runs."""
    place, due = folder / "out", chance.randrange(3, 120)
    place.mkdir()
    remove = partial(shutil.rmtree, place, True)
    answer, said = attempt(lambda: at_line(RENAMING[:3], due, remove, partial(sample.write, place, 1)))
    if answer == "raised":
        raise Lost(str(said))
    return "written before" if answer == "done" else "refused in a sentence"


# ---- while it is read


def overwrite(path: Path, other: Path) -> None:
    """The content of another file is written into it."""
    with open(path, "rb+") as file:
        file.write(other.read_bytes())
        file.truncate()


def replace_by_another(path: Path, other: Path) -> None:
    """Another whole file of the same kind takes its name."""
    shutil.copy(other, path.with_name("other"))
    os.replace(path.with_name("other"), path)


CHANGES: dict[str, Callable[[Path, Path], object]] = {
    "cut": lambda path, _other: os.truncate(path, path.stat().st_size // 2),
    "emptied": lambda path, _other: os.truncate(path, 0),
    "replaced": replace_by_another,
    "overwritten": overwrite,
    "appended to": lambda path, _other: path.open("ab").write(b"\1" * 1000),
    "removed": lambda path, _other: path.unlink(),
}


def changed_while_read(sample: FileKind, folder: Path, chance: random.Random) -> Trial:
    """What is read is one of two files, or an error says why not. Of a header and its data, nobody can know that they belong together."""
    old, digests = versions(sample, folder)
    files = sorted(path.name for path in old.iterdir())
    reading = ("AIFReconLib/io/",)
    lines = attempt(lambda: at_line(reading, None, lambda: None, partial(sample.digest, old / sample.file))[1])[1]

    def trial(place: Path, number: int) -> str:
        shutil.copytree(old, place, dirs_exist_ok=True)
        how, change = list(CHANGES.items())[number % len(CHANGES)]
        file, due = chance.choice(files), chance.randrange(1, int(str(lines)) + 1)
        meddle = partial(change, place / file, folder / "new" / file)
        answer, said = attempt(lambda: at_line(reading, due, meddle, partial(sample.digest, place / sample.file))[0])
        if answer == "raised":
            raise Lost(f"{how}: {said}")
        if answer == "done" and said not in digests.values() and not (len(files) == 2 and how in ("replaced", "overwritten")):
            raise Lost(f"{how}: read as another")
        return "read before or after, whole" if answer == "done" else "refused in a sentence"

    return trial


def in_turn(fault: Callable[[FileKind, Path, random.Random], str], _folder: Path, chance: random.Random) -> Trial:
    """Each kind of write meets this fault in turn."""
    return lambda place, number: fault(WRITTEN[number % len(WRITTEN)], place, chance)


PLACES = {
    "cannot be written": (no_permission, protected, at_a_folder, at_a_pipe, nowhere, too_long),
    "disk full": (disk_full,),
    "folder vanishes": (vanishes,),
}
CASES = (
    *(Fault(fault, each.__name__, partial(in_turn, each)) for fault, places in PLACES.items() for each in places),
    *(Fault("file changes while read", each.file, partial(changed_while_read, each)) for each in READ),
)

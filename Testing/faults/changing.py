"""Inputs that change, are cut, vanish or fail while they are read."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from .children import result_of
from .failing_disk import failing_disk, possible
from .ledger import Entry, Ledger
from .places import attempt, is_sentence
from .readers import READERS, Reader

READING = ("AIFReconLib/io/",)


def cut_in_half(path: Path, _other: Path) -> None:
    """Truncate in place: a memory map of the rest would end the program."""
    os.truncate(path, path.stat().st_size // 2)


def empty(path: Path, _other: Path) -> None:
    """Truncate to nothing."""
    os.truncate(path, 0)


def replace_by_another(path: Path, other: Path) -> None:
    """Another whole file of the same size and kind takes its name."""
    shutil.copy(other, path.with_name("other"))
    os.replace(path.with_name("other"), path)


def overwrite(path: Path, other: Path) -> None:
    """The content of another file is written into it."""
    with open(path, "rb+") as file:
        file.write(other.read_bytes())
        file.truncate()


def append(path: Path, _other: Path) -> None:
    """Something is added at its end."""
    with open(path, "ab") as file:
        file.write(b"\1" * 1000)


def unlink(path: Path, _other: Path) -> None:
    """It is removed."""
    path.unlink(missing_ok=True)


CHANGES = (cut_in_half, empty, replace_by_another, overwrite, append, unlink)


def _read_meanwhile(reader: Reader, path: Path, change: Callable[[], None], due: int | None) -> tuple[str, int]:
    """The digest, and how many lines the reading took; `change` is called before line `due`."""
    lines = 0

    def local(_frame, event, _argument):
        nonlocal lines
        if event == "line":
            if lines == due:
                change()
            lines += 1
        return local

    sys.settrace(lambda frame, *_: local if any(name in frame.f_code.co_filename for name in READING) else None)
    try:
        return reader.read(path), lines
    finally:
        sys.settrace(None)


def changed_while_read(ledger: Ledger, readers: tuple[Reader, ...], moments: int) -> None:
    """Each kind of file, changed in each way at several moments: what is read is one of the two files, or an error says why not."""
    for reader in readers:
        entry = ledger.begin("file changes while read", "cut, emptied, replaced, overwritten, appended to, removed", reader.name)
        if entry is None:
            return
        with tempfile.TemporaryDirectory(prefix="faults-") as made:
            folders = [Path(made) / name for name in ("one", "two")]
            for version, folder in enumerate(folders):
                folder.mkdir()
                attempt(partial(reader.make, folder, version))
            whole = [result_of(partial(reader.read, folder / reader.files[-1])) for folder in folders]
            lines = result_of(partial(_read_meanwhile, reader, folders[0] / reader.files[-1], lambda: None, None))[1]
            for file in reader.files:
                for change in CHANGES:
                    for moment in range(moments):
                        _one_change(entry, reader, folders, file, change, moment * lines // moments, whole)


def _one_change(entry: Entry, reader: Reader, folders: list[Path], file: str, change, due: int, whole: list[str]) -> None:
    with tempfile.TemporaryDirectory(prefix="faults-") as made:
        place = Path(made) / "in"
        shutil.copytree(folders[0], place)
        answers: list[str] = []
        meddle = partial(change, place / file, folders[1] / file)

        def read() -> None:
            answers.append(_read_meanwhile(reader, place / reader.files[-1], meddle, due)[0])
            (Path(made) / "digest").write_text(answers[0], encoding="utf-8")

        answer = attempt(read)
        told = Path(made) / "digest"
        if answer == "done":
            found = told.read_text("utf-8")
            # Of a header and its data file one alone may have been replaced: a reader cannot know that they belonged together
            good = found in whole or (len(reader.files) == 2 and change in (replace_by_another, overwrite))
            (entry.outcomes if good else entry.lost)["read before or after, whole" if good else f"{change.__name__}: read as another"] += 1
        elif is_sentence(answer):
            entry.outcomes["refused in a sentence"] += 1
        else:
            entry.lost[f"{change.__name__}: {answer[:100]}"] += 1


def failing_while_read(ledger: Ledger, readers: tuple[Reader, ...], places: int) -> None:
    """Each kind of file on a disk that fails at several places, in three ways."""
    if not possible():
        ledger.left_out.append("disk fails while read: needs root and /dev/fuse")
        return
    for how, told in (("EIO", "EIO from some byte on"), ("gone", "the disk goes away (ENOTCONN)"), ("short", "it ends before its length")):
        for reader in readers:
            entry = ledger.begin("disk fails while read", f"FUSE: {told}", reader.name)
            if entry is None:
                return
            with tempfile.TemporaryDirectory(prefix="faults-") as made:
                attempt(partial(reader.make, Path(made), 0))
                files = {name: (Path(made) / name).read_bytes() for name in reader.files}
                whole = result_of(partial(reader.read, Path(made) / reader.files[-1]))
            longest = max(map(len, files.values()))
            for place in range(places):
                _one_failure(entry, reader, files, place * longest // places, how, whole)


def _one_failure(entry: Entry, reader: Reader, files: dict[str, bytes], fails_at: int, how: str, whole: str) -> None:
    with tempfile.TemporaryDirectory(prefix="faults-") as made, failing_disk(files, fails_at, how) as disk:
        told = Path(made) / "digest"
        answer = attempt(lambda: told.write_text(reader.read(disk / reader.files[-1]), encoding="utf-8"))
        if answer == "done":
            good = told.read_text("utf-8") == whole
            (entry.outcomes if good else entry.lost)["read whole" if good else f"byte {fails_at}: read as another"] += 1
        elif is_sentence(answer):
            entry.outcomes["refused in a sentence"] += 1
        else:
            entry.lost[f"byte {fails_at}: {answer[:100]}"] += 1


def run(ledger: Ledger, readers: tuple[Reader, ...] = READERS, moments: int = 12, places: int = 8) -> None:
    """All of it."""
    changed_while_read(ledger, readers, moments)
    failing_while_read(ledger, readers, places)

"""Places that cannot be written to, or not for long: full and read-only disks, no permission, names and links of every kind."""

from __future__ import annotations

import contextlib
import ctypes
import os
import resource
import shutil
import signal
import stat
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from AIFReconLib.errors import AIFReconError

from .children import result_of
from .killing import RENAMING, left_in, names_of
from .ledger import Entry, Ledger
from .writers import Writer

NOBODY = 65534
FREE = (4, 8, 16, 24, 32, 40, 48, 64, 80, 96, 112, 128)
"""KiB that are left on a full disk."""

ODD_NAMES = ("with space", "ünïcode 脊椎", "line\nbreak", "-dash", "quote'\"", "percent%s{0}", "tab\t", " ", ".hidden", "x" * 120)


def attempt(work: Callable[[], object]) -> str:
    """What becomes of `work` in a child: ``done``, the sentence of an error, or ``raised ...`` for what must not be."""

    def tell() -> str:
        try:
            work()
        except AIFReconError as error:
            return str(error)
        except BaseException as error:
            return f"raised {type(error).__name__}: {error}"
        return "done"

    try:
        return result_of(tell)
    except RuntimeError as error:
        return f"raised {error}"


def is_sentence(text: str) -> bool:
    """Whether an error says what is wrong and what to do, in one line."""
    return not text.startswith("raised") and text.rstrip().endswith(".") and ". " in text


def book(entry: Entry, writer: Writer, folder: Path, answer: str, before: str | None, known: set[str]) -> None:
    """Count one refused or done write: refused, the older file is as it was and nothing is left; done, the new one is there."""
    target = folder / writer.file
    after = file_digest(writer, target)
    strangers = left_in(folder, known | names_of(writer.file)) if folder.is_dir() else set()
    if answer.startswith("raised"):
        entry.lost[answer[:120]] += 1
    elif strangers:
        entry.lost[f"left {sorted(strangers)}"] += 1
    elif answer == "done":
        if after in (None, before, "damaged"):
            entry.lost[f"done, but the file is {'absent' if after is None else 'damaged or old'}"] += 1
        else:
            entry.outcomes["written, whole"] += 1
    elif not is_sentence(answer):
        entry.lost[answer[:120]] += 1
    elif after != before:
        entry.lost["the older file was changed"] += 1
    else:
        entry.outcomes["refused in a sentence" + (", older file as it was" if before else ", nothing left")] += 1


def file_digest(writer: Writer, target: Path) -> str | None:
    """Which version is there; None for none."""
    if not target.exists():
        return None
    try:
        return result_of(partial(writer.digest, target))
    except RuntimeError:
        return "damaged"


def with_limit(limit: int, work: Callable[[], object]) -> None:
    """`work` where no file may become longer than `limit` bytes."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    work()


@contextlib.contextmanager
def small_disk(size: str) -> Iterator[Path]:
    """A disk of its own in memory; for root."""
    libc = ctypes.CDLL(None, use_errno=True)
    with tempfile.TemporaryDirectory(prefix="faults-disk-") as folder:
        if libc.mount(b"tmpfs", folder.encode(), b"tmpfs", 0, f"size={size}".encode()) != 0:
            raise PermissionError("mounting is for root")
        try:
            yield Path(folder)
        finally:
            libc.umount2(folder.encode(), 2)


def make_read_only(folder: Path) -> None:
    """Remount a small disk so that nothing can be written."""
    ctypes.CDLL(None, use_errno=True).mount(b"tmpfs", str(folder).encode(), b"tmpfs", 32 | 1, b"")


def as_nobody(writer: Writer, folder: Path) -> None:
    """Write as a user without rights; as ourselves where we are no root."""
    if os.getuid() == 0:
        # That user may not be able to load what is loaded late
        with tempfile.TemporaryDirectory(prefix="faults-") as elsewhere:
            writer.write(Path(elsewhere), 0)
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)
    writer.write(folder, 1)


def full_disk(ledger: Ledger, writers: tuple[Writer, ...]) -> None:
    """A disk with so much room left, by a real small disk (root) and by a limit on the length of files."""
    for writer in writers:
        if os.getuid() == 0 and (entry := ledger.begin("disk full", "tmpfs with 4 to 128 KiB left", writer.name)):
            for free in FREE:
                for older in (True, False):
                    with small_disk("1m") as disk:
                        folder = disk / "out"
                        folder.mkdir()
                        if older:
                            attempt(partial(writer.write, folder, 0))
                        before = file_digest(writer, folder / writer.file)
                        space = os.statvfs(disk)
                        (disk / "filler").write_bytes(b"x" * max(space.f_bavail * space.f_frsize - 1024 * free, 0))
                        book(entry, writer, folder, attempt(partial(writer.write, folder, 1)), before, set())
        if entry := ledger.begin("disk full", "RLIMIT_FSIZE, SIGXFSZ ignored", writer.name):
            with tempfile.TemporaryDirectory(prefix="faults-") as made:
                folder = Path(made)
                attempt(partial(writer.write, folder, 0))
                longest = max(path.stat().st_size for path in folder.iterdir())
                before = file_digest(writer, folder / writer.file)
                for share in (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.99):
                    limit = int(share * longest)
                    answer = attempt(partial(with_limit, limit, partial(writer.write, folder, 1)))
                    book(entry, writer, folder, answer, before, set())
                    if answer == "done":
                        before = file_digest(writer, folder / writer.file)


def closed_places(ledger: Ledger, writers: tuple[Writer, ...]) -> None:
    """Places where nothing can be written."""
    places = {
        "the disk is mounted read-only": _on_read_only_disk,
        "the folder has no permission, as another user": _without_permission,
        "the older file is write-protected, as another user": _protected,
        "the target is a folder": _at_a_folder,
        "the target is a pipe": _at_a_pipe,
        "the folder does not exist": _nowhere,
        "the folder is a file": _in_a_file,
        "the name has 300 letters": _too_long,
    }
    for how, place in places.items():
        if how.startswith("the disk") and os.getuid() != 0:
            continue
        if entry := ledger.begin("cannot be written", how, f"each of {len(writers)} kinds of write"):
            for writer in writers:
                with tempfile.TemporaryDirectory(prefix="faults-") as made:
                    os.chmod(made, 0o755)
                    place(entry, writer, Path(made))


def _refused(entry: Entry, writer: Writer, folder: Path, work: Callable[[], object], before: str | None = None) -> None:
    known = {path.name for path in folder.iterdir()}
    answer = attempt(work)
    if answer == "done":
        entry.lost["written in spite of it"] += 1
    else:
        book(entry, writer, folder, answer, before, known)


def _on_read_only_disk(entry: Entry, writer: Writer, _folder: Path) -> None:
    with small_disk("4m") as disk:
        attempt(partial(writer.write, disk, 0))
        before = file_digest(writer, disk / writer.file)
        make_read_only(disk)
        _refused(entry, writer, disk, partial(writer.write, disk, 1), before)


def _without_permission(entry: Entry, writer: Writer, folder: Path) -> None:
    attempt(partial(writer.write, folder, 0))
    before = file_digest(writer, folder / writer.file)
    folder.chmod(0o555)
    _refused(entry, writer, folder, partial(as_nobody, writer, folder), before)
    folder.chmod(0o755)


def _protected(entry: Entry, writer: Writer, folder: Path) -> None:
    attempt(partial(writer.write, folder, 0))
    before = file_digest(writer, folder / writer.file)
    folder.chmod(0o777)
    for path in folder.iterdir():
        path.chmod(0o444)
    _refused(entry, writer, folder, partial(as_nobody, writer, folder), before)


def _at_a_folder(entry: Entry, writer: Writer, folder: Path) -> None:
    (folder / writer.file).mkdir()
    answer = attempt(partial(writer.write, folder, 1))
    _only_a_sentence(entry, answer, (folder / writer.file).is_dir())


def _at_a_pipe(entry: Entry, writer: Writer, folder: Path) -> None:
    os.mkfifo(folder / writer.file)
    answer = attempt(partial(writer.write, folder, 1))
    _only_a_sentence(entry, answer, stat.S_ISFIFO((folder / writer.file).stat().st_mode))


def _nowhere(entry: Entry, writer: Writer, folder: Path) -> None:
    _only_a_sentence(entry, attempt(partial(writer.write, folder / "missing", 1)), not (folder / "missing").exists())


def _in_a_file(entry: Entry, writer: Writer, folder: Path) -> None:
    (folder / "file").write_text("mine", encoding="utf-8")
    _only_a_sentence(entry, attempt(partial(writer.write, folder / "file", 1)), (folder / "file").read_text("utf-8") == "mine")


def _too_long(entry: Entry, writer: Writer, folder: Path) -> None:
    _only_a_sentence(entry, attempt(partial(writer.write, folder / ("n" * 300), 1)), not list(folder.iterdir()))


def _only_a_sentence(entry: Entry, answer: str, untouched: bool) -> None:
    if answer != "done" and is_sentence(answer) and untouched:
        entry.outcomes["refused in a sentence, nothing touched"] += 1
    else:
        entry.lost[answer[:120]] += 1


def odd_names(ledger: Ledger, writers: tuple[Writer, ...]) -> None:
    """Folders with names that need care; where bytes are no text, SimpleITK cannot go and must not be sent."""
    if entry := ledger.begin("odd names", "folder names with spaces, line breaks, Unicode, 120 letters", f"each of {len(writers)} kinds"):
        for writer in writers:
            for name in ODD_NAMES:
                with tempfile.TemporaryDirectory(prefix="faults-") as made:
                    folder = Path(made) / name
                    folder.mkdir()
                    book(entry, writer, folder, attempt(partial(writer.write, folder, 1)), None, set())
    if entry := ledger.begin("odd names", "folder name with bytes that are no UTF-8", f"each of {len(writers)} kinds of write"):
        for writer in writers:
            with tempfile.TemporaryDirectory(prefix="faults-") as made:
                folder = Path(os.fsdecode(os.fsencode(made) + b"/\xff\xfe"))
                folder.mkdir()
                book(entry, writer, folder, attempt(partial(writer.write, folder, 1)), None, set())


def links(ledger: Ledger, writers: tuple[Writer, ...]) -> None:
    """An output that is a link stays one; what it leads to is replaced as a whole."""
    if entry := ledger.begin("links", "output is a link to a file, to nothing, or to itself", f"each of {len(writers)} kinds of write"):
        for writer in writers:
            for leads in ("file", "nothing", "itself"):
                with tempfile.TemporaryDirectory(prefix="faults-") as made:
                    _write_through(entry, writer, Path(made), leads)


def _write_through(entry: Entry, writer: Writer, folder: Path, leads: str) -> None:
    real, link = folder / "real", folder / writer.file
    real.mkdir()
    if leads == "file":
        attempt(partial(writer.write, real, 0))
    before = file_digest(writer, real / writer.file)
    link.symlink_to(link if leads == "itself" else real / writer.file)
    answer = attempt(partial(writer.write, folder, 1))
    after = file_digest(writer, real / writer.file)
    if answer == "done" and leads != "itself" and link.is_symlink() and after not in (before, "damaged"):
        entry.outcomes["written through the link, which stays"] += 1
    elif answer == "done" and leads == "itself" and not link.is_symlink():
        entry.outcomes["a link to itself is replaced by the file"] += 1
    elif is_sentence(answer) and link.is_symlink() and after == before:
        entry.outcomes["refused in a sentence, link and file as they were"] += 1
    else:
        entry.lost[f"{leads}: {answer[:100]}"] += 1


def vanishing_folder(ledger: Ledger, writers: tuple[Writer, ...], each: int) -> None:
    """The folder is taken away, with all that is in it, before some line of the writing runs."""
    for writer in writers:
        if entry := ledger.begin("folder vanishes", f"removed before one of {each} lines of the writing", writer.name):
            for share in range(each):
                with tempfile.TemporaryDirectory(prefix="faults-") as made:
                    folder = Path(made) / "out"
                    folder.mkdir()
                    answer = attempt(
                        partial(_meanwhile, partial(writer.write, folder, 1), partial(shutil.rmtree, folder, True), share, each)
                    )
                    if answer == "done" or is_sentence(answer):
                        entry.outcomes["written before" if answer == "done" else "refused in a sentence"] += 1
                    else:
                        entry.lost[answer[:120]] += 1


def _meanwhile(work: Callable[[], object], meddle: Callable[[], object], share: int, shares: int) -> None:
    """`work`, with `meddle` called before one of the lines that make and rename files."""
    lines, due = 0, None

    def local(_frame, event, _argument):
        nonlocal lines
        if event == "line":
            if lines == due:
                sys.settrace(None)
                meddle()
            lines += 1
        return local

    due = 3 + share * 120 // shares
    sys.settrace(lambda frame, *_: local if any(name in frame.f_code.co_filename for name in RENAMING[:4]) else None)
    try:
        work()
    finally:
        sys.settrace(None)


def run(ledger: Ledger, writers: tuple[Writer, ...], each: int = 12) -> None:
    """All of it."""
    closed_places(ledger, writers)
    odd_names(ledger, writers)
    links(ledger, writers)
    full_disk(ledger, writers)
    vanishing_folder(ledger, writers, each)

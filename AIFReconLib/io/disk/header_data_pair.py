"""Putting a header and its data file in their places, so that at every moment the header names data of its own version.

Two files cannot be renamed at once. A new data file under an old header would be read without complaint: new pixels with old poses.
So the new data come under a name that no other version has, then a header that names them: that is the moment at which the new pair
holds. What follows only brings back the usual name, and is left out while somebody else places the same pair.
"""

from __future__ import annotations

import contextlib
import glob
import os
import re
import shutil
import zlib
from pathlib import Path
from typing import BinaryIO

from .workspace import PREFIX, flush_to_disk

_DATA_FILE = re.compile(rb"^ElementDataFile\s*=[ \t]*([^\r\n]*)[\r\n]*\Z", re.MULTILINE)
_END = 2**16
"""Bytes at the end of a header, more than its last line has."""


def place_pair(temporary_data: Path, data: Path, temporary_header: Path, header: Path) -> None:
    """Move a data file and the MetaImage header that names it to their places.

    Raises OSError when the pair could not be placed; an older one is then as it was.

    Parameters
    ----------
    temporary_data, temporary_header : Path
        The new files, in a workspace of their own on the same disk.
    data, header : Path
        Where they belong. There may be an older pair; its header may name `data` or any other file.

    Notes
    -----
    A program that is killed in between leaves a whole pair, old or new. The data file of the new one may then be called
    ``scan.aifrecon-k2v8x0ab.raw`` in place of ``scan.raw``, and its header says so; the next pair that is written takes it away.
    """
    room = temporary_data.parent
    mark = room / f"{zlib.crc32(os.fsencode(data.name.casefold())):08x}"
    mark.touch()

    def alone() -> bool:
        # Of two who both have made their mark before they look, one at most sees none
        return list(data.parent.glob(f"{PREFIX}*/{mark.name}")) == [mark]

    def place_header(data_name: str) -> None:
        _name_data(temporary_header, data_name)
        if header.exists():
            shutil.copymode(header, temporary_header)
        os.replace(temporary_header, header)

    # What a .nhdr of the same name keeps there is not ours
    free = not data.with_suffix(".nhdr").exists()
    usual = free and alone() and not data.exists() and not header.exists()
    first = data if usual else data.with_name(f"{data.stem}{room.name}{data.suffix}")
    kept = room / "header"
    try:
        if not usual:
            _second_name(temporary_header, kept)
        os.replace(temporary_data, first)
        place_header(first.name)
    except BaseException as error:
        # A network disk may report a failure although the name has changed, and an interrupt may come just after it
        if not _names(header, first.name):
            first.unlink(missing_ok=True)
            raise
        if not isinstance(error, OSError):
            raise
    spares = list(data.parent.glob(f"{glob.escape(data.stem)}{PREFIX}*{glob.escape(data.suffix)}"))
    if usual or not free or not alone():
        return
    # The new pair holds. Where its usual name cannot be had (a disk that is full, a file held open on Windows) it keeps this one.
    with contextlib.suppress(OSError):
        _second_name(first, temporary_data)
        shutil.copyfile(kept, temporary_header)
        os.replace(temporary_data, data)
        place_header(data.name)
        for path in spares:
            path.unlink(missing_ok=True)


def named_data_file(header: Path) -> str | None:
    """The name of the data file in the last line of a MetaImage header; None where it names none or is not there."""
    try:
        with open(header, "rb") as file:
            found = _last_line(file)
    except FileNotFoundError:
        return None
    return found[1].strip().decode("utf-8", errors="surrogateescape") if found else None


def _names(header: Path, data_name: str) -> bool:
    """Whether the header may name this data file: yes, where it cannot be read now."""
    try:
        return named_data_file(header) == data_name
    except OSError:
        return True


def _name_data(header: Path, data_name: str) -> None:
    """Let the last line of a header name this data file."""
    with open(header, "rb+") as file:
        if found := _last_line(file):
            file.seek(found.start(1) - len(found.string), os.SEEK_END)
            file.write(data_name.encode("utf-8", errors="surrogateescape") + b"\n")
            file.truncate()
    flush_to_disk(header)


def _last_line(file: BinaryIO) -> re.Match[bytes] | None:
    """The line of the data file, found in the last bytes of the header."""
    file.seek(max(file.seek(0, os.SEEK_END) - _END, 0))
    return _DATA_FILE.search(file.read())


def _second_name(file: Path, name: Path) -> None:
    """The file under another name as well; a copy where the file system knows no links."""
    try:
        os.link(file, name)
    except OSError:
        shutil.copyfile(file, name)
        flush_to_disk(name)

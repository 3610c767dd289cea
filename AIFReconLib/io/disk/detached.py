"""Putting a header and its data file in the place of older ones, so that at every moment the header names data that fit it.

Two files cannot be renamed at once. A new data file under an old header would be read without complaint: new pixels with old poses.
So the new data come under a name of their own first, then a header that names them: that is the moment at which the new pair holds.
What follows only brings back the usual name.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
from pathlib import Path

from .workspace import flush_to_disk

_SPARE_NAMES = ("aifrecon-new", "aifrecon-newer")
"""Two, because a program that was killed in between has left a header that names one of them."""

_DATA_FILE = re.compile(rb"^(ElementDataFile\s*=[ \t]*)([^\r\n]*)", re.MULTILINE)


def replace_pair(temporary_data: Path, data: Path, temporary_header: Path, header: Path) -> None:
    """Move a data file and the MetaImage header that names it to their places, over an older pair.

    Parameters
    ----------
    temporary_data, temporary_header : Path
        The new files, on the same disk.
    data, header : Path
        Where they belong. The older header may name `data` or any other file.

    Raises
    ------
    OSError
        When the older pair could not be replaced; it is then as it was.

    Notes
    -----
    A program that is killed in between leaves a whole pair, old or new. The data file of the new one may then be called
    ``scan.aifrecon-new.raw`` in place of ``scan.raw``, and its header says so; the next pair that is written takes it away.
    """
    content = temporary_header.read_bytes()

    def place_header(data_name: str) -> None:
        name = data_name.encode("utf-8", errors="surrogateescape")
        temporary_header.write_bytes(_DATA_FILE.sub(lambda line: line[1] + name, content))
        flush_to_disk(temporary_header)
        shutil.copymode(header, temporary_header)
        os.replace(temporary_header, header)

    spares = [data.with_name(f"{data.stem}.{word}{data.suffix}") for word in _SPARE_NAMES]
    spare = next(path for path in spares if path.name != named_data_file(header))
    os.replace(temporary_data, spare)
    try:
        place_header(spare.name)
    except BaseException:
        spare.unlink(missing_ok=True)
        raise
    # The new pair holds. Where its usual name cannot be had (a disk that is full, a file held open on Windows) it keeps this one.
    with contextlib.suppress(OSError):
        _second_name(spare, temporary_data)
        os.replace(temporary_data, data)
        place_header(data.name)
        for path in spares:
            path.unlink(missing_ok=True)


def named_data_file(header: Path) -> str | None:
    """The name of the data file in a MetaImage header; None where it names none or cannot be read."""
    try:
        found = _DATA_FILE.search(header.read_bytes())
    except OSError:
        return None
    return found[2].strip().decode("utf-8", errors="surrogateescape") if found else None


def _second_name(file: Path, name: Path) -> None:
    """The file under another name as well; a copy where the file system knows no links."""
    try:
        os.link(file, name)
    except OSError:
        shutil.copyfile(file, name)
        flush_to_disk(name)

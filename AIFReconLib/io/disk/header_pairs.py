"""A MetaImage file made into a header and a data file."""

from __future__ import annotations

import shutil
from pathlib import Path

from ...errors import OutputError

_DATA_FILE = b"ElementDataFile"


def check_pair_name(path: Path) -> None:
    """Return if a header and a data file of this name can be read by others.

    Raises OutputError otherwise.
    """
    if "%" in path.name:
        raise OutputError(
            f"Cannot write {path}: a data file with a percent sign in its name would be read as a pattern of names. Choose another name."
        )


def split_metaimage(whole: Path, header: Path, data: Path) -> None:
    """Write the header of a .mha file as `header`, which names `data`, and its pixels as `data`; then remove it.

    Notes
    -----
    SimpleITK would write the pair itself, but takes a percent sign in its path, or in that of a folder, for a pattern of file names, and
    ends the program.
    """
    with open(whole, "rb") as file, open(header, "wb") as lines:
        while (line := file.readline()) and not line.startswith(_DATA_FILE):
            lines.write(line)
        lines.write(_DATA_FILE + b" = " + data.name.encode("utf-8", errors="surrogateescape") + b"\n")
        with open(data, "wb") as pixels:
            shutil.copyfileobj(file, pixels)
    whole.unlink()

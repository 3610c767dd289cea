"""A MetaImage or NRRD file is opened by its suffix."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from ...errors import FileFormatError
from ..disk.regular_files import require_regular_file, stamp
from .frame_lines import OutOfOrder
from .header import HeaderLines
from .metafile import UNFINISHED, Metafile
from .metaimage import parse_metaimage
from .nrrd import parse_nrrd

METAIMAGE_SUFFIXES = (".mha", ".mhd")
NRRD_SUFFIXES = (".nrrd", ".nhdr")


def read_metafile(path: str | Path, error: type[FileFormatError]) -> Metafile:
    """The header of a MetaImage file, or by its suffix of an NRRD file.

    Parameters
    ----------
    path : str or Path
    error : type of FileFormatError
        What to raise when the file cannot be used.
    """
    path = Path(path)
    require_regular_file(path, error)
    try:
        with open(path, "rb") as file:
            before = os.fstat(file.fileno())
            parse = parse_nrrd if path.suffix.lower() in NRRD_SUFFIXES else parse_metaimage
            try:
                metafile = parse(HeaderLines(file, path, error, in_memory=False))
            except OutOfOrder:
                file.seek(0)
                metafile = parse(HeaderLines(file, path, error))
            metafile = replace(metafile, header_stamp=stamp(before))
            # The data were looked up after the header was opened: they belong together if its name still leads to the same file
            after = path.stat()
            if (not os.path.samestat(before, after) or stamp(before) != stamp(after)) and UNFINISHED not in metafile.fields:
                raise metafile.failure("the file changed while it was read. Read it again when it is complete.")
            return metafile
    except OSError as cause:
        raise error(f"{path}: the file cannot be read ({cause.strerror}). Check its permissions.") from cause


def data_files(path: Path) -> list[Path]:
    """Where a header keeps its data beside itself, resolved; nothing for files that hold their own or cannot be understood."""
    if path.suffix.lower() not in (*METAIMAGE_SUFFIXES, *NRRD_SUFFIXES):
        return []
    try:
        return [Path(os.path.realpath(read_metafile(path, FileFormatError).data_path))]
    except FileFormatError:
        return []

"""Where a scan is recorded: beside the scene, under its date and time, where nothing else was chosen."""

import datetime
import os
from pathlib import Path

import slicer

from ..inputs.parameters import fileFrom

SUFFIX = ".mhd"
"""Its pixels are not copied when the scan ends, which would take as long as they are many."""


def sceneFolder() -> Path:
    """The folder of the scene's file; of one that was never saved, where Slicer would save it; else the user's own."""
    saved = slicer.mrmlScene.GetURL()
    folders = (Path(saved).parent if saved else None, slicer.mrmlScene.GetRootDirectory(), Path.home())
    return next(folder for folder in map(Path, filter(None, folders)) if folder == Path.home() or os.access(folder, os.W_OK))


def recordingPath(parameters) -> Path | None:
    """The sequence file that a scan which begins now is recorded to; None where it is not to be recorded."""
    if not parameters.liveRecord:
        return None
    chosen = fileFrom(parameters.liveRecordPath)
    return chosen or sceneFolder() / f"Scan {datetime.datetime.now():%Y-%m-%d %H-%M-%S}{SUFFIX}"


def sizeOf(path: Path) -> int:
    """Bytes that the files of a recording take so far: those with its name."""
    return sum(each.stat().st_size for each in path.parent.glob(f"{path.stem}.*") if each.is_file())

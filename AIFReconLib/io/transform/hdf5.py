"""ITK transform files in HDF5 (.h5), made text. The HDF5 library crashes on damaged files, so it sees them in a process of its own."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from ...machine.processes import NO_WINDOW, python_program
from ..disk.itk import short_cause
from .parts import TransformPartError

MAGIC = b"\x89HDF\r\n\x1a\n"
LONGEST = 300.0
"""s to start Python, load SimpleITK and read."""

_CONVERT = "import sys; sys.path[:] = sys.argv[3:]; import SimpleITK as s; s.WriteTransform(s.ReadTransform(sys.argv[1]), sys.argv[2])"


def as_text(path: Path) -> str:
    """What a file of this kind is as a .tfm file, which is made beside it.

    Raises TransformPartError when it cannot be read.
    """
    text = path.with_suffix(".tfm")
    try:
        done = subprocess.run(
            [python_program(), "-c", _CONVERT, str(path), str(text), *sys.path],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=LONGEST,
            check=False,
            encoding="utf-8",
            errors="replace",
            creationflags=NO_WINDOW,
        )
        why = short_cause(RuntimeError(done.stderr)) if done.returncode == 1 else "ITK crashes at it"
        if done.returncode == 0:
            return text.read_text("utf-8", "replace")
    except (OSError, subprocess.TimeoutExpired) as error:
        why = short_cause(error)
    raise TransformPartError(f"is damaged, or cannot be read from HDF5: {why}. Save it from Slicer again, or as .tfm.")

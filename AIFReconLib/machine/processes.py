"""Processes of their own for what may crash: a model, ITK's reader of HDF5."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

NO_WINDOW = getattr(subprocess, "CREATE_NO_WINDOW", 0)
"""Windows would open one."""


def python_program() -> str:
    """The Python that runs this; within Slicer, whose program is another, the one that Slicer brings."""
    program = sys.executable or ""
    return program if Path(program).name.lower().startswith("python") else shutil.which("PythonSlicer") or program

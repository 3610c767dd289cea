"""What processes of ours have in common, and those for what may crash, a model or ITK's reader of HDF5, or take its time: compiling."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

NO_WINDOW = getattr(subprocess, "CREATE_NO_WINDOW", 0)
"""Windows would open one."""

ENVIRONMENT = {"OPENBLAS_NUM_THREADS": "1"}
"""Of every process of ours, where the user has not said otherwise. Our matrices are small: numpy's helpers for products wait busily for the
next one, and take the cores from the threads that work."""

Process = subprocess.Popen[bytes]


def python_program() -> str:
    """The Python that runs this, or within Slicer, whose program is another, the one that Slicer brings.

    Raises FileNotFoundError where there is none.
    """
    program = sys.executable or ""
    is_python = Path(program).name.lower().startswith("python")
    # What is taken for the program there may be another Python, found by its name
    brought = shutil.which("PythonSlicer") if "SLICER_HOME" in os.environ or not is_python else None
    if brought is None and not is_python:
        raise FileNotFoundError("PythonSlicer, which comes with Slicer, is not in its folder of programs")
    return brought or program


def start_python(module: str, function: str, *words: str, stream: int = subprocess.DEVNULL) -> Process:
    """Call one of the library's functions with these words in a process of its own, which reads from and writes to `stream`.

    Raises OSError where none can be started. It imports from where this one does, and an interrupt is for this one alone.
    """
    last = 1 + len(words)
    code = f"import sys; sys.path[:] = sys.argv[{last}:]; from {module} import {function}; {function}(*sys.argv[1:{last}])"
    return subprocess.Popen(
        [python_program(), "-c", code, *words, *sys.path],
        stdin=stream,
        stdout=stream,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        creationflags=NO_WINDOW,
    )

"""Processes of ours: a program of its own that holds the other end of a connection, most often a Python that calls one function."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from subprocess import Popen

    Started = tuple[Popen[bytes], Connection]

CONNECTION = "AIFRECON_CONNECTION"
"""Variable of the environment in which a program is told its end of the connection."""

ENVIRONMENT = {"OPENBLAS_NUM_THREADS": "1"}
"""Of every process of ours, where the user has not said otherwise. Our matrices are small: numpy's helpers for products
wait busily for the next one, and take the cores from the threads that work."""


def python_program() -> str:
    """The Python that runs this, or within Slicer, whose program is another, the one that Slicer brings.

    Raises FileNotFoundError where there is none.
    """
    from shutil import which

    program = sys.executable or ""
    is_python = Path(program).name.lower().startswith("python")
    # What is taken for the program there may be another Python, found by its name
    brought = which("PythonSlicer") if "SLICER_HOME" in os.environ or not is_python else None
    if brought is None and not is_python:
        raise FileNotFoundError("PythonSlicer, which comes with Slicer, is not in its folder of programs")
    return brought or program


def start(command: Sequence[str], **options: Any) -> Started:
    """Start a program, and the connection to it, of which the program asks for its end by `starter`.

    Raises OSError where it cannot be started. `options` are those of `subprocess.Popen`.
    """
    import subprocess
    from multiprocessing.connection import Pipe

    ours, theirs = Pipe()
    handle = theirs.fileno()
    if sys.platform == "win32":
        os.set_handle_inheritable(handle, True)
        options["startupinfo"] = subprocess.STARTUPINFO(lpAttributeList={"handle_list": [handle]})
    else:
        options["pass_fds"] = [handle]
    try:
        return subprocess.Popen(command, env={**ENVIRONMENT, **os.environ, CONNECTION: str(handle)}, **options), ours
    except BaseException:
        ours.close()
        raise
    finally:
        theirs.close()


def start_python(function: Callable[..., None], *arguments: object, stderr: int | None = None) -> Started:
    """Have ``function(connection, *arguments)`` called by a Python of its own, which imports from where this one does.

    It is found by import there; its streams lead nowhere, but for `stderr` where that is given, and an interrupt is for
    this process alone. Nothing of the caller's own program is run again. Raises OSError where none can be started.
    """
    import subprocess

    code = f"import sys; sys.path[:] = sys.argv[1:]; from {__name__} import answer_starter; answer_starter()"
    # Windows would open a window
    flags = getattr(subprocess, "CREATE_NO_WINDOW", 0) | getattr(subprocess, "BELOW_NORMAL_PRIORITY_CLASS", 0)
    process, ours = start(
        [python_program(), "-c", code, *map(str, sys.path)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL if stderr is None else stderr,
        start_new_session=True,
        creationflags=flags,
    )
    # One that has ended already is told by its connection
    with suppress(OSError):
        ours.send((function, arguments))
    return process, ours


def starter() -> Connection | None:
    """The connection to who started this program by `start`, once; None where somebody else did."""
    handle = os.environ.pop(CONNECTION, None)
    if handle is None:
        return None
    from multiprocessing import connection

    # No program that is started from here keeps it
    if sys.platform != "win32":
        os.set_inheritable(int(handle), False)
        return connection.Connection(int(handle))
    return connection.PipeConnection(int(handle))


def answer_starter() -> None:
    """Call what the process was started for."""
    connection = starter()
    if connection is not None:
        function, arguments = connection.recv()
        function(connection, *arguments)

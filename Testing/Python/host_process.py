"""Programs that open the module on the host, each in a process of its own, as Slicer is."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
LONGEST = 570
"""s for one process: less than pytest gives a test, so that what it said is seen."""

OPEN = """
import sys
sys.path[:0] = ["Testing", "Testing/Slicer"]
from host import runHost
host = runHost()
host.start("AIFRecon/AIFRecon.py")
widget = host.open("AIFRecon")
import functools, pathlib, qt, slicer, tinyScene
parameters, ui = widget._parameterNode, widget.ui
"""
"""How such a program begins."""


def run_on_host(*arguments: str | Path, folder: Path = REPOSITORY, **surroundings: str) -> subprocess.CompletedProcess[str]:
    """Python with these arguments; the test is skipped, with the reason, where the host cannot run."""
    for package, name in (("PySide6", "PySide6-Essentials"), ("slicer", "slicer-core")):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{name} is not installed: pip install '.[test]'")
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen", **surroundings}
    command = [sys.executable, *map(str, arguments)]
    with subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            told, complained = (said.decode(errors="replace") for said in process.communicate(timeout=LONGEST))
        except subprocess.TimeoutExpired as late:
            # What is heard ends with the last of all processes that inherited it
            who = "It" if process.poll() is None else "A process that it has started"
            process.kill()
            said = ((late.output or b"") + (late.stderr or b"")).decode(errors="replace")
            pytest.fail(f"{who} goes on after {LONGEST} s: {said[-6000:]}")
    if "cannot run here" in complained:
        pytest.skip(complained.strip().splitlines()[-1])
    return subprocess.CompletedProcess(command, process.returncode, told, complained)

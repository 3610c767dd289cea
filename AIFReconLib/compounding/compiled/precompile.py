"""What takes numba longest, compiled by a process of its own while a CT is looked at: the code is there when the first frame comes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from subprocess import Popen

import numpy as np

from ...arrays import NumberType
from ...holes.nearest import fill_holes
from ...imaging.beams import LINEAR, ProbeGeometry
from ...imaging.gray_levels import GrayLevels
from ...machine.processes import start_python
from ...machine.threads import optional_module, usable_cores
from ...recipe.recipe import Recipe
from ..evidence import ScanLines
from ..layout import PixelLayout
from ..methods.table import method_named

JUDGING, COMPILING = "AIFReconLib.compounding.compiled.numba_evidence", "AIFReconLib.machine.numba_compile"


@contextmanager
def compiled_aside(recipe: Recipe, dtype: NumberType) -> Iterator[Popen[bytes] | None]:
    """While this lasts, a process compiles what inserts a sweep of such images with a CT, and what fills its gaps; it is handed out.

    Nothing waits for it, and nothing is lost where it fails or is ended: who finds no code compiles it. There is none where the code is
    there already or cannot be kept, where other kernels are asked for, which take less than a process to start, and on one core.
    """
    asked = method_named(recipe.method_for(True)).needs_shadows and recipe.engine != "numpy" and usable_cores() > 1
    judging, compiling = (optional_module(name) if asked else None for name in (JUDGING, COMPILING))
    process, connection = None, None
    if judging is not None and compiling is not None and not compiling.is_kept(judging.judge):
        with suppress(OSError):
            process, connection = start_python(compile_for, "uint8" if dtype == np.uint8 else "float32")
    try:
        yield process
    finally:
        if process is not None and connection is not None:
            process.terminate()
            process.wait()
            connection.close()


def compile_for(_connection: Connection, kind: str) -> None:
    """Judge one small image of this type and fill one small volume, which compiles what a job will ask for."""
    judging = optional_module(JUDGING)
    if judging is None:
        return
    layout = PixelLayout((16, 64), (0.5, 0.5), (0, 64, 0, 16), np.ones((64, 16), bool), None, None)
    judge = judging.FrameJudge(ScanLines(layout, ProbeGeometry(LINEAR)), GrayLevels.as_recorded(), 1)
    judge.judge(np.zeros((64, 16), kind), 0, np.zeros((2, 2, 2), np.float32), np.eye(4))
    mask = np.zeros((3, 3, 3), np.uint8)
    mask[1, 1, 1] = 1
    fill_holes(np.zeros(mask.shape, kind), mask, np.ones(3), 1.0)

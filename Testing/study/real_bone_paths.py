"""Lines that pass or meet the real bone: its CT tells which, and the methods are asked the same."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from AIFReconLib.evaluation.lines import lines_near
from AIFReconLib.evaluation.visibility import SweepBeams
from AIFReconLib.geometry.transforms import affine
from AIFReconLib.imaging.beams import LINEAR
from AIFReconLib.progress import Progress
from AIFReconLib.recipe.recipe import ReconstructionSettings

from .method_cases import OURS, PLAIN
from .paths_cases import NONE, RIGHT, WRONG, WRONG_MM, Row, ScannedLines
from .patients import run_tasks
from .real_bone_cases import HOLE_LIMIT, SPACING, RealBone
from .real_bone_measures import AROUND

LINES = 100_000
"""Drawn, of which few are straight enough: the bone is long."""

DEEPER = 3.0
"""mm behind the bone's surface about which lines end, so that they can meet it."""

CASES = ((NONE, PLAIN), (NONE, OURS), (WRONG, OURS), (RIGHT, OURS), (WRONG, ""))
"""CT and method; the CT in place alone is the truth."""


def path_rows(bone: RealBone, folder: Path, jobs: int = 2, progress: Progress | None = None) -> list[Row]:
    """The rows of all cases, made or, where an earlier run has written them to `folder`, read."""
    given = {f"paths-{ct}-{method or 'alone'}".replace(" ", "-"): (bone.folder, ct, method) for ct, method in CASES}
    return run_tasks(_rows_of, given, Row, folder, jobs, progress, "lines to the bone")


def _rows_of(given: tuple[Path, str, str]) -> list[Row]:
    folder, ct, method = given
    bone, scanned = _opened(folder)
    place = affine(np.eye(3), (ct == WRONG) * WRONG_MM * bone.axes[1])
    if not method:
        return [scanned.ct_alone(ct, place)]
    return [scanned.volume(ct, method, None if ct == NONE else place)]


@cache
def _opened(folder: Path) -> tuple[RealBone, ScannedLines]:
    bone = RealBone(folder)
    recipe = ReconstructionSettings(spacing=SPACING, hole_limit=HOLE_LIMIT, probe=LINEAR)
    skin = SweepBeams.of_sequence(bone.sequence, recipe).skin()
    rng = np.random.default_rng(0)
    points, normals = bone.reached
    some = rng.integers(len(points), size=LINES)
    lines = lines_near(skin, points[some] - DEEPER * normals[some], bone.truth.distance, AROUND, rng)
    return bone, ScannedLines(0, "fibula", bone.sequence, bone.labels, bone.truth.distance, lines, recipe)

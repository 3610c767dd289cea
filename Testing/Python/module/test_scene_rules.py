"""What holds for all of AIFRecon/AIFReconScene: no slow imports at the top, no Qt, short documented files."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("slicer", reason="slicer-core is not installed")

FOLDER = Path(__file__).resolve().parents[3] / "AIFRecon" / "AIFReconScene"
FILES = sorted(FOLDER.glob("*.py"))
OWN = {
    "boneNodes",
    "browserItems",
    "gridNodes",
    "phantomSample",
    "probeOverlay",
    "sceneNodes",
    "sequenceNodes",
    "sequenceReader",
    "sliceDisplay",
    "sweepImages",
    "sweepPoses",
    "transforms",
    "volumeNodes",
}
"""Files that run on a bare scene; the others need the strings of Slicer's translation too."""


def test_nothing_slow_is_imported_with_the_conversions():
    names = [path.stem for path in FILES if path.stem in OWN]
    slow = "{'scipy', 'SimpleITK', 'matplotlib', 'numba', 'pyigtl', 'PySide6'}"
    code = (
        f"import sys; sys.path.insert(0, {str(FOLDER.parent)!r}); import slicer; before = set(sys.modules); import importlib\n"
        f"for name in {names}: importlib.import_module('AIFReconScene.' + name)\n"
        f"print(sorted({{name.split('.')[0] for name in set(sys.modules) - before}} & {slow}))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ran.stdout.strip() == "[]", ran.stderr


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_a_file_knows_no_qt(path):
    imported = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            imported |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            imported.add(node.module.split(".")[0])
    assert imported & {"qt", "ctk", "PySide6"} == set()

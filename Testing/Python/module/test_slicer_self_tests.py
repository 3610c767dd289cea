"""The self tests of the Slicer module, as `make slicer-test` runs them: the real module on real MRML nodes and real Qt, without Slicer."""

from __future__ import annotations

import ast

import pytest
from host_process import REPOSITORY, run_on_host

FILES = ["AIFReconTest", *sorted(path.stem for path in (REPOSITORY / "Testing" / "Slicer").glob("*Test.py"))]
GROUPS = 4
"""Processes that the files are shared out to: each starts the application, for seconds."""

LOAD_LATER = """
import sys
sys.path.insert(0, "Testing")
from host import runHost
host = runHost()
host.load_module("AIFRecon/AIFRecon.py")
import slicer
layout = slicer.mrmlScene.GetFirstNodeByClass("vtkMRMLLayoutNode")
print("samples:", len(slicer.modules.sampleDataSources["AIFRecon"]))
print("layouts:", layout.IsLayoutDescription(4204) and layout.IsLayoutDescription(4214))
print("icon:", not slicer.modules.aifrecon.icon.isNull())
host.open("AIFRecon")
host.raise_slot_errors()
"""


@pytest.mark.parametrize("group", range(GROUPS))
def test_the_self_tests_pass(group):
    done = run_on_host("Testing/host/run_self_tests.py", "-k", *(f"{file}." for file in FILES[group::GROUPS]))
    assert done.returncode == 0, (done.stdout + done.stderr)[-6000:]


def test_the_library_is_imported_when_a_self_test_runs_and_not_before():
    """In Slicer all run in one go, and some reload the module: what was imported before is then of another library."""
    trees = [ast.parse(path.read_text("utf-8")) for path in (REPOSITORY / "Testing" / "Slicer").glob("*Test.py")]
    imported = [node for tree in trees for node in tree.body if isinstance(node, (ast.Import, ast.ImportFrom))]
    names = [alias.name for node in imported for alias in node.names] + [getattr(node, "module", None) or "" for node in imported]
    assert [name for name in names if name.startswith(("AIFReconLib", "AIFReconScene", "AIFReconGui"))] == []


def test_sample_data_layouts_and_icon_are_there_where_the_module_is_loaded_while_slicer_runs():
    done = run_on_host("-c", LOAD_LATER)
    assert done.returncode == 0, done.stderr[-3000:]
    assert {"samples: 2", "layouts: True", "icon: True"} <= set(done.stdout.splitlines())

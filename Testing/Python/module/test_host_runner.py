"""The runner of self tests fails where a test fails."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytest_plugins = ["host_fixture"]
RUNNER = Path(__file__).resolve().parents[2] / "host" / "run_self_tests.py"
MODULE = """
from slicer.ScriptedLoadableModule import *

class Tiny(ScriptedLoadableModule):
    pass

class TinyWidget(ScriptedLoadableModuleWidget):
    pass

class TinyTest(ScriptedLoadableModuleTest):
    def test_one(self):
        self.assertEqual(1, {expected})
"""


@pytest.mark.usefixtures("host")
@pytest.mark.parametrize("expected", [1, 2])
def test_the_runner_fails_where_a_self_test_fails(tmp_path, expected):
    path = tmp_path / "Tiny.py"
    path.write_text(MODULE.format(expected=expected), "utf-8")
    command = [sys.executable, str(RUNNER), "--module", str(path), "--tests", str(tmp_path / "none")]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (result.returncode, "Ran 1 test" in result.stdout) == (expected - 1, True), result.stdout + result.stderr

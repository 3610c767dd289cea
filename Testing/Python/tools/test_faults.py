"""The faults of `make faults`, a few of each: what they find, and that they would find it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

TESTING = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the faults are made with what Linux offers")


def run_faults(*arguments: str) -> subprocess.CompletedProcess:
    """`python -m faults` in a process of its own: it forks, and a process with threads must not."""
    return subprocess.run([sys.executable, "-m", "faults", *arguments], cwd=TESTING, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("kind", ["kill", "places", "changing", "endings", "worker"])
def test_nothing_is_lost_by_a_few_faults_of_each_kind(kind):
    done = run_faults("--quick", "--only", kind)
    assert done.returncode == 0, done.stdout + done.stderr[-2000:]
    assert ", 0 losses." in done.stdout


NAIVE = """
import os, sys
sys.path[:0] = [os.path.dirname(os.getcwd()), os.path.join(os.getcwd(), "Python")]
from AIFReconLib.io.disk import workspace
from faults import killing, writers
from faults.ledger import Ledger

workspace.remove_left_behind = lambda parent: None
ledger = Ledger(600)
killing.run(ledger, (writers.OTHERS[2],), (), 24, 0)
print(ledger.lost)
"""


def test_a_library_that_leaves_its_folders_is_found_out():
    done = subprocess.run([sys.executable, "-c", NAIVE], cwd=TESTING, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert int(done.stdout.split()[-1]) > 0

"""The faults of `make faults`, one or more of each: what they find, and that they would find it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

TESTING = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the faults are made with what Linux offers")


@pytest.mark.parametrize(
    "words",
    [
        ["kill -9: live recording l.mhd", "kill -9: write plain.mhd"],
        ["kill -9: worker"],
    ],
)
def test_nothing_is_lost_by_a_few_faults_of_each_kind(words):
    """In a process of its own: it forks, and a process with threads must not."""
    command = [sys.executable, "-m", "faults", "--seconds", "8", *words]
    done = subprocess.run(command, cwd=TESTING, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr[-2000:]
    assert "| nothing |" in done.stdout


PLANTED = """
import os, signal, sys
sys.path[:0] = [os.path.dirname(os.getcwd()), os.path.join(os.getcwd(), "Python")]
from pathlib import Path
from AIFReconLib.io.disk import workspace
from faults import kills, ledger, samples

def careless(folder, version):
    # In place, and with a pause: no write of the library does that
    with open(folder / "r.json", "wb", 0) as file:
        for _ in range(200):
            file.write(bytes([version]) * 5000)

file = samples.FileKind("r.json", careless, samples._bytes)
workspace.remove_left_behind = lambda parent: None
book = ledger.Ledger()
planted = {"left": samples.WRITTEN[-1], "careless": file}[sys.argv[1]]
book.run([ledger.Fault("kill -9", "planted", lambda folder, chance: kills.kill_write(planted, folder, chance))], 15)
print(book.lost, book.markdown())
"""


@pytest.mark.parametrize(("planted", "says"), [("left", "next write: new, left"), ("careless", "mixed, exit -9")])
def test_what_leaves_its_folders_or_writes_in_place_is_found_out(planted, says):
    done = subprocess.run([sys.executable, "-c", PLANTED, planted], cwd=TESTING, capture_output=True, text=True, check=False)
    assert says in done.stdout, done.stdout + done.stderr[-2000:]

"""The faults of `make faults`, a few of each: what they find, and that they would find it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

TESTING = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the faults are made with what Linux offers")

PLANTED = {
    "None": ("scan.mhd", "| nothing |"),
    "faults.write_sequence = in_place": ("writing scan.mhd", "LOST writing scan.mhd: "),
    "workspace.remove_left_behind = lambda parent: None": ("writing scan.mha", "left: {"),
    "faults.Recorder.append = lambda self, frame: None": ("recording scan.mha", "frames listed, 0 readable"),
}
"""Mistakes of the library, a case that meets them, and what is said."""

PROGRAM = """
import sys, tempfile, time
from pathlib import Path
import faults
from AIFReconLib.io.disk import workspace
from AIFReconLib.io.sequence.writer import write_sequence

def in_place(sequence, path, compress):
    # Piece by piece under its name: no write of the library does that
    with tempfile.TemporaryDirectory() as folder:
        write_sequence(sequence, Path(folder) / path.name, compress=compress)
        for made in Path(folder).iterdir():
            with open(path.parent / made.name, "wb", 0) as file:
                for byte in range(0, made.stat().st_size, 2000):
                    file.write(made.read_bytes()[byte : byte + 2000])
                    time.sleep(0.01)

{planted}
sys.argv = ["faults", "--seconds", "15", "{case}"]
sys.exit(faults.main())
"""


@pytest.mark.parametrize("planted", PLANTED)
def test_nothing_is_lost_by_a_few_faults_of_each_kind_and_mistakes_are_found_out(planted):
    """In a process of its own: it forks, and a process with threads must not."""
    case, says = PLANTED[planted]
    program = [sys.executable, "-c", PROGRAM.format(planted=planted, case=case)]
    done = subprocess.run(program, cwd=TESTING, capture_output=True, text=True, check=False)
    assert says in done.stdout, done.stdout + done.stderr[-2000:]
    assert done.returncode == (planted != "None")

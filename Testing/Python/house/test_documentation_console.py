"""The lines for Slicer's Python console in docs/slicer-data.md run, on the host, in a process of their own as in Slicer."""

from __future__ import annotations

from doc_pages import REPOSITORY, blocks
from doc_workplace import make_workplace
from host_process import run_on_host

GUIDE = REPOSITORY / "docs" / "slicer-data.md"

AROUND = """
import sys
from pathlib import Path

repository = Path(sys.argv[1])
sys.path[:0] = [str(repository / "Testing"), str(repository / "Testing" / "Slicer")]
from host import missing, runHost

if reason := missing():
    sys.exit(f"the host cannot run here: {reason}")
host = runHost()
host.load_module(repository / "AIFRecon" / "AIFRecon.py")
import numpy as np
import slicer
import tinyScene
from AIFRecon import AIFReconLogic

tinyScene.addCT()[1].SetName("Segmentation")
# the lines go here
print("voxels:", np.count_nonzero(slicer.util.arrayFromVolume(volume)))
host.raise_slot_errors()
"""
"""What Slicer has done before somebody types the lines, and a look at what they made."""


def test_the_lines_of_the_console_make_a_volume(tmp_path):
    make_workplace(tmp_path)
    (block,) = [block for block in blocks(GUIDE) if block.language == "python"]
    program = tmp_path / "console.py"
    program.write_text(AROUND.replace("# the lines go here", block.text), "utf-8")
    done = run_on_host(program, REPOSITORY, folder=tmp_path, PYTHONPATH=str(REPOSITORY))
    assert done.returncode == 0, done.stderr[-3000:]
    voxels = int(done.stdout.rpartition("voxels:")[2])
    assert voxels > 100

"""The application is closed in the middle of the module's work: it ends silently, and nothing is left half done."""

from __future__ import annotations

import subprocess

import pytest
from host_process import OPEN, run_on_host

SCRIPT = """
updates = []

def nodes():
    scene = slicer.mrmlScene
    kept = [scene.GetNthNode(n) for n in range(scene.GetNumberOfNodes())]
    return sorted(node.GetID() for node in kept if node.IsA("vtkMRMLStorableNode"))

def during(press, close, share):
    "Press, and close the application from an event once so much is done."
    def look(value):
        updates.append(value)
        if value > share and updates.count("closed") == 0:
            updates.append("closed")
            qt.QTimer.singleShot(0, close)
    host.dialogs.on_progress = look
    qt.QTimer.singleShot(0, press)

def chooseInputs():
    parameters.sweep = tinyScene.addSweep()
    parameters.ctVolume, parameters.bone, _registration = tinyScene.addCT()
    parameters.spacing = 1.0

{actions}
before = nodes()
host.run()
print("closed:", "closed" in updates)
print("went on:", len(updates) - 1 - updates.index("closed") > 1)  # a window is closed in two steps
print("unchanged:", nodes() == before)
print("shown:", host.dialogs.messages())
print("errors:", [repr(error) for error in host.take_slot_errors()])
"""

PRESS = "chooseInputs()\nduring(ui.{button}Button.click, {close}, {share})"


def close(actions: str) -> subprocess.CompletedProcess[str]:
    """A session with the module that does something and is closed meanwhile."""
    done = run_on_host("-c", OPEN + SCRIPT.replace("{actions}", actions))
    assert (done.returncode, done.stderr) == (0, ""), done.stderr[-3000:]
    return done


@pytest.mark.parametrize(
    ("button", "share", "way"), [("apply", 600, "slicer.util.mainWindow().close"), ("compare", 300, "slicer.util.exit")]
)
def test_work_ends_with_the_application_without_a_word(button, share, way):
    done = close(PRESS.format(button=button, close=way, share=share))
    assert done.stdout.splitlines()[-5:] == ["closed: True", "went on: False", "unchanged: True", "shown: []", "errors: []"]


SCAN = """
from AIFReconLib.live.replay.server import ReplayServer
server = ReplayServer(tinyScene.makeSequence(), 0, rate=30.0, loop=True)
server.start()
parameters.liveHost, parameters.livePort = "127.0.0.1", server.port
parameters.liveRecordPath = pathlib.Path({path!r})
parameters.spacing = 1.0
ui.liveStartButton.click()
watch = qt.QTimer()
def look():
    live = widget._live._live
    if live is not None and live.statistics.frames_received > 20 and "closed" not in updates:
        updates.append("closed")
        {close}()
watch.connect("timeout()", look)
watch.start(20)
"""


def test_a_scan_ends_with_the_application_and_its_recording_is_whole(tmp_path):
    from AIFReconLib import read_sequence

    done = close(SCAN.format(path=str(tmp_path / "scan.mhd"), close="slicer.util.mainWindow().close"))
    assert done.stdout.splitlines()[-2:] == ["shown: []", "errors: []"]
    assert len(read_sequence(tmp_path / "scan.mhd")) > 10
    assert [path.name for path in tmp_path.iterdir() if path.suffix not in (".mhd", ".raw", ".zraw")] == []

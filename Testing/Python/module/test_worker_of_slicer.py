"""What computes stays out of Slicer's process: all of it is done by the worker, which ends with the application."""

from __future__ import annotations

import time
from pathlib import Path

from host_process import OPEN, run_on_host

SCRIPT = """
from unittest import mock
from AIFReconScene.work import worker
from AIFReconScene.volumes import phantomSample
from AIFReconScene.volumes.volumeNodes import saveSettings

parameters.spacing = 2.0
with mock.patch.object(phantomSample, "loadPhantom", functools.partial(phantomSample.loadPhantom, frames=27)):
    ui.sampleButton.click()
assert parameters.output is not None, host.dialogs.messages()
while widget._recorded.lights.isLooking:
    slicer.app.processEvents()
saveSettings(parameters.output, pathlib.Path(sys.argv[1]) / "settings.json")
ui.compareButton.click()
assert slicer.util.getNodesByClass("vtkMRMLTableNode"), host.dialogs.messages()
widget.logic.reconstruct(parameters.sweep, method="average", spacing=3.0)
packages = ("scipy", "SimpleITK", "numba", "llvmlite", "onnxruntime", "matplotlib", "pyigtl")
print("loaded:", [name for name in packages if name in sys.modules])
print("worker:", worker.pid)
print("errors:", host.dialogs.messages(), [repr(error) for error in host.take_slot_errors()])
qt.QTimer.singleShot(0, slicer.util.exit)
host.run()
"""


def test_nothing_that_computes_is_loaded_by_sample_reconstruction_and_comparison_and_the_worker_ends_with_the_application(tmp_path):
    done = run_on_host("-c", OPEN + SCRIPT, tmp_path)
    said = dict(line.split(": ", 1) for line in done.stdout.splitlines() if ": " in line)
    assert said.get("errors") == "[] []", done.stdout + done.stderr
    assert said["loaded"] == "[]"
    assert (tmp_path / "settings.json").is_file()
    deadline = time.monotonic() + 60
    while Path(f"/proc/{said['worker']}").exists():
        assert time.monotonic() < deadline
        time.sleep(0.1)

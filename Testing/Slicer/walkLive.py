"""Steps of `walkInSlicer.py`: scans of recordings that a process of its own replays over OpenIGTLink.

Each takes the walk. The stalls of *Start* and of what goes on while a scan is under way are noted apart, by names that begin with
``start`` and ``while``.
"""

import contextlib
import pathlib
import re
import shutil
import subprocess
import time

import realData
import slicer
from walkBone import MODEL, requireNetwork

HERE = pathlib.Path(__file__).resolve().parent

FRAMES_SCOUTED, FRAMES_INSERTED = 60, 200
RATE, GUIDED_RATE = 20.0, 30.0
"""Frames per second of a replayed recording."""

HANDLED_EVERY = 2.0
"""s between two things that a user does in a scan."""

GUIDED_FRAMES, GUIDED_SECONDS = 270, 15.0
"""Frames of the simulated sweep, and s for which they are counted once advice has come."""


@contextlib.contextmanager
def replayed(recording, configuration, log, rate=RATE):
    """A scanner: the recording, replayed over OpenIGTLink by a process of its own, whose errors go to the file `log`. Gives the port."""
    python = shutil.which("PythonSlicer") or shutil.which("python3")
    command = [python, "-m", "AIFReconLib", "replay", recording, "--config", configuration, "--port", "0", "--rate", f"{rate:g}", "--loop"]
    with open(log, "w", encoding="utf-8") as errors:
        scanner = subprocess.Popen(
            list(map(str, command)),
            cwd=HERE.parents[1],
            env=slicer.util.startupEnvironment(),
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
        )
    try:
        yield int(re.search(r"port (\d+)", scanner.stdout.readline())[1])
    finally:
        scanner.kill()
        scanner.wait()


def live(walk) -> None:
    """A real recording is replayed, its box found, and a volume grows while it is received."""
    scan(walk, "Live")


def liveNetwork(walk) -> None:
    """The same scan, while a network in a file tells where bone is."""
    from AIFReconScene.inputs.boneSource import BoneSource

    requireNetwork()
    walk.ui.liveBoneModelPathLineEdit.currentPath = str(MODEL)
    walk.ui.liveBoneSourceComboBox.currentIndex = list(BoneSource).index(BoneSource.MODEL)
    looked = scan(walk, "LiveNetwork").seen._watch.state
    if looked.problem is not None or not looked.frames:
        raise RuntimeError(f"the network looked at {looked.frames} frames: {looked.problem}")
    print(f"the network looked at {looked.frames} frames", flush=True)


def liveGuidance(walk) -> None:
    """A simulated patient is scanned at 30 frames/s with *Guidance*, which tells a next move; panel and CT are handled meanwhile."""
    from AIFReconLib.commands.simulate import write_simulated_patient

    slicer.mrmlScene.Clear()
    walk.settle()
    files = write_simulated_patient(walk.folder / "patient", frames=GUIDED_FRAMES)
    walk.open([files.sequence, files.configuration, files.ct, files.labels, files.ct_to_reference])
    walk.parameters.guidance = True
    began = time.monotonic()

    def advised(running) -> None:
        walk.wait(lambda: walk.ui.guidanceMoveLabel.text, what="a next move")
        first, before = time.monotonic() - began, running.session.statistics
        walk.settle(GUIDED_SECONDS)
        after = running.session.statistics
        received = (after.frames_received - before.frames_received) / GUIDED_SECONDS
        inserted = (after.inserted - before.inserted) / GUIDED_SECONDS
        print(f"next move after {first:.1f} s; {received:.1f} frames/s received, {inserted:.1f} inserted", flush=True)
        handle(walk)

    scan(walk, "LiveGuidance", (files.sequence, files.configuration), GUIDED_RATE, advised)


def handle(walk) -> None:
    """Do what a user may do in the middle of a scan; each is noted apart from the scan so far."""
    walk.note("whileLiveGuidance")
    picture = slicer.util.childWidgetVariables(walk.widget.parent)
    boxes = (picture.showLevelsCheckBox, picture.probeUpCheckBox, walk.ui.liveGuidanceCheckBox)
    for button in (
        walk.ui.livePlaceButton,
        walk.ui.undoPlaceButton,
        *(box for box in boxes for _way in ("to", "fro")),
        walk.ui.liveMoreButton,
    ):
        walk.press(button)
        walk.settle(HANDLED_EVERY)
        walk.note(f"whileLiveGuidance, {button.text}")


def scan(walk, name: str, source=None, rate: float = RATE, meanwhile=lambda running: None):
    """Scan in the Live tab; what happened is measured and pictured under a name. Returns the scan, which is over.

    `source` is (recording, configuration), by default a real one; `meanwhile` is called with the scan once its volume is seen to grow.
    """
    recording, configuration = source or realRecording()
    with replayed(recording, configuration, walk.folder / "replay.log", rate) as port:
        walk.parameters.output = None
        walk.parameters.liveHost, walk.parameters.livePort = "127.0.0.1", port
        walk.ui.tabWidget.currentIndex = 1
        walk.settle()
        walk.heart.start()
        walk.press(walk.ui.liveStartButton)
        walk.settle(0.1)
        walk.note(f"start{name}")
        running = walk.widget._live._live
        session = running.session
        walk.wait(lambda: session.scouted >= FRAMES_SCOUTED, what="a box")
        walk.wait(lambda: walk.ui.liveUseBoxButton.enabled, what="Use the scanned area")
        walk.press(walk.ui.liveUseBoxButton)
        walk.wait(lambda: session.statistics.inserted > FRAMES_INSERTED, what="frames")
        walk.wait(lambda: shown("Green") is not None and shown("Green") is running.volumeNode, what="the growing volume in the green view")
        walk.wait(lambda: shown("Red") is running.frameNode, what="the frame in the red view")
        meanwhile(running)
        walk.note(f"while{name}")
        walk.picture(f"scan{name}")
        walk.heart.start()
        walk.press(walk.ui.liveStopButton)
    if walk.parameters.output is None or not slicer.util.arrayFromVolume(walk.parameters.output).any():
        raise RuntimeError(f"the scan left no volume: {walk.ui.liveStatisticsLabel.text}")
    return running


def realRecording():
    """A real recording and its configuration; without real data the step is left out."""
    calibration = realData.folder() / realData.SPINE_CALIBRATION
    return realData.recordingOf(calibration), calibration


def shown(view: str):
    """The volume in the foreground, else the background, of a slice view."""
    composite = slicer.app.layoutManager().sliceWidget(view).mrmlSliceCompositeNode()
    return slicer.mrmlScene.GetNodeByID(composite.GetForegroundVolumeID() or composite.GetBackgroundVolumeID() or "")

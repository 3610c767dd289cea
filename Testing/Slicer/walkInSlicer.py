"""Walks through the module inside a Slicer application as a user does, looks at every step and measures how long the GUI stands still.

    Slicer --no-splash --additional-module-paths AIFRecon --python-script Testing/Slicer/walkInSlicer.py FOLDER

The steps are those of docs/slicer.md: sample data, a reconstruction, the comparison, boxes, saving and loading, bone from echoes and from
a network, a real recording, live scans of it, the lights in all colors. What cannot be done here is said and left out: without the Python
package onnxruntime (Slicer's console: slicer.util.pip_install("onnxruntime")) a network in a file, without real recordings theirs. Into
FOLDER go a picture of the window after each step and `walk.json`: the longest stall of each step in ms, how many times as slow as at best
the machine itself was in it (`walkMachine.py`), what was left out, and what the application's log says that it should not. Every stall over
the limits is told: as `slow`, or as `disturbed` where the machine itself was more than twice as slow as at best just then. The exit status
is 0 when every step succeeded, no stall was over the limits, disturbed or not, and the log holds no traceback.

    ... walkInSlicer.py FOLDER --only recording,live
    ... walkInSlicer.py FOLDER --only liveGuidance
    ... walkInSlicer.py FOLDER --only sampleData,echoes,network,recordedNetwork,liveNetwork

Takes these steps alone.

    ... walkInSlicer.py FOLDER --close SECONDS [--window]

Closes the application in the middle of a reconstruction instead, SECONDS after its start; it must end within a second, in silence.
"""

import json
import pathlib
import sys
import time
import unittest

import numpy as np
import qt
import slicer

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import realData  # noqa: E402 - the folder must be known first
from walkBone import echoes, network, recordedNetwork  # noqa: E402
from walkLights import lights  # noqa: E402
from walkLive import live, liveGuidance, liveNetwork  # noqa: E402
from walkMachine import DISTURBED, watchedMachine  # noqa: E402

WINDOW = (1400, 900)
PANEL_WIDTH = 400
"""Pixels. The panel stays as wide as the user has made it."""

LONGEST_IN_A_RUN, LONGEST_WHILE_LIVE = 0.25, 0.1
"""s for which the GUI may stand still."""

PUSHED, NEAR = (4.0, -6.0, 3.0), 1.5
"""mm: how far the CT is pushed off its place, and how near the bone's box comes back to it."""


class Heart:
    """Beats in the GUI's event loop, and knows the longest time between two beats: for so long nothing was drawn or heard.

    On a machine with other work a part of that time is theirs: `worked` is what the GUI's own thread computed at most between two beats.
    """

    INTERVAL = 5
    """ms."""

    def __init__(self):
        self._timer = qt.QTimer()
        self._timer.setInterval(self.INTERVAL)
        self._timer.connect("timeout()", self._beat)
        self._timer.start()
        self.start()

    def start(self) -> None:
        """Begin a new measurement."""
        self._last, self.longest, self.when = time.monotonic(), 0.0, (0.0, 0.0)
        self.long: list[tuple[float, float]] = []
        """Begin and end of each stall that is over a limit."""
        self._lastWorked, self.worked = time.thread_time(), 0.0

    def _beat(self) -> None:
        now, worked = time.monotonic(), time.thread_time()
        if now - self._last > self.longest:
            self.longest, self.when = now - self._last, (self._last, now)
        if now - self._last > min(LONGEST_IN_A_RUN, LONGEST_WHILE_LIVE):
            self.long.append((self._last, now))
        self.worked = max(self.worked, worked - self._lastWorked)
        self._last, self._lastWorked = now, worked


class Walk:
    """The module in the application, with short ways to what the steps need."""

    LOOK_EVERY = 20
    """ms between two looks at what is waited for."""

    def __init__(self, folder: pathlib.Path):
        self.folder = folder
        self.heart = Heart()
        self.stalls: dict[str, float] = {}
        self.worked: dict[str, float] = {}
        """ms of the stalls in which the GUI's thread computed."""
        self.when: dict[str, tuple[float, float]] = {}
        """Begin and end of the stalls."""
        self.long: list[tuple[str, float, float]] = []
        """Step, begin and end of each stall that is over its limit."""
        self.drawn: dict[str, float] = {}
        """ms until Slicer had drawn what a step has changed; that is its own work."""
        slicer.util.mainWindow().resize(*WINDOW)
        slicer.util.mainWindow().move(0, 0)
        # The offer of numba, made once, is a question that nobody here answers
        slicer.app.userSettings().setValue("AIFRecon/FastOffered", True)
        slicer.util.selectModule("AIFRecon")
        dock = slicer.util.findChild(slicer.util.mainWindow(), "PanelDockWidget")
        slicer.util.mainWindow().resizeDocks([dock], [PANEL_WIDTH], qt.Qt.Horizontal)
        self.settle()
        self.dock, self.width = dock, dock.width
        self.widened: list[str] = []

    @property
    def widget(self):
        """The panel."""
        return slicer.modules.AIFReconWidget

    @property
    def ui(self):
        """The panel's widgets by name."""
        return self.widget.ui

    @property
    def parameters(self):
        """The panel's parameters."""
        return self.widget._parameterNode

    def settle(self, seconds: float = 0.5) -> None:
        """Let the application do what it has put off."""
        self.wait(lambda: False, seconds, "")

    def wait(self, condition, seconds: float = 120.0, what: str = "what was waited for") -> None:
        """Let the event loop run until the condition holds; an error after so many seconds, unless nothing is said to be waited for.

        The loop is Qt's own, as it is where a user waits: one in Python would wait for the threads of a scan between two events.
        """
        loop, timer, end = qt.QEventLoop(), qt.QTimer(), time.monotonic() + seconds
        met, errors = False, []

        def look() -> None:
            nonlocal met
            try:
                met = bool(condition())
            except Exception as error:  # out of a slot it would go to the log
                errors.append(error)
            if met or errors or time.monotonic() > end:
                loop.quit()

        timer.setInterval(self.LOOK_EVERY)
        timer.connect("timeout()", look)
        timer.start()
        loop.exec_()
        timer.stop()
        if errors:
            raise errors[0]
        if not met and what:
            raise RuntimeError(f"{what} did not come: {self.ui.statusLabel.text} {self.ui.liveStatisticsLabel.text}")

    def press(self, button) -> None:
        """Click a button that must be enabled."""
        if not button.enabled:
            raise RuntimeError(f"{button.text} cannot be pressed: {button.toolTip} {self.ui.statusLabel.text}")
        button.click()

    def open(self, paths) -> None:
        """Press the button that opens files, and choose these."""
        recorded = self.widget._recorded
        recorded._ask = lambda: paths
        try:
            self.press(self.ui.openButton)
        finally:
            del recorded._ask
        if self.ui.statusLabel.text[:6] != "Opened":
            raise RuntimeError(f"the files were not opened: {self.ui.statusLabel.text}")

    def picture(self, name: str) -> None:
        """The window as it is, with nothing of a scan half shown."""
        self.settle()
        scan = self.widget._live._live
        self.wait(lambda: scan is None or not scan._inSteps.isUnderWay, what="all of a scan in the views")
        for view in [*slicer.util.findChildren(className="qMRMLSliceView"), *slicer.util.findChildren(className="qMRMLThreeDView")]:
            view.forceRender()
        slicer.util.mainWindow().grab().save(str(self.folder / f"{name}.png"))

    def note(self, name: str) -> None:
        """Keep the longest stall under a name, where it is longer than what is kept there already, and begin a new measurement."""
        if round(self.heart.longest * 1000.0) >= self.stalls.get(name, 0):
            self.when[name] = self.heart.when
        for kept, seconds in ((self.stalls, self.heart.longest), (self.worked, self.heart.worked)):
            kept[name] = max(kept.get(name, 0), round(seconds * 1000.0))
        limit = LONGEST_WHILE_LIVE if name.startswith("while") else LONGEST_IN_A_RUN
        self.long += [(name, begin, end) for begin, end in self.heart.long if end - begin > limit]
        self.heart.start()

    def step(self, function) -> None:
        """Do one step, measured, and take its picture."""
        name = function.__name__
        self.heart.start()
        try:
            function(self)
        finally:
            self.note(name)
            self.settle()
            self.drawn[name] = round(self.heart.longest * 1000.0)
        if self.dock.width != self.width:
            self.widened.append(f"{name}: from {self.width} to {self.dock.width} pixels")
            self.width = self.dock.width
        self.picture(name)
        print(f"{name}: {function.__doc__} Longest stall {self.stalls[name]} ms, worked {self.worked[name]} ms.", flush=True)


def sampleData(walk: Walk) -> None:
    """The sample patient is loaded from the Sample Data module."""
    from AIFReconGui.sampleData import SAMPLE_NAME

    slicer.util.selectModule("SampleData")
    walk.settle()
    buttons = slicer.util.findChildren(slicer.modules.sampledata.widgetRepresentation(), className="QToolButton")
    walk.press(next(button for button in buttons if button.text == SAMPLE_NAME))
    slicer.util.selectModule("AIFRecon")
    walk.settle()
    if walk.parameters.sweep is None or walk.parameters.bone is None or walk.parameters.ctVolume is None:
        raise RuntimeError("the sample data are not chosen in the panel")


def apply(walk: Walk) -> None:
    """The sample patient is reconstructed."""
    walk.press(walk.ui.applyButton)
    if walk.parameters.output is None or not slicer.util.arrayFromVolume(walk.parameters.output).any():
        raise RuntimeError(f"nothing was reconstructed: {walk.ui.statusLabel.text}")


def compare(walk: Walk) -> None:
    """The methods are compared side by side."""
    walk.press(walk.ui.compareButton)
    if slicer.util.getNodes("*comparison*") == {}:
        raise RuntimeError(f"nothing was compared: {walk.ui.statusLabel.text}")


def single(walk: Walk) -> None:
    """Back from the comparison."""
    walk.press(walk.ui.singleViewButton)


def register(walk: Walk) -> None:
    """The CT is pushed off its place, and finds it again."""
    mover = walk.parameters.bone.GetParentTransformNode()
    right = slicer.util.arrayFromTransformMatrix(mover)
    off = right.copy()
    off[:3, 3] += PUSHED
    slicer.util.updateTransformMatrixFromArray(mover, off)
    walk.ui.registrationMoreButton.checked = True
    walk.settle()
    walk.press(walk.ui.placeButton)
    bounds = [0.0] * 6
    walk.parameters.bone.GetBounds(bounds)
    corners = np.array([[x, y, z, 1.0] for x in bounds[:2] for y in bounds[2:4] for z in bounds[4:]])
    missed = np.linalg.norm((corners @ (slicer.util.arrayFromTransformMatrix(mover) - right).T)[:, :3], axis=1).max()
    if missed > NEAR:
        raise RuntimeError(f"the CT lies {missed:.1f} mm off: {walk.ui.registrationLabel.text}")


def guidance(walk: Walk) -> None:
    """The bone takes on the colors of what the sweep met, and the next move is told."""
    walk.ui.coverageMoreButton.checked = True
    walk.settle()
    walk.press(walk.ui.guidanceCheckBox)
    if not walk.ui.guidanceMoveLabel.text or not walk.ui.guidanceTableLabel.text:
        raise RuntimeError(f"no next move was told: {walk.ui.guidanceLabel.text}")


def box(walk: Walk) -> None:
    """A new box lies around the sweep, and is reconstructed."""
    from AIFReconScene.inputs.parameters import Region

    walk.parameters.region = Region.BOX
    walk.settle()
    walk.ui.roiSelector.addNode()
    walk.settle()
    if min(walk.parameters.roi.GetSize()) <= 0.0:
        raise RuntimeError("the new box has no size")
    walk.heart.start()  # drawing the handles of a first box is Slicer's own work
    walk.press(walk.ui.applyButton)


def saveAndLoad(walk: Walk) -> None:
    """The scene is saved, closed and loaded: the same choices, and the same voxels when it is reconstructed again."""
    file = walk.folder / "scene.mrb"
    before = slicer.util.arrayFromVolume(walk.parameters.output).copy()
    method, spacing = walk.parameters.method, walk.parameters.spacing
    if not slicer.util.saveScene(str(file)):
        raise RuntimeError("the scene could not be saved")
    slicer.mrmlScene.Clear()
    walk.settle()
    if not slicer.util.loadScene(str(file)):
        raise RuntimeError("the scene could not be loaded")
    walk.settle()
    np.testing.assert_array_equal(slicer.util.arrayFromVolume(walk.parameters.output), before)
    if (walk.parameters.method, walk.parameters.spacing) != (method, spacing):
        raise RuntimeError("the choices were not loaded")
    walk.heart.start()  # so are saving, emptying and loading a scene
    walk.press(walk.ui.applyButton)
    np.testing.assert_array_equal(slicer.util.arrayFromVolume(walk.parameters.output), before)


def recording(walk: Walk) -> None:
    """A real recording is loaded with its calibration, and reconstructed."""
    slicer.mrmlScene.Clear()
    walk.settle()
    walk.heart.start()  # emptying a scene is Slicer's own work
    calibration = realData.folder() / realData.SPINE_CALIBRATION
    walk.parameters.recordingPath, walk.parameters.configurationPath = realData.recordingOf(calibration), calibration
    walk.settle()
    walk.press(walk.ui.loadButton)
    walk.press(walk.ui.applyButton)
    if walk.parameters.output is None:
        raise RuntimeError(f"the recording was not reconstructed: {walk.ui.statusLabel.text}")


STEPS = (
    *(sampleData, apply, compare, single, register, guidance, box, saveAndLoad),
    *(echoes, network, recordedNetwork, recording, live, liveNetwork, liveGuidance, lights),
)


def logged() -> list[str]:
    """Lines of the application's log that tell of a traceback or an error."""
    path = pathlib.Path(slicer.app.errorLogModel().filePath)
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines() if path.is_file() else []
    # An empty line on standard error is logged as a critical one without a word
    lines = [line for line in lines if not line.rstrip().endswith("-")]
    return [line for line in lines if "Traceback" in line or "[CRITICAL]" in line or "[ERROR]" in line]


def closeInMidRun(walk: Walk, seconds: float, byWindow: bool) -> None:
    """Close the application while it reconstructs, by code or by its window; what Python does afterwards is seen from outside."""
    walk.step(sampleData)
    walk.parameters.spacing = 0.3

    def discard() -> None:
        question = slicer.app.activeModalWidget()
        print(f"answering at {time.time():.3f}", flush=True)
        next(button for button in slicer.util.findChildren(question, className="QPushButton") if "discard" in button.text.lower()).click()

    def close() -> None:
        print(f"closing at {time.time():.3f}", flush=True)
        if byWindow:
            # Slicer asks whether to save the scene first
            qt.QTimer.singleShot(1000, discard)
            slicer.util.mainWindow().close()
        else:
            slicer.util.exit(0)

    qt.QTimer.singleShot(int(seconds * 1000), close)
    walk.press(walk.ui.applyButton)
    print(f"the run ended at {time.time():.3f}", flush=True)


def main(arguments: list[str]) -> int:
    """Walk; the exit status."""
    folder = pathlib.Path(arguments[0])
    folder.mkdir(parents=True, exist_ok=True)
    # A scan is recorded beside the scene
    slicer.mrmlScene.SetRootDirectory(str(folder))
    walk = Walk(folder)
    if "--close" in arguments:
        closeInMidRun(walk, float(arguments[arguments.index("--close") + 1]), "--window" in arguments)
        return 1  # the application should be gone
    failed, left = [], []
    chosen = arguments[arguments.index("--only") + 1].split(",") if "--only" in arguments else [step.__name__ for step in STEPS]
    with watchedMachine(folder / "machine.txt") as machine:
        for step in [step for step in STEPS if step.__name__ in chosen]:
            try:
                walk.step(step)
            except unittest.SkipTest as why:
                left.append(f"{step.__name__}: {why}")
                print(f"LEFT OUT {left[-1]}", flush=True)
            except Exception as error:
                failed.append(f"{step.__name__}: {type(error).__name__}: {error}")
                print(f"FAILED {failed[-1]}", flush=True)
                walk.picture(f"{step.__name__}-failed")
    slow: list[str] = []
    disturbed: list[str] = []
    for name, begin, end in walk.long:
        times = machine.slowed(begin, end)
        (disturbed if times > DISTURBED else slow).append(f"{name}: {1000.0 * (end - begin):.0f} ms, the machine {times:.1f} times as slow")
    trouble = {"failed": failed, "widened": walk.widened, "slow": slow, "disturbed": disturbed, "log": logged()}
    slowed = {name: round(machine.slowed(*when), 1) for name, when in walk.when.items()}
    measured = {"stalls_ms": walk.stalls, "worked_ms": walk.worked, "machine_slowed": slowed, "drawn_ms": walk.drawn}
    found = {"version": slicer.app.applicationVersion, "left_out": left, **measured, **trouble}
    (folder / "walk.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    print(json.dumps(found, indent=2), flush=True)
    return 1 if any(trouble.values()) else 0


if "--close" in sys.argv:
    # In the application's own event loop, whose end is what the work must hear
    qt.QTimer.singleShot(1000, lambda: main(sys.argv[1:]))
else:
    slicer.util.exit(main(sys.argv[1:]))

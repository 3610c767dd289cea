"""Walks through the module in a Slicer application as a user does; measures how smooth its windows stay, and takes pictures of each step.

    Slicer --no-splash --additional-module-paths AIFRecon --python-script Testing/Slicer/walkInSlicer.py FOLDER [SECONDS]
    QT_QPA_PLATFORM=offscreen python Testing/Slicer/walkInSlicer.py FOLDER [SECONDS]  # on Testing/host: to see that it works

A run: the sample in one press, again, the comparison, guidance, paths, a wrong CT, placed, a patient who moves, a thin scan. A scan:
SECONDS (60) of a simulated patient at 30 frames/s of 640 x 480 from a process of its own, with guidance and recording, its box from a
first look over all, presses in its middle, Stop; then one without a CT. What came of it is printed and kept in FOLDER/measured.json, the
pictures in FOLDER/pictures: those of the pages are copies of them. The exit status is 0 when every step succeeded. Only buttons and what
the panel shows are used, so that states of the module can be compared.
"""

import contextlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import zlib
from typing import Any

import numpy as np
from PIL import Image

HERE = pathlib.Path(__file__).resolve().parent
try:
    import qt
except ImportError:
    sys.path.append(str(HERE.parent))
    from host import runHost

    runHost().start(HERE.parents[1] / "AIFRecon" / "AIFRecon.py")
    import qt
sys.path.append(str(HERE))
import slicer  # noqa: E402 - the host makes it
import tinyScene  # noqa: E402 - its folder must be known first

from AIFReconLib.simulation.scan import TrackingErrors  # noqa: E402 - known once Slicer has loaded the module
from AIFReconLib.workflows.simulate import FILES, write_simulated_patient  # noqa: E402

BEAT = 10
"""ms between two looks of the event loop at the clock: what comes later than that was kept waiting."""

LIMITS = 50, 150
"""ms."""

SIZE = 480, 640
"""Rows and columns of a frame."""

ONE_SWEEP = 9.0
"""s that the scanner takes for one sweep, and a little more."""


WRONG = 9.0, -6.0, 13.0
"""mm, RAS, by which the CT is moved: 17 mm."""

MOVED, MOVED_FRAMES = 3.0, 189
"""mm by which the patient who moves lies elsewhere in each pass, and frames of that scan."""

PROGRESS = 0.45
"""Share of the work at which the dialog is pictured."""


class Beat:
    """A timer of the event loop, and how late it came each time: for so long nothing was drawn or heard."""

    def __init__(self):
        self.late: dict[str, list[float]] = {}
        """ms, by step."""
        self.step, self._last, self.also = "", time.monotonic(), lambda: None
        self._timer = qt.QTimer()
        self._timer.connect("timeout()", self._beat)
        self._timer.start(BEAT)

    def begin(self, step: str) -> None:
        """What comes from now on belongs to this step; to none, if it has no name."""
        self.step, self._last = step, time.monotonic()

    def _beat(self) -> None:
        now = time.monotonic()
        if self.step:
            self.late.setdefault(self.step, []).append(max(1000.0 * (now - self._last) - BEAT, 0.0))
        self.also()
        # What this itself takes is not the application's
        self._last = time.monotonic()

    def told(self, kind: str) -> dict[str, float | str]:
        """Of all steps whose name begins so."""
        steps = {step: late for step, late in self.late.items() if step.startswith(kind)}
        late = np.array([each for step in steps.values() for each in step])
        told: dict[str, float | str] = {}
        for limit in LIMITS:
            told[f"{kind}: % of turns within {limit} ms"] = round(100.0 * float(np.mean(late <= limit)), 2)
        longest = max(steps, key=lambda step: max(steps[step]))
        return told | {f"{kind}: longest pause, ms": round(max(steps[longest])), f"{kind}: longest pause in": longest}


class Screen:
    """When frames and voxels of a scan are seen, compared with when they were sent."""

    def __init__(self, folder: pathlib.Path):
        self._folder = folder
        told = json.loads((folder / "frames.json").read_text("utf-8"))
        self.count = len(told)
        self._numbers = {each["checksum"]: number for number, each in enumerate(told)}
        self._points = np.array([[*point, 1.0] for each in told for point in each["points"]])
        self._of = np.array([number for number, each in enumerate(told) for _point in each["points"]])
        self._changed: dict[str, int] = {}
        self.frames: list[tuple[int, float]] = []
        self.voxels: dict[int, float] = {}
        """When the first voxel of a frame was seen."""
        self.begin = 0.0

    def look(self) -> None:
        """Note what is new."""
        now = time.monotonic()
        node = shown("Red")
        if node is not None and self._isNew("frame", node):
            array = slicer.util.arrayFromVolume(node)
            number = self.number(array)
            if number is not None:
                self.frames.append((number, now))
        # The panel's own: to ask the logic for them takes milliseconds
        node = slicer.modules.AIFReconWidget._parameterNode.output
        if self.begin and node is not None and self._isNew("volume", node):
            toIJK = slicer.util.vtkMatrixFromArray(np.eye(4))
            node.GetRASToIJKMatrix(toIJK)
            array = slicer.util.arrayFromVolume(node)
            places = np.rint(self._points @ slicer.util.arrayFromVTKMatrix(toIJK).T)[:, 2::-1].astype(int)
            inside = np.all((places >= 0) & (places < array.shape), axis=1)
            filled = array[tuple(places[inside].T)] > 0
            for number in np.unique(self._of[inside][filled]):
                self.voxels.setdefault(int(number), now)

    def number(self, image: np.ndarray) -> int | None:
        """That of a frame of the sweep; None of another image."""
        return self._numbers.get(zlib.crc32(image.tobytes())) if image.size == SIZE[0] * SIZE[1] else None

    def _isNew(self, what: str, node) -> bool:
        changed = node.GetImageData().GetMTime() if node.GetImageData() is not None else 0
        before, self._changed[what] = self._changed.get(what), changed
        return changed != before

    def told(self) -> dict[str, float]:
        """ms from being sent to being seen."""
        sent = [(int(number), float(when)) for number, when in map(str.split, (self._folder / "sent.txt").read_text("utf-8").splitlines())]
        onScreen = [now - max(when for number, when in sent if number == seen and when <= now) for seen, now in self.frames]
        first: dict[int, float] = {}
        for number, when in sent:
            if when >= self.begin:
                first.setdefault(number, when)
        # Voxels that were there before their frame was sent came from its neighbors
        inVolume = [self.voxels[number] - when for number, when in first.items() if self.voxels.get(number, 0.0) >= when]
        told: dict[str, float] = {}
        for name, ages in (("frame on screen after ms", onScreen), ("voxels after ms", inVolume)):
            for part in (50, 95):
                told[f"{name}, {part} of 100"] = round(1000.0 * float(np.percentile(ages, part))) if ages else -1.0
        return told


def parameters():
    """The module's parameters."""
    return slicer.modules.AIFReconWidget.logic.getParameterNode()


def shown(view: str):
    """The volume in the foreground, else the background, of a slice view."""
    composite = slicer.app.layoutManager().sliceWidget(view).mrmlSliceCompositeNode()
    return slicer.mrmlScene.GetNodeByID(composite.GetForegroundVolumeID() or composite.GetBackgroundVolumeID() or "")


class Walk:
    """The module in the application, used step by step."""

    def __init__(self, folder: pathlib.Path):
        self.folder, self.beat = folder, Beat()
        self.seconds: dict[str, float] = {}
        # The offer of numba, made once, is a question that nobody here answers
        slicer.app.userSettings().setValue("AIFRecon/FastOffered", True)
        slicer.util.mainWindow().resize(1400, 900)
        # A scan is recorded beside the scene
        slicer.mrmlScene.SetRootDirectory(str(folder))
        slicer.util.selectModule("AIFRecon")
        self.ui = slicer.modules.AIFReconWidget.ui

    def wait(self, condition, what: str, seconds: float = 300.0) -> None:
        """Let the event loop run, as where a user waits, until the condition holds; an error after so many seconds if it is named."""
        loop, timer, end = qt.QEventLoop(), qt.QTimer(), time.monotonic() + seconds

        def look() -> None:
            if time.monotonic() > end or condition():
                loop.quit()

        timer.connect("timeout()", look)
        timer.start(20)
        loop.exec_()
        timer.stop()
        if what and not condition():
            raise RuntimeError(f"{what} did not come: {self.ui.statusLabel.text} {self.ui.liveStatisticsLabel.text}")

    def settle(self, seconds: float) -> None:
        """Look at it for a while."""
        self.wait(lambda: False, "", seconds)

    def press(self, step: str, button, after: float = 2.0) -> None:
        """Click a button that must be enabled, and look at what comes of it."""
        if not button.enabled:
            raise RuntimeError(f"{step}: {button.text} cannot be pressed: {button.toolTip} {self.ui.statusLabel.text}")
        self.beat.begin(step)
        begun = time.monotonic()
        button.click()
        self.seconds[step] = round(time.monotonic() - begun, 2)
        self.settle(after)
        self.beat.begin("")
        print(f"{step}: {self.seconds[step]} s", flush=True)

    def picture(self, name: str, widget=None, parts: int = 1) -> None:
        """Keep what the window, or a widget in all its length, shows, cut into so many parts side by side."""
        path = self.folder / "pictures" / f"{name}.png"
        path.parent.mkdir(exist_ok=True)
        (widget or slicer.util.mainWindow()).grab().save(str(path))
        with Image.open(path) as file:
            whole = file.convert("RGB")
        width, height = whole.width, -(-whole.height // parts)
        beside = Image.new("RGB", (parts * width, height), whole.getpixel((0, 0)))
        for part in range(parts):
            beside.paste(whole.crop((0, part * height, width, min((part + 1) * height, whole.height))), (part * width, 0))
        beside.quantize(255, dither=Image.Dither.NONE).save(path, optimize=True)

    def judged(self, step: str, button, name: str) -> None:
        """Press a button that reconstructs, and take the picture when all lights are told."""
        self.press(step, button)
        if parameters().output is None:
            raise RuntimeError(f"nothing was reconstructed: {self.ui.statusLabel.text}")
        self.wait(lambda: not slicer.modules.AIFReconWidget._recorded.lights.isLooking, "the lights")
        self.settle(1.0)
        self.picture(name)

    def begin(self) -> None:
        """Go on in an empty scene, with everything folded as at first."""
        slicer.mrmlScene.Clear()
        for button in (self.ui.registrationMoreButton, self.ui.coverageMoreButton, self.ui.motionMoreButton):
            button.checked = False
        self.ui.pathsCollapsibleButton.collapsed = self.ui.settingsCollapsibleButton.collapsed = True
        self.settle(1.0)

    def run(self) -> None:
        """What is done with a recording."""
        ui, panel = self.ui, slicer.modules.AIFReconWidget.parent
        self.picture("panel-empty", panel)
        self.beat.also = self._progress
        self.judged("run: sample", ui.sampleButton, "result")
        self.picture("panel", panel)
        self.judged("run: Reconstruct", ui.applyButton, "again")
        self.press("run: Compare", ui.compareButton)
        self.picture("compare")
        self.press("run: back from the comparison", ui.singleViewButton)
        for name in ("probeUpCheckBox", "showLevelsCheckBox"):
            slicer.util.findChild(panel, name).click()
        self.settle(1.0)
        self.picture("probe-up")
        slicer.util.findChild(panel, "probeUpCheckBox").click()
        ui.coverageMoreButton.checked = True
        self.press("run: Guidance", ui.guidanceCheckBox)
        self.wait(lambda: ui.guidanceTableLabel.text, "guidance")
        self.picture("guidance")
        self.press("run: no guidance", ui.guidanceCheckBox)
        ui.coverageMoreButton.checked = False
        ui.pathsCollapsibleButton.collapsed = False
        ui.pathTargetComboBox.currentIndex = ui.pathTargetComboBox.findText("L2", qt.Qt.MatchContains)
        self.press("run: Find paths", ui.findPathsButton)
        self.wait(lambda: ui.pathsLabel.text, "paths")
        self.picture("paths")
        ui.pathsCollapsibleButton.collapsed = True
        transform = parameters().bone.GetParentTransformNode()
        place = slicer.util.arrayFromTransformMatrix(transform)
        place[:3, 3] += WRONG
        transform.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(place))
        self.judged("run: Reconstruct with a wrong CT", ui.applyButton, "wrong-ct")
        ui.registrationMoreButton.checked = True
        self.press("run: Place CT", ui.placeButton)
        self.judged("run: Reconstruct with the CT placed", ui.applyButton, "registration")
        ui.settingsCollapsibleButton.collapsed = False
        for name, group in vars(ui).items():
            if name.endswith("GroupBox"):
                group.collapsed = False
        self.settle(1.0)
        self.picture("settings", ui.settingsCollapsibleButton, 2)
        self._imported(parameters().sweep)
        self.begin()
        files = write_simulated_patient(self.folder / "moved", frames=MOVED_FRAMES, errors=TrackingErrors(shifting=MOVED))
        self.open(files.sequence.parent)
        self.judged("run: a patient who moves", ui.applyButton, "motion")
        self.begin()
        self.judged("run: a thin scan", ui.thinSampleButton, "thin")

    def open(self, folder: pathlib.Path) -> None:
        """Open the files of a simulated patient."""
        slicer.modules.AIFReconWidget.logic.openFiles(parameters(), [folder / name for name in FILES])
        self.settle(1.0)

    def _progress(self) -> None:
        """The picture of the dialog that tells how far work has come, once."""
        if not (self.folder / "pictures" / "progress.png").exists():
            for dialog in slicer.app.topLevelWidgets():
                if dialog.inherits("QProgressDialog") and dialog.visible and dialog.value > PROGRESS * dialog.maximum:
                    self.picture("progress", dialog)

    def _imported(self, sweep) -> None:
        """The picture of the window in which images and poses are imported, of this sweep, with all questions answered."""
        from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

        poses = tinyScene.writeForeign(self.folder, sequenceFromBrowser(sweep))
        spacing = np.linalg.norm(poses[0][:3, :2], axis=0)
        self.press("run: Import", self.ui.importButton)
        importer = slicer.modules.AIFReconWidget._recorded.importer
        ui = importer._ui
        ui.imagesLineEdit.currentPath, ui.posesLineEdit.currentPath = str(self.folder / "images.npy"), str(self.folder / "poses.csv")
        ui.transformComboBox.currentIndex = 1
        self.press("run: Check", ui.importCheckButton)
        for question, answer in (("tool", "Probe"), ("time_unit", "ms"), ("spacing", "{:.4g} {:.4g}".format(*spacing))):
            importer._answers[question].currentText = answer
            self.press(f"run: Check {question}", ui.importCheckButton)
        self.picture("import", importer._window)
        importer._window.close()

    def scan(self, scanner: pathlib.Path, port: int, seconds: float) -> dict[str, float | str]:
        """What is done with a patient."""
        ui, screen = self.ui, Screen(scanner)
        self.begin()
        self.open(scanner)
        parameters().guidance, parameters().liveRecord = True, True
        parameters().liveHost, parameters().livePort = "127.0.0.1", port
        ui.tabWidget.currentIndex = 1
        self.settle(1.0)
        self.beat.also = screen.look
        self.press("scan: Start", ui.liveStartButton, 1.0)
        self.beat.begin("scan: first look")
        self.settle(ONE_SWEEP)
        self.wait(lambda: ui.liveUseBoxButton.enabled, "Use the scanned area")
        screen.begin = time.monotonic()
        self.press("scan: Use the scanned area", ui.liveUseBoxButton, 1.0)
        self.beat.begin("scan: while it goes on")
        self.settle(ONE_SWEEP)
        self.wait(lambda: ui.guidanceMoveLabel.text, "a next move")
        self.beat.begin("scan: while it goes on")
        self.settle(max(seconds - 2 * ONE_SWEEP - 16.0, 0.0))
        twice = (ui.liveGuidanceCheckBox, ui.liveMoreButton)
        for button in (ui.livePlaceButton, ui.undoPlaceButton, *twice, *twice):
            self.press(f"scan: {button.text}", button)
        self.beat.also = lambda: None
        self.picture("live")
        self.picture("live-panel", slicer.modules.AIFReconWidget.parent)
        self.press("scan: Stop", ui.liveStopButton)
        said = ui.liveStatisticsLabel.text
        inserted, received = map(int, re.search(r"(\d+) of (\d+) frames", said).groups())  # type: ignore[union-attr]
        numbers: list[Any] = [
            screen.number(image) for path in self.folder.glob("Scan*.raw") for image in np.memmap(path, np.uint8).reshape(-1, *SIZE)
        ]
        left_out = int(sum((np.diff(numbers) - 1) % screen.count)) if None not in numbers else -1
        told: dict[str, float | str] = {"frames received": received, "frames recorded": len(numbers), "frames inserted": inserted}
        return told | {"frames lost": left_out + abs(received - len(numbers)), "said": said} | screen.told()

    def scanWithoutCT(self, port: int) -> None:
        """What is done with a patient of whom there is no CT."""
        from AIFReconScene.inputs.boneSource import BoneSource

        ui = self.ui
        self.begin()
        parameters().guidance, parameters().boneSource = True, BoneSource.ECHOES
        parameters().liveHost, parameters().livePort = "127.0.0.1", port
        self.press("without a CT: Start", ui.liveStartButton, ONE_SWEEP)
        self.wait(lambda: ui.liveUseBoxButton.enabled, "Use the scanned area")
        self.press("without a CT: Use the scanned area", ui.liveUseBoxButton, 4 * ONE_SWEEP)
        self.picture("live-without-ct")
        self.press("without a CT: Stop", ui.liveStopButton)


@contextlib.contextmanager
def beside(folder: pathlib.Path):
    """The scanner; gives its port."""
    python = shutil.which("PythonSlicer") or shutil.which("python3") or sys.executable
    paths = os.pathsep.join(dict.fromkeys([str(HERE.parents[1]), *map(str, sys.path)]))
    command = [python, str(HERE / "scannerBeside.py"), str(folder), str(os.getpid())]
    scanner = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": paths})
    try:
        assert scanner.stdout is not None
        yield int(scanner.stdout.readline())
    finally:
        scanner.kill()
        scanner.communicate()


def main(arguments: list[str]) -> int:
    """Measure and tell; the exit status."""
    folder = pathlib.Path(arguments[0]).resolve()
    (folder / "scanner").mkdir(parents=True, exist_ok=True)
    measured: dict[str, float | str] = {}
    with beside(folder / "scanner") as port:
        walk = Walk(folder)
        try:
            walk.run()
            measured |= {"first press, s": walk.seconds["run: sample"], "second press, s": walk.seconds["run: Reconstruct"]}
            measured |= walk.beat.told("run")
            measured |= walk.scan(folder / "scanner", port, float(arguments[1]) if len(arguments) > 1 else 60.0)
            measured |= walk.beat.told("scan")
            walk.scanWithoutCT(port)
        except Exception as error:
            measured["failed"] = f"{type(error).__name__}: {error}"
    print(*(f"{name}: {value}" for name, value in measured.items()), sep="\n", flush=True)
    found = {"version": slicer.app.applicationVersion, "seconds": walk.seconds, **measured}
    (folder / "measured.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    return 1 if "failed" in measured else 0


if __name__ == "__main__":
    slicer.util.exit(main(sys.argv[1:]))

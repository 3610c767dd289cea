"""The panel as self tests find it: in an empty scene, in its first tab; what a test makes goes with it, scans and servers too.

What several classes do with the panel is here as well: choosing, waiting, pressing and doing something else meanwhile, playing a sweep.
"""

import inspect
import pathlib
import tempfile
import time
import unittest
from unittest import mock

import slicer
import tinyScene

PATIENCE = 300.0
"""s that a test waits for what must come: more than any machine needs, so that load decides nothing."""


def waitFor(condition, seconds=PATIENCE):
    """Let Qt work until `condition()` holds; whether it does."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        slicer.app.processEvents()
        if condition():
            return True
        time.sleep(0.005)
    return False


class OpenPanel(unittest.TestCase):
    """Opens the panel before each test; `folder` is for the test's files, and scans are recorded there."""

    widget = property(lambda self: slicer.modules.AIFReconWidget)
    ui = property(lambda self: self.widget.ui)
    parameters = property(lambda self: self.widget._parameterNode)
    live = property(lambda self: self.widget._live)

    def setUp(self):
        folder, scene = tempfile.TemporaryDirectory(ignore_cleanup_errors=True), slicer.mrmlScene
        self.folder = pathlib.Path(folder.name)
        self.addCleanup(folder.cleanup)
        scene.Clear()
        self.addCleanup(scene.SetRootDirectory, scene.GetRootDirectory())
        scene.SetRootDirectory(folder.name)
        # The file of a scene that was saved or loaded before stays when the scene is closed, and its folder comes first
        scene.SetURL("")
        slicer.util.selectModule("AIFRecon")
        self.ui.tabWidget.currentIndex = 0

    def tearDown(self):
        self.live.close()
        slicer.mrmlScene.Clear()

    # ---- inputs

    def addInputs(self, spacing=1.0):
        """Sweep, CT and bone, chosen; bone is filled, as Slicer shows it at first."""
        self.parameters.sweep = tinyScene.addSweep()
        self.parameters.ctVolume, self.parameters.bone, self.registration = tinyScene.addCT()
        self.parameters.bone.CreateDefaultDisplayNodes()
        self.parameters.spacing = spacing

    def chooseBox(self, center=(0.0, 16.0, 0.0), size=(40.0, 40.0, 30.0)):
        """A box, around what the sweep sees, is reconstructed in."""
        from AIFReconScene.inputs.parameters import Region

        roi = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLMarkupsROINode", "Box")
        roi.SetCenterWorld(*center)
        roi.SetSize(*size)
        self.parameters.roi, self.parameters.region = roi, Region.BOX
        return roi

    def chooseRecording(self):
        """A recording of the tiny sweep in a file; *Load* reads it."""
        from AIFReconLib import write_sequence

        write_sequence(tinyScene.makeSequence(), self.folder / "lumbar.igs.mha")
        self.parameters.recordingPath = self.folder / "lumbar.igs.mha"

    def serve(self, sequence=None, **options):
        """A server of a sequence, else of the tiny one, chosen in the panel."""
        from AIFReconLib.live.replay.server import ReplayServer

        tinyScene.requireLivePackages()
        server = ReplayServer(sequence or tinyScene.makeSequence(), 0, **options)
        server.start()
        self.addCleanup(server.stop)
        self.parameters.liveHost, self.parameters.livePort = "127.0.0.1", server.port
        return server

    # ---- what a user does

    def choose(self, comboBox, text):
        """Select an item by its text."""
        comboBox.currentIndex = comboBox.findText(text)

    def applied(self):
        """Press Reconstruct; the voxels."""
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)
        self.ui.applyButton.click()
        return slicer.util.arrayFromVolume(self.parameters.output)

    def reconstruct(self):
        """Choose sweep, CT and bone, and press Reconstruct; the volume."""
        self.addInputs(spacing=2.0)
        self.ui.applyButton.click()
        return self.parameters.output

    def open(self, *paths):
        """Press the button that opens files, and choose these."""
        with mock.patch.object(self.widget._recorded, "_ask", return_value=list(paths)):
            self.ui.openButton.click()

    def waitUntil(self, condition):
        """Let Qt work until it holds."""
        self.assertTrue(waitFor(condition), f"{self.ui.statusLabel.text} {self.ui.liveStatisticsLabel.text}")

    def waitForLights(self):
        """Until all that they tell is known."""
        self.waitUntil(lambda: not self.widget._recorded.lights.isLooking)

    def pressAnd(self, button, owner, work: str, fraction: float, act, step=""):
        """Press a button, and do something else, once, as soon as `work` of its owner has come so far, in a step of that name."""
        do = getattr(owner, work)
        done: list = []

        def disturbed(*given, **named):
            bound = inspect.signature(do).bind(*given, **named)
            progress = bound.arguments["progress"]

            def report(share, message):
                if share >= fraction and step in str(message) and not done:
                    done.append(act())
                return progress(share, message)

            bound.arguments["progress"] = report
            return do(*bound.args, **bound.kwargs)

        with mock.patch.object(owner, work, disturbed):
            button.click()
        self.assertEqual(len(done), 1)

    def messageOf(self, act) -> str:
        """What the one message says that comes up."""
        with mock.patch.object(slicer.util, "infoDisplay") as shown:
            act()
        self.assertEqual(shown.call_count, 1)
        return shown.call_args.args[0]

    # ---- a scan that follows a sweep of the scene

    def follow(self, browser, image=None):
        """A scan takes what this sweep replays, or an image."""
        from AIFReconScene.inputs.parameters import LiveSource

        self.parameters.liveSource = LiveSource.SCENE
        self.parameters.liveImage = image or browser.GetProxyNode(browser.GetMasterSequenceNode())

    def show(self, browser, number):
        """Replay a frame of a sweep."""
        browser.SetSelectedItemNumber(number)
        slicer.modules.sequences.logic().UpdateProxyNodesFromSequences(browser)

    def playFrames(self, browser, frames):
        """Show frames one by one, each until the scan has received it."""
        for number in frames:
            seen = self.live._live.statistics.frames_received
            self.show(browser, number)
            self.waitUntil(lambda seen=seen: self.live._live.statistics.frames_received > seen)

    # ---- what is shown

    def sliceWidget(self, name="Red"):
        """A slice view."""
        return slicer.app.layoutManager().sliceWidget(name)

    def composite(self, name="Red"):
        """What a slice view shows."""
        return self.sliceWidget(name).mrmlSliceCompositeNode()

    def threeDView(self):
        """The 3D view."""
        return slicer.app.layoutManager().threeDWidget(0).threeDView()

    def picturePanel(self):
        """The part of the panel that says how a reconstruction is looked at."""
        return next(each for each in self.widget._recorded._followers if type(each).__name__ == "PicturePanel")

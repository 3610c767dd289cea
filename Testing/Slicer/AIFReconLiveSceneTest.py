"""Self tests of a live scan beside a scene that changes: what is kept, what is given back, and what goes on without the panel."""

import contextlib
import math
import pathlib
import sys
import tempfile
import threading
import time
import unittest
from unittest import mock

import numpy as np
import slicer

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import tinyScene
from AIFReconLiveTest import waitFor


class AIFReconLiveSceneTest(unittest.TestCase):
    """A scan from a real server on this machine that goes on until it is stopped."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        tinyScene.recordElsewhere(self)
        slicer.util.selectModule("AIFRecon")
        self.take(slicer.modules.AIFReconWidget)
        self.server = None
        self.parameters.spacing = 1.0

    def tearDown(self):
        slicer.modules.AIFReconWidget._live.close()
        if self.server is not None:
            self.server.stop()
        slicer.mrmlScene.Clear()

    def take(self, widget):
        """Work with this panel."""
        self.widget = widget
        self.ui, self.parameters, self.live = widget.ui, widget._parameterNode, widget._live

    def begin(self, box=True):
        """Serve the tiny sweep again and again, and start a scan."""
        from AIFReconScene.inputs.parameters import Region

        from AIFReconLib.live.replay.server import ReplayServer

        tinyScene.requireLivePackages()
        self.server = ReplayServer(tinyScene.makeSequence(), 0, rate=30.0, loop=True)
        self.server.start()
        self.parameters.liveHost, self.parameters.livePort = "127.0.0.1", self.server.port
        if box:
            roi = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLMarkupsROINode", "Box")
            roi.SetCenterWorld(0.0, 16.0, 0.0)
            roi.SetSize(40.0, 40.0, 30.0)
            self.parameters.roi, self.parameters.region = roi, Region.BOX
        self.ui.liveStartButton.click()
        self.assertTrue(waitFor(lambda: self.live._live.frameNode is not None))

    def grow(self):
        """Wait until a volume is shown."""
        live = self.live._live
        self.assertTrue(waitFor(lambda: live.volumeNode is not None and slicer.util.arrayFromVolume(live.volumeNode).any()))
        return live.volumeNode

    def red(self):
        """Composite node of the red view."""
        return slicer.app.layoutManager().sliceWidget("Red").mrmlSliceCompositeNode()

    def scanThreads(self):
        """Threads of a session that are alive."""
        return [thread.name for thread in threading.enumerate() if thread.name.startswith("aifrecon") and "server" not in thread.name]

    # ---- what is kept

    def test_a_volume_that_holds_something_is_not_overwritten(self):
        earlier = tinyScene.addVolume("vtkMRMLScalarVolumeNode", "Earlier", np.full((3, 3, 3), 77, np.uint8), np.eye(4))
        self.parameters.output = earlier
        self.begin()
        self.grow()
        self.ui.liveStopButton.click()
        self.assertIsNot(self.parameters.output, earlier)
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(earlier), 77)

    def test_other_work_waits_until_the_scan_is_stopped(self):
        self.parameters.sweep = tinyScene.addSweep()
        self.begin()
        self.assertFalse(self.ui.applyButton.enabled)
        self.assertIn("Stop the live scan", self.ui.applyButton.toolTip)
        self.ui.liveStopButton.click()
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)

    def test_the_window_follows_the_volume_that_grows(self):
        self.begin()
        display = self.grow().GetDisplayNode()
        self.assertTrue(waitFor(lambda: display.GetWindowLevelMax() > 30))
        self.assertEqual(display.GetUpperThreshold(), 255)

    def test_a_window_that_the_user_has_set_stays(self):
        self.begin()
        display = self.grow().GetDisplayNode()
        display.SetWindowLevelMinMax(5, 111)
        inserted = self.live._live.statistics.inserted
        self.assertTrue(waitFor(lambda: self.live._live.statistics.inserted > inserted + 20))
        self.ui.liveStopButton.click()
        self.assertEqual((display.GetWindowLevelMin(), display.GetWindowLevelMax()), (5, 111))

    def test_a_cancel_while_the_scan_is_ended_leaves_no_frame_behind(self):
        self.begin()
        volume = self.grow()
        live = self.live._live
        live.stop(lambda fraction, message: False)
        self.live.close()
        self.assertIs(live.volumeNode, volume)
        self.assertEqual(slicer.mrmlScene.GetNodesByName("Live frame").GetNumberOfItems(), 0)

    # ---- what is given back

    def test_the_red_view_shows_again_what_it_showed(self):
        ct, _bone, _registration = tinyScene.addCT()
        self.red().SetBackgroundVolumeID(ct.GetID())
        red = slicer.app.layoutManager().sliceWidget("Red").mrmlSliceNode()
        red.SetFieldOfView(33.0, 44.0, 1.0)
        scale = tinyScene.scaleOf(red)
        place = slicer.util.arrayFromVTKMatrix(red.GetSliceToRAS()).copy()
        self.begin(box=False)
        self.assertEqual(self.red().GetBackgroundVolumeID(), self.live._live.frameNode.GetID())
        self.ui.liveStopButton.click()
        self.assertEqual(self.red().GetBackgroundVolumeID(), ct.GetID())
        np.testing.assert_allclose(slicer.util.arrayFromVTKMatrix(red.GetSliceToRAS()), place, atol=1e-9)
        self.assertAlmostEqual(tinyScene.scaleOf(red), scale)

    def test_a_reload_during_a_scan_ends_it_and_takes_the_frame_away(self):
        self.begin()
        self.widget.onReload()
        self.take(slicer.modules.AIFReconWidget)
        self.assertEqual(self.scanThreads(), [])
        self.assertEqual(slicer.mrmlScene.GetNodesByName("Live frame").GetNumberOfItems(), 0)
        self.assertFalse(self.ui.liveStopButton.enabled)

    # ---- nodes that go

    def test_a_volume_that_is_deleted_during_the_scan_is_made_anew(self):
        self.begin()
        volume = self.grow()
        slicer.mrmlScene.RemoveNode(volume)
        self.assertIsNot(self.grow(), volume)
        self.assertTrue(waitFor(lambda: self.parameters.output is self.live._live.volumeNode))

    def test_a_frame_that_is_deleted_is_shown_again(self):
        self.begin()
        slicer.mrmlScene.RemoveNode(self.live._live.frameNode)
        self.assertIsNone(self.live._live.frameNode)
        self.assertTrue(waitFor(lambda: self.live._live.frameNode is not None))
        self.assertEqual(self.red().GetBackgroundVolumeID(), self.live._live.frameNode.GetID())

    def test_views_are_drawn_again_however_the_scan_ends(self):
        paused = []
        slicer.app.connect("renderPaused(bool)", paused.append)
        try:
            self.begin()
            for end in (self.ui.liveStopButton.click, self.live.close):
                if not self.live.isRunning:
                    self.ui.liveStartButton.click()
                # The node of the first frame is made before anything is paused
                self.assertTrue(waitFor(lambda: self.live._live._inSteps.isUnderWay and paused.count(True) > paused.count(False)))
                end()
                self.assertEqual(paused.count(True), paused.count(False))
        finally:
            slicer.app.disconnect("renderPaused(bool)", paused.append)

    def test_frame_and_whatever_else_has_changed_are_drawn_together(self):
        from AIFReconScene.display import viewByView
        from AIFReconScene.live.liveViews import LiveViews

        self.begin()
        done, follow = [], LiveViews.follow

        def steps():
            done.append("else")
            yield

        def drawn():
            done.append(";")
            return iter(())

        def followed(views, node):
            done.append("frame")
            follow(views, node)

        def together():
            self.live.showToo("else", steps())
            return any("else" in each and "frame" in each for each in "".join(done).split(";")[1:-1])

        with mock.patch.object(viewByView, "viewByView", drawn), mock.patch.object(LiveViews, "follow", followed):
            self.assertTrue(waitFor(together), done)

    def test_what_cannot_be_shown_holds_nothing_else_back(self):
        from AIFReconScene.live import liveReconstruction

        with mock.patch.object(liveReconstruction, "outputNodes", side_effect=RuntimeError("no volume today")):
            self.begin()
            self.assertTrue(waitFor(lambda: "no volume today" in self.ui.liveStatisticsLabel.text))
            seen = self.live._live._frame.frame
            self.assertTrue(waitFor(lambda: self.live._live._frame.frame is not seen))
        self.grow()
        self.assertTrue(waitFor(lambda: "no volume today" not in self.ui.liveStatisticsLabel.text))

    @contextlib.contextmanager
    def turnsByHand(self, isBusy=False):
        """No turn is taken but by hand, in an event loop that has much to do or nothing; how often words, a step and threads had one."""
        from AIFReconGui.breath import Breath
        from AIFReconScene.live.liveReconstruction import LiveReconstruction
        from AIFReconScene.live.turns import Turns

        self.live._turning.stop()
        # Nothing is owed to the threads of the scan, and they had the last turn
        self.live._turns.forget()
        self.live._hasWorked = False
        words, step, threads = mock.Mock(), mock.Mock(return_value=True), mock.Mock()
        with contextlib.ExitStack() as patches:
            for owner, name, what in (
                *((type(self.live), "_show", words), (LiveReconstruction, "goOn", step), (Turns, "give", threads)),
                (Breath, "isNeeded", lambda breath: isBusy),
            ):
                patches.enter_context(mock.patch.object(owner, name, what))
            yield lambda: (words.call_count, step.call_count, threads.call_count)

    def test_windows_wait_for_words_a_step_or_the_threads_of_the_scan_and_never_for_two_of_them(self):
        self.begin()
        with self.turnsByHand() as had:
            for calls in range(1, 13):
                self.live._shown = -math.inf if calls % 4 == 1 else math.inf
                self.live._takeTurn()
                self.assertEqual(sum(had()), calls)
        self.assertEqual(had(), (3, 3, 6))

    def test_nothing_is_done_in_a_turn_in_which_windows_were_drawn(self):
        self.begin()
        with self.turnsByHand(isBusy=True) as had:
            for self.live._shown in (-math.inf, math.inf):
                self.live._takeTurn()
        self.assertEqual(had(), (0, 0, 0))

    def test_a_scan_takes_no_step_before_what_the_user_has_chosen_is_done(self):
        from AIFReconGui.inTurns import inTurns, isUnderWay

        self.begin()
        done = []
        with self.turnsByHand() as had:
            self.live._shown = math.inf
            inTurns(iter(["first", "second"]))
            while isUnderWay():
                self.live._takeTurn()
                done.append(had()[1])
                slicer.app.processEvents()
            for _turn in range(2):
                self.live._takeTurn()
        self.assertGreater(len(done), 2)
        self.assertEqual((set(done), had()[1]), ({0}, 1))

    def test_what_the_user_has_chosen_waits_for_turns_in_which_nothing_was_drawn(self):
        from AIFReconGui.breath import Breath
        from AIFReconGui.inTurns import inTurns, isUnderWay

        done, asked = [], []

        def isNeeded(breath):
            asked.append(len(done))
            return len(asked) % 3 != 0

        with mock.patch.object(Breath, "isNeeded", isNeeded):
            inTurns(done.append(each) for each in range(2))
            self.assertTrue(waitFor(lambda: not isUnderWay()))
        self.assertEqual(asked[:7], [0, 0, 0, 1, 1, 1, 2])

    # ---- without the panel

    def test_a_scan_goes_on_while_another_module_is_open(self):
        self.begin()
        self.widget.exit()
        inserted = self.live._live.statistics.inserted
        self.assertTrue(waitFor(lambda: self.live._live.statistics.inserted > inserted + 10))
        self.grow()
        self.widget.enter()
        self.take(self.widget)
        self.assertTrue(self.ui.liveStopButton.enabled)
        self.assertFalse(self.ui.liveStartButton.enabled)
        self.assertTrue(waitFor(lambda: self.parameters.output is self.live._live.volumeNode))

    # ---- words

    def test_what_is_counted_is_told_twice_a_second_and_at_once_where_something_else_is_to_be_said(self):
        from AIFReconGui.panel import livePanel

        self.begin()
        self.live._turning.stop()
        self.live._show()
        said = self.ui.liveStatisticsLabel.text
        with mock.patch.object(livePanel, "linesOf", return_value=["Many frames"]):
            self.live._counted = time.monotonic()
            self.live._show()
            self.assertEqual(self.ui.liveStatisticsLabel.text, said)
            self.live._counted -= livePanel.COUNTED_EVERY
            self.live._show()
            self.assertEqual(self.ui.liveStatisticsLabel.text, "Many frames")
        with mock.patch.object(livePanel, "linesOf", return_value=["Paused"]):
            self.ui.livePauseButton.click()
            self.assertTrue(waitFor(lambda: self.live._live.statistics.phase == "paused"))
            self.live._show()
        self.assertEqual(self.ui.liveStatisticsLabel.text, "Paused")

    def test_the_panel_is_not_laid_out_anew_for_a_style_that_its_large_letters_have(self):
        class Label:
            def __init__(self):
                self.__dict__.update(text="", styles=[""])

            def __setattr__(self, name, value):
                if name == "styleSheet":
                    self.styles.append(value)

            @property
            def styleSheet(self):
                return self.styles[-1]

        label = Label()
        with mock.patch.object(self.live._ui, "liveStateLabel", label):
            for colors in ("#000000", "#000000", "#111111"):
                self.live._showState("Probe seen", (colors, "#ffffff"))
        self.assertEqual(len(label.styles), 3)

    def test_a_failure_is_told_in_large_letters(self):
        self.begin()
        self.live._live.session._collect_error = RuntimeError("The cable broke.")
        self.assertTrue(waitFor(lambda: "the picture no longer grows" in self.ui.liveStateLabel.text))
        self.assertTrue(waitFor(lambda: "The cable broke." in self.ui.liveStatisticsLabel.text))

    def test_frames_that_are_left_out_are_told_in_the_panel_s_words(self):
        self.parameters.skip = 2
        self.begin()
        self.assertTrue(waitFor(lambda: "left out" in self.ui.liveStatisticsLabel.text))
        self.assertNotIn("--", self.ui.liveStatisticsLabel.text)

    def test_what_a_scan_ended_with_is_read_in_the_place_of_its_rate(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "scan.mhd"
            self.parameters.liveRecordPath = path
            self.begin()
            self.assertTrue(waitFor(lambda: "frames/s" in self.ui.liveStatisticsLabel.text))
            self.ui.liveStopButton.click()
            self.assertEqual(self.ui.liveStateLabel.text, "stopped")
            self.assertIn(f"Recorded to {path}", self.ui.liveStatisticsLabel.text)
            self.assertIn("frames added to the picture", self.ui.liveStatisticsLabel.text)
            self.assertNotIn("frames/s", self.ui.liveStatisticsLabel.text)
            self.assertNotIn("connected", self.ui.liveStatisticsLabel.text)

    def test_a_cancel_at_the_end_of_a_scan_is_told(self):
        self.parameters.holeLimit = 3.0
        self.begin()
        self.grow()
        stop = self.live._live.stop
        self.live._live.stop = lambda progress: stop(lambda fraction, message: False)
        self.ui.liveStopButton.click()
        self.assertIn("Canceled", self.ui.liveStatisticsLabel.text)

    def test_a_start_that_is_canceled_while_the_scan_is_prepared_leaves_no_thread_and_no_recording(self):
        from AIFReconLib.live.session.session import LiveSession

        waited = []

        def prepare(session, timeout=None):
            waited.append(timeout)
            self.live._work.cancel()
            return False

        tinyScene.requireLivePackages()
        kept, LiveSession.prepare = LiveSession.prepare, prepare
        try:
            self.ui.liveStartButton.click()
        finally:
            LiveSession.prepare = kept
        self.assertTrue(waited)
        self.assertFalse(self.live.isRunning)
        self.assertIn("Canceled", self.ui.liveStatisticsLabel.text)
        self.assertTrue(waitFor(lambda: not self.scanThreads()))
        self.assertEqual(list(pathlib.Path(slicer.mrmlScene.GetRootDirectory()).iterdir()), [])

    def test_a_canceled_start_is_told_though_no_sweep_is_chosen(self):
        from AIFReconLib.errors import OperationCanceled

        def canceled(parameters, progress):
            raise OperationCanceled

        self.live._start = canceled
        self.ui.liveStartButton.click()
        del self.live._start
        self.assertIn("Canceled", self.ui.liveStatisticsLabel.text)
        self.assertEqual(self.ui.liveStateLabel.text, "not started")

    def test_nothing_is_said_of_a_scan_whose_scene_was_closed(self):
        self.begin()
        self.assertTrue(waitFor(lambda: "frames/s" in self.ui.liveStatisticsLabel.text))
        slicer.mrmlScene.Clear()
        self.assertEqual(self.ui.liveStateLabel.text, "not started")
        self.assertEqual(self.ui.liveStatisticsLabel.text, "")

    def test_a_scan_that_failed_tells_no_rate(self):
        self.begin()
        self.live._live.session._collect_error = RuntimeError("The cable broke.")
        self.assertTrue(waitFor(lambda: "the picture no longer grows" in self.ui.liveStateLabel.text))
        self.assertNotIn("frames/s", self.ui.liveStatisticsLabel.text)
        self.assertEqual(self.ui.liveStatisticsLabel.text.count("The cable broke."), 1)

    def test_a_server_that_is_entered_stays_entered(self):
        self.parameters.liveHost, self.parameters.livePort = "127.0.0.1", 12345
        self.widget.exit()
        self.widget.enter()
        self.assertEqual(self.widget._parameterNode.livePort, 12345)

"""Self tests of a live scan beside a scene that changes: what is kept, what is given back, and what goes on without the panel."""

import os
import pathlib
import signal
import sys
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
        self.assertTrue(waitFor(lambda: self.live._live._views.frameNode is not None))

    def grow(self):
        """Wait until a volume is shown."""
        live = self.live._live
        self.assertTrue(waitFor(lambda: live.volumeNode is not None and slicer.util.arrayFromVolume(live.volumeNode).any()))
        return live.volumeNode

    def red(self):
        """Composite node of the red view."""
        return slicer.app.layoutManager().sliceWidget("Red").mrmlSliceCompositeNode()

    # ---- what is kept

    def test_other_work_waits_until_the_scan_is_stopped(self):
        self.parameters.sweep = tinyScene.addSweep()
        self.begin()
        self.assertFalse(self.ui.applyButton.enabled)
        self.assertIn("Stop the live scan", self.ui.applyButton.toolTip)
        self.ui.liveStopButton.click()
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)

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
        self.assertEqual(self.red().GetBackgroundVolumeID(), self.live._live._views.frameNode.GetID())
        self.ui.liveStopButton.click()
        self.assertEqual(self.red().GetBackgroundVolumeID(), ct.GetID())
        np.testing.assert_allclose(slicer.util.arrayFromVTKMatrix(red.GetSliceToRAS()), place, atol=1e-9)
        self.assertAlmostEqual(tinyScene.scaleOf(red), scale)

    def test_a_reload_during_a_scan_ends_it_and_takes_the_frame_away(self):
        self.begin()
        self.widget.onReload()
        self.take(slicer.modules.AIFReconWidget)
        self.assertTrue(waitFor(lambda: not self.server.clients))
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
        slicer.mrmlScene.RemoveNode(self.live._live._views.frameNode)
        self.assertIsNone(self.live._live._views.frameNode)
        self.assertTrue(waitFor(lambda: self.live._live._views.frameNode is not None))
        self.assertEqual(self.red().GetBackgroundVolumeID(), self.live._live._views.frameNode.GetID())

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

    def test_a_start_that_is_canceled_while_the_scan_is_prepared_leaves_no_scan_and_no_recording(self):
        from AIFReconScene.work import worker

        def canceled(*_arguments, progress=None, **_named):
            self.live._work.cancel()
            return begin(*_arguments, progress=progress, **_named)

        tinyScene.requireLivePackages()
        begin = worker.keep
        with mock.patch.object(worker, "keep", canceled):
            self.ui.liveStartButton.click()
        self.assertFalse(self.live.isRunning)
        self.assertIn("Canceled", self.ui.liveStatisticsLabel.text)
        self.assertTrue(waitFor(lambda: not list(pathlib.Path(slicer.mrmlScene.GetRootDirectory()).iterdir())))

    # ---- the process that scans

    def test_a_scan_whose_process_is_killed_right_before_stop_is_finished_all_the_same(self):
        from AIFReconScene.work import worker

        from AIFReconLib import read_sequence

        self.begin()
        self.grow()
        live = self.live._live
        before = live.statistics.frames_received
        os.kill(worker.pid, signal.SIGTERM)
        self.ui.liveStopButton.click()
        [recorded] = pathlib.Path(slicer.mrmlScene.GetRootDirectory()).glob("*.mhd")
        self.assertGreaterEqual(len(read_sequence(recorded)), before)
        self.assertIn(str(recorded), self.ui.liveStatisticsLabel.text)
        self.assertEqual(live.lost, "")

    def test_a_scan_whose_process_is_killed_goes_on_with_nothing_lost(self):
        from AIFReconScene.work import worker

        from AIFReconLib import read_sequence

        self.begin()
        self.grow()
        before = self.live._live.statistics.frames_received
        os.kill(worker.pid, signal.SIGTERM)
        self.assertTrue(waitFor(lambda: self.live._live.lost))
        self.assertTrue(waitFor(lambda: not self.live._live.lost and self.live._live.statistics.frames_received > before + 20))
        live = self.live._live
        self.ui.liveStopButton.click()
        folder = pathlib.Path(slicer.mrmlScene.GetRootDirectory())
        self.assertEqual(sorted({path.suffix for path in folder.iterdir()}), [".mhd", ".raw"])
        [recorded] = folder.glob("*.mhd")
        self.assertEqual(len(read_sequence(recorded)), live.statistics.frames_received)
        self.assertEqual(live.statistics.waiting, 0)

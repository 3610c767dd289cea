"""Self tests of a live scan beside a scene that changes: what is kept, what is given back, and what goes on without the panel."""

import os
import signal
from unittest import mock

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel


class AIFReconLiveSceneTest(OpenPanel):
    """A scan from a real server on this machine that goes on until it is stopped."""

    def setUp(self):
        super().setUp()
        self.parameters.spacing = 1.0

    def begin(self, box=True):
        """Serve the tiny sweep again and again, and start a scan."""
        self.server = self.serve(rate=30.0, loop=True)
        if box:
            self.chooseBox()
        self.ui.liveStartButton.click()
        self.waitUntil(lambda: self.live._live._views.frameNode is not None)

    def grow(self):
        """Wait until a volume is shown."""
        live = self.live._live
        self.waitUntil(lambda: live.volumeNode is not None and slicer.util.arrayFromVolume(live.volumeNode).any())
        return live.volumeNode

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

    def test_the_red_view_lies_in_the_frame_and_then_shows_again_what_it_showed(self):
        ct, _bone, _registration = tinyScene.addCT()
        self.composite().SetBackgroundVolumeID(ct.GetID())
        red = self.sliceWidget().mrmlSliceNode()
        red.SetFieldOfView(33.0, 44.0, 1.0)
        scale = tinyScene.scaleOf(red)
        place = tinyScene.placeOf(red)
        self.begin(box=False)
        frame = self.live._live._views.frameNode
        self.assertEqual(self.composite().GetBackgroundVolumeID(), frame.GetID())
        toFrame = np.linalg.inv(tinyScene.ijkToRAS(frame)) @ tinyScene.placeOf(red)
        np.testing.assert_allclose(toFrame[:, 3], [31.5, 39.5, 0.0, 1.0], atol=1e-6)
        np.testing.assert_allclose(toFrame[2, :2], 0.0, atol=1e-6)
        self.assertTrue(red.GetSliceVisible())
        self.ui.liveStopButton.click()
        self.assertFalse(red.GetSliceVisible())
        self.assertEqual(self.composite().GetBackgroundVolumeID(), ct.GetID())
        np.testing.assert_allclose(tinyScene.placeOf(red), place, atol=1e-9)
        self.assertAlmostEqual(tinyScene.scaleOf(red), scale)

    def test_a_reload_during_a_scan_ends_it_and_takes_the_frame_away(self):
        self.begin()
        self.widget.onReload()
        self.waitUntil(lambda: not self.server.clients)
        self.assertEqual(slicer.mrmlScene.GetNodesByName("Live frame").GetNumberOfItems(), 0)
        self.assertFalse(self.ui.liveStopButton.enabled)

    # ---- without the panel

    def test_a_scan_goes_on_while_another_module_is_open(self):
        self.begin()
        self.widget.exit()
        inserted = self.live._live.statistics.inserted
        self.waitUntil(lambda: self.live._live.statistics.inserted > inserted + 10)
        self.grow()
        self.widget.enter()
        self.assertTrue(self.ui.liveStopButton.enabled)
        self.assertFalse(self.ui.liveStartButton.enabled)
        self.waitUntil(lambda: self.parameters.output is self.live._live.volumeNode)

    def test_a_start_that_is_canceled_while_the_scan_is_prepared_leaves_no_scan_and_no_recording(self):
        from AIFReconScene.work import worker

        def canceled(*arguments, **named):
            self.live._work.cancel()
            return mock.DEFAULT

        tinyScene.requireLivePackages()
        with mock.patch.object(worker, "keep", wraps=worker.keep, side_effect=canceled):
            self.ui.liveStartButton.click()
        self.assertFalse(self.live.isRunning)
        self.assertIn("Canceled", self.ui.liveStatisticsLabel.text)
        self.waitUntil(lambda: not list(self.folder.iterdir()))

    # ---- the process that scans

    def test_a_scan_whose_process_is_killed_goes_on_with_nothing_lost_and_so_it_ends_right_before_stop(self):
        from AIFReconScene.work import worker

        from AIFReconLib import read_sequence

        self.begin()
        self.grow()
        before = self.live._live.statistics.frames_received
        os.kill(worker.pid, signal.SIGTERM)
        self.waitUntil(lambda: self.live._live.lost)
        self.waitUntil(lambda: not self.live._live.lost and self.live._live.statistics.frames_received > before + 20)
        live = self.live._live
        os.kill(worker.pid, signal.SIGTERM)
        self.ui.liveStopButton.click()
        self.assertEqual(sorted({path.suffix for path in self.folder.iterdir()}), [".mhd", ".raw"])
        [recorded] = self.folder.glob("*.mhd")
        self.assertEqual(len(read_sequence(recorded)), live.statistics.frames_received)
        self.assertIn(str(recorded), self.ui.liveStatisticsLabel.text)
        self.assertEqual((live.statistics.waiting, live.lost), (0, ""))

"""Self tests of the Live section: from a server and from the scene's nodes, with what is lost, paused, and closed meanwhile."""

import re

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel


class AIFReconLiveTest(OpenPanel):
    """The Live section, with a real server on this machine."""

    def setUp(self):
        super().setUp()
        self.parameters.spacing = 1.0

    def scan(self, frames=tinyScene.FRAMES):
        """Start, wait until so many frames have come, stop; the session's last statistics."""
        self.ui.liveStartButton.click()
        live = self.live._live
        self.waitUntil(lambda: live.statistics.frames_received >= frames)
        self.ui.liveStopButton.click()
        return live.statistics

    def offline(self, roi):
        """What a reconstruction of the recording gives in that box."""
        from AIFReconScene.inputs.gridNodes import gridFromROI

        from AIFReconLib import Recipe, reconstruct

        settings = Recipe(method="average", spacing=1.0)
        return reconstruct(tinyScene.makeSequence(), settings, grid=gridFromROI(roi, settings.spacing_xyz())).intensity

    def test_a_scan_from_a_server_gives_the_voxels_of_the_recording_without_the_frame_whose_tool_is_not_seen(self):
        self.serve(rate=60.0)
        roi = self.chooseBox()
        statistics = self.scan()
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(self.parameters.output), self.offline(roi).array)
        self.assertEqual((statistics.inserted, sum(statistics.skipped.values())), (tinyScene.FRAMES - 1, 1))

    def test_a_server_that_stays_connected_and_sends_nothing_more_is_told_with_the_time(self):
        self.serve(rate=60.0)
        self.chooseBox()
        self.ui.liveStartButton.click()
        self.waitUntil(lambda: re.fullmatch(r"No images, no positions since \d\d:\d\d:\d\d", self.ui.liveStateLabel.text))
        self.assertEqual(self.live._live.statistics.connection, "connected")
        self.assertEqual(self.ui.guidanceMoveLabel.text, "Connected, but nothing comes: check Plus and the scanner")

    def test_a_server_that_is_gone_is_told_with_the_time(self):
        server = self.serve(rate=20.0, loop=True)
        self.chooseBox()
        self.ui.liveStartButton.click()
        self.waitUntil(lambda: self.live._live.statistics.frames_received > 3)
        server.stop()
        self.waitUntil(lambda: self.ui.guidanceMoveLabel.text == "The connection is lost: check Plus and the network")
        self.waitUntil(lambda: re.search(r"No images, no positions since \d\d:\d\d:\d\d", self.ui.liveStateLabel.text))

    def test_without_a_box_the_sweep_finds_it(self):
        self.serve(rate=30.0, loop=True)
        self.ui.liveStartButton.click()
        self.waitUntil(lambda: self.ui.liveUseBoxButton.enabled and self.live._live.seen.scouted >= 30)
        self.ui.liveUseBoxButton.click()
        self.waitUntil(lambda: self.live._live.statistics.inserted > 30)
        self.assertFalse(self.ui.liveUseBoxButton.enabled)

    def test_the_box_of_a_configuration_needs_no_scouting(self):
        box = 'OutputOrigin="-19.5 -3.5 -14.5" OutputSpacing="1 1 1" OutputExtent="0 39 0 39 0 29"'
        self.parameters.configurationPath = self.folder / "plus.xml"
        self.parameters.configurationPath.write_text(f"<PlusConfiguration><VolumeReconstruction {box}/></PlusConfiguration>")
        self.serve(rate=60.0)
        self.scan()
        roi = self.chooseBox()
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(self.parameters.output), self.offline(roi).array)

    def test_a_server_that_is_not_there_is_told_and_the_panel_stays_alive(self):
        self.serve().stop()
        self.chooseBox()
        self.ui.liveStartButton.click()
        self.waitUntil(lambda: "frames/s" in self.ui.liveStatisticsLabel.text and self.live._live.statistics.trouble)
        self.waitUntil(lambda: self.live._live.statistics.trouble in self.ui.liveStatisticsLabel.text)
        self.ui.liveStopButton.click()
        self.assertTrue(self.ui.liveStartButton.enabled)
        self.assertIsNone(self.parameters.output)

    def test_one_press_reconstructs_all_that_was_recorded(self):
        from AIFReconScene.inputs.parameters import Method

        self.ui.tabWidget.currentIndex = 1
        self.assertFalse(self.ui.liveRebuildButton.isVisibleTo(self.ui.liveTab))
        self.serve(rate=60.0)
        roi = self.chooseBox()
        self.scan()
        self.assertTrue(self.ui.liveRebuildButton.isVisibleTo(self.ui.liveTab) and self.ui.liveRebuildButton.enabled)
        self.parameters.method = Method.AVERAGE
        ofScan = self.parameters.output
        before = slicer.util.arrayFromVolume(ofScan).copy()
        self.ui.liveRebuildButton.click()
        self.assertIsNot(self.parameters.output, ofScan)
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(ofScan), before)
        self.assertEqual(self.parameters.sweep.GetNumberOfItems(), tinyScene.FRAMES)
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(self.parameters.output), self.offline(roi).array)
        self.assertIn("Done.", self.ui.statusLabel.text)
        self.assertEqual(self.ui.tabWidget.currentIndex, 0)

    def test_a_replayed_sweep_of_the_scene_can_be_the_source(self):
        sweep = tinyScene.addSweep()
        roi = self.chooseBox()
        self.follow(sweep)
        self.ui.liveStartButton.click()
        live = self.live._live
        self.playFrames(sweep, [*range(1, tinyScene.FRAMES), 0])  # the first is shown already: nothing would change
        self.ui.liveStopButton.click()
        self.assertEqual((live.statistics.inserted, sum(live.statistics.skipped.values())), (tinyScene.FRAMES - 1, 1))
        different = slicer.util.arrayFromVolume(self.parameters.output) != self.offline(roi).array
        self.assertLess(different.mean(), 0.01)

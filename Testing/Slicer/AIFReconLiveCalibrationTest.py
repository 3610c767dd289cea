"""Self tests of a live scan with a real calibration, whose axes are not quite at right angles, and of views that cannot show it."""

from unittest import mock

import numpy as np
import realData
import slicer
import tinyScene
from openPanel import OpenPanel


class AIFReconLiveCalibrationTest(OpenPanel):
    """A replayed real recording, received with its Plus configuration."""

    def begin(self):
        """Replay the recording and start a scan in the region that it covers."""
        from AIFReconScene.inputs.parameters import Region

        from AIFReconLib import read_sequence, reconstruct
        from AIFReconLib.recipe.recipe import ReconstructionSettings

        calibration = realData.folder() / realData.SPINE_CALIBRATION
        self.sequence = read_sequence(realData.recordingOf(calibration), config=calibration)
        covered = reconstruct(self.sequence, ReconstructionSettings(spacing=2.0)).intensity
        self.parameters.regionVolume = tinyScene.addVolume(
            "vtkMRMLScalarVolumeNode", "Region", np.zeros_like(covered.array), covered.ijk_to_reference
        )
        self.parameters.region, self.parameters.configurationPath = Region.LIKE_VOLUME, calibration
        self.serve(self.sequence, rate=10.0, loop=True)
        self.ui.liveStartButton.click()
        self.scan = self.live._live
        self.waitUntil(lambda: self.scan.statistics.inserted > 3)

    def test_the_frame_is_seen_in_its_place_and_the_voxels_are_those_of_the_exact_calibration(self):
        from AIFReconLib import reconstruct
        from AIFReconLib.geometry.volume import VoxelGrid
        from AIFReconLib.recipe.recipe import ReconstructionSettings

        self.begin()
        self.waitUntil(lambda: self.scan._views.frameNode is not None)
        self.assertEqual(self.composite().GetBackgroundVolumeID(), self.scan._views.frameNode.GetID())
        shown, exact = tinyScene.ijkToRAS(self.scan._views.frameNode), self.scan._views.frame.image_to_reference
        rows, columns = self.scan._views.frame.image.shape
        corners = np.array([[0, columns, 0, columns], [0, 0, rows, rows], [0, 0, 0, 0], [1, 1, 1, 1]])
        # Half of the 2.7 degrees for each axis, over half of the 70 mm from the middle of the image to its edge
        self.assertLess(np.abs((shown @ corners - exact @ corners)[:3]).max(), 1.2)
        axes = shown[:3, :3] / np.linalg.norm(shown[:3, :3], axis=0)
        np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-6)
        self.waitUntil(lambda: self.scan.statistics.inserted > 2 * len(self.sequence))
        self.ui.liveStopButton.click()
        region = self.parameters.regionVolume
        grid = VoxelGrid(region.GetImageData().GetDimensions(), tinyScene.ijkToRAS(region))
        expected = reconstruct(self.sequence, ReconstructionSettings(spacing=2.0), grid=grid).intensity.array
        found = slicer.util.arrayFromVolume(self.parameters.output)
        self.assertGreater(np.corrcoef(found.ravel(), expected.ravel())[0, 1], 0.99)

    def test_a_view_that_fails_neither_hides_nor_stops_the_scan(self):
        from AIFReconScene.live.liveViews import LiveViews

        with mock.patch.object(LiveViews, "follow", side_effect=RuntimeError("the view is broken")):
            self.begin()
            self.waitUntil(lambda: self.ui.liveStateLabel.text == "Probe seen")
            self.waitUntil(lambda: "the view is broken" in self.ui.liveStatisticsLabel.text)
            inserted = self.scan.statistics.inserted
            self.waitUntil(lambda: self.scan.statistics.inserted > inserted + 3)
            self.waitUntil(lambda: self.scan.volumeNode is not None)
        self.waitUntil(lambda: "the view is broken" not in self.ui.liveStatisticsLabel.text)
        self.ui.liveStopButton.click()
        self.assertTrue(slicer.util.arrayFromVolume(self.parameters.output).any())

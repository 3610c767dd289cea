"""Self test of a long scan from the scene's nodes: every update is accounted for, and nothing in the scene grows."""

import pathlib
import sys
import unittest
from unittest import mock

import slicer

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import liveSceneSoak

FRAMES = 400


class AIFReconLiveSoakTest(unittest.TestCase):
    """A third of a simulated minute."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        slicer.util.selectModule("AIFRecon")
        self.widget = slicer.modules.AIFReconWidget
        # Each update is waited for until the panel knows of it
        asking = mock.patch("AIFReconScene.live.liveReconstruction.ASK_EVERY", 0.0)
        asking.start()
        self.addCleanup(asking.stop)

    def tearDown(self):
        self.widget._live.close()
        slicer.mrmlScene.Clear()

    def test_a_long_scan_leaves_nothing_behind_and_accounts_for_every_image(self):
        soak = liveSceneSoak.begin(self.widget)
        looks = soak.run(FRAMES)
        live = self.widget._live._live
        self.widget.ui.liveStopButton.click()
        statistics = live.statistics
        self.assertEqual(soak.updates, statistics.frames_received + statistics.dropped_images)
        self.assertEqual(statistics.frames_received, statistics.inserted + statistics.frames_skipped)
        self.assertGreater(statistics.dropped_images, 0)
        settled = looks[len(looks) // 2 :]
        for name in ("nodes", "observers", "threads"):
            self.assertEqual(len({getattr(look, name) for look in settled}), 1, (name, looks))

    def test_every_scan_takes_all_of_its_frame_out_of_the_scene(self):
        soak = liveSceneSoak.begin(self.widget)
        seen = []
        for _ in range(3):
            soak.updates = 0
            for _frame in range(40):
                soak.update()
            soak.look(0)
            self.widget.ui.liveStopButton.click()
            seen.append(slicer.mrmlScene.GetNumberOfNodesByClass("vtkMRMLScalarVolumeDisplayNode"))
            self.widget._parameterNode.output = None
            self.widget.ui.liveStartButton.click()
        volumes = slicer.mrmlScene.GetNumberOfNodesByClass("vtkMRMLScalarVolumeNode")
        self.assertEqual(seen, [volumes - 2, volumes - 1, volumes])

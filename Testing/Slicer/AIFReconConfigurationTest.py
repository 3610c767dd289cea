"""Self tests of Plus configurations: what one asks for is done by the panel as by the command line, with nothing set by hand."""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import numpy as np
import slicer

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import realData
import tinyScene


class AIFReconConfigurationTest(unittest.TestCase):
    """Load and Apply beside `aifrecon reconstruct`, on the real recordings."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        slicer.util.selectModule("AIFRecon")
        self.widget = slicer.modules.AIFReconWidget
        self.ui, self.parameters = self.widget.ui, self.widget._parameterNode
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def tearDown(self):
        slicer.mrmlScene.Clear()

    def load(self, recording: pathlib.Path, configuration: pathlib.Path):
        """Load a recording with its configuration."""
        slicer.mrmlScene.Clear()
        self.parameters = self.widget._parameterNode
        self.parameters.recordingPath, self.parameters.configurationPath = recording, configuration
        self.ui.loadButton.click()

    def apply(self):
        """Press Apply; the volume node."""
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)
        self.ui.applyButton.click()
        return self.parameters.output

    def commandLine(self, recording: pathlib.Path, configuration: pathlib.Path):
        """The volume that `aifrecon reconstruct` writes."""
        from AIFReconLib import read_volume
        from AIFReconLib.__main__ import main

        path = pathlib.Path(self.folder.name) / "volume.nrrd"
        arguments = ["aifrecon", "reconstruct", str(recording), "--config", str(configuration), "--output", str(path)]
        with mock.patch.object(sys, "argv", arguments), contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(main(), 0)
        return read_volume(path)

    def assertSame(self, node, volume):
        """The same voxels in the same place."""
        np.testing.assert_allclose(tinyScene.ijkToRAS(node), volume.ijk_to_reference, atol=1e-6)
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(node), volume.array)

    def test_every_real_configuration_gives_the_voxels_of_the_command_line(self):
        configurations = sorted(realData.folder().glob("*.xml"))
        self.assertGreater(len(configurations), 3)
        for configuration in configurations:
            with self.subTest(configuration=configuration.name):
                recording = realData.recordingOf(configuration)
                self.load(recording, configuration)
                self.assertSame(self.apply(), self.commandLine(recording, configuration))

    def test_the_clip_rectangle_and_the_holes_of_the_real_configuration_are_honored(self):
        configuration = realData.folder() / realData.SPINE_CALIBRATION
        self.load(realData.recordingOf(configuration), configuration)
        self.parameters.keepMask = True
        volume = self.apply()
        self.assertEqual(volume.GetImageData().GetDimensions(), (147, 106, 105))
        mask = volume.GetNodeReference("AIFRecon.mask")
        self.assertTrue((slicer.util.arrayFromVolume(mask) == 2).any())

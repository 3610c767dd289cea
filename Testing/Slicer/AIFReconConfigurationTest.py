"""Self tests of Plus configurations: what one asks for is done by the panel as by the command line, with nothing set by hand."""

import contextlib
import io
import pathlib
import sys
from unittest import mock

import numpy as np
import realData
import slicer
import tinyScene
from openPanel import OpenPanel


class AIFReconConfigurationTest(OpenPanel):
    """Load and Apply beside `aifrecon reconstruct`, on the real recordings."""

    def load(self, recording: pathlib.Path, configuration: pathlib.Path):
        """Load a recording with its configuration."""
        slicer.mrmlScene.Clear()
        self.parameters.recordingPath, self.parameters.configurationPath = recording, configuration
        self.ui.loadButton.click()

    def commandLine(self, recording: pathlib.Path, configuration: pathlib.Path):
        """The volume that `aifrecon reconstruct` writes."""
        from AIFReconLib import read_volume
        from AIFReconLib.__main__ import main

        path = self.folder / "volume.nrrd"
        arguments = ["aifrecon", "reconstruct", str(recording), "--config", str(configuration), "--output", str(path)]
        with mock.patch.object(sys, "argv", arguments), contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(main(), 0)
        return read_volume(path)

    def assertSame(self, voxels, volume):
        """The same voxels in the same place."""
        np.testing.assert_allclose(tinyScene.ijkToRAS(self.parameters.output), volume.ijk_to_reference, atol=1e-6)
        np.testing.assert_array_equal(voxels, volume.array)

    def test_every_real_configuration_gives_the_voxels_of_the_command_line(self):
        configurations = sorted(realData.folder().glob("*.xml"))
        self.assertGreater(len(configurations), 3)
        for configuration in configurations:
            with self.subTest(configuration=configuration.name):
                recording = realData.recordingOf(configuration)
                self.load(recording, configuration)
                self.assertSame(self.applied(), self.commandLine(recording, configuration))

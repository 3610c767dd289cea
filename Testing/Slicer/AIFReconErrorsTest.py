"""Self tests of what the panel says when something cannot be done: once, in its own words, and without the marks of a bug."""

import importlib.metadata
import logging
import pathlib
import sys
import tempfile
import unittest

import slicer

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import tinyScene


class AIFReconErrorsTest(unittest.TestCase):
    """Errors that a user can mend, and those of the module."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        slicer.util.selectModule("AIFRecon")
        self.widget = slicer.modules.AIFReconWidget
        self.ui, self.parameters = self.widget.ui, self.widget._parameterNode
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def tearDown(self):
        self.widget._live.close()
        slicer.mrmlScene.Clear()

    def told(self, press) -> str:
        """What is said when a button is pressed whose work fails; a warning or a traceback in the log would mark Slicer's error log."""
        with self.assertLogs(level=logging.INFO) as log:
            press()
        marked = [record for record in log.records if record.levelno >= logging.WARNING or record.exc_info]
        self.assertEqual([record.getMessage() for record in marked], [])
        return "\n".join(record.getMessage() for record in log.records)

    def chooseBrokenRecording(self):
        """A file that breaks off in its header."""
        path = pathlib.Path(self.folder.name) / "broken.igs.mha"
        path.write_text("ObjectType = Image\nNDims = 3\n", encoding="utf-8")
        self.parameters.recordingPath = path

    def test_a_recording_that_cannot_be_read_is_no_bug(self):
        self.chooseBrokenRecording()
        said = self.told(self.widget._recorded.onLoad)
        self.assertIn("The recording could not be loaded.", said)
        self.assertIn("broken.igs.mha", said)
        self.assertTrue(self.ui.loadButton.enabled)

    def test_a_volume_that_no_frame_falls_into_is_no_bug_and_told_in_the_panel_s_words(self):
        from AIFReconScene.inputs.parameters import Region

        self.parameters.sweep = tinyScene.addSweep()
        roi = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLMarkupsROINode", "Far away")
        roi.SetCenterWorld(500.0, 500.0, 500.0)
        roi.SetSize(10.0, 10.0, 10.0)
        self.parameters.roi, self.parameters.region = roi, Region.BOX
        said = self.told(self.widget._recorded.onReconstruct)
        self.assertIn("no frame falls into the volume", said)
        self.assertNotIn("--", said)
        self.assertIn("Check its box", said)

    def test_a_package_that_is_not_installed_keeps_a_scan_from_starting_and_is_no_bug(self):
        find = importlib.metadata.version

        def without(name):
            if name == "pyigtl":
                raise importlib.metadata.PackageNotFoundError(name)
            return find(name)

        self.addCleanup(setattr, importlib.metadata, "version", find)
        importlib.metadata.version = without
        said = self.told(self.widget._live.onStart)
        self.assertIn("pyigtl", said)
        self.assertFalse(self.widget._live.isRunning)
        self.assertEqual(self.ui.liveStateLabel.text, "not started")

    def test_a_bug_is_raised(self):
        def broken(parameters, progress):
            raise KeyError("a bug")

        self.widget.logic.loadRecording = broken
        self.addCleanup(delattr, self.widget.logic, "loadRecording")
        with self.assertRaises(KeyError):
            self.widget._recorded.onLoad()

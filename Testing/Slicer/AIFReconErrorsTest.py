"""Self tests of what the panel says when something cannot be done: once, in its own words, and without the marks of a bug."""

import importlib.metadata
import logging
from unittest import mock

import tinyScene
from openPanel import OpenPanel


class AIFReconErrorsTest(OpenPanel):
    """Errors that a user can mend, and those of the module."""

    def told(self, press) -> str:
        """What is said when a button is pressed whose work fails; a warning or a traceback in the log would mark Slicer's error log."""
        with self.assertLogs(level=logging.INFO) as log:
            press()
        marked = [record for record in log.records if record.levelno >= logging.WARNING or record.exc_info]
        self.assertEqual([record.getMessage() for record in marked], [])
        return "\n".join(record.getMessage() for record in log.records)

    def chooseBrokenRecording(self):
        """A file that breaks off in its header."""
        path = self.folder / "broken.igs.mha"
        path.write_text("ObjectType = Image\nNDims = 3\n", encoding="utf-8")
        self.parameters.recordingPath = path

    def test_a_recording_that_cannot_be_read_is_no_bug(self):
        self.chooseBrokenRecording()
        said = self.told(self.widget._recorded.onLoad)
        self.assertIn("The recording could not be loaded.", said)
        self.assertIn("broken.igs.mha", said)
        self.assertTrue(self.ui.loadButton.enabled)

    def test_a_volume_that_no_frame_falls_into_is_no_bug_and_told_in_the_panel_s_words(self):
        self.parameters.sweep = tinyScene.addSweep()
        self.chooseBox((500.0, 500.0, 500.0))
        said = self.told(self.widget._recorded.onReconstruct)
        self.assertIn("no frame falls into the volume", said)
        self.assertNotIn("--", said)
        self.assertIn("Check its box", said)

    def test_a_package_that_is_not_installed_keeps_a_scan_from_starting_and_is_no_bug(self):
        with mock.patch.object(importlib.metadata, "version", side_effect=importlib.metadata.PackageNotFoundError("pyigtl")):
            said = self.told(self.live.onStart)
        self.assertIn("pyigtl", said)
        self.assertFalse(self.live.isRunning)
        self.assertEqual(self.ui.liveStateLabel.text, "not started")

    def test_a_bug_is_raised(self):
        broken = mock.patch.object(self.widget.logic, "loadRecording", side_effect=KeyError("a bug"))
        with broken, self.assertRaises(KeyError):
            self.widget._recorded.onLoad()

"""Self tests of the panel in Slicer's main window: how wide it is, and what can be reached without scrolling."""

import pathlib
import sys
import unittest

import qt
import slicer

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import tinyScene

LONG = "The recording of the second sweep over the lumbar spine has no transform from ProbeToTracker. " * 4


class AIFReconWindowTest(unittest.TestCase):
    """The panel beside the views."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        slicer.util.selectModule("AIFRecon")
        self.widget = slicer.modules.AIFReconWidget
        self.ui, self.parameters = self.widget.ui, self.widget._parameterNode
        self.window = slicer.util.mainWindow()
        if self.window is None:
            self.skipTest("this Slicer runs without its main window")

    def tearDown(self):
        self.widget._live.close()
        slicer.mrmlScene.Clear()

    def width(self):
        """Of the panel, as the window lays it out now."""
        for _settling in range(5):
            slicer.app.processEvents()
        return self.window.findChild(qt.QDockWidget, "PanelDockWidget").width

    def test_the_panel_stays_as_wide_as_it_is_whatever_it_says(self):
        for section in (self.ui.reportCollapsibleButton, self.ui.liveCollapsibleButton):
            section.collapsed = False
        before = self.width()
        for name in ("status", "sweepStatus", "boneStatus", "liveState", "liveStatistics", "report"):
            with self.subTest(label=name):
                label = getattr(self.ui, f"{name}Label")
                label.text, label.visible = LONG, True
                self.assertEqual(self.width(), before)
                label.text = "x"
                self.assertEqual(self.width(), before)

    def test_the_panel_stays_as_wide_as_it_is_when_inputs_are_chosen_and_reconstructed(self):
        before = self.width()
        self.parameters.sweep = tinyScene.addSweep("A sweep with a name that is much longer than the panel is wide, and then some more")
        self.assertEqual(self.width(), before)
        self.parameters.ctVolume, self.parameters.bone, _registration = tinyScene.addCT()
        self.assertEqual(self.width(), before)
        self.parameters.spacing = 2.0
        self.ui.applyButton.click()
        self.assertEqual(self.width(), before)

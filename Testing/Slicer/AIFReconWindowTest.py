"""Self tests of the panel in Slicer's main window: how wide it is, and what can be reached without scrolling."""

import qt
import slicer
import tinyScene
from openPanel import OpenPanel

LONG = "The recording of the second sweep over the lumbar spine has no transform from ProbeToTracker. " * 4


class AIFReconWindowTest(OpenPanel):
    """The panel beside the views."""

    def setUp(self):
        super().setUp()
        self.window = slicer.util.mainWindow()
        if self.window is None:
            self.skipTest("this Slicer runs without its main window")

    def settle(self):
        """Let the window lay itself out: every level asks the one around it."""
        for _level in range(5):
            slicer.app.processEvents()

    def width(self):
        """Of the panel, as the window lays it out now."""
        self.settle()
        return self.window.findChild(qt.QDockWidget, "PanelDockWidget").width

    def test_the_panel_stays_as_wide_as_it_is_whatever_is_chosen_and_whatever_it_says(self):
        for button in (self.ui.trackingMoreButton, self.ui.liveMoreButton):
            button.checked = True
            self.addCleanup(button.click)
        before = self.width()
        self.addInputs(spacing=2.0)
        self.parameters.sweep.SetName("A sweep with a name that is much longer than the panel is wide, and then some more")
        self.assertEqual(self.width(), before)
        self.ui.applyButton.click()
        self.assertEqual(self.width(), before)
        for name in ("status", "sweepStatus", "boneStatus", "coverageVerdict", "report", "liveState", "guidanceMove", "liveStatistics"):
            with self.subTest(label=name):
                label = getattr(self.ui, f"{name}Label")
                self.ui.tabWidget.currentIndex = int(self.ui.liveContents.isAncestorOf(label))
                label.text, label.visible = LONG, True
                self.assertEqual(self.width(), before)
                label.text = "x"
                self.assertEqual(self.width(), before)

    def test_texts_have_room_for_all_of_their_lines_when_the_panel_gets_narrower(self):
        from AIFReconGui.panel.layout import say

        self.parameters.sweep = tinyScene.addSweep()
        before = self.width()
        dock = self.window.findChild(qt.QDockWidget, "PanelDockWidget")
        label = self.ui.statusLabel
        self.addCleanup(self.window.resizeDocks, [dock], [before], qt.Qt.Horizontal)
        self.window.resizeDocks([dock], [before + 150], qt.Qt.Horizontal)
        self.settle()
        label.visible = True
        say(label, "\n".join([LONG] * 3))
        self.settle()
        lines = label.heightForWidth(label.width)
        self.window.resizeDocks([dock], [before], qt.Qt.Horizontal)
        self.settle()
        self.assertGreater(label.heightForWidth(label.width), lines)
        self.assertGreaterEqual(label.minimumHeight, label.heightForWidth(label.width))
        self.assertGreaterEqual(label.height, label.heightForWidth(label.width))

    def isSeen(self, widget) -> bool:
        """Whether the whole of a widget is in view."""
        seen = widget.visibleRegion().boundingRect()
        return (seen.width(), seen.height()) == (widget.width, widget.height)

    def test_a_scan_can_be_steered_without_scrolling_in_a_window_of_1000_pixels(self):
        self.window.resize(1400, 1000)
        self.ui.tabWidget.currentIndex = 1
        self.serve(rate=20.0, loop=True)
        self.ui.liveStartButton.click()
        self.waitUntil(lambda: self.ui.liveUseBoxButton.enabled)
        for name in ("PauseButton", "ResetButton", "StopButton", "UseBoxButton", "StateLabel", "RecordedLabel"):
            with self.subTest(widget=name):
                self.waitUntil(lambda name=name: self.isSeen(getattr(self.ui, f"live{name}")))
        where = self.ui.liveStopButton.y
        for said in (
            "Probe seen",
            "Bring what is not seen into the tracker's view",
            "\u2192  aim the beam 12\u00b0 more toward the patient's right",
        ):
            self.widget._live._showMove(said)
            self.settle()
            self.assertEqual(self.ui.liveStopButton.y, where)
        self.ui.liveStopButton.click()

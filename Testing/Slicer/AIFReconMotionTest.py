"""The light for motion, and its checkbox, on a patient who lies elsewhere in each pass."""

from dataclasses import replace

import numpy as np
import slicer
from openPanel import OpenPanel
from simulatedPatient import addPatient, patient

FRAMES, PASSES = 189, 9


def moved(sweep, by=3.0):
    """The sweep of a patient who lies so many mm elsewhere in each pass."""
    shifts = np.random.default_rng(1).normal(0.0, by / 3**0.5, (PASSES, 3))

    def record(number, each):
        shift = np.eye(4)
        shift[:3, 3] = shifts[number * PASSES // FRAMES]
        transforms = {n: replace(t, matrix=t.matrix @ shift) if n.source == "Reference" else t for n, t in each.transforms.items()}
        return replace(each, transforms=transforms)

    return replace(sweep, records=[record(n, each) for n, each in enumerate(sweep.records)])


class AIFReconMotionTest(OpenPanel):
    """What the panel says of motion, and what it does about it."""

    def reconstruct(self, sweep):
        """Add the patient with this sweep, reconstruct, wait for all lights; what that for motion says."""
        addPatient(frames=FRAMES, sweep=sweep)
        self.widget.initializeParameterNode()
        self.parameters.spacing = 3.0
        return self.press()

    def press(self):
        """Press Reconstruct, and wait for all lights."""
        self.ui.applyButton.click()
        self.waitForLights()
        return self.ui.motionSignalLabel.text, self.ui.motionVerdictLabel.text

    def assert_the_page_tells(self):
        """The page that the panel saves tells of the motion, and judges the CT by the sweep without it."""
        self.picturePanel().saveReport(self.folder / "page.html")
        text = (self.folder / "page.html").read_text("utf-8")
        for words in ("Motion of the patient", "Mended: echoes lie", "data:image/svg+xml"):
            self.assertIn(words, text)
        self.assertNotIn("do not agree", text)

    def test_motion_is_taken_out_and_the_checkbox_leaves_it_in_and_back(self):
        sign, words = self.reconstruct(moved(patient(frames=FRAMES).sweep))
        self.assertIn("good", sign, words)
        self.assertIn("with that taken out", words)
        # What lies on the CT now lay 2 mm off it
        self.assertIn("good", self.ui.calibrationSignalLabel.text, self.ui.calibrationVerdictLabel.text)
        self.assertIn("Mended", self.ui.statusLabel.text)
        self.ui.motionMoreButton.click()
        self.assertFalse(self.ui.motionDetails.pixmap.isNull())
        self.assertTrue(self.ui.motionDetails.isVisibleTo(self.widget.parent))
        self.assert_the_page_tells()
        mended = slicer.util.arrayFromVolume(self.parameters.output).copy()
        self.ui.takeOutMotionCheckBox.click()
        sign, words = self.press()
        self.assertIn("caution", sign, words)
        self.assertIn("mm", words)
        self.assertTrue(self.ui.takeOutMotionCheckBox.isVisibleTo(self.widget.parent))
        self.assertFalse(np.array_equal(slicer.util.arrayFromVolume(self.parameters.output), mended))
        self.ui.takeOutMotionCheckBox.click()
        self.ui.applyButton.click()
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(self.parameters.output), mended)

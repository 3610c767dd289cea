"""Self tests of the CT during a scan: placed after the scouting pass, watched, placed anew when the patient moves."""

import numpy as np
import tinyScene
from simulatedPatient import FRAMES, OpenPatient


class AIFReconLiveRegistrationTest(OpenPatient):
    """A scan of a simulated patient, played frame by frame into the image that the scan follows."""

    def setUp(self):
        super().setUp()
        # What a tracker's Reference lies under: moving it moves the patient from beneath the CT
        self.patient = tinyScene.addTransform("ReferenceToRAS", np.eye(4))
        tinyScene.putSweepUnder(self.nodes.browser, self.patient)
        self.follow(self.nodes.browser)

    def playFrames(self, browser, frames):
        """And until the bone of each was looked for."""
        for number in frames:
            seen = self.live._live.statistics.frames_received
            super().playFrames(browser, [number])
            self.waitUntil(lambda seen=seen: self.live._live.seen.compared >= seen)

    def play(self, frames=range(FRAMES)):
        """Show frames of the sweep."""
        self.playFrames(self.nodes.browser, frames)

    def test_after_the_scouting_pass_the_ct_is_placed_and_the_box_is_used_with_it(self):
        tinyScene.setMatrix(self.transform, self.true @ tinyScene.moved(5.0, -4.0, 3.0))
        self.start()
        self.assertTrue(self.live._live.seen.is_scouting)
        self.play()
        self.ui.livePlaceButton.click()
        self.assertLess(self.error(), 1.0)
        self.ui.liveUseBoxButton.click()
        self.play(range(3))
        self.waitUntil(lambda: self.live._live.statistics.inserted >= FRAMES)
        self.assertFalse(self.live._live.statistics.trouble)

    def test_a_patient_who_moves_is_told_in_large_letters_and_the_ct_can_be_placed_anew(self):
        self.start()
        self.playUntil(lambda: "CT and sweep agree" in self.ui.liveStatisticsLabel.text)
        motion = tinyScene.moved(9.0, 4.0, 6.0)
        tinyScene.setMatrix(self.patient, motion)
        self.playUntil(lambda: "no longer fits" in self.ui.liveStateLabel.text)
        self.assertIn("26px", self.ui.liveStateLabel.styleSheet)
        self.play()
        self.assertTrue(self.ui.livePlaceButton.enabled)
        self.ui.livePlaceButton.click()
        self.assertLess(self.error(motion @ self.true), 1.5, self.ui.registrationLabel.text)
        self.waitUntil(lambda: "no longer fits" not in self.ui.liveStateLabel.text)
        self.ui.undoPlaceButton.click()
        self.waitUntil(lambda: not self.ui.undoPlaceButton.enabled)
        np.testing.assert_array_equal(tinyScene.matrixOf(self.transform), self.true)

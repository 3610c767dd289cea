"""Self tests of several sweeps as one: what is offered and chosen, what is made of them, and what cannot be joined."""

import numpy as np
import qt
import slicer
import tinyScene
from openPanel import OpenPanel

BESIDE = 0.0, 0.0, 9.0
"""mm. Along the slab, so that both sweeps see its face."""


class AIFReconSweepsTest(OpenPanel):
    """The list of further sweeps, and Apply."""

    def setUp(self):
        super().setUp()
        self.parameters.sweep = tinyScene.addSweep("First")
        self.parameters.spacing, self.parameters.holeLimit = 1.0, 0.0

    def offered(self) -> list:
        """Names in the list."""
        combo = self.ui.otherSweepsComboBox
        return [combo.itemText(row) for row in range(combo.count)]

    def check(self, *names):
        """Check these in the list, as a user does."""
        combo = self.ui.otherSweepsComboBox
        for row, name in enumerate(self.offered()):
            state = qt.Qt.Checked if name in names else qt.Qt.Unchecked
            combo.setCheckState(combo.model().index(row, combo.modelColumn), state)

    def checked(self) -> list:
        """Names that are checked."""
        return [self.offered()[index.row()] for index in self.ui.otherSweepsComboBox.checkedIndexes()]

    def test_checked_sweeps_are_reconstructed_as_one_and_counted_each(self):
        from AIFReconLib import Recipe, reconstruct

        second = tinyScene.addSweep("Second", BESIDE)
        self.check("Second")
        self.assertEqual(list(self.parameters.otherSweeps), [second])
        self.assertIn("First: 11 of 12 frames have a position", self.ui.sweepStatusLabel.text)
        self.assertIn("Second: 11 of 12 frames have a position", self.ui.sweepStatusLabel.text)
        self.choose(self.ui.methodComboBox, "average")
        self.ui.applyButton.click()
        volume = self.parameters.output
        asked = Recipe(method="average", spacing=1.0, hole_limit=0.0)
        expected = reconstruct([tinyScene.makeSequence(), tinyScene.makeSequence(BESIDE)], asked).intensity
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(volume), expected.array)
        np.testing.assert_allclose(tinyScene.ijkToRAS(volume), expected.ijk_to_reference, atol=1e-6)
        self.assertEqual(volume.GetName(), "First +1 average")
        self.assertIn("22 of 24 frames", self.ui.summaryLabel.text)
        self.assertIn("Second: 11 of 12 frames; skipped:", self.ui.statusLabel.text)

    def test_a_new_box_lies_around_all_of_them(self):
        from AIFReconScene.inputs.parameters import Region

        def depth():
            roi = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLMarkupsROINode")
            self.parameters.region, self.parameters.roi = Region.BOX, roi
            return roi.GetSize()[2]

        tinyScene.addSweep("Second", BESIDE)
        alone = depth()
        self.check("Second")
        self.assertAlmostEqual(depth() - alone, BESIDE[2])

    def test_a_sweep_that_goes_is_chosen_no_more(self):
        second, third = tinyScene.addSweep("Second", BESIDE), tinyScene.addSweep("Third")
        self.check("Second", "Third")
        slicer.mrmlScene.RemoveNode(second)
        self.assertEqual((self.offered(), self.checked()), (["Third"], ["Third"]))
        self.assertEqual(list(self.parameters.otherSweeps), [third])

    def test_a_chosen_sweep_that_cannot_be_placed_any_more_is_named(self):
        second = tinyScene.addSweep("Second", BESIDE)
        self.check("Second")
        tinyScene.warp(second)
        self.assertFalse(self.ui.applyButton.enabled)
        self.assertIn("Warp", self.ui.applyButton.toolTip)

    def test_the_ct_is_placed_on_all_of_them(self):
        from AIFReconScene.registration.ctRegistration import CTRegistration

        self.parameters.ctVolume, self.parameters.bone, _registration = tinyScene.addCT()
        tinyScene.addSweep("Second", BESIDE)
        registration = CTRegistration()
        alone = _echoes(registration.check(self.parameters))
        self.check("Second")
        self.assertEqual(_echoes(registration.check(self.parameters)), 2 * alone)


def _echoes(placed) -> int:
    return placed.agreement.echoes + placed.agreement.elsewhere

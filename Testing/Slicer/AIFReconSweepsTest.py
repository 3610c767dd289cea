"""Self tests of several sweeps as one: what is offered and chosen, what is made of them, and what cannot be joined."""

import pathlib
import sys
import unittest

import numpy as np
import qt
import slicer

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import tinyScene

BESIDE = 0.0, 0.0, 9.0
"""mm. Along the slab, so that both sweeps see its face."""

FAR = 0.0, 0.0, 3000.0


class AIFReconSweepsTest(unittest.TestCase):
    """The list of further sweeps, and Apply."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        slicer.util.selectModule("AIFRecon")
        self.widget = slicer.modules.AIFReconWidget
        self.ui, self.parameters = self.widget.ui, self.widget._parameterNode
        self.first = self.parameters.sweep = tinyScene.addSweep("First")
        self.parameters.spacing, self.parameters.holeLimit = 1.0, 0.0

    def tearDown(self):
        slicer.mrmlScene.Clear()

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
        self.ui.methodComboBox.currentIndex = self.ui.methodComboBox.findText("average")
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
        import vtk

        second = tinyScene.addSweep("Second", BESIDE)
        self.check("Second")
        warp = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLTransformNode", "Warp")
        warp.SetAndObserveTransformToParent(vtk.vtkThinPlateSplineTransform())
        image = second.GetProxyNode(second.GetMasterSequenceNode())
        image.GetParentTransformNode().SetAndObserveTransformNodeID(warp.GetID())
        self.assertFalse(self.ui.applyButton.enabled)
        self.assertIn("Warp", self.ui.applyButton.toolTip)

    def test_sweeps_that_no_patient_spans_are_refused_with_both_names(self):
        from AIFReconLib.errors import GeometryError

        far = tinyScene.addSweep("Second", FAR)
        with self.assertRaisesRegex(GeometryError, "First and Second lie 29.. mm apart, so they are not in one Reference"):
            self.widget.logic.reconstruct(self.first, otherSweeps=[far], spacing=1.0)

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

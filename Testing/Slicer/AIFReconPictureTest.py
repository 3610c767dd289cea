"""Self tests of the picture: measured or enhanced, the tint, bone in 3D, the probe's side up, names of levels, and the report."""

import pathlib
import sys
import unittest

import numpy as np
import slicer

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import tinyScene


class AIFReconPictureTest(unittest.TestCase):
    """The part of the panel that says how a reconstruction is looked at."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        slicer.app.layoutManager().setLayout(slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView)
        slicer.util.selectModule("AIFRecon")
        self.widget = slicer.modules.AIFReconWidget
        self.ui, self.parameters = self.widget.ui, self.widget._parameterNode
        self.picture = next(each for each in self.widget._followers if type(each).__name__ == "PicturePanel")

    def tearDown(self):
        slicer.mrmlScene.Clear()

    def reconstruct(self):
        """Sweep, CT and bone are chosen and Apply is pressed; the volume."""
        self.parameters.sweep = tinyScene.addSweep()
        self.parameters.ctVolume, self.parameters.bone, _registration = tinyScene.addCT()
        self.parameters.bone.CreateDefaultDisplayNodes()
        self.parameters.spacing = 2.0
        self.ui.applyButton.click()
        return self.parameters.output

    def composite(self, name="Red"):
        """What a slice view shows."""
        return slicer.app.layoutManager().sliceWidget(name).mrmlSliceCompositeNode()

    def measured(self):
        """The plain echo that is kept beside the output."""
        from AIFReconScene.volumes.volumeNodes import measuredOf

        return measuredOf(self.parameters.output)

    # ---- measured or enhanced

    def test_the_plain_echo_is_the_average_of_the_same_frames_on_the_same_voxels(self):
        output = self.reconstruct()
        import AIFRecon

        averaged = AIFRecon.AIFReconLogic().reconstruct(self.parameters.sweep, region=output, method="average", spacing=2.0)
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(self.measured()), slicer.util.arrayFromVolume(averaged))
        self.assertGreater(np.abs(slicer.util.arrayFromVolume(output).astype(int) - slicer.util.arrayFromVolume(averaged)).max(), 10)

    def test_one_toggle_shows_the_plain_echo_in_the_same_gray_levels_and_back(self):
        output = self.reconstruct()
        output.GetDisplayNode().SetWindowLevelMinMax(10.0, 90.0)
        box = self.picture._ui.showMeasuredCheckBox
        box.click()
        for name in ("Red", "Yellow", "Green"):
            self.assertEqual(self.composite(name).GetForegroundVolumeID(), self.measured().GetID())
        display = self.measured().GetDisplayNode()
        self.assertEqual((display.GetWindowLevelMin(), display.GetWindowLevelMax()), (10.0, 90.0))
        self.parameters.opacity = 0.25
        self.assertAlmostEqual(self.composite().GetForegroundOpacity(), 0.25)
        box.click()
        self.assertEqual(self.composite().GetForegroundVolumeID(), output.GetID())

    def test_the_plain_echo_stays_in_view_when_apply_is_pressed_again(self):
        self.reconstruct()
        kept = self.measured()
        self.parameters.showMeasured = True
        self.ui.applyButton.click()
        self.assertIs(self.measured(), kept)
        self.assertEqual(self.composite().GetForegroundVolumeID(), kept.GetID())

    def test_where_nothing_is_enhanced_there_is_nothing_to_toggle(self):
        self.reconstruct()
        from AIFReconScene.inputs.parameters import Method

        kept = self.measured()
        self.parameters.method = Method.AVERAGE
        self.ui.applyButton.click()
        self.assertIsNone(self.measured())
        self.assertIsNone(kept.GetScene())
        self.assertFalse(self.picture._ui.showMeasuredCheckBox.enabled)
        self.assertIn("Apply", self.picture._ui.showMeasuredCheckBox.toolTip)

    # ---- tint

    def test_brightness_that_the_method_added_is_tinted_and_nothing_else_is(self):
        output = self.reconstruct()
        tint = slicer.mrmlScene.GetNodeByID(self.composite().GetLabelVolumeID())
        bands, shown, plain = (slicer.util.arrayFromVolume(each) for each in (tint, output, self.measured()))
        self.assertTrue((bands > 0).any())
        self.assertTrue((shown[bands > 0] > plain[bands > 0]).all())
        self.assertTrue((bands[shown <= plain] == 0).all())

    def test_the_tint_fades_with_the_volume_and_goes_with_its_box_the_plain_echo_and_the_panel(self):
        self.reconstruct()
        self.parameters.opacity = 0.3
        self.assertAlmostEqual(self.composite().GetLabelOpacity(), 0.3)
        for change in ("showRaised", "showMeasured"):
            with self.subTest(change=change):
                setattr(self.parameters, change, not getattr(self.parameters, change))
                self.assertFalse(self.composite().GetLabelVolumeID())
                setattr(self.parameters, change, not getattr(self.parameters, change))
                self.assertTrue(self.composite().GetLabelVolumeID())
        self.widget.exit()
        self.assertFalse(self.composite().GetLabelVolumeID())
        self.assertIsNone(slicer.mrmlScene.GetFirstNodeByName("Raised brightness"))
        self.widget.enter()
        self.assertTrue(self.composite().GetLabelVolumeID())

    def test_labels_that_somebody_else_shows_stay(self):
        other = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLLabelMapVolumeNode", "Lesion")
        self.composite("Green").SetLabelVolumeID(other.GetID())
        self.reconstruct()
        self.assertEqual(self.composite("Green").GetLabelVolumeID(), other.GetID())
        self.assertNotEqual(self.composite("Red").GetLabelVolumeID(), other.GetID())

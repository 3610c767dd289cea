"""Self tests of the advanced choices: each reaches the reconstruction as the command line's option does, or is refused with a reason."""

import pathlib

import numpy as np
import tinyScene
from openPanel import OpenPanel

CLIP = 20, 10, 25, 40


class AIFReconAdvancedTest(OpenPanel):
    """The panel beside the library's own call."""

    def setUp(self):
        super().setUp()
        self.parameters.sweep = tinyScene.addSweep()
        self.parameters.spacing = 1.0

    def expected(self, settings: dict) -> np.ndarray:
        """The voxels of the library's own call."""
        from AIFReconLib import Recipe, reconstruct

        return reconstruct(tinyScene.makeSequence(), Recipe(spacing=1.0, **settings)).intensity.array

    def mask(self) -> pathlib.Path:
        """An importance mask in a file, and its left half in black."""
        import SimpleITK as sitk

        columns, rows = tinyScene.FRAME_SIZE
        array = np.full((rows, columns), 255, np.uint8)
        array[:, : columns // 2] = 0
        path = self.folder / "mask.png"
        sitk.WriteImage(sitk.GetImageFromArray(array), str(path))
        return path

    # ---- each reaches the reconstruction

    def test_what_is_chosen_is_what_the_library_does(self):
        ui = self.ui
        clip = ((getattr(ui, f"clip{name}SpinBox"), "value", number) for name, number in zip(("Column", "Row", "Width", "Height"), CLIP))
        linear = ((ui.interpolationComboBox, "currentText", "linear"), (ui.methodComboBox, "currentText", "average"))
        mask = ((ui.importanceMaskPathLineEdit, "currentPath", str(self.mask())),)
        for asked, widgets in (
            ({"clip_px": CLIP}, clip),
            ({"clip_px": CLIP, "importance_mask": self.mask()}, mask),
            ({"clip_px": CLIP, "importance_mask": self.mask(), "method": "average", "interpolation": "linear"}, linear),
        ):
            with self.subTest(asked=list(asked)):
                for widget, name, value in widgets:
                    setattr(widget, name, value)
                np.testing.assert_array_equal(self.applied(), self.expected(asked))

    def test_only_the_fan_enters(self):
        from AIFReconScene.inputs.parameters import ProbeShape

        self.parameters.probe, self.parameters.apexColumn, self.parameters.apexRow = ProbeShape.SECTOR, 32.0, -20.0
        self.ui.fanLastRadiusSpinBox.value = 70.0
        self.ui.fanFirstRadiusSpinBox.value = 30.0
        self.ui.fanFirstAngleSpinBox.value, self.ui.fanLastAngleSpinBox.value = -20.0, 15.0
        fan = {"fan_angles_deg": (-20, 15), "fan_radius_px": (30, 70), "probe": "sector", "apex_px": (32, -20)}
        expected = self.expected(fan)
        np.testing.assert_array_equal(self.applied(), expected)

    def test_bone_can_be_looked_for_in_the_sweep(self):
        self.choose(self.ui.methodComboBox, "weighted")
        self.assertFalse(self.ui.applyButton.enabled)
        self.assertIn("needs bone", self.ui.statusLabel.text)
        self.choose(self.ui.boneSourceComboBox, "The echoes themselves")
        voxels = self.applied()
        self.assertFalse(np.array_equal(voxels, self.expected({"method": "average"})))
        points = tinyScene.worldOfBrightVoxels(self.parameters.output, 150)
        self.assertLess(np.abs(np.median(points[:, 1]) - tinyScene.FACE), 1.0)

    # ---- reading a recording

    def test_a_time_offset_moves_the_poses_of_a_recording_that_is_loaded(self):
        from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

        from AIFReconLib import with_time_offset
        from AIFReconLib.sweep.poses import sweep_poses

        self.ui.timeOffsetSpinBox.value = 0.04
        self.chooseRecording()
        self.ui.loadButton.click()
        found = sweep_poses(sequenceFromBrowser(self.parameters.sweep)).image_to_reference
        expected = sweep_poses(with_time_offset(tinyScene.makeSequence(), 0.04)).image_to_reference
        np.testing.assert_allclose(found, expected, atol=1e-4)

    # ---- what does not go together

    def test_methods_are_not_compared_with_what_only_some_of_them_can_do(self):
        self.addInputs()
        self.choose(self.ui.methodComboBox, "average")
        self.assertTrue(self.ui.compareButton.enabled, self.ui.compareButton.toolTip)
        self.choose(self.ui.interpolationComboBox, "linear")
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)
        self.assertFalse(self.ui.compareButton.enabled)
        self.assertIn("choose nearest to compare", self.ui.compareButton.toolTip)
        self.choose(self.ui.interpolationComboBox, "nearest")
        self.ui.importanceMaskPathLineEdit.currentPath = str(self.mask())
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)
        self.assertFalse(self.ui.compareButton.enabled)
        self.assertIn("leave the mask out to compare", self.ui.compareButton.toolTip)

    # ---- digits

    def test_the_smallest_weight_floor_that_can_be_entered_reconstructs(self):
        self.addInputs()
        self.ui.weightFloorSpinBox.value = 0.0
        self.assertEqual(self.parameters.weightFloor, self.ui.weightFloorSpinBox.minimum)
        self.assertGreater(self.parameters.weightFloor, 0.0)
        self.applied()

    # ---- tracking report

    def test_the_tracking_report_tells_what_was_used_and_skipped_and_the_coverage_after_a_reconstruction(self):
        self.ui.trackingMoreButton.checked = True
        for said in ("11 of 12", "OUT_OF_VIEW"):
            self.assertIn(said, self.ui.reportLabel.text)
        self.assertNotIn("of the voxels measured", self.ui.reportLabel.text)
        self.choose(self.ui.methodComboBox, "average")
        voxels = self.applied()
        self.assertIn(">Volume</td>", self.ui.reportLabel.text)
        self.assertIn("of the voxels measured", self.ui.reportLabel.text)
        self.assertIn("average", self.ui.reportLabel.text)
        _title, report = self.widget.logic.trackingReport(self.parameters)
        self.assertEqual(report.coverage["voxels"], voxels.size)
        self.ui.trackingMoreButton.checked = False

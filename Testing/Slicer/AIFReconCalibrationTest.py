"""Self tests of the light Calibration: a sweep with a wrong calibration is calibrated in the panel, as a user does it, and back again."""

from dataclasses import replace

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel
from simulatedPatient import addPatient, patient, wronglyCalibrated

BONE = np.array([[240.0, 120.0], [120.0, 150.0], [360.0, 150.0], [240.0, 200.0]])
"""Pixels (column, row) where the images of the simulated patient show bone."""


def wrongBy(share: float = 1.0) -> np.ndarray:
    """(4, 4), pixels: pose @ this is the pose of a calibration that is off by this part of 3 mm, 2 degrees and 1% of both sizes."""
    turned = tinyScene.rotation(0, 1.5 * share) @ tinyScene.rotation(1, -1.5 * share)
    plane = tinyScene.moved(2.0 * share, -1.5 * share, 1.5 * share) @ turned @ np.diag([1.0 + 0.01 * share, 1.0 - 0.01 * share, 1.0, 1.0])
    in_mm = np.diag([0.26, 0.26, 1.0, 1.0])
    return np.linalg.inv(in_mm) @ plane @ in_mm


class AIFReconCalibrationTest(OpenPanel):
    """The buttons, on a patient whose true calibration is known."""

    def setUp(self):
        super().setUp()
        self.wrong = wronglyCalibrated(wrongBy())
        self.ui.calibrationMoreButton.checked = False

    def add(self, sweep=None):
        """The patient in the scene, with the wrong sweep; all is chosen. The browser."""
        nodes = addPatient(sweep=sweep or self.wrong)
        self.browser, self.ctToReference = nodes.browser, nodes.ctToReference
        self.widget.initializeParameterNode()
        self.parameters.spacing = 2.0
        return self.browser

    def image(self):
        """The node that the images are replayed into."""
        return self.parameters.sweep.GetProxyNode(self.parameters.sweep.GetMasterSequenceNode())

    def poses(self) -> np.ndarray:
        """(frames, 4, 4), where the module has the frames."""
        from AIFReconScene.sweep.sequenceReader import IMAGE_TO_WORLD, sequenceFromBrowser

        sequence = sequenceFromBrowser(self.parameters.sweep)
        return np.array([record.transforms[IMAGE_TO_WORLD].matrix for record in sequence.records])

    def off(self, frames=slice(None)) -> float:
        """mm, by which bone is placed wrongly in the median over the frames; the chosen sweep has these of the patient's."""
        from AIFReconLib.sweep.poses import sweep_poses

        points = np.column_stack([BONE, np.zeros(len(BONE)), np.ones(len(BONE))]).T
        difference = (self.poses() - sweep_poses(patient().sweep).image_to_reference[frames]) @ points
        return float(np.median(np.linalg.norm(difference[:, :3], axis=1)))

    def calibrate(self) -> str:
        """Press the button; what was said."""
        self.ui.calibrateButton.click()
        return self.ui.calibrationLabel.text

    def transforms(self) -> list:
        """Names of the transforms of the scene."""
        return [node.GetName() for node in slicer.util.getNodesByClass("vtkMRMLLinearTransformNode")]

    # ---- calibrating

    def test_a_wrong_calibration_is_mended_where_the_scene_shows_it_and_undo_brings_every_bit_back(self):
        self.add()
        before, names, above = self.poses(), self.transforms(), self.image().GetTransformNodeID()
        self.assertGreater(self.off(), 2.0)
        self.assertFalse(self.ui.undoCalibrationButton.enabled)
        said = self.calibrate()
        self.assertIn("image points are placed within", said)
        self.assertLess(self.off(), 1.0, said)
        node = self.image().GetParentTransformNode()
        self.assertEqual(node.GetName(), f"{self.image().GetName()} calibration")
        for number in (0, 12):
            self.browser.SetSelectedItemNumber(number)
            np.testing.assert_allclose(tinyScene.worldOf(self.image()), self.poses()[number], atol=1e-6)
        self.ui.undoCalibrationButton.click()
        np.testing.assert_array_equal(self.poses(), before)
        self.assertEqual((self.transforms(), self.image().GetTransformNodeID()), (names, above))
        self.assertFalse(self.ui.undoCalibrationButton.enabled)
        self.assertIn("back as it was", self.ui.calibrationLabel.text)

    def test_sweeps_that_are_chosen_together_are_calibrated_together(self):
        from AIFReconScene.sweep.sequenceNodes import browserFromSequence

        from AIFReconLib.sweep.edits import select_frames

        sweeps = [self.add(select_frames(self.wrong, every=2)), browserFromSequence(select_frames(self.wrong, 1, every=2), "Other")]
        self.parameters.otherSweeps = sweeps[1:]
        before = self.poses()
        said = self.calibrate()
        for number, sweep in enumerate(sweeps):
            self.parameters.sweep = sweep
            self.assertLess(self.off(slice(number, None, 2)), 1.0, said)
        self.ui.undoCalibrationButton.click()
        self.parameters.sweep = sweeps[0]
        np.testing.assert_array_equal(self.poses(), before)
        self.assertGreater(self.off(slice(0, None, 2)), 2.0)

    def test_the_light_offers_it_and_does_not_hold_for_the_new_calibration(self):
        self.add(wronglyCalibrated(wrongBy(0.3)))
        self.assertFalse(self.ui.calibrateButton.visible)
        self.ui.placeButton.click()
        self.ui.applyButton.click()
        self.waitForLights()
        self.assertIn("mm off", self.ui.calibrationVerdictLabel.text, self.ui.registrationLabel.text)
        self.assertRegex(self.ui.calibrationVerdictLabel.text, "shift out of the image -.*with “Calibrate on this sweep”")
        self.assertIn("caution", self.ui.calibrationSignalLabel.text)
        self.assertTrue(self.ui.calibrateButton.visible)
        told = {name: getattr(self.ui, f"{name}VerdictLabel").text for name in ("tracking", "registration", "calibration")}
        self.calibrate()
        for name in told:
            self.assertIn("something has changed", getattr(self.ui, f"{name}VerdictLabel").text)
        self.ui.undoCalibrationButton.click()
        for name, text in told.items():
            self.assertEqual(getattr(self.ui, f"{name}VerdictLabel").text, text)

    def test_a_calibration_is_saved_with_the_scene_and_a_right_one_is_left_alone(self):
        self.add()
        self.calibrate()
        poses = self.poses()
        tinyScene.saveAndOpenAgain(self)
        np.testing.assert_allclose(self.poses(), poses, atol=1e-4)
        names = self.transforms()
        self.assertIn("as given agrees with this sweep", self.calibrate())
        self.assertEqual(self.transforms(), names)
        self.assertFalse(self.ui.undoCalibrationButton.enabled)

    def test_a_calibration_of_the_scene_gets_the_new_matrix(self):
        from AIFReconLib.geometry.transform_graph import TransformName
        from AIFReconLib.sweep.configuration import NO_CONFIGURATION

        name = TransformName("Image", "Probe")
        matrix = np.array(self.wrong.transforms[name].matrix)
        self.add(replace(patient().sweep, configuration=NO_CONFIGURATION))
        # Some calibrations say nothing of the way out of the image
        node = tinyScene.addTransform(str(name), matrix @ np.diag([1.0, 1.0, 0.3, 1.0]))
        self.widget.initializeParameterNode()
        before, kept = self.poses(), tinyScene.matrixOf(node)
        self.assertGreater(self.off(), 2.0)
        said = self.calibrate()
        self.assertLess(self.off(), 1.0, said)
        self.assertIsNone(self.image().GetParentTransformNode())
        self.ui.undoCalibrationButton.click()
        np.testing.assert_array_equal(tinyScene.matrixOf(node), kept)
        np.testing.assert_array_equal(self.poses(), before)

    # ---- refused

    def test_a_cancel_changes_nothing_nor_does_a_sweep_that_does_not_tell(self):
        from AIFReconScene.registration import sweepCalibration

        self.add()
        tinyScene.setMatrix(self.ctToReference, patient().ct_to_reference @ tinyScene.moved(0.0, 0.0, 60.0))
        before, names = self.poses(), self.transforms()
        self.pressAnd(self.ui.calibrateButton, sweepCalibration, "inWorker", 0.5, lambda: self.widget._work.cancel())
        self.assertIn("Canceled.", self.ui.calibrationLabel.text)
        np.testing.assert_array_equal(self.poses(), before)
        said = self.calibrate()
        self.assertIn("The calibration was not changed.", said)
        self.assertNotIn("--", said)
        np.testing.assert_array_equal(self.poses(), before)
        self.assertEqual(self.transforms(), names)
        self.assertFalse(self.ui.undoCalibrationButton.enabled)

    def test_images_that_each_have_a_place_of_their_own_are_refused_in_a_sentence_and_so_is_a_sweep_without_bone(self):
        self.add()
        images = self.browser.GetMasterSequenceNode()
        self.image().SetAndObserveTransformNodeID(None)
        for number in range(images.GetNumberOfDataNodes()):
            images.GetNthDataNode(number).SetOrigin(0.0, 0.0, float(number))
        self.assertIn("no transform of the scene can take a calibration", self.messageOf(self.calibrate))
        self.parameters.bone = None
        self.assertFalse(self.ui.calibrateButton.enabled)
        self.assertIn("Select the bone", self.ui.calibrateButton.toolTip)

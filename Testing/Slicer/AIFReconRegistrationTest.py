"""Self tests of the Registration section: the CT of a simulated patient is displaced, placed on the sweep, and brought back."""

import os
import signal

import numpy as np
import slicer
import tinyScene
from simulatedPatient import OpenPatient, addPatient


class AIFReconRegistrationTest(OpenPatient):
    """The section, as a user works with it, on a patient whose true place is known."""

    def displace(self, motion=None):
        """Move the CT from its true place; where it is then."""
        motion = tinyScene.moved(5.0, -4.0, 3.0) @ tinyScene.rotation(0, 4.0) if motion is None else motion
        tinyScene.setMatrix(self.transform, self.true @ motion)
        return tinyScene.matrixOf(self.transform)

    def echoModels(self) -> list:
        """Model nodes with echoes."""
        return [node for node in slicer.util.getNodesByClass("vtkMRMLModelNode") if node.GetName().startswith("Bone echoes")]

    # ---- placing

    def test_a_displaced_ct_comes_back_to_within_a_millimeter_with_its_bone_no_voxel_changes_and_undo_brings_every_bit_back(self):
        place = self.displace()
        self.assertFalse(self.ui.undoPlaceButton.enabled)
        self.assertGreater(self.error(), 5.0)
        voxels, before = slicer.util.arrayFromVolume(self.nodes.ct).copy(), tinyScene.ijkToRAS(self.nodes.ct)
        self.ui.placeButton.click()
        self.assertLess(self.error(), 1.0)
        self.assertIn("CT and sweep agree", self.ui.registrationLabel.text)
        np.testing.assert_array_equal(tinyScene.worldOf(self.nodes.ct), tinyScene.worldOf(self.nodes.segmentation))
        np.testing.assert_array_equal(tinyScene.ijkToRAS(self.nodes.ct), before)
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(self.nodes.ct), voxels)
        self.undo()
        np.testing.assert_array_equal(tinyScene.matrixOf(self.transform), place)
        self.waitUntil(lambda: "do not agree" in self.ui.registrationLabel.text)
        self.assertIn("back where it was", self.ui.registrationLabel.text)

    def test_a_ct_that_lies_anywhere_is_found(self):
        from AIFReconScene.inputs.parameters import RegistrationStart

        self.displace(tinyScene.moved(300.0, 200.0, -150.0) @ tinyScene.rotation(1, 100.0))
        self.parameters.registrationStart = RegistrationStart.ANYWHERE
        self.ui.placeButton.click()
        self.assertLess(self.error(), 1.0, self.ui.registrationLabel.text + self.ui.statusLabel.text)

    def test_each_vertebra_is_placed_on_its_own_and_undo_brings_the_bone_back(self):
        from AIFReconScene.inputs.boneNodes import labelsFromNode
        from AIFReconScene.inputs.parameters import RegistrationStart

        self.displace()
        self.parameters.registrationStart = RegistrationStart.EACH_ON_ITS_OWN
        self.ui.placeButton.click()
        self.assertLess(self.error(), 1.0, self.ui.registrationLabel.text + self.ui.statusLabel.text)
        self.assertIn("CT and sweep agree", self.ui.registrationLabel.text)
        bent = self.parameters.bone
        self.assertEqual(bent.GetName(), f"{self.nodes.segmentation.GetName()} as scanned")
        placed, whole = labelsFromNode(bent), labelsFromNode(self.nodes.segmentation)
        self.assertEqual(np.unique(placed.array).tolist(), np.unique(whole.array).tolist())
        for number in np.unique(whole.array)[1:]:
            middles = [
                labels.ijk_to_reference @ [*np.argwhere(labels.array == number).mean(axis=0)[::-1], 1.0] for labels in (placed, whole)
            ]
            self.assertLess(np.linalg.norm(middles[0] - middles[1]), 2.0)
        self.ui.undoPlaceButton.click()
        self.assertIs(self.parameters.bone, self.nodes.segmentation)
        self.assertIsNone(slicer.mrmlScene.GetFirstNodeByName(bent.GetName()) if bent.GetScene() else None)
        self.assertGreater(self.error(), 5.0)

    def test_a_worker_that_has_died_leaves_a_ct_that_can_be_checked_again(self):
        from AIFReconScene.work import worker

        self.ui.checkButton.click()
        os.kill(worker.pid, signal.SIGTERM)
        self.displace()
        self.waitUntil(lambda: not self.ui.registrationLabel.text)
        self.assertEqual(self.ui.agreementProgressBar.value, 0)
        self.ui.checkButton.click()
        self.assertIn("do not agree", self.ui.registrationLabel.text)

    def test_a_transform_is_made_where_there_is_none(self):
        tinyScene.setMatrix(self.transform, np.eye(4))
        true, motion = self.true, tinyScene.moved(4.0, -3.0, 2.0)
        bone, ct = self.nodes.segmentation, self.nodes.ct
        for node in (bone, ct):
            node.SetAndObserveTransformNodeID(None)
        # The sweep is moved instead, to where the CT nearly lies: a CT in its own coordinates
        above = tinyScene.addTransform("ReferenceToRAS", np.linalg.inv(true) @ motion)
        tinyScene.putSweepUnder(self.nodes.browser, above)
        count = slicer.mrmlScene.GetNumberOfNodesByClass("vtkMRMLLinearTransformNode")
        self.ui.placeButton.click()
        self.assertEqual(slicer.mrmlScene.GetNumberOfNodesByClass("vtkMRMLLinearTransformNode"), count + 1)
        self.assertIs(bone.GetParentTransformNode(), ct.GetParentTransformNode())
        self.assertLess(self.error(np.linalg.inv(true) @ motion @ true), 1.0)
        self.undo()
        self.assertIsNone(bone.GetParentTransformNode())
        self.assertIsNone(ct.GetParentTransformNode())
        self.assertEqual(slicer.mrmlScene.GetNumberOfNodesByClass("vtkMRMLLinearTransformNode"), count)

    def test_a_transform_above_sweep_and_ct_is_left_alone(self):
        place = tinyScene.moved(10.0, 20.0, 30.0) @ tinyScene.rotation(2, 30.0)
        above = tinyScene.addTransform("ReferenceToRAS", place, self.transform)
        tinyScene.putSweepUnder(self.nodes.browser, above)
        self.displace()
        self.ui.placeButton.click()
        np.testing.assert_array_equal(tinyScene.matrixOf(above), place)
        self.assertLess(self.error(place @ self.true), 1.0)

    # ---- undo

    def undo(self):
        """Press Undo, of the only move there is, and wait until it is done."""
        self.ui.undoPlaceButton.click()
        self.waitUntil(lambda: not self.ui.undoPlaceButton.enabled)

    # ---- refused

    def test_the_ct_of_another_patient_is_not_moved_and_can_be_taken_all_the_same(self):
        stranger = addPatient(seed=3, frames=9)
        self.parameters.ctVolume, self.parameters.bone = stranger.ct, stranger.segmentation
        self.parameters.sweep = self.nodes.browser
        tinyScene.setMatrix(stranger.ctToReference, self.true)
        self.ui.placeButton.click()
        np.testing.assert_array_equal(tinyScene.matrixOf(stranger.ctToReference), self.true)
        self.assertIn("The CT was not moved.", self.ui.registrationLabel.text)
        self.assertNotIn("--", self.ui.registrationLabel.text)
        self.assertGreaterEqual(self.ui.alternativesComboBox.count, 1)
        self.ui.takePlaceButton.click()
        self.assertFalse((tinyScene.matrixOf(stranger.ctToReference) == self.true).all())
        self.undo()
        np.testing.assert_array_equal(tinyScene.matrixOf(stranger.ctToReference), self.true)

    def test_different_transforms_above_ct_and_bone_are_refused_in_a_sentence(self):
        before = self.displace()
        self.nodes.ct.SetAndObserveTransformNodeID(None)
        said = self.messageOf(self.ui.placeButton.click)
        self.assertIn("lie under different transforms", said)
        np.testing.assert_array_equal(tinyScene.matrixOf(self.transform), before)

    def test_a_warping_transform_is_refused_in_a_sentence(self):
        tinyScene.addWarping(self.nodes.ct, self.nodes.segmentation)
        self.assertIn("must be linear", self.messageOf(self.ui.placeButton.click))

    # ---- checking

    def test_a_check_moves_nothing_and_the_gauge_follows_a_ct_that_is_moved_by_hand_and_back_to_where_it_rested_before_the_last_check(self):
        self.ui.checkButton.click()
        high = self.ui.agreementProgressBar.value
        np.testing.assert_array_equal(tinyScene.matrixOf(self.transform), self.true)
        self.assertIn("CT and sweep agree", self.ui.registrationLabel.text)
        self.assertGreater(high, 80)
        self.assertIn("%", self.ui.agreementProgressBar.format)
        self.assertIn("Label 2 L3: ", self.ui.agreementProgressBar.toolTip)
        self.assertFalse(self.ui.undoPlaceButton.enabled)
        away = tinyScene.moved(0.0, 0.0, 12.0)
        self.displace(away)
        self.waitUntil(lambda: self.ui.agreementProgressBar.value < high - 20)
        self.assertIn("do not agree", self.ui.registrationLabel.text)
        self.assertEqual(len(self.echoModels()), 1)
        tinyScene.setMatrix(self.transform, self.true)
        self.waitUntil(lambda: self.ui.agreementProgressBar.value == high)
        self.displace(away)
        self.waitUntil(lambda: self.ui.agreementProgressBar.value < high - 20)
        tinyScene.setMatrix(self.transform, self.true)
        self.ui.checkButton.click()
        self.assertEqual(self.ui.agreementProgressBar.value, high)
        self.displace(away)
        self.waitUntil(lambda: self.ui.agreementProgressBar.value < high - 20)

    # ---- echoes

    def test_echoes_lie_on_the_true_surface_whatever_the_place_of_the_ct(self):
        self.displace(tinyScene.moved(0.0, 0.0, 12.0))
        self.ui.checkButton.click()
        (model,) = self.echoModels()
        points = slicer.util.arrayFromModelPoints(model).copy()
        tinyScene.setMatrix(self.transform, self.true)
        self.ui.checkButton.click()
        np.testing.assert_array_equal(slicer.util.arrayFromModelPoints(model), points)

    # ---- meanwhile

    def placeAnd(self, act):
        """Press Place, and do something else at one of its reports."""
        self.pressAnd(self.ui.placeButton, self.widget._registration._registration, "register", 0.3, act)

    def test_a_cancel_leaves_the_ct_where_it_was(self):
        before = self.displace()
        self.placeAnd(lambda: self.widget._work.cancel())
        np.testing.assert_array_equal(tinyScene.matrixOf(self.transform), before)
        self.assertIn("Canceled.", self.ui.registrationLabel.text)
        self.assertTrue(self.ui.placeButton.enabled)

    def test_a_node_that_is_deleted_meanwhile_ends_it_with_a_sentence(self):
        before = self.displace()
        for name in ("ct", "browser"):
            with self.subTest(name=name):
                node = getattr(self.nodes, name)
                called = node.GetName()
                self.placeAnd(lambda node=node: slicer.mrmlScene.RemoveNode(node))
                np.testing.assert_array_equal(tinyScene.matrixOf(self.transform), before)
                self.assertEqual(self.ui.registrationLabel.text, f"{called} was deleted meanwhile. Nothing was changed.")
        self.assertFalse(self.ui.placeButton.enabled)

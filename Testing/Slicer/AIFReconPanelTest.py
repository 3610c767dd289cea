"""Self tests of the panel: nodes to widgets and back, what can be pressed and why not, cancel, a scene that is closed or saved, reload."""

import importlib
from unittest import mock

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel


class AIFReconPanelTest(OpenPanel):
    """The panel, as a user works with it."""

    def test_a_method_that_was_registered_meanwhile_is_in_the_list_and_makes_the_volume(self):
        own = importlib.import_module("ownMethod").flat
        self.addInputs()
        self.widget.enter()
        self.choose(self.ui.methodComboBox, own.name)
        self.assertEqual(self.parameters.ownMethod, own.name)
        self.ui.applyButton.click()
        self.assertEqual(self.parameters.output.GetAttribute("AIFRecon.Method"), own.name)
        self.assertEqual(set(np.unique(slicer.util.arrayFromVolume(self.parameters.output))), {0, 77})
        self.parameters.bone = None
        self.assertIn(f"{own.name} needs bone", self.ui.statusLabel.text)
        self.choose(self.ui.methodComboBox, "average")
        self.assertEqual(self.parameters.ownMethod, "")
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)

    def test_a_method_of_a_saved_scene_that_nobody_registered_is_named_with_what_to_do(self):
        self.addInputs()
        self.parameters.ownMethod = "my_methods:mine"
        self.assertEqual(self.ui.methodComboBox.currentText, "my_methods:mine")
        self.assertFalse(self.ui.applyButton.enabled)
        self.assertIn("import my_methods in the Python console", self.ui.statusLabel.text)

    # ---- bone of a CT that nobody has segmented

    def addBareCT(self, hounsfield=True):
        """A ball of bone in a body in air, moved by a transform."""
        k, j, i = np.ogrid[:40, :50, :60]
        ball, body = np.sqrt((k - 20.0) ** 2 + (j - 28) ** 2 + (i - 30) ** 2), np.hypot(j - 26, i - 30.0) + 0 * k
        values = np.where(ball < 9, np.where(ball < 7, 220, 900), np.where(body < 22, 45, -1000)).astype(np.int16)
        ct = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "Bare CT")
        slicer.util.updateVolumeFromArray(ct, values if hounsfield else values + 1024)
        ct.SetSpacing(1.0, 1.2, 1.5)
        tinyScene.addTransform("Place", tinyScene.moved(5.0, -7.0, 11.0), ct)
        self.parameters.ctVolume = ct
        return ct

    def test_the_bone_of_a_ct_becomes_a_segmentation_that_is_chosen_and_lies_on_it(self):
        from AIFReconScene.inputs.boneNodes import labelsFromNode

        self.assertTrue(self.ui.boneFromCTButton.isHidden())
        ct = self.addBareCT()
        self.assertFalse(self.ui.boneFromCTButton.isHidden())
        self.assertIn("“Bone from CT” finds that of the CT", self.ui.boneStatusLabel.text)
        self.ui.boneFromCTButton.click()
        bone = self.parameters.bone
        self.assertEqual(bone.GetTransformNodeID(), ct.GetTransformNodeID())
        self.assertIn("HU, found in the CT", self.ui.statusLabel.text)
        self.assertTrue(self.ui.boneFromCTButton.isHidden())
        labels = labelsFromNode(bone)
        places = np.argwhere(labels.array > 0)[:, ::-1] @ labels.affine[:3, :3].T + labels.affine[:3, 3]
        # The middle of the ball, voxel (30, 28, 20) of 1 x 1.2 x 1.5 mm, in the world
        np.testing.assert_allclose(places.mean(axis=0), (35.0, 26.6, 41.0), atol=0.3)

    def test_a_ct_without_hounsfield_units_is_refused_in_a_sentence_and_the_scene_stays(self):
        self.addBareCT(hounsfield=False)
        from AIFReconScene.volumes.segments import boneFromCT

        from AIFReconLib.errors import GeometryError

        before = slicer.mrmlScene.GetNumberOfNodes()
        with self.assertRaisesRegex(GeometryError, "not in Hounsfield units"):
            boneFromCT(self.parameters)
        self.assertEqual(slicer.mrmlScene.GetNumberOfNodes(), before)
        self.assertIsNone(self.parameters.bone)

    # ---- work

    def test_the_methods_are_compared_in_a_table(self):
        from AIFReconLib.evaluation.quantities import HEADINGS

        self.addInputs()
        self.ui.compareButton.click()
        table = slicer.util.getNodesByClass("vtkMRMLTableNode")[-1]
        self.assertEqual(table.GetNumberOfRows(), 4)
        columns = [table.GetTable().GetColumn(number) for number in range(table.GetNumberOfColumns())]
        self.assertEqual([each.GetName().rstrip(" \u2191\u2193") for each in columns], ["volume", *HEADINGS.values()])
        # Rounded, as numbers, by which a table can be sorted
        found = [columns[1 + list(HEADINGS).index("bone_cnr")].GetValue(row) for row in range(4)]
        self.assertEqual(found, [round(each, 2) for each in found])
        made = {node.GetAttribute("AIFRecon.Method") for node in slicer.util.getNodesByClass("vtkMRMLScalarVolumeNode")}
        self.assertEqual(made - {None}, {"average", "aif", "aif-compensated", "weighted"})

    # ---- scenes and reload

    def test_a_saved_scene_brings_everything_back(self):
        self.addInputs()
        self.parameters.alpha = 0.4
        self.ui.applyButton.click()
        voxels = slicer.util.arrayFromVolume(self.parameters.output).copy()
        name = self.parameters.output.GetName()
        tinyScene.saveAndOpenAgain(self)
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)
        self.assertEqual(self.ui.sweepSelector.currentNode().GetName(), "Sweep")
        self.assertIn("11 of 12", self.ui.sweepStatusLabel.text)
        parameters = self.widget.logic.getParameterNode()
        self.assertEqual(parameters.output.GetName(), name)
        self.assertAlmostEqual(parameters.alpha, 0.4)
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(parameters.output), voxels)
        again = self.widget.logic.reconstruct(parameters.sweep, parameters.bone, spacing=1.0, alpha=0.4)
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(again), voxels)

    def test_of_a_scene_that_is_loaded_beside_itself_the_later_one_is_shown_whole(self):
        self.addInputs()
        self.ui.applyButton.click()
        first = self.parameters.output
        told = self.ui.trackingVerdictLabel.text, self.ui.registrationVerdictLabel.text
        # Slicer's views show no reconstruction after that; the stand-in's show the later one
        with mock.patch("AIFReconScene.display.sliceDisplay.isShown", return_value=False):
            tinyScene.saveAndOpenAgain(self, beside=True)
        later = self.widget._parameterNode.output
        self.assertEqual((later is first, later.GetName()), (False, first.GetName()))
        shown = {each.GetForegroundVolumeID() for each in slicer.util.getNodesByClass("vtkMRMLSliceCompositeNode")}
        self.assertEqual(shown - {None}, {later.GetID()})
        bones = slicer.util.getNodesByClass("vtkMRMLSegmentationNode")
        self.assertEqual([each.GetName() for each in bones if each.GetDisplayVisibility()], [self.widget._parameterNode.bone.GetName()])
        self.assertEqual((self.ui.trackingVerdictLabel.text, self.ui.registrationVerdictLabel.text), told)
        # Both sweeps can be used
        sweeps = slicer.util.getNodesByClass("vtkMRMLSequenceBrowserNode")
        np.testing.assert_array_equal(*(self.reconstructed(sweep) for sweep in sweeps))

    def reconstructed(self, sweep):
        """Voxels of another volume."""
        self.parameters.sweep, self.parameters.output = sweep, None
        return self.applied()

    def test_what_was_said_goes_with_what_it_was_said_about(self):
        from AIFReconGui import sampleData

        from AIFReconLib.errors import OutputError

        self.widget._recorded._report = "The scene was closed meanwhile."
        self.widget._recorded.update("")
        self.addInputs()
        self.assertNotIn("meanwhile", self.ui.statusLabel.text)
        slicer.mrmlScene.Clear()
        self.assertFalse(self.ui.applyButton.enabled)
        with mock.patch.object(sampleData, "addPhantom", side_effect=OutputError("No space.")):
            said = self.messageOf(self.ui.sampleButton.click)
        self.assertEqual(said, "The sample patient could not be made.\n\nNo space.")

    def test_the_module_can_be_reloaded(self):
        before = self.widget
        before.onReload()
        self.assertIsNot(self.widget, before)
        self.assertFalse(self.ui.applyButton.enabled)

"""Self tests of what happens to the panel while it is open: nodes change or go, a scene is loaded, another module is entered."""

import pathlib
import sys
import tempfile
import unittest

import numpy as np
import slicer
import vtk

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import tinyScene


class AIFReconLifecycleTest(unittest.TestCase):
    """The panel beside a scene that changes."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        slicer.util.selectModule("AIFRecon")
        self.widget = slicer.modules.AIFReconWidget
        self.ui, self.parameters = self.widget.ui, self.widget._parameterNode

    def tearDown(self):
        slicer.mrmlScene.Clear()

    def addInputs(self):
        """Sweep, CT and bone, chosen."""
        self.parameters.sweep = tinyScene.addSweep()
        self.parameters.ctVolume, self.parameters.bone, self.registration = tinyScene.addCT()
        self.parameters.spacing = 1.0

    def reenter(self):
        """Another module and back."""
        self.widget.exit()
        self.widget.enter()
        self.parameters = self.widget._parameterNode

    # ---- scenes

    def test_a_scene_that_is_loaded_fills_the_panel(self):
        self.addInputs()
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "scene.mrb"
            self.assertTrue(slicer.mrmlScene.WriteToMRB(str(path)))
            slicer.mrmlScene.Clear()
            self.assertFalse(self.ui.applyButton.enabled)
            self.assertTrue(slicer.mrmlScene.ReadFromMRB(str(path), True))
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)
        self.assertEqual(self.ui.sweepSelector.currentNode().GetName(), "Sweep")
        self.assertIn("11 of 12", self.ui.sweepStatusLabel.text)

    def test_the_layouts_of_a_comparison_are_known_from_the_start(self):
        layout = slicer.mrmlScene.GetFirstNodeByClass("vtkMRMLLayoutNode")
        self.assertTrue(layout.IsLayoutDescription(4204) and layout.IsLayoutDescription(4214))

    # ---- nodes that go

    def test_a_deleted_sweep_is_no_longer_chosen(self):
        self.addInputs()
        self.parameters.showProbe = self.parameters.showOutlines = True
        slicer.mrmlScene.RemoveNode(self.parameters.sweep)
        self.assertFalse(self.ui.applyButton.enabled)
        self.assertEqual([node for node in slicer.util.getNodesByClass("vtkMRMLModelNode") if "Sweep" in node.GetName()], [])

    def test_every_chosen_node_can_be_deleted(self):
        self.addInputs()
        self.ui.applyButton.click()
        for name in ("output", "bone", "ctVolume", "sweep"):
            with self.subTest(name=name):
                slicer.mrmlScene.RemoveNode(getattr(self.parameters, name))
                self.assertIsNone(getattr(self.parameters, name))
        self.assertFalse(self.ui.applyButton.enabled)

    def test_nothing_of_the_scene_is_observed_after_another_module_is_entered(self):
        self.addInputs()
        sweep, bone = self.parameters.sweep, self.parameters.bone
        self.widget.exit()
        self.assertEqual(self.widget._watch._observations, [])
        sweep.Modified()
        bone.GetSegmentation().AddEmptySegment("new")
        self.widget.enter()

    # ---- nodes that change

    def test_a_sweep_that_is_placed_later_can_be_reconstructed(self):
        self.addInputs()
        image = self.parameters.sweep.GetProxyNode(self.parameters.sweep.GetMasterSequenceNode())
        warp = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLTransformNode", "Warp")
        warp.SetAndObserveTransformToParent(vtk.vtkThinPlateSplineTransform())
        pose = image.GetParentTransformNode()
        pose.SetAndObserveTransformNodeID(warp.GetID())
        self.assertFalse(self.ui.applyButton.enabled)
        self.assertIn("Warp", self.ui.applyButton.toolTip)
        pose.SetAndObserveTransformNodeID(None)
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)

    def test_what_was_changed_in_another_module_is_seen(self):
        self.addInputs()
        image = self.parameters.sweep.GetProxyNode(self.parameters.sweep.GetMasterSequenceNode())
        self.widget.exit()
        warp = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLTransformNode", "Warp")
        warp.SetAndObserveTransformToParent(vtk.vtkThinPlateSplineTransform())
        image.GetParentTransformNode().SetAndObserveTransformNodeID(warp.GetID())
        self.widget.enter()
        self.assertFalse(self.ui.applyButton.enabled)

    def test_a_sweep_is_not_read_again_while_it_is_replayed(self):
        from AIFReconScene.sweep.sweepStatus import sweepKey

        sweep = tinyScene.addSweep()
        before = sweepKey(sweep)
        sweep.SetSelectedItemNumber(7)
        slicer.modules.sequences.logic().UpdateProxyNodesFromSequences(sweep)
        self.assertEqual(sweepKey(sweep), before)

    def test_a_sweep_is_described_once_its_recording_has_ended(self):
        from AIFReconScene.sweep import sequenceReader

        self.addInputs()
        sweep = self.parameters.sweep
        images = sweep.GetMasterSequenceNode()
        frames = images.GetNumberOfDataNodes()
        looked = []
        summary = sequenceReader.sweepSummary
        sequenceReader.sweepSummary = lambda *sweepAndImages: looked.append(1) or summary(*sweepAndImages)
        try:
            sweep.SetRecordingActive(True)
            self.assertFalse(self.ui.applyButton.enabled)
            self.assertIn("Stop the recording", self.ui.applyButton.toolTip)
            for number in range(3):
                images.SetDataNodeAtValue(images.GetNthDataNode(0), str(100.0 + number))
                sweep.Modified()
            self.assertEqual(len(looked), 1)
            sweep.SetRecordingActive(False)
        finally:
            sequenceReader.sweepSummary = summary
        self.assertIn(f"of {frames + 3} frames", self.ui.sweepStatusLabel.text)
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)

    def test_the_report_waits_for_the_end_of_the_recording(self):
        self.addInputs()
        self.parameters.sweep.SetRecordingActive(True)
        self.ui.trackingMoreButton.checked = True
        self.assertIn("Stop the recording", self.ui.reportLabel.text)
        self.assertFalse(self.ui.copyReportButton.enabled)
        self.parameters.sweep.SetRecordingActive(False)
        self.assertNotIn("Stop the recording", self.ui.reportLabel.text)
        self.assertTrue(self.ui.copyReportButton.enabled)

    def test_the_probe_is_drawn_on_the_frame_that_is_shown(self):
        from AIFReconScene.inputs.parameters import ProbeShape

        sweep = self.addEmbeddedSweep()
        self.parameters.sweep, self.parameters.probe, self.parameters.showProbe = sweep, ProbeShape.LINEAR, True
        for number in (0, 4):
            sweep.SetSelectedItemNumber(number)
            slicer.modules.sequences.logic().UpdateProxyNodesFromSequences(sweep)
            bounds = [0.0] * 6
            slicer.util.getNode("Embedded beams").GetRASBounds(bounds)
            self.assertAlmostEqual((bounds[4] + bounds[5]) / 2, 10.0 * number, delta=0.2)

    def addEmbeddedSweep(self):
        """Images that carry their pose in their own matrix, 10 mm apart, without any transform."""
        images = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLSequenceNode", "Embedded images")
        for number in range(5):
            node = slicer.vtkMRMLScalarVolumeNode()
            slicer.util.updateVolumeFromArray(node, np.full((1, 40, 50), 99, np.uint8))
            node.SetIJKToRASMatrix(slicer.util.vtkMatrixFromArray(tinyScene.moved(0.0, 0.0, 10.0 * number)))
            images.SetDataNodeAtValue(node, str(number))
        browser = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLSequenceBrowserNode", "Embedded")
        browser.SetAndObserveMasterSequenceNodeID(images.GetID())
        slicer.modules.sequences.logic().UpdateProxyNodesFromSequences(browser)
        return browser

    # ---- segments

    def test_a_removed_segment_is_chosen_no_more(self):
        self.addInputs()
        segmentation = self.parameters.bone.GetSegmentation()
        segmentation.AddEmptySegment("extra", "Extra")
        self.parameters.boneSegments = ["extra"]
        segmentation.RemoveSegment("extra")
        self.assertEqual(self.parameters.boneSegments, [])
        self.assertEqual(self.ui.segmentsComboBox.count, 1)

    def test_segments_of_another_segmentation_are_not_taken_for_those_chosen(self):
        self.addInputs()
        segmentIDs = list(self.parameters.bone.GetSegmentation().GetSegmentIDs())
        self.parameters.bone.GetSegmentation().AddEmptySegment("extra", "Extra")
        self.parameters.boneSegments = segmentIDs
        other = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLSegmentationNode", "Other")
        for segmentID in (*segmentIDs, "third"):
            other.GetSegmentation().AddEmptySegment(segmentID)
        self.parameters.bone = other
        self.assertEqual(self.parameters.boneSegments, [])

    def test_chosen_segments_stay_chosen_after_another_module(self):
        self.addInputs()
        self.parameters.bone.GetSegmentation().AddEmptySegment("extra", "Extra")
        self.parameters.boneSegments = ["extra"]
        self.reenter()
        self.assertEqual(self.parameters.boneSegments, ["extra"])

    # ---- output

    def test_the_output_s_name_tells_the_method_that_made_it(self):
        from AIFReconScene.inputs.parameters import Method

        self.addInputs()
        self.parameters.method = Method.AIF_COMPENSATED
        self.ui.applyButton.click()
        output = self.parameters.output
        self.parameters.method = Method.AIF
        self.ui.applyButton.click()
        self.assertIs(self.parameters.output, output)
        self.assertEqual(output.GetName(), "Sweep aif")

    def test_a_name_that_the_user_gave_stays(self):
        from AIFReconScene.inputs.parameters import Method

        self.addInputs()
        self.ui.applyButton.click()
        self.parameters.output.SetName("Mine")
        self.parameters.method = Method.AVERAGE
        self.ui.applyButton.click()
        self.assertEqual(self.parameters.output.GetName(), "Mine")

    def test_what_is_kept_beside_the_output_is_filled_again(self):
        self.addInputs()
        self.parameters.keepScore = self.parameters.keepMask = True
        self.ui.applyButton.click()
        count = len(slicer.util.getNodesByClass("vtkMRMLScalarVolumeNode"))
        self.ui.applyButton.click()
        self.assertEqual(len(slicer.util.getNodesByClass("vtkMRMLScalarVolumeNode")), count)

    def test_the_sweep_s_own_image_cannot_be_the_output(self):
        self.addInputs()
        self.parameters.output = self.parameters.sweep.GetProxyNode(self.parameters.sweep.GetMasterSequenceNode())
        self.assertFalse(self.ui.applyButton.enabled)
        self.assertIn("overwrite", self.ui.applyButton.toolTip)

    def test_a_view_that_was_moved_stays_when_the_same_place_is_reconstructed_again(self):
        self.addInputs()
        self.ui.applyButton.click()
        red = slicer.app.layoutManager().sliceWidget("Red").mrmlSliceNode()
        red.SetFieldOfView(12.0, 12.0, 1.0)
        red.SetSliceOffset(red.GetSliceOffset() + 3.0)
        scale, place = tinyScene.scaleOf(red), tinyScene.placeOf(red)
        self.parameters.alpha = 0.3
        self.ui.applyButton.click()
        self.assertAlmostEqual(tinyScene.scaleOf(red), scale)
        np.testing.assert_allclose(tinyScene.placeOf(red), place, atol=1e-6)

    def test_the_table_of_a_comparison_is_shown(self):
        self.addInputs()
        self.ui.compareButton.click()
        view = slicer.mrmlScene.GetSingletonNode("AIFReconTable", "vtkMRMLTableViewNode")
        table = slicer.util.getNodesByClass("vtkMRMLTableNode")[-1]
        self.assertEqual(view.GetTableNodeID(), table.GetID())
        hierarchy = slicer.mrmlScene.GetSubjectHierarchyNode()
        self.assertEqual(hierarchy.GetItemName(hierarchy.GetItemParent(hierarchy.GetItemByDataNode(table))), "AIFRecon Sweep comparison")

    def test_a_comparison_by_bone_probability_has_no_table_and_says_nothing_wrong(self):
        self.addInputs()
        size = slicer.util.arrayFromVolume(self.parameters.ctVolume).shape
        probability = tinyScene.addVolume(
            "vtkMRMLScalarVolumeNode", "Probability", np.full(size, 0.5, np.float32), tinyScene.ijkToRAS(self.parameters.ctVolume)
        )
        probability.SetAndObserveTransformNodeID(self.registration.GetID())
        self.parameters.bone = probability
        self.ui.compareButton.click()
        self.assertEqual(slicer.util.getNodesByClass("vtkMRMLTableNode"), [])
        self.assertIn("weighted", self.ui.statusLabel.text)

    def test_the_spacing_follows_the_configuration_of_a_recording(self):
        from AIFReconScene.inputs.parameters import takeConfigured
        from AIFReconScene.sweep.sweepRecord import writeRecord

        from AIFReconLib.sweep.configuration import PlusConfiguration

        sweep = tinyScene.addSweep()
        writeRecord(sweep, {"configuration": PlusConfiguration(path=pathlib.Path("Plus.xml"), spacing=(0.7, 0.7, 0.7))})
        takeConfigured(self.parameters, sweep)
        self.assertAlmostEqual(self.ui.spacingSpinBox.value, 0.7)

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

    # ---- nodes that go

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

    def test_a_sweep_is_not_read_again_while_it_is_replayed(self):
        from AIFReconScene.sweep.sweepStatus import sweepKey

        sweep = tinyScene.addSweep()
        before = sweepKey(sweep)
        sweep.SetSelectedItemNumber(7)
        slicer.modules.sequences.logic().UpdateProxyNodesFromSequences(sweep)
        self.assertEqual(sweepKey(sweep), before)

    def test_a_sweep_is_described_once_its_recording_has_ended(self):
        from AIFReconScene.sweep import sweepStatus

        self.addInputs()
        sweep = self.parameters.sweep
        images = sweep.GetMasterSequenceNode()
        frames = images.GetNumberOfDataNodes()
        looked = []
        summary = sweepStatus.sweepSummary
        sweepStatus.sweepSummary = lambda *sweepAndImages: looked.append(1) or summary(*sweepAndImages)
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
            sweepStatus.sweepSummary = summary
        self.assertIn(f"of {frames + 3} frames", self.ui.sweepStatusLabel.text)
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)

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

    # ---- output

    def test_what_is_kept_beside_the_output_is_filled_again(self):
        self.addInputs()
        self.parameters.keepScore = self.parameters.keepMask = True
        self.ui.applyButton.click()
        count = len(slicer.util.getNodesByClass("vtkMRMLScalarVolumeNode"))
        self.ui.applyButton.click()
        self.assertEqual(len(slicer.util.getNodesByClass("vtkMRMLScalarVolumeNode")), count)

    def test_the_spacing_follows_the_configuration_of_a_recording(self):
        from AIFReconScene.inputs.parameters import takeConfigured
        from AIFReconScene.sweep.sequenceNodes import RECORD_ATTRIBUTE

        from AIFReconLib.sweep.configuration import PlusConfiguration
        from AIFReconLib.sweep.record_text import record_text

        sweep = tinyScene.addSweep()
        record = {"configuration": PlusConfiguration(path=pathlib.Path("Plus.xml"), spacing=(0.7, 0.7, 0.7))}
        sweep.SetAttribute(RECORD_ATTRIBUTE, record_text(record))
        takeConfigured(self.parameters, sweep)
        self.assertAlmostEqual(self.ui.spacingSpinBox.value, 0.7)

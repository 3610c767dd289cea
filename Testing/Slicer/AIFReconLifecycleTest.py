"""Self tests of what happens to the panel while it is open: nodes change or go, a scene is loaded, another module is entered."""

from unittest import mock

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel


class AIFReconLifecycleTest(OpenPanel):
    """The panel beside a scene that changes."""

    # ---- nodes that go

    def test_every_chosen_node_can_be_deleted(self):
        self.addInputs()
        self.ui.applyButton.click()
        for name in ("output", "bone", "ctVolume", "sweep"):
            with self.subTest(name=name):
                slicer.mrmlScene.RemoveNode(getattr(self.parameters, name))
                self.assertIsNone(getattr(self.parameters, name))
        self.assertFalse(self.ui.applyButton.enabled)

    # ---- nodes that change

    def test_a_sweep_that_is_placed_later_can_be_reconstructed(self):
        self.addInputs()
        pose = tinyScene.warp(self.parameters.sweep)
        self.assertFalse(self.ui.applyButton.enabled)
        self.assertRegex(self.ui.applyButton.toolTip, "Warp.* must be linear.*Harden it")
        pose.SetAndObserveTransformNodeID(None)
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)

    def test_a_sweep_is_described_once_its_recording_has_ended(self):
        from AIFReconScene.sweep import sweepStatus

        self.addInputs()
        sweep = self.parameters.sweep
        images = sweep.GetMasterSequenceNode()
        frames = images.GetNumberOfDataNodes()
        with mock.patch.object(sweepStatus, "sweepSummary", wraps=sweepStatus.sweepSummary) as looked:
            sweep.SetRecordingActive(True)
            self.assertFalse(self.ui.applyButton.enabled)
            self.assertIn("Stop the recording", self.ui.applyButton.toolTip)
            for number in range(3):
                images.SetDataNodeAtValue(images.GetNthDataNode(0), str(100.0 + number))
                sweep.Modified()
            self.assertEqual(looked.call_count, 1)
            sweep.SetRecordingActive(False)
            seen = looked.call_count
            # Nor is it read again while it is replayed
            self.show(sweep, 7)
            self.assertEqual(looked.call_count, seen)
        self.assertIn(f"of {frames + 3} frames", self.ui.sweepStatusLabel.text)
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)

    def test_the_probe_is_drawn_on_the_frame_that_is_shown(self):
        from AIFReconScene.inputs.parameters import ProbeShape

        sweep = self.addEmbeddedSweep()
        self.parameters.sweep, self.parameters.probe, self.parameters.showProbe = sweep, ProbeShape.LINEAR, True
        for number in (0, 4):
            self.show(sweep, number)
            bounds = tinyScene.boundsOf(slicer.util.getNode("Embedded beams"))
            self.assertAlmostEqual(bounds[2].mean(), 10.0 * number, delta=0.2)

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
        combo = self.ui.segmentsComboBox
        checked = [combo.itemText(index.row()) for index in combo.checkedIndexes()]
        self.assertEqual((combo.count, checked), (2, [self.parameters.bone.GetSegmentation().GetNthSegment(0).GetName()]))
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

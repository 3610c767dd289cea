"""Self tests of what happens to the scene while work goes on: the views stay alive, so nodes are deleted, moved, and scenes closed."""

from functools import partial

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel


class AIFReconMeanwhileTest(OpenPanel):
    """Apply and Compare methods, with something else done at one of their reports."""

    def addInputs(self):
        """And an output that holds something, in a new scene."""
        slicer.mrmlScene.Clear()
        super().addInputs(spacing=2.0)
        self.parameters.output = tinyScene.addVolume("vtkMRMLScalarVolumeNode", "Earlier", np.full((3, 3, 3), 77, np.uint8), np.eye(4))

    def names(self) -> list:
        """Names of the nodes that are made here."""
        kinds = ("vtkMRMLScalarVolumeNode", "vtkMRMLSegmentationNode", "vtkMRMLSequenceBrowserNode", "vtkMRMLTableNode")
        return sorted(node.GetName() for kind in kinds for node in slicer.util.getNodesByClass(kind))

    def needed(self) -> dict:
        """A node of each kind that work needs."""
        sweep = self.parameters.sweep
        return {
            "sweep": sweep,
            "images": sweep.GetMasterSequenceNode(),
            "replayed image": sweep.GetProxyNode(sweep.GetMasterSequenceNode()),
            "CT": self.parameters.ctVolume,
            "bone": self.parameters.bone,
            "registration": self.registration,
            "output": self.parameters.output,
        }

    # ---- nodes that go

    def test_a_node_that_is_deleted_during_a_reconstruction_or_a_comparison_ends_it_with_one_sentence(self):
        self.addInputs()
        apply, compare = (self.ui.applyButton, "apply"), (self.ui.compareButton, "compare")
        during = [(compare, 0.0, "sweep"), (compare, 0.75, "bone"), (compare, 0.4, "CT"), *((apply, 0.5, name) for name in self.needed())]
        for (button, work), fraction, name in during:
            with self.subTest(work=work, name=name):
                self.addInputs()
                node = self.needed()[name]
                called = node.GetName()
                slicer.mrmlScene.RemoveNode(node)
                expected = self.names()
                self.addInputs()
                node, output = self.needed()[name], self.parameters.output
                self.pressAnd(button, self.widget.logic, work, fraction, partial(slicer.mrmlScene.RemoveNode, node))
                self.assertEqual(self.widget._recorded._report, f"{called} was deleted meanwhile. Nothing was changed.")
                self.assertEqual(self.names(), expected)
                np.testing.assert_array_equal(slicer.util.arrayFromVolume(output), 77)
                self.assertTrue(self.ui.sweepSelector.enabled)

    def test_a_node_that_is_deleted_while_bone_is_drawn_leaves_the_reconstruction(self):
        self.addInputs()
        ct = self.parameters.ctVolume
        self.pressAnd(self.ui.applyButton, self.widget.logic, "apply", 0.8, lambda: slicer.mrmlScene.RemoveNode(ct), "surface of bone")
        self.assertIn("frames", self.ui.summaryLabel.text)
        self.assertGreater(slicer.util.arrayFromVolume(self.parameters.output).shape[0], 3)

    def test_a_scene_that_is_closed_ends_the_work_with_one_sentence(self):
        for button, work in ((self.ui.applyButton, "apply"), (self.ui.compareButton, "compare")):
            with self.subTest(work=work):
                self.addInputs()
                self.pressAnd(button, self.widget.logic, work, 0.5, lambda: slicer.mrmlScene.Clear())
                self.assertEqual(self.widget._recorded._report, "The scene was closed meanwhile.")
                self.assertEqual(self.names(), [])
                self.assertTrue(self.ui.sweepSelector.enabled)

    # ---- nodes that change

    def test_a_box_that_is_moved_during_a_comparison_changes_nothing_of_it(self):
        self.addInputs()
        box = self.chooseBox(size=(20.0, 20.0, 10.0))
        self.pressAnd(self.ui.compareButton, self.widget.logic, "compare", 0.3, lambda: box.SetSize(30.0, 20.0, 10.0))
        made = [slicer.util.getNode(name) for name in self.names() if "comparison" in name]
        self.assertEqual({node.GetImageData().GetDimensions() for node in made}, {(10, 10, 5)})

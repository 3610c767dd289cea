"""Self tests of what happens to the scene while work goes on: the views stay alive, so nodes are deleted, moved, and scenes closed."""

import pathlib
import sys
import unittest

import numpy as np
import slicer

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import tinyScene


class AIFReconMeanwhileTest(unittest.TestCase):
    """Apply and Compare methods, with something else done at one of their reports."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        slicer.util.selectModule("AIFRecon")
        self.widget = slicer.modules.AIFReconWidget
        self.ui, self.parameters = self.widget.ui, self.widget._parameterNode

    def tearDown(self):
        slicer.mrmlScene.Clear()

    def addInputs(self):
        """Sweep, CT, bone and an output that holds something, chosen."""
        slicer.mrmlScene.Clear()
        self.parameters = self.widget._parameterNode
        self.parameters.sweep = tinyScene.addSweep()
        self.parameters.ctVolume, self.parameters.bone, self.registration = tinyScene.addCT()
        self.parameters.spacing = 2.0
        self.parameters.output = tinyScene.addVolume("vtkMRMLScalarVolumeNode", "Earlier", np.full((3, 3, 3), 77, np.uint8), np.eye(4))

    def pressAnd(self, button, work: str, fraction: float, act, step=""):
        """Press a button, and do something else as soon as `work` of the logic has come so far, in a step of that name."""
        do = getattr(self.widget.logic, work)
        done: list[str] = []

        def disturbed(parameters, progress):
            def report(share, message):
                if share >= fraction and step in str(message) and not done:
                    done.append(act())
                return progress(share, message)

            return do(parameters, report)

        setattr(self.widget.logic, work, disturbed)
        try:
            button.click()
        finally:
            delattr(self.widget.logic, work)
        self.assertEqual(len(done), 1)

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

    def test_a_node_that_is_deleted_during_a_reconstruction_ends_it_with_one_sentence(self):
        self.addInputs()
        for name in self.needed():
            with self.subTest(name=name):
                self.addInputs()
                node = self.needed()[name]
                called, output = node.GetName(), self.parameters.output
                slicer.mrmlScene.RemoveNode(node)
                expected = self.names()
                self.addInputs()
                node = self.needed()[name]
                self.pressAnd(self.ui.applyButton, "apply", 0.5, lambda node=node: slicer.mrmlScene.RemoveNode(node))
                self.assertEqual(self.widget._recorded._report, f"{called} was deleted meanwhile. Nothing was changed.")
                self.assertEqual(self.names(), expected)
                np.testing.assert_array_equal(slicer.util.arrayFromVolume(output), 77)
                self.assertTrue(self.ui.sweepSelector.enabled)

    def test_a_node_that_is_deleted_during_a_comparison_ends_it_with_one_sentence(self):
        for name, fraction in (("sweep", 0.0), ("bone", 0.75), ("CT", 0.4)):
            with self.subTest(name=name):
                self.addInputs()
                node = self.needed()[name]
                called = node.GetName()
                self.pressAnd(self.ui.compareButton, "compare", fraction, lambda node=node: slicer.mrmlScene.RemoveNode(node))
                self.assertEqual(self.widget._recorded._report, f"{called} was deleted meanwhile. Nothing was changed.")
                self.assertEqual([name for name in self.names() if "comparison" in name or "metrics" in name], [])

    def test_a_node_that_is_deleted_while_bone_is_drawn_leaves_the_reconstruction(self):
        self.addInputs()
        ct = self.parameters.ctVolume
        self.pressAnd(self.ui.applyButton, "apply", 0.8, lambda: slicer.mrmlScene.RemoveNode(ct), "surface of bone")
        self.assertIn("frames", self.ui.summaryLabel.text)
        self.assertGreater(slicer.util.arrayFromVolume(self.parameters.output).shape[0], 3)

    def test_a_scene_that_is_closed_ends_the_work_with_one_sentence(self):
        for button, work in ((self.ui.applyButton, "apply"), (self.ui.compareButton, "compare")):
            with self.subTest(work=work):
                self.addInputs()
                self.pressAnd(button, work, 0.5, lambda: slicer.mrmlScene.Clear())
                self.assertEqual(self.widget._recorded._report, "The scene was closed meanwhile.")
                self.assertEqual(self.names(), [])
                self.assertTrue(self.ui.sweepSelector.enabled)

    def cells(self) -> list:
        """What the table of the comparison says."""
        (table,) = slicer.util.getNodesByClass("vtkMRMLTableNode")
        rows, columns = table.GetNumberOfRows(), table.GetNumberOfColumns()
        return [table.GetCellText(row, column) for row in range(rows) for column in range(columns)]

    # ---- nodes that change

    def test_a_box_that_is_moved_during_a_comparison_changes_nothing_of_it(self):
        from AIFReconScene.inputs.parameters import Region

        self.addInputs()
        box = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLMarkupsROINode", "Box")
        box.SetCenterWorld(0.0, 16.0, 0.0)
        box.SetSize(20.0, 20.0, 10.0)
        self.parameters.roi, self.parameters.region = box, Region.BOX
        self.pressAnd(self.ui.compareButton, "compare", 0.3, lambda: box.SetSize(30.0, 20.0, 10.0))
        made = [slicer.util.getNode(name) for name in self.names() if "comparison" in name]
        self.assertEqual({node.GetImageData().GetDimensions() for node in made}, {(10, 10, 5)})

"""Self tests of long work: canceled at any point it leaves the scene as it was, and what is done again replaces what was done before."""

from unittest import mock

import numpy as np
import slicer
import tinyScene
import workerStates
from openPanel import OpenPanel


class AIFReconWorkTest(OpenPanel):
    """Load, Apply and Compare methods: canceled, repeated, undone."""

    def tearDown(self):
        slicer.mrmlScene.SetUndoOff()
        slicer.mrmlScene.ClearUndoStack()
        super().tearDown()

    def pressAndCancel(self, button, work: str, fraction: float):
        """Press a button and cancel as soon as `work` of the logic has come so far."""
        self.pressAnd(button, self.widget.logic, work, fraction, lambda: self.widget._work.cancel())

    def scene(self) -> dict:
        """Every node by its ID with its name, and what the views show."""
        found: dict = {"names": {each: slicer.mrmlScene.GetNodeByID(each).GetName() for each in tinyScene.nodeIDs()}}
        for node in slicer.util.getNodesByClass("vtkMRMLSliceCompositeNode"):
            found[node.GetID()] = node.GetBackgroundVolumeID(), node.GetForegroundVolumeID(), node.GetForegroundOpacity()
        for node in slicer.util.getNodesByClass("vtkMRMLSliceNode"):
            found[node.GetID()] = round(tinyScene.scaleOf(node), 6), tinyScene.placeOf(node).round(6).tolist()
        return {**found, "layout": slicer.app.layoutManager().layout}

    def made(self, className="vtkMRMLScalarVolumeNode") -> list:
        """Names of the volumes or tables that were made of a sweep."""
        return sorted(node.GetName() for node in slicer.util.getNodesByClass(className) if node.GetAttribute("AIFRecon.Name"))

    # ---- the worker

    def test_a_worker_that_dies_in_a_reconstruction_is_told_in_a_sentence_and_the_next_press_works(self):
        self.addInputs(spacing=2.0)
        before = self.scene()
        told = self.messageOf(lambda: self.pressAnd(self.ui.applyButton, self.widget.logic, "apply", 0.1, workerStates.killWorker))
        self.assertIn("The process that computes ended with code 9. Nothing was changed; try again.", told)
        self.assertEqual(self.scene(), before)
        self.ui.applyButton.click()
        self.assertIsNotNone(self.parameters.output)

    # ---- cancel

    def test_a_canceled_load_leaves_the_scene_as_it_was(self):
        self.chooseRecording()
        # The tool bar that replays a sweep stays once it was shown, and makes the views smaller
        self.ui.loadButton.click()
        slicer.mrmlScene.Clear()
        slicer.app.processEvents()
        self.chooseRecording()
        before = self.scene()
        for fraction in (0.0, 0.3, 0.9, 0.94):
            with self.subTest(fraction=fraction):
                self.pressAndCancel(self.ui.loadButton, "loadRecording", fraction)
                self.assertEqual(self.scene(), before)
                self.assertIsNone(self.parameters.sweep)
                self.assertIn("Canceled", self.widget._recorded._report)

    def fileSome(self) -> list:
        """CT, labels, a place and two recordings as files, to be opened by the button; something else is chosen."""
        from AIFReconLib import write_sequence
        from AIFReconLib.geometry.volume import Volume

        paths = [self.folder / name for name in ("first.igs.mha", "second.igs.mha", "ct.nrrd", "labels.nrrd", "place.tfm")]
        for path in paths[:2]:
            write_sequence(tinyScene.makeSequence(), path)
        array = np.zeros((6, 6, 6), np.int16)
        array[2:4, 2:4, 1:3], array[2:4, 2:4, 4:5] = 1, 2
        Volume(array * 700 - 500, np.eye(4)).write(paths[2])
        Volume(array.astype(np.uint8), np.eye(4)).write(paths[3])
        tinyScene.write(slicer.vtkMRMLLinearTransformNode(), paths[4])
        self.addInputs(spacing=2.0)
        return paths

    def chosen(self) -> dict:
        """What follows the files that are opened, and what CT and bone lie under."""
        from AIFReconScene.volumes.opening import CHOSEN

        parameters = self.parameters
        above = [node.GetTransformNodeID() for node in (parameters.ctVolume, parameters.bone)]
        return {"above": above, **{name: getattr(parameters, name) for name in CHOSEN}, "otherSweeps": list(parameters.otherSweeps)}

    def test_files_that_are_canceled_or_of_which_one_cannot_be_read_leave_scene_and_choices_as_they_were(self):
        paths = self.fileSome()
        nodes, chosen = self.scene()["names"], self.chosen()
        with mock.patch.object(self.widget._recorded, "_ask", return_value=paths):
            for fraction in (0.0, 0.2, 0.5, 0.65, 0.95):
                self.pressAndCancel(self.ui.openButton, "openFiles", fraction)
                self.assertIn("Canceled", self.ui.statusLabel.text)
                self.assertEqual((self.scene()["names"], self.chosen()), (nodes, chosen), fraction)
        paths[1].write_bytes(paths[1].read_bytes()[:-100])
        self.open(*paths)
        self.assertEqual((self.scene()["names"], self.chosen()), (nodes, chosen))

    def test_files_are_chosen_in_the_order_in_which_they_need_each_other(self):
        paths = self.fileSome()
        before = self.chosen()["above"]
        self.open(*paths)
        self.assertEqual(self.parameters.sweep.GetName(), "first")
        self.assertEqual([sweep.GetName() for sweep in self.parameters.otherSweeps], ["second"])
        self.assertEqual((self.parameters.ctVolume.GetName(), self.parameters.bone.GetName()), ("ct", "labels"))
        above = self.chosen()["above"]
        self.assertEqual(above[0], above[1])
        self.assertNotIn(above[0], before)

    def test_a_canceled_comparison_or_reconstruction_leaves_the_scene_as_it_was(self):
        self.reconstruct()
        before, output = self.scene(), self.parameters.output
        compare, apply = (self.ui.compareButton, "compare"), (self.ui.applyButton, "apply")
        for (button, work), fraction in ((compare, 0.0), (compare, 0.3), (compare, 0.6), (compare, 0.8), (compare, 0.98), (apply, 0.5)):
            with self.subTest(work=work, fraction=fraction):
                self.pressAndCancel(button, work, fraction)
                self.assertEqual(self.scene(), before)
                self.assertIs(self.parameters.output, output)
                self.assertIn("Canceled", self.ui.statusLabel.text)

    # ---- what is seen of what was opened

    def test_a_recording_is_seen_at_once_in_the_plane_of_its_frame(self):
        red = slicer.app.applicationLogic().GetSliceLogicByLayoutName("Red")
        self.chooseRecording()
        self.ui.loadButton.click()
        image = self.parameters.sweep.GetProxyNode(self.parameters.sweep.GetMasterSequenceNode())
        self.assertEqual(red.GetSliceCompositeNode().GetBackgroundVolumeID(), image.GetID())
        normal = tinyScene.placeOf(red.GetSliceNode())[:3, 2]
        np.testing.assert_allclose(normal @ tinyScene.worldOf(image)[:3, :2], 0.0, atol=1e-6)
        self.parameters.spacing = 2.0
        self.ui.applyButton.click()
        self.assertEqual(red.GetSliceNode().GetOrientation(), "Axial")
        self.assertEqual(red.GetSliceCompositeNode().GetBackgroundVolumeID(), self.parameters.output.GetID())

    def test_a_ct_without_a_sweep_is_seen_at_once_with_its_bone(self):
        self.open(*self.fileSome()[2:])
        red = slicer.app.applicationLogic().GetSliceLogicByLayoutName("Red").GetSliceCompositeNode()
        self.assertEqual(red.GetBackgroundVolumeID(), self.parameters.ctVolume.GetID())
        surface = slicer.vtkSegmentationConverter.GetClosedSurfaceRepresentationName()
        self.assertTrue(self.parameters.bone.GetSegmentation().ContainsRepresentation(surface))

    def test_a_ct_without_bone_is_looked_at_from_outside_its_box(self):
        ct = self.fileSome()[2]
        slicer.mrmlScene.Clear()
        slicer.app.layoutManager().setLayout(slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView)
        self.open(ct)
        camera = self.threeDView().cameraNode()
        self.assertGreater(np.linalg.norm(np.subtract(camera.GetPosition(), camera.GetFocalPoint())), 10.0)

    def test_outlines_of_bone_are_off_by_one_press_and_stay_off(self):
        self.reconstruct()
        display = self.parameters.bone.GetDisplayNode()
        self.assertTrue(display.GetVisibility2D())
        self.parameters.showBoneOutlines = False
        self.assertFalse(display.GetVisibility2D())
        self.ui.applyButton.click()
        self.assertFalse(display.GetVisibility2D())
        self.parameters.showBoneOutlines = True
        self.assertTrue(display.GetVisibility2D())

    # ---- again

    def test_a_result_that_was_renamed_is_not_written_over(self):
        mine = self.reconstruct()
        mine.SetName("Mine")
        voxels = slicer.util.arrayFromVolume(mine).copy()
        self.parameters.spacing = 3.0
        self.ui.applyButton.click()
        self.assertIsNot(self.parameters.output, mine)
        self.assertTrue(np.array_equal(slicer.util.arrayFromVolume(mine), voxels))

    def test_what_was_kept_beside_a_result_goes_with_it(self):
        self.reconstruct()
        self.assertIn("Sweep measured", self.made())
        slicer.mrmlScene.RemoveNode(self.parameters.output)
        self.assertEqual((self.made(), self.made("vtkMRMLModelNode")), ([], []))

    def test_a_comparison_does_not_write_over_a_reconstruction(self):
        from AIFReconScene.inputs.parameters import Method

        self.addInputs(spacing=2.0)
        self.ui.compareButton.click()
        adopted = slicer.util.getNode("Sweep comparison average")
        self.parameters.output, self.parameters.method = adopted, Method.AVERAGE
        self.ui.applyButton.click()
        self.assertEqual(adopted.GetName(), "Sweep average")
        self.parameters.spacing = 3.0
        self.ui.compareButton.click()
        self.assertEqual(adopted.GetSpacing(), (2.0, 2.0, 2.0))

    # ---- undo, several scenes

    def test_a_reconstruction_can_be_undone_where_the_application_has_asked_for_it(self):
        usual = slicer.vtkMRMLScalarVolumeNode()
        usual.UndoEnabledOn()
        slicer.mrmlScene.AddDefaultNode(usual)
        self.addCleanup(usual.UndoEnabledOff)
        slicer.mrmlScene.SetUndoOn()
        self.reconstruct()
        self.parameters.output = None
        self.ui.applyButton.click()
        self.assertEqual(self.weighted(), ["Sweep weighted", "Sweep weighted_1"])
        slicer.mrmlScene.Undo()
        self.assertEqual(self.weighted(), ["Sweep weighted"])
        self.assertIsNone(self.parameters.output)
        self.ui.applyButton.click()
        self.assertEqual(self.weighted(), ["Sweep weighted", "Sweep weighted_1"])

    def weighted(self) -> list:
        """What was made, without the plain echo that is kept beside it."""
        return [name for name in self.made() if "measured" not in name]

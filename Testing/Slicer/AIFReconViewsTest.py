"""Self tests of what the views show after something was loaded or reconstructed, and that they are given back."""

import pathlib
import sys
import tempfile
import unittest

import numpy as np
import slicer
import vtk
from vtk.util import numpy_support

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import tinyScene


class AIFReconViewsTest(unittest.TestCase):
    """Slice views, 3D views and the tool bar that replays."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        slicer.app.layoutManager().setLayout(slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView)
        slicer.util.selectModule("AIFRecon")
        self.widget = slicer.modules.AIFReconWidget
        self.ui, self.parameters = self.widget.ui, self.widget._parameterNode
        self.threeD = slicer.app.layoutManager().threeDWidget(0).threeDView()

    def tearDown(self):
        slicer.mrmlScene.Clear()

    def addInputs(self):
        """Sweep, CT and bone, chosen; bone is filled, as Slicer shows it at first."""
        self.parameters.sweep = tinyScene.addSweep()
        self.parameters.ctVolume, self.parameters.bone, _registration = tinyScene.addCT()
        self.parameters.bone.CreateDefaultDisplayNodes()
        self.parameters.spacing = 2.0

    def load(self):
        """Read the sweep from a file, as the user does."""
        from AIFReconLib import write_sequence

        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "lumbar.igs.mha"
            write_sequence(tinyScene.makeSequence(), path)
            self.parameters.recordingPath = path
            self.ui.loadButton.click()

    def composite(self, name="Red"):
        """What a slice view shows."""
        return slicer.app.layoutManager().sliceWidget(name).mrmlSliceCompositeNode()

    def lookAt(self, *place):
        """Have the 3D view look somewhere else, as a user may."""
        self.threeD.cameraNode().SetFocalPoint(place)

    def focus(self) -> np.ndarray:
        """Where the 3D view looks."""
        return np.array(self.threeD.cameraNode().GetFocalPoint())

    def middle(self, node) -> np.ndarray:
        """Of a node, RAS."""
        bounds = [0.0] * 6
        node.GetRASBounds(bounds)
        return np.reshape(bounds, (3, 2)).mean(axis=1)

    # ---- what was loaded

    def test_a_sweep_that_was_loaded_can_be_replayed_at_once(self):
        self.load()
        sequences = slicer.modules.sequences
        self.assertTrue(sequences.isToolBarVisible())
        self.assertIs(sequences.toolBar().activeBrowserNode(), self.parameters.sweep)

    def test_without_a_ct_no_letters_in_3d_take_a_trackers_axes_for_the_patients(self):
        view = slicer.app.layoutManager().threeDWidget(0).threeDView().mrmlViewNode()
        self.load()
        self.assertFalse(view.GetAxisLabelsVisible())
        self.parameters.ctVolume, _bone, _registration = tinyScene.addCT()
        self.assertTrue(view.GetAxisLabelsVisible())
        self.parameters.ctVolume = None
        self.assertFalse(view.GetAxisLabelsVisible())
        slicer.mrmlScene.Clear()
        self.assertTrue(view.GetAxisLabelsVisible())

    def test_the_ct_is_in_the_slice_views_after_a_sweep_was_loaded(self):
        self.parameters.ctVolume, _bone, _registration = tinyScene.addCT()
        self.load()
        for name in ("Red", "Yellow", "Green"):
            with self.subTest(view=name):
                self.assertEqual(self.composite(name).GetBackgroundVolumeID(), self.parameters.ctVolume.GetID())
        red = slicer.app.layoutManager().sliceWidget("Red").mrmlSliceNode()
        np.testing.assert_allclose(tinyScene.placeOf(red)[:3, 3], self.middle(self.parameters.ctVolume), atol=1.0)

    # ---- bone beside a reconstruction

    def test_bone_is_an_outline_while_a_reconstruction_is_on_display(self):
        self.addInputs()
        display = self.parameters.bone.GetDisplayNode()
        self.assertTrue(display.GetVisibility2DFill())
        self.ui.applyButton.click()
        self.assertFalse(display.GetVisibility2DFill())
        self.assertTrue(display.GetVisibility2DOutline())

    def test_bone_is_filled_again_when_the_user_leaves_and_outlined_when_he_is_back(self):
        self.addInputs()
        display = self.parameters.bone.GetDisplayNode()
        self.ui.applyButton.click()
        self.widget.exit()
        self.assertTrue(display.GetVisibility2DFill())
        self.widget.enter()
        self.assertFalse(display.GetVisibility2DFill())

    # ---- 3D

    def test_bone_has_its_surface_in_3d_and_the_view_looks_at_it(self):
        self.addInputs()
        self.parameters.bone.GetSegmentation().AddEmptySegment("empty", "Empty")
        self.lookAt(500.0, 500.0, 500.0)
        self.ui.applyButton.click()
        bone = self.parameters.bone
        surface = bone.GetClosedSurfaceInternalRepresentation(bone.GetSegmentation().GetNthSegmentID(0))
        self.assertGreater(surface.GetNumberOfPolys(), 100)
        # Slicer takes its box and letters for things that appear
        np.testing.assert_allclose(self.focus(), self.middle(bone), atol=10.0)

    def test_the_surface_lies_where_the_bone_is(self):
        self.addInputs()
        self.ui.applyButton.click()
        bone, bounds = self.parameters.bone, [0.0] * 6
        toWorld = vtk.vtkTransformPolyDataFilter()
        transform = vtk.vtkTransform()
        transform.SetMatrix(slicer.util.vtkMatrixFromArray(tinyScene.CT_TO_WORLD))
        toWorld.SetTransform(transform)
        toWorld.SetInputData(bone.GetClosedSurfaceInternalRepresentation(bone.GetSegmentation().GetNthSegmentID(0)))
        toWorld.Update()
        toWorld.GetOutput().GetBounds(bounds)
        self.assertAlmostEqual(bounds[2], tinyScene.FACE, delta=1.5)

    # ---- rims

    def test_what_was_not_measured_does_not_darken_what_was(self):
        self.addInputs()
        self.ui.applyButton.click()
        voxels = slicer.util.arrayFromVolume(self.parameters.output)
        voxels[voxels > 0] = 200
        slicer.util.arrayFromVolumeModified(self.parameters.output)
        red = slicer.app.layoutManager().sliceWidget("Red")
        self.turn(red.mrmlSliceNode(), 33.0)
        reslice = red.sliceLogic().GetForegroundLayer().GetReslice()
        reslice.Update()
        seen = numpy_support.vtk_to_numpy(reslice.GetOutput().GetPointData().GetScalars())
        self.assertEqual(set(np.unique(seen)), {0, 200})

    def turn(self, sliceNode, degrees):
        """Turn a slice view in its plane, so that its pixels are not those of any volume."""
        turned = tinyScene.placeOf(sliceNode) @ tinyScene.rotation(2, degrees)
        sliceNode.GetSliceToRAS().DeepCopy(slicer.util.vtkMatrixFromArray(turned))
        sliceNode.UpdateMatrices()

"""Self tests of what the views show after something was loaded or reconstructed, and that they are given back."""

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel
from vtk.util import numpy_support


class AIFReconViewsTest(OpenPanel):
    """Slice views, 3D views and the tool bar that replays."""

    def setUp(self):
        super().setUp()
        slicer.app.layoutManager().setLayout(slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView)

    # ---- what was loaded

    def test_without_a_ct_no_letters_in_3d_take_a_trackers_axes_for_the_patients(self):
        view = self.threeDView().mrmlViewNode()
        self.chooseRecording()
        self.ui.loadButton.click()
        self.assertFalse(view.GetAxisLabelsVisible())
        self.parameters.ctVolume, _bone, _registration = tinyScene.addCT()
        self.assertTrue(view.GetAxisLabelsVisible())
        self.parameters.ctVolume = None
        self.assertFalse(view.GetAxisLabelsVisible())
        slicer.mrmlScene.Clear()
        self.assertTrue(view.GetAxisLabelsVisible())
        # A scan has no sweep, but its volume lies in a tracker's axes too
        self.parameters.output = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "Live average")
        self.assertFalse(view.GetAxisLabelsVisible())

    def test_a_sweep_that_was_loaded_can_be_replayed_at_once_and_the_ct_is_in_the_slice_views(self):
        self.parameters.ctVolume, _bone, _registration = tinyScene.addCT()
        self.chooseRecording()
        self.ui.loadButton.click()
        self.assertTrue(slicer.modules.sequences.isToolBarVisible())
        self.assertIs(slicer.modules.sequences.toolBar().activeBrowserNode(), self.parameters.sweep)
        for name in ("Red", "Yellow", "Green"):
            with self.subTest(view=name):
                self.assertEqual(self.composite(name).GetBackgroundVolumeID(), self.parameters.ctVolume.GetID())
        red = self.sliceWidget("Red").mrmlSliceNode()
        np.testing.assert_allclose(tinyScene.placeOf(red)[:3, 3], tinyScene.boundsOf(self.parameters.ctVolume).mean(axis=1), atol=1.0)

    # ---- bone beside a reconstruction

    def test_bone_is_outlined_beside_a_reconstruction_and_filled_again_when_the_user_leaves(self):
        self.addInputs(spacing=2.0)
        display = self.parameters.bone.GetDisplayNode()
        self.assertTrue(display.GetVisibility2DFill())
        self.ui.applyButton.click()
        self.assertFalse(display.GetVisibility2DFill())
        self.assertTrue(display.GetVisibility2DOutline())
        self.widget.exit()
        self.assertTrue(display.GetVisibility2DFill())
        self.widget.enter()
        self.assertFalse(display.GetVisibility2DFill())

    # ---- 3D

    def test_bone_has_its_surface_in_3d_where_the_bone_is_and_the_view_looks_at_it(self):
        self.addInputs(spacing=2.0)
        self.parameters.bone.GetSegmentation().AddEmptySegment("empty", "Empty")
        camera = self.threeDView().cameraNode()
        camera.SetFocalPoint(500.0, 500.0, 500.0)
        self.ui.applyButton.click()
        bone = self.parameters.bone
        surface = bone.GetClosedSurfaceInternalRepresentation(bone.GetSegmentation().GetNthSegmentID(0))
        self.assertGreater(surface.GetNumberOfPolys(), 100)
        points = numpy_support.vtk_to_numpy(surface.GetPoints().GetData())
        inWorld = points @ tinyScene.CT_TO_WORLD[:3, :3].T + tinyScene.CT_TO_WORLD[:3, 3]
        self.assertAlmostEqual(inWorld[:, 1].min(), tinyScene.FACE, delta=1.5)
        # Slicer takes its box and letters for things that appear
        np.testing.assert_allclose(camera.GetFocalPoint(), tinyScene.boundsOf(bone).mean(axis=1), atol=10.0)

    # ---- rims

    def test_what_was_not_measured_does_not_darken_what_was(self):
        self.reconstruct()
        voxels = slicer.util.arrayFromVolume(self.parameters.output)
        voxels[voxels > 0] = 200
        slicer.util.arrayFromVolumeModified(self.parameters.output)
        red = self.sliceWidget("Red")
        # Turned in its plane, so that its pixels are not those of any volume
        turned = tinyScene.placeOf(red.mrmlSliceNode()) @ tinyScene.rotation(2, 33.0)
        red.mrmlSliceNode().GetSliceToRAS().DeepCopy(slicer.util.vtkMatrixFromArray(turned))
        red.mrmlSliceNode().UpdateMatrices()
        reslice = red.sliceLogic().GetForegroundLayer().GetReslice()
        reslice.Update()
        seen = numpy_support.vtk_to_numpy(reslice.GetOutput().GetPointData().GetScalars())
        self.assertEqual(set(np.unique(seen)), {0, 200})

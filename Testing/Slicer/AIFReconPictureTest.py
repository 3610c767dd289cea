"""Self tests of the picture: measured or enhanced, the tint, bone in 3D, the probe's side up, names of levels, and the report."""

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel


class AIFReconPictureTest(OpenPanel):
    """The part of the panel that says how a reconstruction is looked at."""

    def setUp(self):
        super().setUp()
        slicer.app.layoutManager().setLayout(slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView)
        self.picture = self.picturePanel()

    def measured(self):
        """The plain echo that is kept beside the output."""
        from AIFReconScene.volumes.volumeNodes import measuredOf

        return measuredOf(self.parameters.output)

    # ---- measured or enhanced

    def test_one_toggle_shows_the_plain_echo_in_the_same_gray_levels_and_back(self):
        output = self.reconstruct()
        output.GetDisplayNode().SetWindowLevelMinMax(10.0, 90.0)
        box = self.picture._ui.showMeasuredCheckBox
        box.click()
        for name in ("Red", "Yellow", "Green"):
            self.assertEqual(self.composite(name).GetForegroundVolumeID(), self.measured().GetID())
        display = self.measured().GetDisplayNode()
        self.assertEqual((display.GetWindowLevelMin(), display.GetWindowLevelMax()), (10.0, 90.0))
        self.parameters.opacity = 0.25
        self.assertAlmostEqual(self.composite().GetForegroundOpacity(), 0.25)
        box.click()
        self.assertEqual(self.composite().GetForegroundVolumeID(), output.GetID())

    # ---- tint

    def test_brightness_that_the_method_added_is_tinted_and_nothing_else_is(self):
        output = self.reconstruct()
        tint = slicer.mrmlScene.GetNodeByID(self.composite().GetLabelVolumeID())
        bands, shown, plain = (slicer.util.arrayFromVolume(each) for each in (tint, output, self.measured()))
        self.assertTrue((bands > 0).any())
        self.assertTrue((shown[bands > 0] > plain[bands > 0]).all())
        self.assertTrue((bands[shown <= plain] == 0).all())

    def test_the_tint_fades_with_the_volume_and_goes_with_its_box_the_plain_echo_and_the_panel(self):
        self.reconstruct()
        self.parameters.opacity = 0.3
        self.assertAlmostEqual(self.composite().GetLabelOpacity(), 0.3)
        for change in ("showRaised", "showMeasured"):
            with self.subTest(change=change):
                setattr(self.parameters, change, not getattr(self.parameters, change))
                self.assertFalse(self.composite().GetLabelVolumeID())
                setattr(self.parameters, change, not getattr(self.parameters, change))
                self.assertTrue(self.composite().GetLabelVolumeID())
        self.widget.exit()
        # Also where a volume is shown meanwhile
        self.picture.show()
        self.assertFalse(self.composite().GetLabelVolumeID())
        self.assertIsNone(slicer.mrmlScene.GetFirstNodeByName("Raised brightness"))
        self.widget.enter()
        self.assertTrue(self.composite().GetLabelVolumeID())

    # ---- bone in 3D

    def showBone(self):
        """Reconstruct is pressed, and bone shows as a plate on the near face of the slab; the model that is kept beside the output."""
        from AIFReconScene.inputs.boneNodes import labelsFromNode
        from AIFReconScene.picture.spineView import keepSpine

        from AIFReconLib.bone.field import BoneField
        from AIFReconLib.geometry.volume import Volume
        from AIFReconLib.inspection.bone_surface import bone_surface
        from AIFReconLib.inspection.shown_bone import ShownBone

        self.reconstruct()
        plate = np.zeros((24, 9, 24), np.float32)
        plate[4:20, 3:6, 4:20] = 1.0
        bone = BoneField.from_labels(labelsFromNode(self.parameters.bone))
        field = Volume(plate, tinyScene.moved(-12.0, tinyScene.FACE - 4.0, -12.0))
        model = keepSpine(self.parameters.output, bone_surface(ShownBone(field, 1, 0, bone, np.eye(4))), "Sweep")
        self.parameters.opacity = 0.5
        return model

    def test_the_bone_that_shows_is_a_surface_in_3d_the_ct_s_bone_is_translucent_behind_and_both_go_with_the_volume(self):
        model, bone = self.showBone(), self.parameters.bone.GetDisplayNode()
        self.assertTrue(model.GetDisplayVisibility())
        points = slicer.util.arrayFromModelPoints(model)
        self.assertAlmostEqual(points[:, 1].mean(), tinyScene.FACE, delta=0.5)
        # On a plate that lies on the face, no corner is farther than half of its thickness
        distances = slicer.util.arrayFromModelPointData(model, model.GetDisplayNode().GetActiveScalarName())
        self.assertLess(distances.max(), 3.0)
        self.assertLess(bone.GetOpacity3D(), 0.5)
        self.assertTrue(bone.GetBackfaceCulling())
        self.parameters.showSpine = False
        self.assertFalse(model.GetDisplayVisibility())
        self.assertEqual((bone.GetOpacity3D(), bone.GetBackfaceCulling()), (1.0, 0))
        # It goes with the volume that shows it
        self.parameters.showSpine, output = True, self.parameters.output
        for chosen in (None, output):
            self.parameters.output = chosen
            self.assertEqual(bool(model.GetDisplayVisibility()), chosen is output)
        # Of the slab no frame shows a shadow that is long enough: none of its bone shows
        self.ui.applyButton.click()
        self.assertIsNone(model.GetScene())
        self.assertFalse(self.picture._ui.showSpineCheckBox.enabled)
        self.assertEqual(bone.GetOpacity3D(), 1.0)

    # ---- slice views

    def axes(self, name):
        """Right and up of a slice view, RAS."""
        return tinyScene.placeOf(self.sliceWidget(name).mrmlSliceNode())[:3, :2].T

    def test_with_the_probe_s_side_up_the_red_view_lies_as_the_frames_do_and_comes_back(self):
        self.parameters.sweep = tinyScene.addSweep()
        before = self.axes("Red")
        self.picture._ui.probeUpCheckBox.click()
        self.waitUntil(lambda: self.isTurned("Green"))
        right, up = self.axes("Red")
        # On the mean the frames' rows run along +y, and their columns along +x
        np.testing.assert_allclose(up, [0.0, -1.0, 0.0], atol=0.1)
        np.testing.assert_allclose(right, [1.0, 0.0, 0.0], atol=0.1)
        head_on_the_left, up = self.axes("Yellow")
        np.testing.assert_allclose((head_on_the_left, up), [[0.0, 0.0, -1.0], [0.0, -1.0, 0.0]], atol=0.1)
        right, up = self.axes("Green")
        np.testing.assert_allclose((right, up), [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], atol=0.1)
        self.picture._ui.probeUpCheckBox.click()
        self.waitUntil(lambda: not self.isTurned("Green"))
        np.testing.assert_allclose(self.axes("Red"), before, atol=1e-6)

    def isTurned(self, name) -> bool:
        """Whether the probe's side is up in a slice view, the last of which is the green one."""
        return self.sliceWidget(name).mrmlSliceNode().GetOrientation().endswith("ProbeUp")

    def namesIn(self, name):
        """Names that are written into a slice view."""
        node = slicer.mrmlScene.GetFirstNodeByName(f"Levels {name}")
        return [] if node is None else [node.GetNthControlPointLabel(number) for number in range(node.GetNumberOfControlPoints())]

    def test_levels_that_share_a_labelmap_are_named_each_in_its_own_place_in_the_slices_near_it_and_nowhere_after_that(self):
        ct, bone, registration = tinyScene.addCT()
        labels = np.zeros((40, 50, 50), np.uint8)
        for value, i in ((1, 10), (2, 30)):
            labels[10:30, 15:35, i : i + 6] = value
        node = tinyScene.addVolume("vtkMRMLLabelMapVolumeNode", "Levels", labels, tinyScene.ijkToRAS(ct))
        node.SetAndObserveTransformNodeID(registration.GetID())
        bone.GetSegmentation().RemoveAllSegments()
        slicer.modules.segmentations.logic().ImportLabelmapToSegmentationNode(node, bone)
        for number, name in enumerate(("L3", "L4")):
            bone.GetSegmentation().GetNthSegment(number).SetName(name)
        self.parameters.bone = bone
        self.picture._ui.showLevelsCheckBox.click()
        # The last to get its names
        self.waitUntil(lambda: slicer.mrmlScene.GetFirstNodeByName("Levels Green") is not None)
        green = self.sliceWidget("Green").mrmlSliceNode()
        middles = [tinyScene.CT_TO_WORLD @ tinyScene.ijkToRAS(ct) @ [i + 2.5, 24.5, 19.5, 1.0] for i in (10, 30)]
        green.JumpSliceByCentering(*(middles[0] + middles[1])[:3] / 2)
        self.assertEqual(self.namesIn("Green"), ["L3", "L4"])
        node = slicer.mrmlScene.GetFirstNodeByName("Levels Green")
        normal = slicer.util.arrayFromVTKMatrix(green.GetSliceToRAS())[:3, 2]
        for number, middle in enumerate(middles):
            place = np.array(node.GetNthControlPointPosition(number))
            np.testing.assert_allclose(np.cross(place - middle[:3], normal), 0.0, atol=1e-3)
        green.JumpSliceByCentering(0.0, tinyScene.FACE + 64.0, 0.0)
        self.assertEqual(self.namesIn("Green"), [])
        self.picture._ui.showLevelsCheckBox.click()
        self.waitUntil(lambda: slicer.mrmlScene.GetFirstNodeByName("Levels Green") is None)

    # ---- report

    def test_the_page_stands_alone_with_pictures_sweep_agreement_coverage_and_settings(self):
        self.showBone()
        self.picture.saveReport(self.folder / "one")
        page = (self.folder / "one.html").read_text("utf-8")
        self.assertEqual(page.count("data:image/png;base64,"), 7)
        for words in ("as measured", "CT and sweep", "Bone hit by the beams", "weight_floor", "frames used".capitalize(), "AIFRecon"):
            self.assertIn(words, page)
        self.assertNotIn("://", page)

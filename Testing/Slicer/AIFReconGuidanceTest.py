"""Self tests of guidance: bone colored by what a recorded sweep or a scan has met, shares, the next move, and sentences in their place."""

from unittest import mock

import numpy as np
import slicer
import tinyScene
from simulatedPatient import OpenPatient

OWN = ("Bone met", "Colors of bone met", "Advised probe")

QUICK = """
from AIFReconLib.guidance import passes
from AIFReconLib.live.session import guidance_watch
passes.SAGITTAL_TILTS_DEG, passes.SAGITTAL_ACROSS_DEG, passes.TRANSVERSE_TILTS_DEG = (-38.0, 38.0), (0.0,), (0.0,)
guidance_watch.SKIN_AFTER, guidance_watch.FAR_AFTER, guidance_watch.RENEW_EVERY = 3, 10, 0.5
"""
"""Has a worker look at few candidates, after few frames."""


class AIFReconGuidanceTest(OpenPatient):
    """The box *Guidance* on a simulated patient."""

    spacing = 5.0

    def setUp(self):
        super().setUp()
        self.follow(self.nodes.browser)
        self.ui.tabWidget.currentIndex = 1

    @classmethod
    def setUpClass(cls):
        from AIFReconScene.work import worker

        worker.call(exec, QUICK)

    @classmethod
    def tearDownClass(cls):
        from AIFReconScene.work import worker

        worker.close()

    # ---- what tests do

    def setBox(self, wanted=True):
        """Click the box, if it is not so already."""
        if self.ui.guidanceCheckBox.checked != wanted:
            self.ui.guidanceCheckBox.click()

    def start(self):
        """Begin a scan with the box set."""
        self.parameters.guidance = True
        super().start()

    def model(self, name="Bone met"):
        """A node of ours, or None."""
        return slicer.mrmlScene.GetFirstNodeByName(name)

    def levels(self):
        """What the corners of the bone in color say."""
        return slicer.util.arrayFromModelPointData(self.model(), "Met")

    def colored(self):
        """Whether some bone was met in color."""
        return self.model() is not None and (self.levels() > 1).any()

    def own(self):
        """All nodes that guidance has made."""
        return [node for node in map(slicer.mrmlScene.GetNodeByID, tinyScene.nodeIDs()) if node.GetName() in OWN]

    # ---- a recorded sweep

    def test_the_colors_are_those_that_the_library_tells_and_the_next_move_is_in_large_type_in_panel_and_3d_view(self):
        from AIFReconScene.inputs.boneNodes import labelsFromNode
        from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

        from AIFReconLib.guidance.coverage import coverage, share_of

        self.setBox()
        labels = labelsFromNode(self.nodes.segmentation, world=False)
        found = coverage(sequenceFromBrowser(self.nodes.browser), labels, tinyScene.worldOf(self.nodes.segmentation))
        levels = self.levels()
        reachable = levels > 0
        self.assertAlmostEqual((levels[reachable] > 1).mean(), found.all.met, delta=0.06)
        self.assertAlmostEqual((levels[reachable] == 4).mean(), found.all.below_45_deg, delta=0.06)
        # The table tells what the light does: of the bone that faces the back
        self.assertIn(f"{share_of(found.met, found.met.bone.posterior).met:.0%}", self.ui.guidanceTableLabel.text)
        # In the panel, for in the view it would cover the ghost
        self.assertIn("squarely, below 45", self.ui.guidanceColorsLabel.text.replace("&nbsp;", " "))
        text = self.ui.guidanceMoveLabel.text
        self.assertRegex(text, "^[\u2190-\u2193\u21bb\u25cf]  ")
        self.assertEqual(self.ui.guidanceLabel.text.splitlines()[0], text)
        self.assertIn("26px", self.ui.guidanceMoveLabel.styleSheet)
        annotation = self.threeDView().cornerAnnotation()
        lines = annotation.GetText(2).splitlines()
        self.assertEqual(" ".join(lines), text[3:])
        self.assertTrue(all(len(line) <= 24 for line in lines), lines)
        self.assertGreaterEqual(annotation.GetMaximumLineHeight() * 250, annotation.GetMaximumFontSize())

    def test_the_ghost_stands_where_the_move_leads_the_ct_takes_its_colors_along_and_without_the_box_nothing_is_left(self):
        from AIFReconScene.display.boneColors import BoneColors

        display, ct = self.nodes.segmentation.GetDisplayNode(), self.nodes.ct
        changed = ct.GetMTime(), ct.GetDisplayNode().GetMTime()
        self.setBox()
        self.assertEqual((ct.GetMTime(), ct.GetDisplayNode().GetMTime()), changed)
        move, columns = self.widget._guidance._shown.move, self.parameters.liveImage.GetImageData().GetDimensions()[0]
        least, most = tinyScene.boundsOf(self.model("Advised probe")).T
        face = move.image_to_reference @ [columns / 2, 40.0, 0.0, 1.0]
        self.assertTrue((least <= face[:3]).all() and (face[:3] <= most).all())
        self.assertTrue(self.model("Advised probe").GetDisplayNode().GetVisibility2D())
        before = tinyScene.boundsOf(self.model())
        tinyScene.setMatrix(self.nodes.ctToReference, tinyScene.moved(0.0, 0.0, 50.0) @ tinyScene.matrixOf(self.nodes.ctToReference))
        np.testing.assert_allclose(tinyScene.boundsOf(self.model()) - before, [[0, 0], [0, 0], [50, 50]], atol=1e-3)
        # Segments are not drawn in 3D under the colors, and come back, also where another session hid them
        self.assertEqual((display.GetVisibility3D(), display.GetVisibility()), (0, 1))
        BoneColors().clear()
        self.assertTrue(display.GetVisibility3D())
        self.assertTrue(self.own())
        self.setBox(False)
        self.waitUntil(lambda: not self.own())
        self.assertFalse(self.ui.guidanceWords.isVisibleTo(self.ui.coverageDetails))
        self.assertFalse(self.ui.liveColorsLabel.isVisibleTo(self.ui.liveTab))
        self.assertEqual(self.live._advised, "")
        self.assertFalse(self.threeDView().cornerAnnotation().GetText(2))

    def test_a_cancel_leaves_the_scene_as_it_was(self):
        from AIFReconGui.longWork import ProgressDialog

        with mock.patch.object(ProgressDialog, "__call__", return_value=False):
            self.setBox()
        self.assertEqual(self.own(), [])

    def test_without_a_ct_the_echoes_tell_what_was_hit_and_where_to_go(self):
        self.parameters.bone = None
        self.setBox()
        self.assertTrue(self.colored(), self.ui.guidanceLabel.text)
        self.assertIn(1, self.levels())  # where bone may go on
        self.assertIsNone(self.model().GetParentTransformNode())
        self.assertIn("All bone", self.ui.guidanceTableLabel.text)
        self.assertNotRegex(self.ui.guidanceTableLabel.text, "Label|interspinous")
        self.assertRegex(self.ui.guidanceLabel.text, "over the bone; shows [0-9.]+ cm\u00b2 more bone$")
        self.assertNotRegex(self.ui.guidanceLabel.text, "head|feet|patient")
        self.setBox(False)
        self.waitUntil(lambda: not self.own())

    # ---- a scan

    def test_a_scan_without_a_ct_colors_the_bone_of_its_echoes_and_says_the_next_move(self):
        from AIFReconScene.inputs.boneSource import BoneSource

        self.parameters.bone, self.parameters.boneSource = None, BoneSource.ECHOES
        self.start()
        self.playUntil(lambda: self.colored() and self.live._advised)
        self.assertNotRegex(self.live._advised, "head|feet|patient")
        self.assertIsNotNone(self.model("Advised probe"))

    def test_a_scan_after_paths_were_found_leads_to_what_they_did_not_see(self):
        self.widget.logic.paths.unseen = np.array([[0.0, 20.0, 0.0], [3.0, 20.0, 0.0], [0.0, 20.0, 3.0], [0.0, 23.0, 3.0]])
        self.start()
        self.playUntil(lambda: self.colored() and "looks where paths were not seen" in self.ui.guidanceLabel.text)
        self.assertIn("%", self.ui.guidanceTableLabel.text)

    def test_a_scan_colors_the_bone_and_says_the_next_move_and_what_it_has_met_is_still_seen_when_it_is_over(self):
        self.start()
        self.playUntil(lambda: self.colored() and self.live._advised and self.ui.guidanceMoveLabel.text == self.live._advised)
        self.assertIn("%", self.ui.guidanceTableLabel.text)
        self.assertIsNotNone(self.model("Advised probe"))
        self.ui.liveStopButton.click()
        self.assertTrue(self.colored())
        slicer.app.processEvents()
        # No order to move the probe outlasts the scan
        self.assertIsNone(self.model("Advised probe"))
        self.assertFalse(self.threeDView().cornerAnnotation().GetText(2))
        self.assertEqual(self.ui.guidanceMoveLabel.text, "Look at the picture, or press Start")
        self.setBox(False)
        self.waitUntil(lambda: not self.own())

    def test_what_changes_while_scanning_is_followed_until_the_scene_is_closed(self):
        from AIFReconScene.live import followedBone

        self.addCleanup(setattr, followedBone, "SETTLED", followedBone.SETTLED)
        followedBone.SETTLED = 0.05
        self.start()
        self.playUntil(self.colored)
        corners = self.model().GetPolyData().GetNumberOfPoints()
        slicer.mrmlScene.RemoveNode(self.model())
        self.playUntil(self.colored)
        segmentation = self.nodes.segmentation.GetSegmentation()
        segmentation.RemoveSegment(segmentation.GetNthSegmentID(0))
        self.playUntil(lambda: self.colored() and self.model().GetPolyData().GetNumberOfPoints() < corners)
        place = tinyScene.matrixOf(self.nodes.ctToReference)
        tinyScene.setMatrix(self.nodes.ctToReference, tinyScene.moved(400.0, 0.0, 0.0))
        self.playUntil(lambda: "No frame has come near" in self.ui.guidanceLabel.text)
        tinyScene.setMatrix(self.nodes.ctToReference, place)
        self.playUntil(self.colored)
        slicer.mrmlScene.Clear()
        self.assertFalse(self.live.isRunning)
        self.assertEqual(self.own(), [])

    def test_a_segmentation_that_is_deleted_while_scanning_leaves_a_sentence(self):
        self.start()
        self.playUntil(self.colored)
        slicer.mrmlScene.RemoveNode(self.nodes.segmentation)
        self.playUntil(lambda: "Select the bone" in self.ui.guidanceLabel.text)
        self.assertEqual(self.own(), [])
        self.assertIsNone(self.live._live.displayProblem)

"""Self tests of the section Paths: lines and map in the scene, the number that follows a line that is dragged, and what must be said."""

import numpy as np
import slicer
import tinyScene
from simulatedPatient import OpenPatient, patient

FRAMES = 63
"""Of the sweep: seven at each of nine angles."""


class AIFReconPathsTest(OpenPatient):
    """The section, on a simulated patient."""

    frames, spacing = FRAMES, 1.5

    def setUp(self):
        super().setUp()
        self.paths = self.widget.logic.paths
        self.ui.pathsCollapsibleButton.collapsed = False

    # ---- what tests do

    def find(self) -> str:
        """Reconstruct where nothing was, and press the button; what was said."""
        if self.parameters.output is None:
            self.ui.applyButton.click()
        self.assertTrue(self.ui.findPathsButton.enabled, self.ui.findPathsButton.toolTip)
        self.ui.findPathsButton.click()
        self.waitUntil(lambda: bool(self.ui.pathsLabel.text))
        return self.ui.pathsLabel.text

    def expected(self, target="1-2", labels=True):
        """What the library finds, of the nodes as they are."""
        from AIFReconScene.inputs.boneNodes import labelsFromNode
        from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser
        from AIFReconScene.volumes.volumeNodes import volumeOf

        from AIFReconLib.paths.free_paths import free_paths

        _node, _time, result, _skin = self.paths._last
        bone = labelsFromNode(self.nodes.segmentation, world=False) if labels else None
        place = tinyScene.worldOf(self.nodes.segmentation) if labels else None
        sweep, volume = sequenceFromBrowser(self.nodes.browser), volumeOf(self.parameters.output)
        return free_paths(volume, target, sweep, bone, place, mask=result.mask, score=result.score)

    def target(self):
        """Where the canal is between the first two levels, as the nodes are."""
        from AIFReconScene.inputs.boneNodes import labelsFromNode

        from AIFReconLib.bone.canal import canal_between
        from AIFReconLib.geometry.labels import Labels

        labels = labelsFromNode(self.nodes.segmentation, world=False)
        place = tinyScene.worldOf(self.nodes.segmentation)
        return canal_between(Labels(labels.array, labels.ijk_to_reference), "1-2", place)

    def words(self, found, entry, end) -> str:
        """What the panel says of a line."""
        clearance, seen = found.along(entry, end)
        return f"{clearance:.1f} mm, {np.floor(100 * seen):.0f}% seen, {np.linalg.norm(end - entry):.0f} mm deep"

    def points(self, name="Path 1") -> np.ndarray:
        """The ends of a line."""
        return slicer.util.arrayFromMarkupsControlPoints(slicer.util.getNode(name), world=True)

    def made(self) -> list:
        """Names of the lines and of the map in the scene."""
        lines = [node.GetName() for node in slicer.util.getNodesByClass("vtkMRMLMarkupsLineNode")]
        return sorted([*lines, *(node.GetName() for node in slicer.util.getNodesByClass("vtkMRMLModelNode") if "paths" in node.GetName())])

    def addPoint(self, *place):
        """A point as target."""
        self.ui.pathTargetComboBox.currentIndex = self.ui.pathTargetComboBox.count - 1
        node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "Target")
        if place:
            node.AddControlPoint(*place)
        self.parameters.pathPoint = node
        return node

    # ---- what is found

    def test_lines_and_map_are_those_that_the_library_finds_and_the_number_follows_a_line_that_is_dragged(self):
        self.assertFalse(self.ui.pathsCollapsibleButton.visible)
        said, found = self.find(), self.expected()
        self.assertGreater(len(found.windows), 1)
        self.assertEqual([self.ui.pathTargetComboBox.itemText(n) for n in range(3)], ["L2 to L3", "L3 to L4", "a point"])
        for number, window in enumerate(found.windows, start=1):
            np.testing.assert_allclose(self.points(f"Path {number}"), [window.entry, window.end], atol=1e-3)
        skin = slicer.util.getNode("Free paths on the skin")
        np.testing.assert_allclose(slicer.util.arrayFromModelPoints(skin), found.entries, atol=1e-3)
        np.testing.assert_array_equal(slicer.util.arrayFromModelPointData(skin, "Best line from here"), found.states)
        self.assertGreater(skin.GetPolyData().GetNumberOfPolys(), 100)
        self.assertTrue(skin.GetDisplayNode().GetScalarVisibility())
        np.testing.assert_allclose(self.paths.unseen, found.unseen, atol=1e-3)
        self.assertIn(self.words(found, *self.points()), said)
        self.assertIn("CT and volume agree", said)
        self.assertIn("not for guiding a needle", self.ui.pathsResearchLabel.text)
        self.assertTrue(self.ui.pathsResearchLabel.visible)
        self.assertIn("not&nbsp;seen", self.ui.pathColorsLabel.text)
        node = slicer.util.getNode("Path 1")
        for step in ((0.0, 0.0, 6.0), (9.0, 0.0, 2.0), (-20.0, 4.0, 0.0)):
            node.SetNthControlPointPositionWorld(0, *(self.points()[0] + step))
            expected = self.words(found, *self.points())
            self.waitUntil(lambda expected=expected: expected in self.ui.pathsLabel.text), (expected, self.ui.pathsLabel.text)

    def test_another_line_is_shown_with_the_slices_along_and_across_it_until_the_scene_is_closed(self):
        self.find()
        for number, name in enumerate(("Path 1", "Path 2")):
            if number:
                self.ui.pathsComboBox.activated.emit(number)
            visible = [node.GetName() for node in self.paths.lines if node.GetDisplayVisibility()]
            self.assertEqual(visible, [name])
            entry, end = self.points(name)
            down = (end - entry) / np.linalg.norm(end - entry)
            red, yellow = (tinyScene.placeOf(self.sliceWidget(each).mrmlSliceNode()) for each in ("Red", "Yellow"))
            np.testing.assert_allclose((np.array([entry, end]) - red[:3, 3]) @ red[:3, 2], 0.0, atol=1e-6)
            self.assertAlmostEqual(down @ red[:3, 1], -1.0)
            self.assertAlmostEqual(abs(down @ yellow[:3, 2]), 1.0)
            for plane in (red, yellow):
                np.testing.assert_allclose(plane[:3, 3], (entry + end) / 2, atol=1e-6)
                self.assertAlmostEqual(np.linalg.det(plane[:3, :3]), 1.0)
        slicer.mrmlScene.Clear()
        self.assertEqual(self.ui.pathsLabel.text, "")

    def test_a_ct_that_does_not_lie_on_the_sweep_is_said_and_not_believed(self):
        self.ui.applyButton.click()
        tinyScene.setMatrix(self.nodes.ctToReference, tinyScene.moved(0.0, 15.0, 8.0) @ tinyScene.worldOf(self.nodes.segmentation))
        self.addPoint(*self.target())
        said = self.find()
        self.assertIn("the CT does not lie on the volume's bone", said)
        self.assertIn("no lower bound is promised. Find the place of the CT with “Place CT on sweep”.", said)
        found = self.expected(self.points("Target")[0], labels=False)
        np.testing.assert_allclose(self.points(), [found.windows[0].entry, found.windows[0].end], atol=1e-3)

    def test_the_next_move_leads_to_windows_that_were_not_seen(self):
        self.find()
        self.ui.guidanceCheckBox.click()
        self.waitUntil(lambda: "looks where paths were not seen" in self.ui.guidanceLabel.text)
        self.ui.pathTargetComboBox.currentIndex = 1
        self.waitUntil(lambda: self.paths.unseen is None)
        self.ui.guidanceSweepButton.click()
        self.waitUntil(lambda: "more bone" in self.ui.guidanceLabel.text)

    # ---- what changes

    def test_what_was_found_does_not_hold_for_a_ct_that_was_moved_or_another_target(self):
        for change in (
            lambda: tinyScene.setMatrix(self.nodes.ctToReference, tinyScene.moved(0.0, 0.0, 1.0)),
            lambda: self.ui.pathTargetComboBox.__setattr__("currentIndex", 1),
        ):
            self.find()
            shown = [slicer.util.getNode("Free paths on the skin"), slicer.util.getNode("Path 1")]
            self.assertTrue(all(node.GetDisplayVisibility() for node in shown))
            change()
            self.waitUntil(lambda: not self.ui.pathsLabel.text)
            self.assertFalse(any(node.GetDisplayVisibility() for node in shown))
            self.assertFalse(self.ui.pathsComboBox.visible)
            tinyScene.setMatrix(self.nodes.ctToReference, patient(frames=FRAMES).ct_to_reference)

    def test_paths_are_saved_with_the_scene_and_found_again_in_the_same_nodes(self):
        self.find()
        made, points = self.made(), self.points()
        tinyScene.saveAndOpenAgain(self)
        self.assertEqual(self.made(), made)
        np.testing.assert_allclose(self.points(), points, atol=1e-3)
        skin = slicer.util.getNode("Free paths on the skin")
        self.assertEqual(skin.GetDisplayNode().GetActiveScalarName(), "Best line from here")
        self.assertEqual(self.ui.pathsLabel.text, "")
        # The score was not kept in the scene
        self.assertIn("Shadows are not known", self.find())
        self.assertEqual([name for name in self.made() if "skin" in name], ["Free paths on the skin"])
        self.assertEqual(len(self.made()), 1 + len(self.paths.lines))

    def test_a_scan_that_has_ended_needs_no_sweep(self):
        from AIFReconScene.inputs.boxes import layAround

        self.follow(self.nodes.browser)
        self.parameters.sweep = self.nodes.browser
        layAround(self.chooseBox(), self.parameters)
        self.parameters.sweep = None
        self.ui.liveStartButton.click()
        self.playFrames(self.nodes.browser, range(FRAMES))
        self.ui.liveStopButton.click()
        self.assertIsNotNone(self.parameters.output)
        self.assertIsNone(self.parameters.sweep)
        self.assertIn("mm deep", self.find())
        self.assertNotIn("Shadows are not known", self.ui.pathsLabel.text)
        skin = self.paths._last[3]
        expected = self.expected().entries
        near = np.linalg.norm(slicer.util.arrayFromModelPoints(slicer.util.getNode("Free paths on the skin"))[:, None] - expected, axis=2)
        self.assertLess(np.median(near.min(axis=1)), 1.0)
        self.assertGreater(len(skin), FRAMES)

    # ---- what is missing

    def test_without_a_point_or_with_one_out_of_reach_it_says_so_and_a_new_one_is_placed_by_the_next_click(self):
        self.ui.applyButton.click()
        node = self.addPoint()
        self.assertFalse(self.ui.findPathsButton.enabled)
        self.assertIn("place it with a click", self.ui.findPathsButton.toolTip)
        self.assertTrue(self.ui.pathPointSelector.visible)
        self.ui.pathPointSelector.nodeAddedByUser.emit(node)
        logic = slicer.app.applicationLogic()
        self.assertEqual(logic.GetSelectionNode().GetActivePlaceNodeID(), node.GetID())
        self.assertEqual(logic.GetInteractionNode().GetCurrentInteractionMode(), slicer.vtkMRMLInteractionNode.Place)
        logic.GetInteractionNode().SetCurrentInteractionMode(slicer.vtkMRMLInteractionNode.ViewTransform)
        node.AddControlPoint(500.0, 0.0, 0.0)
        self.assertIn("The target must lie 5 to 200 mm under the skin", self.messageOf(self.ui.findPathsButton.click))
        self.assertEqual((self.ui.pathsLabel.text, self.made()), ("", []))
        node.SetNthControlPointPositionWorld(0, *self.target())
        self.assertIn("mm deep", self.find())

    def test_no_path_at_all_is_one_sentence(self):
        # So coarse that half a voxel is more than any line is clear of bone
        self.parameters.spacing = 2.5
        self.assertEqual(self.find().splitlines()[0], "No line from the skin reaches the target past bone.")
        self.assertEqual(self.made(), ["Free paths on the skin"])

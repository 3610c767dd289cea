"""Self tests of the import of images and poses: questions as choices, the drawing, the sweep, and the rectangle that is recognized."""

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel


class AIFReconImportTest(OpenPanel):
    """The window in which images and poses are taken in, as a user works with it."""

    panel = OpenPanel.ui

    def opened(self):
        """The widgets of the window, with both files chosen."""
        poses = tinyScene.writeForeign(self.folder, tinyScene.makeSequence())
        self.panel.importButton.click()
        importer = self.widget._recorded.importer
        importer._ui.imagesLineEdit.currentPath = str(self.folder / "images.npy")
        importer._ui.posesLineEdit.currentPath = str(self.folder / "poses.csv")
        return importer, importer._ui, poses

    def test_what_the_files_leave_open_is_asked_as_choices_and_the_sweep_lies_where_the_poses_say(self):
        importer, ui, poses = self.opened()
        self.assertFalse(ui.importCheckButton.enabled)
        self.assertIn("what the poses are", ui.importWordsEdit.plainText)
        ui.transformComboBox.currentIndex = 1
        ui.importCheckButton.click()
        self.assertFalse(ui.takeButton.enabled)
        self.assertIn("poses of 2 tools", ui.importWordsEdit.plainText)
        self.assertEqual(self.choices(importer, "tool"), ["", "Probe", "Patient"])
        self.assertEqual(self.choices(importer, "reference_tool"), ["", "Probe", "Patient"])
        self.answer(importer, "tool", "Probe")
        self.assertEqual(self.choices(importer, "time_unit"), ["", "s", "ms", "us", "100ns", "ns"])
        self.answer(importer, "time_unit", "ms")
        self.assertIn("size of a pixel is not known", ui.importWordsEdit.plainText)
        importer._answers["spacing"].currentText = "{} {}".format(*tinyScene.PIXEL)
        self.assertTrue(ui.drawingLabel.isHidden())
        ui.importCheckButton.click()
        self.assertFalse(ui.drawingLabel.isHidden())
        self.assertIn("stamp in ms", ui.importWordsEdit.plainText)
        self.assertTrue(ui.takeButton.enabled)
        ui.takeButton.click()
        self.assertIn("11 of 12", self.panel.sweepStatusLabel.text)
        self.assertEqual(self.parameters.sweep.GetName(), "images")
        self.assertTrue(importer._window.isHidden())
        self.assertLieAt(poses)

    def test_the_marker_on_the_patient_becomes_the_frame_in_which_the_sweep_lies(self):
        importer, ui, poses = self.answered()
        self.answer(importer, "reference_tool", "Patient")
        ui.takeButton.click()
        self.assertLieAt([tinyScene.moved(-1, -2, -3 - number / 100) @ pose for number, pose in enumerate(poses)])

    def test_a_calibration_places_the_image_in_the_probe_and_a_sweep_that_is_read_anew_is_turned(self):
        importer, ui, poses = self.opened()
        pixels = np.diag([*tinyScene.PIXEL, 0.45, 1.0])
        (self.folder / "ImageToProbe.txt").write_text(" ".join(map(str, pixels.ravel())))
        ui.transformComboBox.currentIndex = 2
        ui.calibrationLineEdit.currentPath = str(self.folder / "ImageToProbe.txt")
        ui.importCheckButton.click()
        self.answer(importer, "tool", "Probe")
        self.answer(importer, "time_unit", "ms")
        ui.orientationComboBox.currentIndex = 2
        self.assertFalse(ui.takeButton.enabled)
        ui.importCheckButton.click()
        ui.takeButton.click()
        self.assertLieAt(poses)
        from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

        images = sequenceFromBrowser(self.parameters.sweep).images
        np.testing.assert_array_equal(images[3], np.load(self.folder / "images.npy")[3][:, ::-1])

    def test_a_sweep_that_is_not_imported_any_more_leaves_the_scene_as_it_was(self):
        importer, ui, _poses = self.answered()
        ui.importCheckButton.click()
        before = slicer.mrmlScene.GetNumberOfNodes()
        self.pressAnd(ui.takeButton, importer, "_take", 0.5, lambda: self.widget._work.cancel())
        self.assertEqual(slicer.mrmlScene.GetNumberOfNodes(), before)
        self.assertIsNone(self.parameters.sweep)
        self.assertFalse(importer._window.isHidden())

    def test_the_window_goes_when_the_user_leaves_the_module_and_is_there_anew(self):
        importer, ui, _poses = self.opened()
        window = importer._window
        slicer.util.selectModule("Data" if hasattr(slicer.modules, "data") else "Transforms")
        self.assertIsNone(importer._window)
        self.assertTrue(not window or window.isHidden())
        slicer.util.selectModule("AIFRecon")
        self.panel.importButton.click()
        self.assertIsNot(importer._ui, ui)
        self.assertEqual(importer._ui.transformComboBox.currentIndex, 0)

    def answered(self):
        """The widgets of the window, with all that it asks answered but the size of a pixel."""
        importer, ui, poses = self.opened()
        ui.transformComboBox.currentIndex = 1
        ui.importCheckButton.click()
        self.answer(importer, "tool", "Probe")
        self.answer(importer, "time_unit", "ms")
        importer._answers["spacing"].currentText = "{} {}".format(*tinyScene.PIXEL)
        return importer, ui, poses

    def assertLieAt(self, poses):
        from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

        from AIFReconLib.sweep.poses import sweep_poses

        found = sweep_poses(sequenceFromBrowser(self.parameters.sweep)).image_to_reference
        good = [number for number in range(tinyScene.FRAMES) if number != tinyScene.UNTRACKED]
        np.testing.assert_allclose(found[good][:, :, [0, 1, 3]], np.array(poses)[good][:, :, [0, 1, 3]], atol=1e-6)

    def choices(self, importer, name):
        box = importer._answers[name]
        return [box.itemText(row) for row in range(box.count)]

    def answer(self, importer, name, text):
        """As the user does: an item of the list is activated, which is looked at on the spot."""
        box = importer._answers[name]
        box.currentIndex = box.findText(text)
        box.activated(box.currentIndex)

    def test_a_change_takes_back_what_was_seen_and_other_files_are_asked_anew(self):
        importer, ui, _poses = self.answered()
        ui.importCheckButton.click()
        self.assertTrue(ui.takeButton.enabled)
        ui.importCloseButton.click()
        self.assertTrue(importer._window.isHidden())
        self.assertIsNone(importer._seen)
        self.panel.importButton.click()
        self.assertFalse(ui.takeButton.enabled)
        ui.importCheckButton.click()
        self.assertTrue(ui.takeButton.enabled)
        ui.transformComboBox.currentIndex = 3
        self.assertFalse(ui.takeButton.enabled)
        self.assertTrue(ui.drawingLabel.isHidden())
        self.assertIn("tool", importer._answers)
        ui.posesLineEdit.currentPath = str(self.folder / "others.csv")
        self.assertEqual(importer._answers, {})
        self.assertFalse(ui.importCheckButton.enabled)

    def test_what_cannot_be_read_is_said_in_the_window_and_the_scene_stays(self):
        _importer, ui, _poses = self.opened()
        (self.folder / "poses.csv").write_text("x,y\n1,2\n")
        ui.transformComboBox.currentIndex = 1
        before = slicer.mrmlScene.GetNumberOfNodes()
        ui.importCheckButton.click()
        self.assertIn("must be 4x4 matrices", ui.importWordsEdit.plainText)
        self.assertFalse(ui.takeButton.enabled)
        self.assertEqual(slicer.mrmlScene.GetNumberOfNodes(), before)

    # ---- what is recognized, and names

    def test_the_rectangle_that_is_recognized_is_one_press(self):
        self.assertFalse(self.panel.recognizeButton.enabled)
        self.parameters.sweep = tinyScene.addSweep()
        self.panel.recognizeButton.click()
        clip = [self.parameters.clipColumn, self.parameters.clipRow, self.parameters.clipWidth, self.parameters.clipHeight]
        columns, rows = tinyScene.FRAME_SIZE
        np.testing.assert_allclose(clip[:3], [tinyScene.MARGIN, 0, columns - 2 * tinyScene.MARGIN - 1], atol=1.0)
        self.assertTrue(rows / 2 < clip[3] < rows, clip)  # deep in the bone all is dark
        self.assertIn("Set as recognized", self.panel.statusLabel.text)
        self.panel.applyButton.click()
        self.assertIsNotNone(self.parameters.output)

    def test_a_renamed_transform_is_known_at_once(self):
        browser = tinyScene.addSweep()
        image = browser.GetProxyNode(browser.GetMasterSequenceNode())
        image.SetAndObserveTransformNodeID(None)
        recorded = next(node for node in slicer.util.getNodesByClass("vtkMRMLSequenceNode") if node is not browser.GetMasterSequenceNode())
        items = [recorded.GetNthDataNode(number) for number in range(recorded.GetNumberOfDataNodes())]
        for node, name in ((recorded, "S"), (browser.GetProxyNode(recorded), "T"), *((item, "T") for item in items)):
            node.SetName(name)
            for attribute in ("Sequences.Source", "Sequences.BaseName"):
                node.SetAttribute(attribute, None)
        self.parameters.sweep = browser
        self.assertFalse(self.panel.applyButton.enabled)
        recorded.SetName("ImageToReference")
        self.assertIn("11 of 12 frames have a position", self.panel.sweepStatusLabel.text)
        self.assertTrue(self.panel.applyButton.enabled)

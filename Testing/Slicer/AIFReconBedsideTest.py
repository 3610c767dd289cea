"""Self tests of what stands at the bedside: how many clicks a picture takes, the lights, presets, and scenes of the older panel."""

import pathlib
import unittest
import unittest.mock
from dataclasses import replace
from functools import partial

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel
from simulatedPatient import FRAMES, addPatient

HERE = pathlib.Path(__file__).resolve().parent


class AIFReconBedsideTest(OpenPanel):
    """The panel as somebody meets it who has never seen it."""

    def setUp(self):
        super().setUp()
        self.clicks = 0

    def click(self, button):
        """Click what can be seen and pressed, and count."""
        self.assertTrue(button.enabled, f"{button.text}: {button.toolTip}")
        self.assertTrue(button.isVisibleTo(self.widget.parent), button.text)
        self.clicks += 1
        button.click()

    def assertPicture(self):
        """There is a volume with something in it, and the views show it."""
        output = self.parameters.output
        self.assertIsNotNone(output, self.ui.statusLabel.text)
        self.assertTrue(slicer.util.arrayFromVolume(output).any())
        self.assertEqual(self.composite().GetForegroundVolumeID(), output.GetID())

    def levels(self) -> list:
        """What the lights say: the words on their signs."""
        names = ("tracking", "registration", "coverage", "calibration")
        return [getattr(self.ui, f"{name}SignalLabel").text.split(" ", 1)[1] for name in names]

    # ---- clicks

    def test_the_sample_patient_is_one_click_away_from_an_empty_scene(self):
        from AIFReconScene.volumes import phantomSample

        self.parameters.spacing = 2.0
        small = partial(phantomSample.loadPhantom, frames=FRAMES)
        with unittest.mock.patch.object(phantomSample, "loadPhantom", small):
            self.click(self.ui.sampleButton)
        self.assertPicture()
        self.assertEqual(self.clicks, 1)
        self.assertEqual(self.levels()[1], "good")
        self.assertFalse(self.ui.sampleButton.isVisibleTo(self.widget.parent))

    def test_a_sample_that_is_canceled_leaves_the_scene_as_it_was(self):
        from AIFReconScene.volumes import phantomSample

        before = tinyScene.nodeIDs()
        small = partial(phantomSample.loadPhantom, frames=9)
        with unittest.mock.patch.object(phantomSample, "loadPhantom", small):
            for share in (0.5, 0.975):
                self.pressAnd(self.ui.sampleButton, phantomSample, "loadPhantom", share, lambda: self.widget._work.cancel())
                self.assertEqual(tinyScene.nodeIDs(), before)

    def test_a_thin_scan_of_the_sample_says_that_it_is_thin(self):
        from AIFReconScene.volumes import phantomSample

        self.parameters.spacing = 2.0
        with unittest.mock.patch.object(phantomSample, "FEW_FRAMES", FRAMES):
            self.click(self.ui.thinSampleButton)
        self.assertPicture()
        self.assertIn("not all lights are green", self.ui.statusLabel.text)

    def test_a_recording_with_its_ct_is_open_placed_and_reconstructed_in_three_clicks(self):
        from AIFReconLib import write_sequence

        ct, bone, registration = tinyScene.addCT()
        off = tinyScene.moved(0.0, 4.0, 0.0) @ tinyScene.matrixOf(registration)
        tinyScene.setMatrix(registration, off)
        paths = [self.folder / name for name in ("sweep.igs.mha", "CT.nrrd", "vertebrae.seg.nrrd", "place.tfm")]
        write_sequence(tinyScene.makeSequence(), paths[0])
        for node, path in zip((ct, bone, registration), paths[1:]):
            tinyScene.write(node, path)
        slicer.mrmlScene.Clear()
        with unittest.mock.patch.object(self.widget._recorded, "_ask", return_value=paths):
            self.click(self.ui.openButton)
        self.parameters.spacing = 1.0
        self.assertEqual(self.ui.statusLabel.text, "Opened sweep.igs.mha, CT.nrrd, vertebrae.seg.nrrd, place.tfm.")
        self.assertTrue(self.ui.inputsCollapsibleButton.collapsed)
        self.click(self.ui.placeButton)
        self.click(self.ui.applyButton)
        self.assertPicture()
        self.assertEqual(self.clicks, 3)
        np.testing.assert_allclose(tinyScene.worldOf(self.parameters.bone)[:3, 3], tinyScene.CT_TO_WORLD[:3, 3], atol=4.0)

    def test_files_in_any_order_end_in_the_same_scene(self):
        from AIFReconLib import write_sequence
        from AIFReconLib.geometry.transform_graph import TransformName
        from AIFReconLib.sweep.frames import FrameRecord

        ct, _bone, registration = tinyScene.addCT()
        place = tinyScene.matrixOf(registration)
        sequence, image, probe = tinyScene.makeSequence(), TransformName("Image", "Reference"), TransformName("Probe", "Reference")
        calibration, poses = np.diag([*tinyScene.PIXEL, 0.45, 1.0]), [each.transforms[image] for each in sequence.records]
        rigid = [replace(pose, matrix=pose.matrix @ np.linalg.inv(calibration)) for pose in poses]
        records = [FrameRecord(each.timestamp, transforms={probe: pose}) for each, pose in zip(sequence.records, rigid)]
        paths = [self.folder / name for name in ("place.tfm", "CT.nrrd", "sweep.igs.mha", "calibration.xml")]
        tinyScene.write(registration, paths[0])
        tinyScene.write(ct, paths[1])
        write_sequence(replace(sequence, records=records), paths[2])
        matrix = " ".join(map(str, calibration.ravel()))
        paths[3].write_text(
            "<PlusConfiguration><CoordinateDefinitions>"
            f'<Transform From="Image" To="Probe" Matrix="{matrix}" /></CoordinateDefinitions></PlusConfiguration>'
        )
        slicer.mrmlScene.Clear()
        said = []
        for path in paths:
            self.open(path)
            said.append(self.ui.statusLabel.text.splitlines()[0])
        self.assertEqual(said[0], "Opened place.tfm. place is taken for the place of the CT that is opened next.")
        self.assertEqual(said[1], "Opened CT.nrrd. The CT lies where place says.")
        self.assertEqual(said[3], "Opened calibration.xml. The recording was read again with this calibration.")
        np.testing.assert_allclose(tinyScene.matrixOf(self.parameters.ctVolume.GetParentTransformNode()), place, atol=1e-6)
        self.assertEqual(slicer.mrmlScene.GetNumberOfNodesByClass("vtkMRMLSequenceBrowserNode"), 1)
        self.assertIn("11 of 12 frames", self.widget.logic.describeSweep(self.parameters))

    def test_a_file_of_labels_becomes_segments_in_the_same_voxels(self):
        from AIFReconScene.inputs.boneNodes import labelsFromNode

        from AIFReconLib.geometry.volume import Volume

        oblique = tinyScene.moved(3.0, -4.0, 5.0) @ np.array(
            [[0.0, -1.5, 0.0, 0.0], [1.2, 0.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0], [0, 0, 0, 1]]
        )
        array = np.zeros((9, 8, 7), np.uint8)
        array[2:6, 1:5, 2:4], array[2:6, 5:7, 2:6] = 2, 7
        Volume(array, oblique).write(self.folder / "vertebrae.nrrd")
        self.widget.logic.openFiles(self.parameters, [self.folder / "vertebrae.nrrd"])
        bone = self.parameters.bone
        self.assertTrue(bone.IsA("vtkMRMLSegmentationNode"))
        self.assertEqual(slicer.mrmlScene.GetNumberOfNodesByClass("vtkMRMLVolumeNode"), 0)
        segments = [bone.GetSegmentation().GetNthSegment(number).GetName() for number in range(2)]
        self.assertEqual((bone.GetName(), segments), ("vertebrae", ["Label 2", "Label 7"]))
        labels = labelsFromNode(bone)
        np.testing.assert_array_equal(labels.array, np.select([array == 2, array == 7], [1, 2]))
        np.testing.assert_allclose(labels.ijk_to_reference, oblique, atol=1e-6)

    def test_a_file_of_no_kind_is_named_and_nothing_is_read(self):
        (self.folder / "picture.doc").write_text("x")
        with self.assertRaisesRegex(Exception, "picture.doc"):
            self.widget.logic.openFiles(self.parameters, [self.folder / "picture.doc"])

    # ---- lights

    def test_the_lights_say_what_was_found_and_go_out_when_it_no_longer_holds(self):
        self.assertEqual(self.levels(), ["not yet"] * 4)
        self.addInputs()
        self.click(self.ui.applyButton)
        self.assertEqual(self.levels()[0], "good")
        self.assertIn("11 of 12 frames", self.ui.trackingVerdictLabel.text)
        self.assertIn("echoes", self.ui.registrationVerdictLabel.text)
        self.waitForLights()
        self.assertIn("%", self.ui.coverageVerdictLabel.text)
        self.assertNotEqual(self.levels()[2], "not yet")
        self.assertEqual(self.levels()[3], "not yet")
        self.assertIn("cannot be told from this sweep", self.ui.calibrationVerdictLabel.text)
        # They are saved with the result
        labels = [self.ui.coverageVerdictLabel, self.ui.calibrationVerdictLabel]
        levels, advised = self.levels(), [label.text for label in labels]
        tinyScene.saveAndOpenAgain(self)
        self.assertEqual((self.levels(), [label.text for label in labels]), (levels, advised))
        place = self.widget._parameterNode.bone.GetParentTransformNode()
        tinyScene.setMatrix(place, tinyScene.moved(0.0, 0.0, 9.0) @ tinyScene.matrixOf(place))
        self.waitUntil(lambda: self.levels()[1:] == ["not yet"] * 3)
        self.assertEqual(self.levels()[0], "good")
        for unreadable in ("no JSON", "[]", '{"coverage": 1}', '{"coverage": [[], "worse", "", ""]}'):
            self.widget._parameterNode.output.SetAttribute("AIFRecon.Verdicts", unreadable)
            self.widget._recorded.update("")
            self.assertEqual(self.levels()[2], "not yet", unreadable)

    def test_a_ct_that_lies_elsewhere_is_red_with_the_button_that_places_it(self):
        self.addInputs()
        tinyScene.setMatrix(self.registration, tinyScene.moved(0.0, 6.0, 0.0) @ tinyScene.matrixOf(self.registration))
        self.click(self.ui.applyButton)
        self.assertEqual(self.levels()[1], "poor")
        self.assertIn("Place the CT", self.ui.registrationVerdictLabel.text)
        self.assertTrue(self.ui.placeButton.isVisibleTo(self.widget.parent))
        self.waitForLights()
        self.assertIn("known where CT and sweep agree", self.ui.calibrationVerdictLabel.text)
        # No advice of coverage rests on a CT that lies elsewhere
        self.assertIn("known where CT and sweep agree", self.ui.coverageVerdictLabel.text)
        # Elsewhere nothing is known of it; where it lay, what was known is
        said, place = self.ui.registrationVerdictLabel.text, tinyScene.matrixOf(self.registration)
        tinyScene.setMatrix(self.registration, tinyScene.moved(0.0, 3.0, 0.0) @ place)
        self.waitUntil(lambda: self.levels()[1] == "not yet")
        tinyScene.setMatrix(self.registration, place)
        self.waitUntil(lambda: self.ui.registrationVerdictLabel.text == said)

    def test_without_a_ct_nothing_is_shown_that_takes_one(self):
        self.addInputs()
        self.parameters.bone = self.parameters.ctVolume = None
        self.click(self.ui.applyButton)
        self.assertIsNotNone(self.parameters.output)
        names = ("tracking", "registration", "coverage", "calibration", "motion")
        shown = [name for name in names if getattr(self.ui, f"{name}VerdictLabel").isVisibleTo(self.widget.parent)]
        self.assertEqual(shown, ["tracking", "motion"])
        picture = self.picturePanel()._ui
        self.assertFalse(picture.opacitySliderWidget.isVisibleTo(self.widget.parent))
        self.assertFalse(picture.boneOutlinesCheckBox.isVisibleTo(self.widget.parent))

    def test_a_calibration_that_agrees_is_good(self):
        addPatient()
        self.widget.initializeParameterNode()
        self.parameters.spacing = 3.0
        self.click(self.ui.applyButton)
        self.assertIn("being worked out", self.ui.calibrationVerdictLabel.text)
        self.waitForLights()
        self.assertIn("agrees with this sweep within", self.ui.calibrationVerdictLabel.text)
        self.assertEqual(self.levels()[3], "good")

    # ---- settings

    def test_a_preset_sets_the_settings_and_is_named_while_they_are_as_it_says(self):
        from AIFReconScene.inputs.parameters import Method

        combo = self.ui.presetComboBox
        self.assertEqual(combo.currentText, "Standard")
        combo.currentIndex = combo.findText("As in the paper")
        self.assertEqual((self.parameters.method, self.parameters.holeLimit), (Method.AIF, 0.0))
        self.ui.spacingSpinBox.value = 0.77
        self.assertEqual(combo.currentText, "Own settings")
        combo.currentIndex = combo.findText("Fast look")
        self.assertEqual((self.parameters.spacing, self.parameters.method), (1.0, Method.AUTOMATIC))

    def test_a_scene_of_the_older_panel_opens_with_its_settings(self):
        from AIFReconScene.inputs.parameters import ImageOrientation, Method, ProbeShape, Region, RegistrationStart, SigmaUnit

        slicer.mrmlScene.SetURL(str(HERE / "savedByOlderPanel.mrml"))
        self.assertTrue(slicer.mrmlScene.Connect())
        p = self.widget.logic.getParameterNode()
        self.assertEqual(
            (p.alpha, p.spacing, p.holeLimit, p.boneSigma, p.opacity, p.apexColumn, p.skip), (0.35, 0.8, 1.5, 4.0, 0.25, 320.5, 2)
        )
        self.assertEqual((p.liveHost, p.livePort, p.liveImageDevice), ("scanner", 18950, "Image_Reference"))
        self.assertEqual((p.method, p.region, p.boneSigmaUnit, p.probe), (Method.AIF, Region.BOX, SigmaUnit.MM, ProbeShape.SECTOR))
        self.assertEqual((p.registrationStart, p.imageOrientation), (RegistrationStart.ANYWHERE, ImageOrientation.UN))
        self.assertTrue(p.guidance and p.keepScore and p.liveRecord)
        self.assertEqual(p.recordingPath, pathlib.Path("sweep.igs.mha"))

    # ---- live

    def test_a_scan_is_recorded_beside_the_scene_unless_nobody_wants_that(self):
        from AIFReconScene.live.liveFiles import recordingPath

        beside = self.folder / "beside"
        beside.mkdir()
        slicer.mrmlScene.SetURL(str(beside / "scene.mrb"))
        self.assertEqual(recordingPath(self.parameters).parent, beside)
        self.parameters.liveRecordPath = beside / "mine.mha"
        self.assertEqual(recordingPath(self.parameters).name, "mine.mha")
        self.parameters.liveRecord = False
        self.assertIsNone(recordingPath(self.parameters))

    def test_a_server_is_looked_for_on_this_computer_first(self):
        from AIFReconLib.live.replay.server import ReplayServer
        from AIFReconLib.live.wire import search

        with ReplayServer(tinyScene.makeSequence(), 0, rate=20.0, loop=True) as server:
            asked = []
            found = search.answering([("127.0.0.1", server.port)], lambda share, said: asked.append(str(said)) or True)
        if found == ("127.0.0.1", server.port):  # else this computer has a scanner of its own
            self.assertIn("18944", asked[0])
        self.assertEqual(found[0], "127.0.0.1")
        kept = [("scanner", 18944), ("127.0.0.1", 18945)]
        self.assertEqual(search.from_text(search.as_text(kept)), kept)

"""Self tests of bone from a network or from the echoes: the choice in both tabs, what it gives, what is refused, and a scan."""

import pathlib
import time

import numpy as np
import slicer
import tinyScene
import workerStates
from openPanel import OpenPanel, waitFor


class AIFReconNetworkTest(OpenPanel):
    """The tiny sweep, and a network that knows where its echoes are."""

    def setUp(self):
        super().setUp()
        self.parameters.spacing, self.parameters.holeLimit = 1.0, 0.0

    def said(self):
        """What the network says: certain bone where the echoes are."""
        from AIFReconLib.sweep.frames import TrackedSequence

        sweep = tinyScene.makeSequence()
        images = np.where(np.asarray(sweep.images) == tinyScene.ECHO, 255, 0).astype(np.uint8)
        return TrackedSequence(images, sweep.records)

    def model(self) -> pathlib.Path:
        """The network in a file that comes with the tests; it knows an echo over darkness."""
        from AIFReconGui.packages import MODEL, isInstalled

        if not isInstalled(MODEL):
            self.skipTest(f"{MODEL} is not installed, and Slicer installs nothing in testing mode")
        return pathlib.Path(__file__).resolve().parents[1] / "models" / "bone.onnx"

    def expected(self, estimatorOf):
        """The voxels of the library's own call."""
        # Here and not above: another test may have reloaded the library since
        from AIFReconLib import Recipe, reconstruct
        from AIFReconLib.bone.predicted_bone import bone_from_frames

        sweep = tinyScene.makeSequence()
        bone = bone_from_frames(sweep, estimatorOf(sweep))
        return reconstruct(sweep, Recipe(spacing=1.0, hole_limit=0.0), bone).intensity.array

    # ---- recorded

    def test_recorded_predictions_reconstruct_as_they_do_in_the_library(self):
        from AIFReconScene.sweep.sequenceNodes import browserFromSequence

        from AIFReconLib.bone.recorded_predictions import RecordedPredictions

        self.parameters.sweep = tinyScene.addSweep()
        self.parameters.bonePredictions = browserFromSequence(self.said(), "Said").GetMasterSequenceNode()
        self.choose(self.ui.boneSourceComboBox, "An AI model, as it was recorded")
        np.testing.assert_array_equal(self.applied(), self.expected(lambda sweep: RecordedPredictions(sweep, self.said())))

    def test_a_network_in_a_file_reconstructs_as_it_does_in_the_library(self):
        from AIFReconLib.bone.network.model import OnnxModel

        path = self.model()
        self.parameters.sweep = tinyScene.addSweep()
        self.choose(self.ui.boneSourceComboBox, "An AI model in a file")
        self.ui.boneModelPathLineEdit.currentPath = str(path)
        np.testing.assert_array_equal(self.applied(), self.expected(lambda sweep: OnnxModel(path)))
        self.assertIn("bone.onnx", self.ui.statusLabel.text)

    def test_what_a_scan_recorded_of_a_network_is_opened_beside_the_scan(self):
        from AIFReconLib import write_sequence
        from AIFReconLib.bone.recorded_predictions import COVERS
        from AIFReconLib.sweep.frames import TrackedSequence

        half = self.said()
        for record in half.records:
            record.fields[COVERS] = "0 0 64 80"
        half = TrackedSequence(half.images[:, ::2, ::2], half.records)
        write_sequence(half, self.folder / "scan-bone.mhd")
        write_sequence(tinyScene.makeSequence(), self.folder / "scan.mhd")
        paths = [self.folder / name for name in ("scan.mhd", "scan-bone.mhd")]
        self.widget.logic.openFiles(self.parameters, paths)
        self.assertIn("scan", self.parameters.sweep.GetName())
        self.assertNotIn("bone", self.parameters.sweep.GetName())
        self.assertEqual(self.ui.boneSourceComboBox.currentText, "An AI model, as it was recorded")
        self.assertTrue(self.applied().any())

    # ---- refusals

    def test_a_file_that_is_no_network_is_refused_in_a_sentence_and_nothing_is_made(self):
        self.model()
        wrong = self.folder / "wrong.onnx"
        wrong.write_bytes(b"no network")
        self.parameters.sweep, self.parameters.boneModelPath = tinyScene.addSweep(), wrong
        self.choose(self.ui.boneSourceComboBox, "An AI model in a file")
        self.assertIn("cannot run this model", self.messageOf(self.ui.applyButton.click))
        self.assertIsNone(self.parameters.output)
        self.ui.liveStartButton.click()
        self.assertFalse(self.live.isRunning)

    # ---- while scanning

    def stream(self, box=True):
        """A scan whose messages the test gives."""
        from AIFReconScene.inputs.parameters import ProbeShape
        from AIFReconScene.work import inWorker, worker

        tinyScene.requireLivePackages()
        inWorker(workerStates.receiveWhatIsPut)
        self.addCleanup(worker.close)
        self.parameters.liveRecordPath = self.folder / "scan.mhd"
        # Known, it need not be recognized in frames that a test would have to wait for
        self.parameters.probe, self.parameters.clipColumn = ProbeShape.LINEAR, tinyScene.MARGIN
        self.parameters.clipWidth, self.parameters.clipHeight = tinyScene.FRAME_SIZE[0] - 2 * tinyScene.MARGIN, tinyScene.FRAME_SIZE[1]
        if box:
            self.chooseBox()
        self.ui.liveStartButton.click()
        self.assertTrue(self.live.isRunning)

    def send(self, device="", rounds=range(1)):
        """The tiny sweep again and again, and what the network says of it where that has a device."""
        from AIFReconScene.work import inWorker

        from AIFReconLib.live.wire.messages import ImageMessage, TransformMessage
        from AIFReconLib.sweep.poses import sweep_poses

        sweep, said = tinyScene.makeSequence(), self.said()
        poses = sweep_poses(sweep).image_to_reference
        for number in [number for _ in rounds for number in range(tinyScene.FRAMES) if number != tinyScene.UNTRACKED]:
            self.sent = getattr(self, "sent", 0) + 1
            inWorker(workerStates.put, ImageMessage("Image", float(self.sent), sweep.images[number], np.eye(4), {}, time.monotonic(), 2))
            inWorker(
                workerStates.put,
                TransformMessage("ImageToReference", float(self.sent), poses[number], received=time.monotonic(), header_version=2),
            )
            if device:
                inWorker(workerStates.put, ImageMessage(device, float(self.sent), said.images[number], np.eye(4), {}, time.monotonic()))
            waitFor(lambda: self.live._live.statistics.frames_received >= self.sent, 5.0)

    def assertGrows(self):
        """What is known of bone reaches the volume; then the scan is stopped."""
        self.waitUntil(lambda: "Bone is known from" in self.ui.liveStatisticsLabel.text)
        self.ui.liveStopButton.click()
        self.assertTrue(slicer.util.arrayFromVolume(self.parameters.output).any())

    def test_predictions_that_are_streamed_weight_a_scan_and_are_recorded_with_it(self):
        from AIFReconLib import read_sequence
        from AIFReconLib.bone.recorded_predictions import RecordedPredictions

        self.parameters.liveBoneDevice = "Bone"
        self.choose(self.ui.liveBoneSourceComboBox, "An AI model that runs elsewhere")
        self.stream()
        self.assertFalse(self.ui.liveBoneSourceComboBox.enabled)
        self.send("Bone")
        self.waitUntil(lambda: any("from 11 " in line for line in self.live._live.seen.bone_lines))
        self.assertGrows()
        self.assertIn("scan-bone.mhd", self.ui.liveStatisticsLabel.text)
        again = RecordedPredictions(read_sequence(self.folder / "scan.mhd"), read_sequence(self.folder / "scan-bone.mhd"))
        self.assertIn("11 of 11 frames, matched by time", again.notes()[0])

    def test_a_network_in_a_file_looks_at_a_scan_from_its_scouting_pass_on(self):
        self.parameters.boneModelPath = self.model()
        self.choose(self.ui.liveBoneSourceComboBox, "An AI model in a file")
        self.stream(box=False)
        self.send(rounds=range(3))
        self.waitUntil(lambda: any("Bone is known from" in line for line in self.live._live.seen.bone_lines))
        self.ui.liveUseBoxButton.click()
        self.send(rounds=range(3))
        self.assertGrows()
        self.assertTrue((self.folder / "scan-bone.mhd").is_file())

    def test_a_scan_looks_for_its_own_echoes(self):
        self.choose(self.ui.liveBoneSourceComboBox, "The echoes themselves")
        self.stream()
        self.send(rounds=range(4))
        self.assertGrows()
        self.assertFalse((self.folder / "scan-bone.mhd").exists())

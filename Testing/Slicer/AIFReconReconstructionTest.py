"""Self tests of the logic: what comes out, where it lies in millimeters, and that a failure or cancel leaves the scene as it was."""

import pathlib
import tempfile
import unittest

import numpy as np
import slicer
import tinyScene
import workerStates


class AIFReconReconstructionTest(unittest.TestCase):
    """The logic, as the Python console uses it."""

    def setUp(self):
        import AIFRecon  # another after a reload

        slicer.mrmlScene.Clear()
        self.logic = AIFRecon.AIFReconLogic()
        self.sweep = tinyScene.addSweep()
        self.ct, self.bone, self.registration = tinyScene.addCT()

    def tearDown(self):
        self.logic.cleanup()
        slicer.mrmlScene.Clear()

    def assertOnFace(self, volume, within=1.0):
        """Every bright voxel lies on the near face of the bone."""
        points = tinyScene.worldOfBrightVoxels(volume, 120)
        self.assertGreater(len(points), 100)
        self.assertLess(np.abs(points[:, 1] - tinyScene.FACE).max(), within)

    def test_bright_voxels_lie_on_the_bone_and_the_ct_is_not_touched(self):
        before = slicer.util.arrayFromVolume(self.ct).copy()
        self.assertOnFace(self.logic.reconstruct(self.sweep, self.bone, spacing=0.5, hole_limit=0.0))
        np.testing.assert_array_equal(slicer.util.arrayFromVolume(self.ct), before)
        self.assertIs(self.ct.GetParentTransformNode(), self.registration)

    def test_the_ct_s_transform_decides_where_bone_is_expected(self):
        """With the CT moved away no pixel counts as bone, and weighted becomes a plain mean."""
        self.registration.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(tinyScene.moved(300.0, 0.0, 0.0)))
        away = self.logic.reconstruct(self.sweep, self.bone, spacing=1.0, method="aif", keep=("score",))
        score = slicer.util.getNode(f"{away.GetName()}*core*")
        self.assertEqual(slicer.util.arrayFromVolume(score).max(), 0.0)

    def test_the_voxels_of_a_volume_are_used_with_its_transform(self):
        volume = self.logic.reconstruct(self.sweep, self.bone, holeLimit=0.0, inputs={"region": self.ct})
        expected = tinyScene.CT_TO_WORLD @ tinyScene.ijkToRAS(self.ct)
        np.testing.assert_allclose(tinyScene.ijkToRAS(volume), expected, atol=1e-6)
        self.assertOnFace(volume, within=1.3)

    def test_a_volume_says_how_it_was_made_in_the_scene_and_in_a_header_that_slicer_writes(self):
        import json

        from AIFReconScene.volumes.volumeNodes import saveSettings

        from AIFReconLib.provenance.settings_files import read_settings

        volume = self.logic.reconstruct(self.sweep, self.bone, spacing=1.0, boneSigmaMm=3.0, boneGain=0.7, keep=("hits",))
        text = volume.GetAttribute("AIFRecon_settings")
        hits = volume.GetNodeReference("AIFRecon.hits")
        self.assertEqual((hits.GetAttribute("AIFRecon_settings"), volume.GetAttribute("AIFRecon_method")), (text, "weighted"))
        self.assertEqual((json.loads(text)["bone_sigma_mm"], json.loads(text)["bone_gain"]), (3.0, 0.7))
        with tempfile.TemporaryDirectory() as folder:
            scene, header, settings = (pathlib.Path(folder) / name for name in ("scene.mrb", "volume.nrrd", "settings.json"))
            storage = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLNRRDStorageNode")
            storage.SetFileName(str(header))
            self.assertTrue(storage.WriteData(volume))
            slicer.mrmlScene.RemoveNode(storage)
            saveSettings(volume, settings)
            for path in (header, settings):
                kept = read_settings(path)
                np.testing.assert_array_equal(kept.recipe.grid.ijk_to_reference, np.array(json.loads(text)["grid_to_reference"]))
                self.assertEqual((kept.options["method"], kept.options["bone_sigma_mm"], kept.recipe.probe), ("weighted", 3.0, "linear"))
            self.assertTrue(slicer.mrmlScene.WriteToMRB(str(scene)))
            slicer.mrmlScene.Clear()
            self.assertTrue(slicer.mrmlScene.ReadFromMRB(str(scene), True))
        self.assertEqual(slicer.util.getNode("Sweep weighted").GetAttribute("AIFRecon_settings"), text)

    def test_a_failure_or_a_cancel_midway_leaves_the_scene_as_it_was(self):
        from AIFReconLib.errors import InsufficientMemoryError, OperationCanceled

        before = tinyScene.nodeIDs()
        with self.assertRaises(OperationCanceled):
            self.logic.reconstruct(self.sweep, self.bone, spacing=1.0, progress=lambda fraction, message: fraction < 0.5)
        with workerStates.littleMemory(100_000), self.assertRaises(InsufficientMemoryError):
            self.logic.reconstruct(self.sweep, self.bone, spacing=0.2)
        self.assertEqual(tinyScene.nodeIDs(), before)

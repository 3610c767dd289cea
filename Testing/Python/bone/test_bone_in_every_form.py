"""Real shapes of vertebrae as models, labels, a folder of masks and a CT: the same bone, and the same volume of a sweep over it."""

from __future__ import annotations

import numpy as np
import pytest
import scipy
from study.ct_bone import surface_off
from study.method_cases import HOLE_LIMIT, simulated_scan

from AIFReconLib.bone.ct.from_ct import labels_from_ct
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.geometry.labels import Labels
from AIFReconLib.geometry.solid import inside_of_surface
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.io.volume.label_files import read_labels
from AIFReconLib.io.volume.models import read_model
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.simulation.anatomy import LumbarPhantom, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep

FRAMES = 36


@pytest.fixture(scope="module")
def shapes(data_dir):
    """Two lumbar vertebrae of a statistical shape model, as they are and as voxels of 1 mm."""
    models = read_labels([data_dir / "lumbar-shape" / f"L{n}.stl" for n in (3, 4)])
    assert models.names == {1: "L3", 2: "L4"}
    low, high = models.grid.corners().min(axis=0), models.grid.corners().max(axis=0)
    grid = VoxelGrid.from_spacing(low, np.ceil(high - low).astype(int).tolist(), 1.0)
    array = np.zeros(grid.shape, np.uint8)
    for n in (1, 2):
        model = read_model(data_dir / "lumbar-shape" / f"L{n + 2}.stl")
        array[inside_of_surface(model.points, model.triangles, grid)] = n
    return models, Labels(array, grid.ijk_to_reference)


def ct_of(labels: Labels) -> Volume:
    """Cortical bone around trabecular in muscle, in air."""
    inside = scipy.ndimage.gaussian_filter((labels.array > 0).astype(np.float32), 0.5)
    deep = scipy.ndimage.distance_transform_edt(labels.array > 0) > 2
    values = 50 + inside * (np.where(deep, 220.0, 1000.0) - 50)
    k, j, i = np.ogrid[tuple(slice(0, n) for n in labels.shape)]
    middle = np.array(labels.shape) / 2
    body = np.hypot((j - middle[1]) / middle[1], (i - middle[2]) / middle[2]) + 0 * k < 0.97
    noise = np.random.default_rng(0).normal(0, 15, labels.shape)
    return Volume(np.where(body, values, -1000) + noise, labels.ijk_to_reference)


@pytest.fixture(scope="module")
def from_ct(shapes):
    return labels_from_ct(ct_of(shapes[1]))


def test_files_and_folders_hold_the_same_labels(shapes, tmp_path):
    models, labels = shapes
    labels.write(tmp_path / "labels.nii.gz")
    (tmp_path / "masks").mkdir()
    for n, name in ((1, "vertebrae_L3"), (2, "vertebrae_L4")):
        Volume((labels.array == n).astype(np.uint8), labels.ijk_to_reference).write(tmp_path / "masks" / f"{name}.nrrd")
    folder = read_labels(tmp_path / "masks")
    np.testing.assert_array_equal(read_labels(tmp_path / "labels.nii.gz").array, labels.array)
    np.testing.assert_array_equal(folder.array, labels.array)
    assert folder.names == models.names


def test_the_surface_is_the_same_as_models_and_as_a_ct(shapes, from_ct):
    models, labels = shapes
    for form in (models, from_ct):
        median, off = surface_off(labels, form)
        # The stairs of 1 mm voxels alone are 0.25 mm
        assert median < 0.3
        assert off < 0.75


class ShapesInABack:
    """Real shapes at the place of a simulated patient's vertebrae, as a probe on the back meets them."""

    def __init__(self, labels: Labels, patient: LumbarPhantom):
        self.labels, self.skin_y, self.scattering_db = labels, patient.skin_y, patient.scattering_db
        points = np.argwhere(labels.array)[:, ::-1] @ labels.ijk_to_reference[:3, :3].T + labels.ijk_to_reference[:3, 3]
        owner = labels.array[labels.array > 0]
        hindmost = [own[own[:, 1] <= own[:, 1].min() + 2].mean(axis=0) for own in (points[owner == n] for n in (1, 2))]
        self.ct_to_reference = np.eye(4)
        self.ct_to_reference[:3, 3] = np.mean(patient.spinous_tips(), axis=0) - np.mean(hindmost, axis=0)
        self.tips = np.array(hindmost) + self.ct_to_reference[:3, 3]
        outside, inside = (scipy.ndimage.distance_transform_edt(labels.array == 0), scipy.ndimage.distance_transform_edt(labels.array > 0))
        self.bone_distance = Volume((outside - inside).astype(np.float32), labels.ijk_to_reference).placed_by(self.ct_to_reference)

    def spinous_tips(self):
        return self.tips


def test_a_sweep_gives_the_same_volume_with_models_with_labels_and_with_a_ct(shapes, from_ct):
    models, labels = shapes
    back = ShapesInABack(labels, make_lumbar_phantom(spacing=3.0, ct_noise=0.0))
    scan = simulated_scan(back, PhasedArray(), multi_angle_sweep(back, FRAMES), 0)

    def shown(bone, method="weighted"):
        placed = None if bone is None else LabeledBone(bone, back.ct_to_reference, scan.sequence)
        result = reconstruct(scan.sequence, ReconstructionSettings(method=method, spacing=1.0, hole_limit=HOLE_LIMIT), placed)
        return result, evaluate(result.intensity, scan.truth, result.mask).bone

    exact, best = shown(labels)
    plain = shown(None, "average")[1]
    for form in (models, from_ct):
        result, bone = shown(form)
        alike = np.corrcoef(exact.intensity.array.ravel(), result.intensity.array.ravel())[0, 1]
        assert alike > 0.97
        assert bone.cnr > 0.94 * best.cnr > plain.cnr
        assert bone.coverage > 0.97 * best.coverage > plain.coverage
        # Half a voxel
        assert abs(bone.localization_bias - best.localization_bias) < 0.5

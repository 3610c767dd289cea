"""Small made-up sweeps for tests: oblique poses, anisotropic pixels, rotated grids, and a bone map around a sphere."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.compounding.state import Reconstruction
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedFrame, TrackedSequence


def rigid(rotation_vector_deg=(0.0, 0.0, 0.0), translation=(0.0, 0.0, 0.0)) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec(np.deg2rad(rotation_vector_deg)).as_matrix()
    matrix[:3, 3] = translation
    return matrix


def image_pose(spacing=(0.4, 0.7), rotation_vector_deg=(0.0, 0.0, 0.0), translation=(0.0, 0.0, 0.0)) -> np.ndarray:
    """image_to_reference of an image with this pixel spacing in mm."""
    return rigid(rotation_vector_deg, translation) @ np.diag([spacing[0], spacing[1], 0.5 * sum(spacing), 1.0])


def laid_on(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Points moved as one to where others are, (n, 3) each."""
    here, there = points.mean(axis=0), others.mean(axis=0)
    return Rotation.align_vectors(others - there, points - here)[0].apply(points - here) + there


def oblique_frames(seed=0, count=5, shape=(26, 34), spacing=(0.4, 0.7), dtype=np.uint8) -> list[TrackedFrame]:
    """Frames about the origin, each turned and shifted at random; integers fill their type's range, floats 0 to 300."""
    rng = np.random.default_rng(seed)
    frames = []
    for number in range(count):
        pose = image_pose(spacing, rng.normal(0, 25, 3), rng.normal(0, 1.0, 3))
        pose[:3, 3] -= pose[:3, 0] * shape[1] / 2 + pose[:3, 1] * shape[0] / 2
        top = np.iinfo(dtype).max + 1 if np.issubdtype(dtype, np.integer) else 300
        image = (rng.random(shape) * top).astype(dtype)
        frames.append(TrackedFrame(image, pose, timestamp=0.05 * number, number=number))
    return frames


def oblique_sequence(seed=0, count=5, spread=0.0, dtype=np.uint8) -> TrackedSequence:
    """Such frames as a sequence without a calibration, moved by up to `spread` mm or so more."""
    frames = oblique_frames(seed, count, dtype=dtype)
    poses = np.stack([frame.placed()[1] for frame in frames])
    poses[:, :3, 3] += spread * np.random.default_rng(seed).normal(size=(count, 3))
    return TrackedSequence.from_arrays(np.stack([frame.placed()[0] for frame in frames]), poses, 0.05 * np.arange(count))


def turned_grid(spacing=(0.9, 1.1, 1.3), size=(14, 15, 13), rotation_vector_deg=(12.0, -25.0, 40.0)) -> VoxelGrid:
    """A grid about the origin, smaller than the sweep, so that pixels fall outside too."""
    matrix = rigid(rotation_vector_deg) @ np.diag([*spacing, 1.0])
    matrix[:3, 3] = -matrix[:3, :3] @ (np.array(size) / 2)
    return VoxelGrid(size, matrix)


def places(grid: VoxelGrid) -> np.ndarray:
    """Centers of all voxels in Reference, [k, j, i, 3], mm."""
    return transform_points(grid.ijk_to_reference, np.moveaxis(np.indices(grid.shape)[::-1], 0, -1).astype(float))


def compounded(frames, grid=None, bone=None, probe=None, region=None, importance=None, **settings) -> Reconstruction:
    """What frames put into a grid give: floating point, holes left as they are, unless told otherwise."""
    wanted = ReconstructionSettings(**{"hole_limit": 0.0, "output_type": "float32", **settings})
    reconstructor = Reconstructor(grid or turned_grid(), wanted, bone, probe=probe, region=region, importance=importance)
    reconstructor.insert(frames)
    return reconstructor.finish()


def sphere_bone(radius=4.0, center=(0.5, -0.3, 0.8), sigma_mm=1.5) -> BoneMap:
    """A ball of bone, in a rotated label volume with voxels of 0.8 mm."""
    size, spacing = 30, 0.8
    matrix = rigid((5.0, 10.0, -20.0)) @ np.diag([spacing, spacing, spacing, 1.0])
    matrix[:3, 3] = np.asarray(center) - matrix[:3, :3] @ np.full(3, (size - 1) / 2)
    distance = np.linalg.norm(places(VoxelGrid((size,) * 3, matrix)) - center, axis=-1)
    return BoneMap.from_labels(Volume((distance < radius).astype(np.uint8), matrix), sigma_mm=sigma_mm)


def two_vertebrae() -> Volume:
    """Two blocks with spines toward the back (-y), labels 1 and 2, 8 mm apart along z; voxels of 1 mm, x and y from -30."""
    labels = np.zeros((80, 61, 61), dtype=np.uint8)
    for label, k in ((1, 10), (2, 44)):
        labels[k : k + 22, 34:50, 18:43] = label
        labels[k + 4 : k + 26, 12:36, 27:34] = label
    return Volume(labels, rigid(translation=(-30.0, -30.0, -40.0)))

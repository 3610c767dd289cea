"""Patients with real vertebrae: the mean lumbar shapes of shared/data, warped and bent anew for every seed, in simulated soft tissue."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage
from scipy.spatial.transform import Rotation

from AIFReconLib.evaluation.surface import distance_from_labels
from AIFReconLib.geometry.solid import inside_of_surface
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.io.volume.models import read_model
from AIFReconLib.simulation.anatomy import LumbarAnatomy, soft_tissue_of
from AIFReconLib.simulation.soft_tissue import SoftTissue

from .patients import data_folder

LEVELS = ("L2", "L3", "L4", "L5")

SPACING = 0.6
"""mm between voxels of labels and distances."""

SKIN_TO_TIP = 12.0
"""mm from the skin to the hindmost spinous process."""

WARP, WARP_LENGTH, SCALE, BEND_DEG = 1.5, 30.0, 0.06, 3.0
"""mm (standard deviation) and mm (wavelength, about) of the smooth warp, standard deviation of the sizes along three axes, and largest
change of the posture at each disc."""


@dataclass(frozen=True, eq=False)
class LumbarShapes:
    """A patient of real shape: what `LumbarPhantom` has, in Reference (RAS, mm, the origin on the skin)."""

    labels: Volume
    bone_distance: Volume
    soft_tissue: SoftTissue
    tips: np.ndarray
    ct_to_reference: np.ndarray = field(default_factory=lambda: np.eye(4))

    def skin_y(self, x: ArrayLike, z: ArrayLike) -> np.ndarray:
        """y of the skin at (x, z), mm."""
        return self.soft_tissue.skin_y(x, z)

    def scattering_db(self, points_reference: np.ndarray, beams_reference: np.ndarray) -> np.ndarray:
        """Strength of the echo of soft tissue."""
        return self.soft_tissue.scattering_db(points_reference, beams_reference)

    def spinous_tips(self) -> np.ndarray:
        """Hindmost point of each vertebra in Reference, (4, 3), mm."""
        return self.tips


@cache
def _means(folder: Path) -> list[tuple[np.ndarray, np.ndarray]]:
    models = [read_model(folder / f"{level}.stl") for level in LEVELS]
    return [(model.points, model.triangles) for model in models]


def lumbar_shapes(seed: int, warp: float = WARP, spacing: float = SPACING) -> LumbarShapes:
    """The patient of a seed; 0 with `warp` 0 is the mean shape as it is."""
    rng = np.random.default_rng([seed, 50])
    means = _means(data_folder("lumbar-shape"))
    points = [vertices.copy() for vertices, _ in means]
    if warp > 0:
        points = _bent(_warped(points, rng, warp), rng)
    every = np.concatenate(points)
    tips = np.array([one[one[:, 1].argmin()] for one in points])
    middle = np.array([np.median(tips[:, 0]), tips[:, 1].min() - SKIN_TO_TIP, tips[:, 2].mean()])
    low, high = every.min(axis=0) - middle - 8.0, every.max(axis=0) - middle + 8.0
    grid = VoxelGrid.from_spacing(low, (np.ceil((high - low) / spacing).astype(int) + 1).tolist(), spacing)
    array = np.zeros(grid.shape, np.uint8)
    for number, (one, (_, triangles)) in enumerate(zip(points, means, strict=True), 1):
        array[(array == 0) & inside_of_surface(one - middle, triangles, grid)] = number
    labels = Volume(array, grid.ijk_to_reference)
    anatomy = LumbarAnatomy(seed=seed, vertebrae=4, skin_to_lamina=45.0, lordosis_deg=1.0)
    distance = distance_from_labels(labels)
    return LumbarShapes(labels, distance, soft_tissue_of(anatomy), tips - middle)


def _warped(points: list[np.ndarray], rng: np.random.Generator, warp: float) -> list[np.ndarray]:
    """The vertices under a smooth random displacement of the whole spine, and other sizes along its axes."""
    every = np.concatenate(points)
    first = every.min(axis=0) - WARP_LENGTH
    size = np.ceil((np.ptp(every, axis=0) + 2 * WARP_LENGTH) / (WARP_LENGTH / 4)).astype(int) + 1
    noise = ndimage.gaussian_filter(rng.standard_normal((3, *size)), (0, 1.6, 1.6, 1.6))
    noise *= warp / noise.std(axis=(1, 2, 3), keepdims=True)
    sizes = 1.0 + SCALE * np.clip(rng.standard_normal(3), -2, 2)
    warped = []
    for one in points:
        at = (one - first).T / (WARP_LENGTH / 4)
        warped.append(sizes * (one + np.stack([ndimage.map_coordinates(axis, at, order=3) for axis in noise], axis=-1)))
    return warped


def _bent(points: list[np.ndarray], rng: np.random.Generator) -> list[np.ndarray]:
    """Every vertebra turned against the one below, about the middle between both: flexed and, less, to the sides and about its axis."""
    bent = [one.copy() for one in points]
    for upper in range(len(points) - 2, -1, -1):
        angles = np.radians(np.array([1.0, 0.4, 0.4]) * BEND_DEG * rng.uniform(-1, 1, 3))
        turn, about = Rotation.from_rotvec(angles).as_matrix(), (bent[upper].mean(axis=0) + bent[upper + 1].mean(axis=0)) / 2
        for above in range(upper + 1):
            bent[above] = (bent[above] - about) @ turn.T + about
    return bent

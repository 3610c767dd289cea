"""The phantom as a CT scanner shows it: Hounsfield units with partial volume and noise."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

from ..arrays import Reals, Singles
from ..geometry.volume import VoxelGrid
from .implicit_shapes import ellipse
from .soft_tissue import LIGAMENT_HALF_WIDTH, SKIN_THICKNESS, SoftTissue

CORTICAL_THICKNESS = 1.6
"""mm. Thin elements such as laminae come out mostly cortical, as they are."""

AIR, SKIN, FAT, MUSCLE, LIGAMENT = -1000.0, 10.0, -100.0, 52.0, 40.0
DISC, SAC, BLOOD, TRABECULAR, CORTICAL = 82.0, 18.0, 42.0, 210.0, 1050.0
"""HU, typical at 120 kV."""


def hounsfield_units(
    tissue: SoftTissue, grid_in_reference: VoxelGrid, bone_distance: Singles, noise: float, rng: np.random.Generator
) -> NDArray[np.int16]:
    """HU on a grid, [k, j, i] int16.

    Parameters
    ----------
    grid_in_reference : VoxelGrid
        Where the voxels are in Reference.
    bone_distance : [k, j, i] float32 array, mm
        Signed distance to bone on that grid.
    noise : float, HU
        Standard deviation, correlated over about a voxel as a soft kernel leaves it.
    """
    spacing = float(grid_in_reference.spacing.max())
    matrix = grid_in_reference.ijk_to_reference.astype(np.float32)
    i, j = (np.arange(n, dtype=np.float32) for n in grid_in_reference.size[:2])
    values = np.empty(grid_in_reference.shape, dtype=np.int16)
    for k in range(grid_in_reference.size[2]):
        x, y, z = (matrix[r, 0] * i[None, :] + matrix[r, 1] * j[:, None] + (matrix[r, 2] * k + matrix[r, 3]) for r in range(3))
        fibers, sheets = (tissue.sample_texture(kind, x, y, z) for kind in (0, 1))
        soft = _soft_tissue(tissue, x, y, z, fibers, sheets, spacing)
        distance = bone_distance[k]
        bone = _part_inside(distance, spacing)
        core = _part_inside(distance + CORTICAL_THICKNESS, spacing)
        solid = CORTICAL + (TRABECULAR + 35.0 * sheets - CORTICAL) * core
        hounsfield = soft + (solid - soft) * bone
        if noise > 0:
            grain = scipy.ndimage.gaussian_filter(rng.standard_normal(x.shape, dtype=np.float32), 0.6, mode="wrap")
            hounsfield = hounsfield + grain * np.float32(noise / grain.std())
        values[k] = np.clip(np.rint(hounsfield), -1024, 3071)
    return values


def _part_inside(distance: Reals, spacing: float) -> Reals:
    """How much of a voxel lies inside a surface, by its center's signed distance."""
    inside: Reals = np.clip(0.5 - distance / spacing, 0.0, 1.0)
    return inside


def _soft_tissue(tissue: SoftTissue, x: Singles, y: Singles, z: Singles, fibers: Singles, sheets: Singles, spacing: float) -> Reals:
    """HU without bone and noise, at points given by float32 arrays of one shape."""
    radius = np.hypot(y - np.float32(tissue.arc_center_y), z)
    depth = radius - np.float32(tissue.skin_radius) - tissue.skin_relief(x)
    forward = radius - np.float32(tissue.skin_radius + tissue.skin_to_lamina)
    fat = FAT + 9.0 * sheets
    muscle = MUSCLE + 5.0 * fibers - 60.0 * np.clip(fibers - 1.5, 0.0, 1.0)

    value = fat
    septum = np.abs(np.abs(x) - 22.0 - 0.35 * forward) < 0.9
    back_muscle = (depth > tissue.fat_depth(x)) & (forward < 21.0 - 0.004 * x * x) & ~(septum & (forward < 8.0))
    value = np.where(back_muscle, muscle, value)
    psoas = ellipse(np.abs(x) - 38.0, forward - tissue.body_center, 15.0, 21.0)
    quadratus = ellipse(np.abs(x) - 60.0, forward - 24.0, 13.0, 10.0)
    value = np.where(np.minimum(psoas, quadratus) < 0, muscle, value)
    value = np.where((np.abs(x) < LIGAMENT_HALF_WIDTH) & (forward < 0) & (depth > tissue.fat_depth(x)), LIGAMENT + 6.0 * sheets, value)

    aorta = np.hypot(x + 11.0, forward - tissue.body_center - tissue.body_radii[1] - 10.5) - 8.5
    vein = ellipse(x - 15.0, forward - tissue.body_center - tissue.body_radii[1] - 9.5, 11.0, 8.0)
    value = np.where(np.minimum(aorta, vein) < 0, BLOOD, value)

    canal = ellipse(x, forward - tissue.canal_center, *tissue.canal_radii)
    value = np.where(canal < 1.5, fat + 25.0, value)
    value = np.where(ellipse(x, forward - tissue.canal_center - 1.0, *(r - 2.0 for r in tissue.canal_radii)) < 0, SAC + 2.0 * fibers, value)
    angle = np.arctan2(z, y - np.float32(tissue.arc_center_y))
    column = (angle > tissue.body_angles[0]) & (angle < tissue.body_angles[1])
    disc = ellipse(x, forward - tissue.body_center, *tissue.body_radii)
    value = np.where((disc < 0) & column & (canal > 0), DISC + 8.0 * np.clip(disc / 4.0, -1.0, 0.0), value)
    skin = np.where(depth < SKIN_THICKNESS, SKIN, value)
    hounsfield: Reals = AIR + (skin - AIR) * _part_inside(-depth, spacing)
    return hounsfield

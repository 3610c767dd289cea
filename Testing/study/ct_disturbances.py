"""What CTs hold beside bone and soft tissue: noise, blur, a table under the back, a calcified aorta, contrast medium in the bowel."""

from __future__ import annotations

import numpy as np
import scipy

from AIFReconLib.geometry.volume import Volume
from AIFReconLib.simulation.anatomy import LumbarPhantom

SPACINGS = (0.8, 1.0, 1.25)
"""mm, by patient."""

BLUR = 0.45
"""mm. Standard deviation of a soft kernel's point spread, beside that of the voxels."""

NOISE = (15.0, 40.0)
"""HU, by patient."""

TABLE, TABLE_THICKNESS = 320.0, 2.5
CALCIUM, WALL, AORTA = 850.0, 1.6, 8.5
CONTRAST = (260.0, 480.0)
"""HU, mm, mm, and HU by patient."""


def disturbed_ct(phantom: LumbarPhantom, seed: int) -> Volume:
    """The phantom's CT with all of that, in its own frame; int16.

    The CT must have been made without noise of its own.
    """
    rng = np.random.default_rng([seed, 50])
    matrix = (phantom.ct_to_reference @ phantom.ct.ijk_to_reference).astype(np.float32)
    k, j, i = np.ogrid[tuple(slice(0, n) for n in phantom.ct.shape)]
    x, y, z = (matrix[r, 0] * i + matrix[r, 1] * j + matrix[r, 2] * k + matrix[r, 3] for r in range(3))
    tissue, values = phantom.soft_tissue, phantom.ct.array.astype(np.float32)
    bone = phantom.labels.array > 0
    spacing = float(phantom.ct.spacing.max())
    # The table: a shallow trough that the back touches where it is lowest
    skin = np.asarray(tissue.skin_y(np.linspace(-60, 60, 25)[:, None], np.linspace(z.min(), z.max(), 25)))
    top = float(skin.min()) - 0.0005 * x * x
    table = np.abs(y - (top - TABLE_THICKNESS / 2)) - TABLE_THICKNESS / 2
    values = _put(values, table, TABLE, spacing)
    forward = np.hypot(y - tissue.arc_center_y, z) - tissue.skin_radius - tissue.skin_to_lamina
    middle = tissue.body_center + tissue.body_radii[1] + 10.5
    across, along = x + 11.0, forward - middle
    wall = np.abs(np.hypot(across, along) - AORTA) - WALL / 2
    angle, turns = np.arctan2(along, across), z / 14.0
    plaques = np.sin(2 * angle + 1.3 * turns + rng.uniform(0, 6)) + np.sin(turns * 2.1 + rng.uniform(0, 6))
    values = np.where(bone | (plaques < 0.6), values, _put(values, wall, CALCIUM, spacing))
    level = rng.uniform(*CONTRAST)
    for side in (-1, 1):
        for _ in range(2):
            radii = rng.uniform(8.0, 12.0, 3)
            at = side * rng.uniform(38.0, 48.0), middle - rng.uniform(2.0, 10.0), rng.uniform(-25.0, 25.0)
            far = np.sqrt(((x - at[0]) / radii[0]) ** 2 + ((forward - at[1]) / radii[1]) ** 2 + ((z - at[2]) / radii[2]) ** 2)
            values = np.where(bone, values, _put(values, (far - 1) * radii.min(), level, spacing))
    values = scipy.ndimage.gaussian_filter(values, BLUR / phantom.ct.spacing[::-1])
    noise = scipy.ndimage.gaussian_filter(rng.standard_normal(values.shape, dtype=np.float32), 0.6)
    values += noise * np.float32(rng.uniform(*NOISE) / noise.std())
    return Volume(np.clip(np.rint(values), -1024, 3071).astype(np.int16), phantom.ct.ijk_to_reference)


def _put(values: np.ndarray, distance: np.ndarray, level: float, spacing: float) -> np.ndarray:
    """A shape with this signed distance filled with a value, the voxels at its surface in part."""
    return values + (level - values) * np.clip(0.5 - distance / spacing, 0.0, 1.0)

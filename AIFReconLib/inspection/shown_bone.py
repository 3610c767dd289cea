"""The bone that a reconstruction shows, as a smooth field for a surface in 3D: for display only, never for measuring."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Matrix, Numbers
from ..bone.field import BoneField
from ..compounding.state import Reconstruction
from ..errors import SettingsError
from ..geometry.box import block_sums
from ..geometry.transforms import invert, transform_points
from ..geometry.volume import Volume

CELL = 1.0
"""mm, about: voxels are averaged to this before anything else, for a view shows no more."""

SMOOTHING = 1.6
"""mm, sigma. Joins what neighboring frames show of one bone; what lies farther apart stays apart."""

LEAST_SEEN = 0.25
"""Of what is smoothed: where less was measured than this, the rest is not made up."""

LEVEL = 0.09
"""Of the field, where the surface is drawn."""

CRUMB = 150.0
"""mm3. Pieces that are smaller are hidden: about a square centimeter of surface."""

BRIGHT, STRONG = 99.5, 99.0
"""Percentiles of the measured voxels, of gray level and of mean weight, that count fully."""

STRONGER = 3.0
"""Times the weight of most voxels that counts fully at least: where no voxel has more weight than others, no bone shows."""

LOOKED_AT = 1_000_000
"""Voxels from which percentiles are taken, at most."""


@dataclass(frozen=True, eq=False)
class ShownBone:
    """Where bone shows."""

    field: Volume  #: float32. Above `LEVEL` is bone; without pieces below `CRUMB`.
    pieces: int
    hidden: int
    """Pieces that are shown, and crumbs that are not."""
    bone: BoneField | None = None  #: Of the CT
    bone_to_reference: Matrix | None = None  #: (4, 4)

    def distances(self, points_reference: Floats) -> Floats | None:
        """How far points (n, 3) lie from the CT's bone, (n,) mm; None without a CT."""
        if self.bone is None or self.bone_to_reference is None:
            return None
        distance, _slopes = self.bone.sample(transform_points(invert(self.bone_to_reference), points_reference))
        far: Floats = np.abs(distance)
        return far


def shown_bone(result: Reconstruction, labels: Volume | None = None, labels_to_reference: Matrix | None = None) -> ShownBone:
    """What a method that weights by bone shows of it.

    Raises SettingsError when score or hits were not kept.

    Parameters
    ----------
    result : Reconstruction
        With score and hits.
    labels : Volume of integers or None
        Of the CT, for `ShownBone.distances`.
    labels_to_reference : (4, 4) array, mm, or None

    Notes
    -----
    The field follows the score: per voxel it is the product of brightness and of the mean weight of the pixels that entered, beyond that
    of most voxels, both from 0 to 1. Smoothing is a normalized convolution [1]_ over measured voxels: one that no frame has met is no
    evidence against bone.

    References
    ----------
    .. [1] Knutsson and Westin (1993), Normalized and differential convolution, CVPR.
    """
    if result.score is None or result.hits is None:
        raise SettingsError("Input result must have score and hits; got one without. Ask for them: reconstruct(..., beside=BESIDE).")
    measured = result.hits.array > 0
    weight = np.zeros(measured.shape, dtype=np.float32)
    np.divide(result.score.array, result.hits.array, out=weight, where=measured)
    most, strong = _levels(weight, measured, (50.0, STRONG))
    strong = max(strong, STRONGER * most)
    (bright,) = _levels(result.intensity.array, measured, (BRIGHT,))
    brightness = result.intensity.array.astype(np.float32) * np.float32(1.0 / max(bright, 1e-9))
    weight = np.clip((weight - np.float32(most)) * np.float32(1.0 / max(strong - most, 1e-9)), 0.0, 1.0) * np.minimum(brightness, 1.0)
    spacing = result.grid.spacing
    factors = np.clip(np.floor(CELL / spacing + 0.5), 1, result.grid.size).astype(int)
    shown, seen = (block_sums(array, factors[::-1], np.float32) / np.float32(factors.prod()) for array in (weight, measured))
    sigma = (SMOOTHING / (spacing * factors))[::-1]
    shown, seen = (scipy.ndimage.gaussian_filter(array, sigma, mode="nearest") for array in (shown, seen))
    field = shown / np.maximum(seen, np.float32(LEAST_SEEN))
    pieces, count = scipy.ndimage.label(field > LEVEL, np.ones((3, 3, 3)))
    small = np.bincount(pieces.reshape(-1), minlength=count + 1) * float(np.prod(spacing * factors)) < CRUMB
    small[0] = False
    field[small[pieces]] = 0.0
    to_ijk = np.diag([*factors, 1.0])
    to_ijk[:3, 3] = (factors - 1) / 2
    hidden = int(small.sum())
    bone = None if labels is None else BoneField.from_labels(labels)
    place = np.eye(4) if labels_to_reference is None else labels_to_reference
    return ShownBone(Volume(field, result.grid.ijk_to_reference @ to_ijk), count - hidden, hidden, bone, place)


def _levels(array: Numbers, measured: Numbers, percents: tuple[float, ...]) -> list[float]:
    step = max(array.size // LOOKED_AT, 1)
    some = array.reshape(-1)[::step][measured.reshape(-1)[::step]]
    return [float(np.percentile(some, percent)) if some.size else 0.0 for percent in percents]

"""Bone echoes without images: rays sent into labeled bone until they meet it. Shares no code with the registration."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy import ndimage

from AIFReconLib.bone.echoes.found import SweepEchoes
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.simulation.anatomy import LumbarAnatomy, LumbarPhantom, make_lumbar_phantom
from AIFReconLib.simulation.morphometry import VertebraSizes

TILTS_DEG = ((0, 0), (25, 0), (-25, 0), (0, 15), (0, -15))
"""Of the rays, to the side and along the spine."""


class EqualLevels(LumbarAnatomy):
    """A spine of L3s: nothing but the place tells a vertebra from its neighbors."""

    def sizes_of(self, level: str, scale: float = 1.0) -> VertebraSizes:
        """Those of L3."""
        return super().sizes_of("L3", scale)


@lru_cache
def spine(seed: int = 0, vertebrae: int = 3, flexion_deg: float = 0.0) -> LumbarPhantom:
    """A spine whose CT lies in Reference as it is."""
    return make_lumbar_phantom(LumbarAnatomy.from_seed(seed, vertebrae), spacing=1.0, ct_flexion_deg=flexion_deg)


def spine_of_equal_levels() -> LumbarPhantom:
    """Four vertebrae that fit at each other's place."""
    return make_lumbar_phantom(EqualLevels(vertebrae=4, irregularity=0.0), spacing=1.0)


def ray_echoes(distance: Volume, pitch: float = 2.5, z_range=(-70.0, 70.0), depth: float = 70.0, noise: float = 0.0) -> SweepEchoes:
    """Where rays from behind (along +y, and tilted) first meet bone.

    Parameters
    ----------
    distance : Volume of float, mm
        Signed distance to bone, in Reference.
    z_range : (low, high), mm
        Part of the spine that is looked at.
    noise : float, mm
        Along each axis.
    pitch, depth : float, mm
        Between rays, and how far they go.
    """
    rng = np.random.default_rng(0)
    points, beams, frames = [], [], []
    xs, zs = np.meshgrid(np.arange(-28.0, 28.0, pitch), np.arange(z_range[0], z_range[1], pitch), indexing="ij")
    steps = np.arange(0.0, depth, 0.25)
    for side, along in TILTS_DEG:
        beam = np.array([np.tan(np.radians(side)), 1.0, np.tan(np.radians(along))])
        beam /= np.linalg.norm(beam)
        through = np.stack([xs.ravel(), np.full(xs.size, 30.0), zs.ravel()], axis=1)
        start = through - beam * ((through[:, 1] + 5.0) / beam[1])[:, None]
        way = start[:, None] + steps[None, :, None] * beam
        to_ijk = np.linalg.inv(distance.ijk_to_reference)
        ijk = way.reshape(-1, 3) @ to_ijk[:3, :3].T + to_ijk[:3, 3]
        inside = ndimage.map_coordinates(distance.array, ijk.T[::-1], order=1, mode="constant", cval=6.0).reshape(way.shape[:2]) <= 0
        met = inside.any(axis=1)
        points.append(way[met, inside[met].argmax(axis=1)])
        beams.append(np.tile(beam, (int(met.sum()), 1)))
        frames.append(np.round(points[-1][:, 2]).astype(np.int64))
    met_at = np.concatenate(points)
    return SweepEchoes(
        met_at + noise * rng.standard_normal(met_at.shape), np.concatenate(beams), np.ones(len(met_at), np.float32), np.concatenate(frames)
    )

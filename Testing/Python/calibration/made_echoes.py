"""Bone echoes of a known spine and known image planes, without images: rays sent along the planes until they meet bone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from ray_echoes import spine
from scipy import ndimage
from scipy.spatial.transform import Rotation

from AIFReconLib.bone.field import BoneField
from AIFReconLib.calibration.echoes import Correction, ImagedEchoes, _angles, _PlaneTrack
from AIFReconLib.geometry.transforms import affine, transform_points
from AIFReconLib.simulation.scan import random_rigid

ANGLES = ((0, 0, 0), (25, 0, 0), (-25, 0, 0), (0, 15, 0), (0, -15, 0), (10, 10, 90))
"""Degrees: tilt within the image plane, out of it, and turn of the probe about its beam."""

FRAMES, RATE, SPACING = 12, 20.0, (0.2, 0.3)
"""Frames a pass, Hz, and mm: pixels that are higher than wide."""


def made_echoes(angles=ANGLES, seed: int = 0, noise: float = 0.1) -> ImagedEchoes:
    """What a pass along the spine and back shows at each of these angles; times tell one pass from the next."""
    distance = spine(seed).bone_distance
    rng = np.random.default_rng(seed)
    planes, points, frames = [], [], []
    times: list[float] = []
    for in_plane, out_of_plane, turn in angles:
        upright = Rotation.from_euler("YZX", [turn, -in_plane, out_of_plane], degrees=True).as_matrix()
        for way in (1, -1):
            start = times[-1] + 2.0 if times else 0.0
            for n, z in enumerate(np.linspace(-60.0, 60.0, FRAMES)[::way]):
                planes.append(affine(upright, np.array([0.0, 30.0, z]) - upright[:, 1] * 35.0 - upright[:, 0] * 30.0))
                times.append(start + n / RATE)
    across = np.arange(0.0, 60.0, 2.0)
    depths = np.arange(2.0, 75.0, 0.2)
    to_ijk = np.linalg.inv(distance.ijk_to_reference)
    for number, plane in enumerate(planes):
        grid = np.stack([*np.meshgrid(across, depths, indexing="ij"), np.zeros((len(across), len(depths)))], axis=-1)
        ijk = transform_points(to_ijk @ plane, grid.reshape(-1, 3))
        inside = ndimage.map_coordinates(distance.array, ijk.T[::-1], order=1, mode="constant", cval=6.0).reshape(grid.shape[:2]) <= 0
        met = inside.any(axis=1)
        points.append(grid[met, inside[met].argmax(axis=1)])
        frames.append(np.full(int(met.sum()), number))
    found = np.concatenate(points)
    found[:, 1] += noise * rng.standard_normal(len(found)) - 0.1
    every, stamps = np.array(planes), np.array(times)
    return ImagedEchoes(
        found,
        np.tile([0.0, 1.0, 0.0], (len(found), 1)),
        np.ones(len(found), np.float32),
        np.concatenate(frames),
        np.arange(len(planes)),
        stamps,
        every,
        np.zeros(len(planes), dtype=np.int64),
        _angles(every),
        (_PlaneTrack(stamps, every),),
        SPACING,
        (300, 250),
    )


def wrongly_calibrated(
    echoes: ImagedEchoes, shift: float, turn_deg: float, scale=(1.0, 1.0), delay: float = 0.0, seed: int = 0
) -> ImagedEchoes:
    """The same recording by a calibration that is shifted (mm) and turned, with pixels and poses that are wrong by this."""
    wrong = random_rigid(shift, turn_deg, np.random.default_rng(seed), echoes.center)
    late = echoes.tracks[0].at(echoes.times - delay) @ wrong
    return replace(
        echoes,
        points=echoes.points * [*scale, 1.0],
        planes=late,
        tracks=(_PlaneTrack(echoes.times, late),),
        spacing=(echoes.spacing[0] * scale[0], echoes.spacing[1] * scale[1]),
    )


def field(seed: int = 0) -> BoneField:
    """Of the spine, whose labels lie in Reference as they are."""
    return BoneField.from_labels(spine(seed).labels)


def misplaced(true: ImagedEchoes, echoes: ImagedEchoes, correction: Correction, labels_to_reference) -> np.ndarray:
    """mm by which each echo is placed beside where it is on the bone."""
    there = true.placed(Correction.none(true.center)).points
    here = transform_points(np.linalg.inv(labels_to_reference), echoes.placed(correction).points)
    return np.linalg.norm(here - there, axis=1)

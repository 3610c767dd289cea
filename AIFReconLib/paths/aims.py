"""Where lines begin and end: the skin that a probe was on, and the spinal canal between two vertebrae."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import scipy

from ..arrays import Floats, Mask, Matrix
from ..errors import GeometryError
from ..geometry.labels import Labels
from ..geometry.transforms import invert, pixel_spacing, transform_points
from ..imaging.beams import LINEAR
from ..recipe.recipe import Recipe
from ..remedies import Remedy
from ..resolve import Imaging, resolve_imaging
from ..sweep.frames import TrackedSequence
from ..sweep.joined import joined
from ..sweep.poses import sweep_poses

FACE = 1.0
"""mm along the beams within which pixels are the probe's face."""

FACE_POINTS = 16
"""Of each frame, along its face."""

PITCH = 1.0
"""mm between the places at which labels are asked for the canal."""

NARROWEST = 60.0
"""mm2 of a hole in a slice of a vertebra that may be its canal; those of vessels and of the segmentation are smaller."""


def skin_under(sequences: TrackedSequence | Iterable[TrackedSequence], recipe: Recipe | None = None) -> Floats:
    """Points on the skin: where the face of the probe was in each frame of one or more sweeps, (n, 3) mm in Reference.

    Raises AIFReconError when frames cannot be placed or beams not be told.
    """
    sequence, recipe = joined(sequences), recipe or Recipe()
    poses = sweep_poses(sequence, recipe.image_to_reference, recipe.reference)
    placed = poses.image_to_reference[poses.require_usable(sequence.name)]
    return faces_at(placed, resolve_imaging(sequence, poses, True, recipe), sequence.frame_size)


def faces_at(poses: Floats, imaging: Imaging, frame_size: tuple[int, int]) -> Floats:
    """Points of the probe's face, (n, 3) mm in Reference, at the poses of images of so many columns and rows, (frames, 4, 4)."""
    rows, columns = np.nonzero(imaging.region.mask(*frame_size))
    x, y = pixel_spacing(poses[0])
    probe = imaging.known_probe()
    if probe.kind == LINEAR:
        depth, across = rows * y, columns * x
    else:
        right, down = (columns - probe.apex[0]) * x, (rows - probe.apex[1]) * y
        depth, across = np.hypot(right, down), np.arctan2(right, down)
    face = np.flatnonzero(depth <= depth.min() + FACE)
    face = face[np.argsort(across[face])]
    face = face[np.unique(np.linspace(0, len(face) - 1, min(len(face), FACE_POINTS)).round().astype(int))]
    pixels = np.stack([columns[face], rows[face], np.zeros(len(face))], axis=1).astype(np.float64)
    return np.concatenate([transform_points(pose, pixels) for pose in poses])


def canal_between(labels: Labels, level: str, labels_to_reference: Matrix | None = None) -> Floats:
    """The middle of the spinal canal between two vertebrae, (3,) mm in Reference.

    Raises GeometryError when `level` does not name two labels, as L3-L4 does, or a vertebra shows no canal.

    Notes
    -----
    In slices across the line through the centers of both vertebrae the canal is the largest hole in each. The answer lies half-way between
    the middles of their holes.
    """
    upper, lower = _two(labels, level)
    place = labels.ijk_to_reference if labels_to_reference is None else labels_to_reference @ labels.ijk_to_reference
    bones = [transform_points(place, np.argwhere(labels.array == number)[:, ::-1].astype(np.float64)) for number in (upper, lower)]
    along = bones[1].mean(axis=0) - bones[0].mean(axis=0)
    turn = np.linalg.svd(along[None])[2]
    middles = []
    for number, points in zip((upper, lower), bones, strict=True):
        low, high = (points @ turn.T).min(axis=0) - 2 * PITCH, (points @ turn.T).max(axis=0) + 2 * PITCH
        to_reference = np.eye(4)
        to_reference[:3] = np.column_stack([PITCH * turn.T, turn.T @ low])
        to_labels, shape = invert(place) @ to_reference, tuple(np.ceil((high - low) / PITCH).astype(int) + 1)
        mask = (labels.array == number).astype(np.uint8)
        bone = scipy.ndimage.affine_transform(mask, to_labels[:3, :3][::-1], to_labels[:3, 3][::-1], shape, order=0) > 0
        holes = [(k, _largest_hole(bone[k])) for k in range(len(bone))]
        canal = [np.insert(np.argwhere(hole), 0, k, axis=1) for k, hole in holes if hole is not None]
        if not canal:
            raise GeometryError(f"The canal of {labels.called(number)} is not closed by its bone in the labels.", Remedy.AIM_AT_A_POINT)
        middles.append(transform_points(to_reference, np.concatenate(canal).mean(axis=0)))
    middle: Floats = (middles[0] + middles[1]) / 2
    return middle


def _two(labels: Labels, level: str) -> tuple[int, int]:
    """The numbers of the labels that a level names."""
    there = {name.lower(): number for number, name in labels.names.items()} | {str(number): number for number in labels.numbers().tolist()}
    words = level.lower().split("-")
    for cut in range(1, len(words)):
        one, other = ("-".join(some).strip() for some in (words[:cut], words[cut:]))
        if one in there and other in there and one != other:
            return there[one], there[other]
    raise GeometryError(f"Input target must be a point X Y Z, or two labels as in L3-L4; got {level!r}. There are {labels.in_words()}.")


def _largest_hole(bone: Mask) -> Mask | None:
    holes, count = scipy.ndimage.label(scipy.ndimage.binary_fill_holes(bone) & ~bone)
    sizes = np.bincount(holes.reshape(-1), minlength=count + 1)[1:] * PITCH**2
    return None if not count or sizes.max() < NARROWEST else holes == sizes.argmax() + 1

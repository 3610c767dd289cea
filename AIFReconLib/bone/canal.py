"""Where the spinal canal is: the hole in the vertebrae of a segmentation."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Matrix
from ..errors import GeometryError
from ..geometry.labels import Labels
from ..geometry.transforms import invert, transform_points
from ..geometry.volume import Volume

PITCH = 1.0
"""mm between the places at which labels are asked for the canal."""

NARROWEST = 60.0
"""mm2 of a hole in a slice of a vertebra that may be its canal; those of vessels and of the segmentation are smaller."""


def canal_between(labels: Labels, level: str, labels_to_reference: Matrix | None = None) -> Floats:
    """The middle of the spinal canal between two vertebrae, (3,) mm in Reference.

    Raises GeometryError when `level` does not name two labels, as L3-L4 does, or a vertebra shows no canal.

    Notes
    -----
    In slices across the line through the centers of both vertebrae the canal is the largest hole in each. The answer lies half-way between
    the middles of their holes.
    """
    pair = _two(labels, level)
    bones = [_Bone(labels if labels_to_reference is None else labels.placed_by(labels_to_reference), number) for number in pair]
    middles = []
    for number, bone in zip(pair, bones, strict=True):
        middle = bone.canal(bones[1].center - bones[0].center)
        if middle is None:
            raise GeometryError(
                f"The canal of {labels.called(number)} is not closed by its bone in the labels.", "Give a point X Y Z as {target}."
            )
        middles.append(middle)
    between: Floats = np.mean(middles, axis=0)
    return between


def canals_of(labels: Volume, numbers: Integers) -> Floats:
    """From the middle of the canal of each of these vertebrae to that of the next one, (n, 2, 3) mm; without those that show no canal."""
    given = labels if isinstance(labels, Labels) else Labels(labels.array, labels.ijk_to_reference)
    bones = [_Bone(given, int(number)) for number in numbers if int(number) in given.boxes]
    canals: list[list[Floats]] = []
    if len(bones) > 1:
        centers = np.array([bone.center for bone in bones])
        axis = np.linalg.svd(centers - centers.mean(axis=0))[2][0]
        for one, other in pairwise(bones[n] for n in np.argsort(centers @ axis)):
            begin, end = (bone.canal(other.center - one.center) for bone in (one, other))
            if begin is not None and end is not None:
                canals.append([begin, end])
    return np.array(canals).reshape(-1, 2, 3)


class _Bone:
    """One vertebra of labels that lie in Reference."""

    def __init__(self, labels: Labels, number: int):
        box = labels.boxes[number]
        self._bone = (labels.array[box] == number).astype(np.uint8)
        place = labels.ijk_to_reference.copy()
        place[:3, 3] = transform_points(place, np.array([part.start for part in box[::-1]], dtype=np.float64))
        self._to_ijk = invert(place)
        self._points = transform_points(place, np.argwhere(self._bone)[:, ::-1].astype(np.float64))
        self.center: Floats = self._points.mean(axis=0)

    def canal(self, along: Floats) -> Floats | None:
        """The middle of its canal, (3,) mm, looked for in slices across a direction; None where no slice has a hole as large."""
        turn = np.linalg.svd(along[None])[2]
        low, high = (self._points @ turn.T).min(axis=0) - 2 * PITCH, (self._points @ turn.T).max(axis=0) + 2 * PITCH
        axes = [np.arange(first, last + PITCH, PITCH) for first, last in zip(low, high, strict=True)]
        places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1) @ turn
        ijk = transform_points(self._to_ijk, places.reshape(-1, 3)).T[::-1]
        bone = scipy.ndimage.map_coordinates(self._bone, ijk, order=0).reshape(places.shape[:3]) > 0
        canal = [places[k][hole] for k in range(len(bone)) if (hole := _largest_hole(bone[k])) is not None]
        return np.concatenate(canal).mean(axis=0) if canal else None


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

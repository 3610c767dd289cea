"""Each bone on its own: a patient lies for the CT and bends for the scan, so every vertebra gets a rigid motion, held to its neighbors.

References
----------
Gill S, Abolmaesumi P, Fichtinger G, Boisvert J, Pichora D, Borshneck D, Mousavi P (2012), Biomechanically constrained groupwise
ultrasound to CT registration of the lumbar spine, Medical Image Analysis 16:662-674: one rigid motion per vertebra, springs between
neighbors. Rasoulian A, Abolmaesumi P, Mousavi P (2012), Feature-based multibody rigid registration of CT and ultrasound images of lumbar
spine, Medical Physics 39:3154-3166: the same on points of the bone surface. The springs here are simpler than either's: points of the
disc should move alike.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Integers
from ..bone.echoes.found import SweepEchoes
from ..bone.field import BoneField
from ..geometry.transforms import invert, transform_points
from ..geometry.volume import Volume, VoxelGrid, nearest
from .agreement import Agreement
from .comparison import EchoFit, agreement_of, fit_echoes
from .refine import _Cost, minimized, vector_motion

SEGMENT_SCALES = (4.0, 2.0, 1.0)
"""mm. As `SCALES`."""

SEGMENT_ECHOES = 1800
"""Echoes that take part, of all bones together."""

SPRING = 8.0
"""mm by which points of a disc may move differently at the cost of one echo in ten that do not agree."""

DISC_ARM = 15.0
"""mm from the middle between two bones to the points that hold them together."""


@dataclass(frozen=True, eq=False)
class Segments:
    """Where each bone came to lie."""

    transforms: dict[int, Floats]  #: (4, 4) mm: labels_to_reference of each label
    agreement: Agreement  #: Of the bones in those places


def fields_of_labels(labels: Volume) -> dict[int, BoneField]:
    """The field of each label alone, in the order of their numbers."""
    return {int(label): BoneField.from_labels(labels, int(label)) for label in np.unique(labels.array) if label > 0}


def fit_segments(echoes: SweepEchoes, fields: dict[int, BoneField], labels_to_reference: Floats) -> Segments:
    """Let each label, with its field as `fields_of_labels` gives it, move on its own from a place that is about right for all.

    Minimized is the sum over the echoes of 1 - exp(-d^2 / 2 s^2), d an echo's distance to the bone that it belongs to, and over
    neighbors
    of one tenth of their echoes times the mean squared difference, in units of `SPRING`, by which six points about the middle between them
    move. An echo belongs to the bone nearest to it, anew at each scale. Neighbors are labels that follow each other.
    """
    numbers = list(fields)
    centers = np.array([fields[label].middle for label in numbers])
    places = {label: np.array(labels_to_reference, dtype=np.float64) for label in numbers}
    chosen = echoes.thinned(SEGMENT_ECHOES)
    for scale in SEGMENT_SCALES:
        # The label that each echo is nearest to
        distances = [fields[label].sample(transform_points(invert(places[label]), chosen.points))[0] for label in numbers]
        owners: Integers = np.array(numbers)[np.argmin(np.abs(distances), axis=0)]
        places = _moved_together(chosen, fields, places, owners, centers, scale)
    return Segments(places, _agreement(echoes, fields, places))


def _moved_together(
    echoes: SweepEchoes, fields: dict[int, BoneField], places: dict[int, Floats], owners: Integers, centers: Floats, scale: float
) -> dict[int, Floats]:
    """The places after all bones have moved to the optimum of one scale."""
    numbers = list(fields)
    costs = {label: _Cost(echoes[owners == label], fields[label], places[label]) for label in numbers if (owners == label).any()}
    pivots = {label: transform_points(places[label], center) for label, center in zip(numbers, centers)}
    for label, cost in costs.items():
        # Each bone turns about its own middle, not about its echoes', so that springs and echoes speak of the same motion
        cost.center, cost.lever = pivots[label], DISC_ARM
    pairs = list(itertools.pairwise(numbers))
    arms = DISC_ARM * np.concatenate([np.eye(3), -np.eye(3)])
    counts = [max(len(echoes) / len(numbers), 1.0)] * len(pairs)
    echo_count = sum((owners == label).sum() for label in costs)

    def discs(a: int, b: int) -> tuple[Floats, Floats]:
        """The six points between two bones, as each of them carries them: where they were in the labels' frame, in Reference now."""
        middle = (centers[numbers.index(a)] + centers[numbers.index(b)]) / 2
        return transform_points(places[a], middle + arms), transform_points(places[b], middle + arms)

    springs = [(a, b, *discs(a, b), math.sqrt(0.2 * count / len(arms)) / SPRING) for (a, b), count in zip(pairs, counts)]
    column = {label: slice(6 * n, 6 * n + 6) for n, label in enumerate(numbers)}

    def motion(vector: Floats, label: int) -> Floats:
        return vector_motion(vector[column[label]], pivots[label], DISC_ARM)

    def judged(vector: Floats) -> tuple[Floats, Floats]:
        rows, slopes = [], np.zeros((echo_count + 18 * len(springs), len(vector)))
        row = 0
        for label, cost in costs.items():
            distances, along = cost(vector[column[label]])
            rows.append(distances / scale)
            slopes[row : row + len(along), column[label]] = along / scale
            row += len(along)
        for a, b, of_a, of_b, stiffness in springs:
            apart = transform_points(motion(vector, a), of_a) - transform_points(motion(vector, b), of_b)
            rows.append(stiffness * apart.ravel())
            for label, points, sign in ((a, of_a, 1.0), (b, of_b, -1.0)):
                arm = transform_points(motion(vector, label), points) - pivots[label] - vector[column[label]][:3]
                block = np.zeros((len(points), 3, 6))
                block[:, :, :3] = np.eye(3)
                block[:, :, 3:] = np.cross(np.eye(3)[None], arm[:, None]).transpose(0, 2, 1) / DISC_ARM
                slopes[row : row + 3 * len(points), column[label]] = sign * stiffness * block.reshape(-1, 6)
            row += 3 * len(of_a)
        return np.concatenate(rows), slopes

    vector = minimized(judged, 6 * len(numbers), echo_count, 1e-4, 20)
    return {label: motion(vector, label) @ places[label] for label in numbers}


def _agreement(echoes: SweepEchoes, fields: dict[int, BoneField], places: dict[int, Floats]) -> Agreement:
    """As `check`, where every bone has its own place: an echo is judged by the bone nearest to it, and must not lie behind another."""
    fits = [fit_echoes(echoes, fields[label], places[label]) for label in fields]
    distances, reachable = (np.array([getattr(fit, name) for fit in fits]) for name in ("distances", "reachable"))
    mine = np.argmin(np.abs(distances), axis=0), np.arange(len(echoes))
    return agreement_of(EchoFit(distances[mine], reachable[mine]), np.array(list(fields))[mine[0]])


def placed_labels(labels: Volume, places: dict[int, Floats]) -> Volume:
    """The labels in Reference, each where its own labels_to_reference puts it, on voxels like theirs.

    The grid is the labels' own where the first place puts it, as large as all bones need. A voxel takes the label of the voxel nearest
    to where it came from; where two bones claim one, the later label.
    """
    base = labels.placed_by(next(iter(places.values())))
    boxes = scipy.ndimage.find_objects(labels.array.astype(np.int32))
    corners = {}
    for label, place in places.items():
        spans = [np.array([s.start - 1, s.stop]) for s in (boxes[label - 1] or ())[::-1]]
        ijk: Integers = np.array(np.meshgrid(*spans)).reshape(3, -1).T
        corners[label] = transform_points(base.grid.reference_to_ijk @ place @ labels.ijk_to_reference, ijk)
    low = np.floor(np.min([c.min(axis=0) for c in corners.values()], axis=0)).astype(int)
    high = np.ceil(np.max([c.max(axis=0) for c in corners.values()], axis=0)).astype(int)
    shift = np.eye(4)
    shift[:3, 3] = low
    grid = VoxelGrid(tuple(high - low + 1), base.ijk_to_reference @ shift)
    result = np.zeros(grid.shape, dtype=labels.array.dtype)
    for label, place in places.items():
        first = np.floor(corners[label].min(axis=0)).astype(int) - low
        last = np.ceil(corners[label].max(axis=0)).astype(int) - low
        k, j, i = np.meshgrid(*[np.arange(a, b + 1) for a, b in zip(first[::-1], last[::-1])], indexing="ij")
        to_labels = labels.grid.reference_to_ijk @ invert(place) @ grid.ijk_to_reference
        source = transform_points(to_labels, np.column_stack([i.ravel(), j.ravel(), k.ravel()]))
        mine = (nearest(labels, source) == label).reshape(k.shape)
        result[k[mine], j[mine], i[mine]] = label
    return Volume(result, grid.ijk_to_reference)

"""What is measured on real bone beside the metrics of `evaluate`: how much of what is bright is bone, and what a misplaced CT draws."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from AIFReconLib.evaluation.lines import values_at
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.surface import BoneSurface
from AIFReconLib.evaluation.visibility import BoneTruth
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume, nearest

THRESHOLDS = tuple(range(80, 251, 10))
"""Gray levels above which a voxel is bright, for the curve of precision against what is shown."""

BRIGHT = 180
"""The gray level that tables name."""

AROUND = 8.0
"""mm from the bone's surface within which voxels are judged: the next bone, which has no labels, is farther."""

ON_BONE = 1.5
"""mm from the surface within which a bright voxel is bone, and within which a point of the surface is shown."""

ELSEWHERE = 3.0
"""mm that a point of a misplaced CT's surface lies from the true one, at least, for what is bright there to be false bone."""

INCIDENCES = (0, 15, 30, 45, 60, 75, 85)
"""degrees between beam and normal, edges of the bins."""

BY_INCIDENCE = ("bone_cnr", "bone_coverage", "bone_thickness", "bone_localization_error")


def reached_points(truth: BoneTruth) -> np.ndarray:
    """Which points of the surface a beam reached, (n,) bool; all where no sweep is known."""
    return np.ones(len(truth.surface), dtype=bool) if truth.best_cosine is None else np.isfinite(truth.best_cosine)


def incidence(truth: BoneTruth) -> np.ndarray:
    """The best angle at which each point was met, (n,) degrees; NaN where none is known."""
    cosines = np.full(len(truth.surface), np.nan) if truth.best_cosine is None else truth.best_cosine
    return np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))


def precision(volume: Volume, truth: BoneTruth) -> dict[str, float]:
    """Of the voxels near bone that exceed each threshold: the shares on its surface, inside and outside; and the surface that is shown.

    Returns
    -------
    numbers : dict of str to float
        ``precision_180``, ``inside_180``, ``outside_180`` (0 to 1; NaN where nothing is bright) and ``shown_180``, the share of the area
        that beams reached with something so bright within `ON_BONE` along its normal.
    """
    bright = np.argwhere(volume.array > THRESHOLDS[0])
    places = transform_points(volume.ijk_to_reference, bright[:, ::-1].astype(np.float64))
    distance = nearest(truth.distance, transform_points(truth.distance.grid.reference_to_ijk, places), outside=np.inf)
    near = np.abs(distance) <= AROUND
    gray, distance = volume.array[tuple(bright[near].T)], distance[near]
    seen = reached_points(truth)
    areas = truth.surface.areas[seen]
    response = surface_response(volume, truth.surface.points_reference[seen], truth.surface.normals_reference[seen])
    numbers = {}
    for threshold in THRESHOLDS:
        those = distance[gray > threshold]
        shares = {"precision": np.abs(those) <= ON_BONE, "inside": those < -ON_BONE, "outside": those > ON_BONE}
        numbers.update({f"{name}_{threshold}": float(share.mean()) if those.size else float("nan") for name, share in shares.items()})
        numbers[f"shown_{threshold}"] = float(areas[response > threshold].sum() / areas.sum())
    return numbers


def surface_response(volume: Volume, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """The brightest gray level within `ON_BONE` of each surface point along its normal, (n,)."""
    offsets = np.arange(-ON_BONE, ON_BONE + 0.01, 0.25)
    return values_at(volume, points[:, None] + offsets[:, None] * normals[:, None]).max(axis=1)


def false_bone(volume: Volume, truth: BoneTruth, ct_error: np.ndarray) -> dict[str, float]:
    """What is bright where a misplaced CT alone expects bone: ``false_bone``, the share of that area, and ``false_area``, mm^2.

    Parameters
    ----------
    truth : BoneTruth
        In the right place, with the sweep's beams.
    ct_error : (4, 4) array, mm
        Reference -> Reference: where the CT was put instead.

    Notes
    -----
    The area is that of the misplaced surface whose points the beams reached where they truly are, and that lies `ELSEWHERE` or more
    from the true surface, inside bone or outside of it. Bright is above `BRIGHT` within `ON_BONE` along the normal.
    """
    seen = reached_points(truth)
    points = transform_points(ct_error, truth.surface.points_reference[seen])
    normals, areas = truth.surface.normals_reference[seen] @ ct_error[:3, :3].T, truth.surface.areas[seen]
    distance = nearest(truth.distance, transform_points(truth.distance.grid.reference_to_ijk, points), outside=np.inf)
    elsewhere = np.abs(distance) >= ELSEWHERE
    area = float(areas[elsewhere].sum())
    if area == 0.0:
        return {"false_bone": float("nan"), "false_area": 0.0}
    bright = surface_response(volume, points[elsewhere], normals[elsewhere]) > BRIGHT
    return {"false_bone": float(areas[elsewhere][bright].sum()) / area, "false_area": area}


def by_incidence(volume: Volume, truth: BoneTruth, mask: Volume) -> dict[str, float]:
    """The metrics of `evaluate` on the bone that was met best at each range of angles: ``bone_cnr_30`` from 30 degrees on."""
    angles = incidence(truth)
    numbers = {}
    for low, high in pairwise(INCIDENCES):
        within = (angles >= low) & (angles < high)
        found = evaluate(volume, restricted(truth, within), mask).to_dict() if within.any() else {}
        numbers.update({f"{name}_{low}": found.get(name, float("nan")) for name in (*BY_INCIDENCE, "bone_area")})
    return numbers


def restricted(truth: BoneTruth, points: np.ndarray) -> BoneTruth:
    """A truth of some of its surface points only, (n,) bool."""
    surface = truth.surface
    part = BoneSurface(surface.points_reference[points], surface.normals_reference[points], surface.areas[points], surface.labels[points])
    best = None if truth.best_cosine is None else truth.best_cosine[points]
    return BoneTruth(part, truth.distance, truth.border[points], best, truth.shadows)

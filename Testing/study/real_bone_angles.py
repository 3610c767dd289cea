"""How bright real bone is by the angle at which a beam meets it, and what is left in its shadow: peaks traced in the frames themselves.

Poses are good to about 1 mm, so profiles at the CT's surface would blur what is thinner. The trace follows the echo within `BAND` of where
the CT lies, and does the same farther up, where there is no bone: what it finds there is what tracing alone makes of speckle.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np
from measured import table
from scipy import ndimage
from scipy.spatial import cKDTree

from AIFReconLib.evaluation.visibility import BoneTruth
from AIFReconLib.geometry.transforms import invert, transform_points
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.ultrasound import UltrasoundEffects, simulate_frame
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

from .flat_bone import DEPTH, FlatBone, excess, simulated_profiles

ANGLES = (0, 10, 20, 30, 40, 50, 60, 70, 80)
"""degrees between beam and normal, edges of the bins."""

BAND = 2.0
"""mm before and behind the CT's surface within which an echo is bone's."""

ELSEWHERE = 6.0
"""mm before the surface about which the same is traced where there is no bone."""

STEP = 4
"""Columns from one traced scan line to the next."""

BEND = 2
"""Pixels of depth by which an echo may leave the CT's course from one of these to the next."""

TISSUE = (3.0, 8.0)
"""mm before the echo: the tissue that it is held against."""

SHADOW = ((2.0, 4.0), (4.0, 6.0), (6.0, 8.0), (8.0, 10.0), (10.0, 12.0), (12.0, 14.0), (14.0, 16.0))
"""mm behind the echo."""

SQUARE = 20.0
"""degrees up to which an echo counts as met squarely, when others are given as shares of it."""

FEWEST = 50
"""Scan lines from which a range of angles is told."""


@dataclass(frozen=True, eq=False)
class Echoes:
    """One echo a scan line, (n,) each, in gray levels; a shadow's levels and deviations are (n, len(SHADOW)), NaN past the image."""

    angle: np.ndarray
    peak: np.ndarray
    elsewhere: np.ndarray
    tissue: np.ndarray
    tissue_deviation: np.ndarray
    shadow: np.ndarray
    shadow_deviation: np.ndarray


def traced_echoes(sequence: TrackedSequence, truth: BoneTruth, every: int = 1) -> Echoes:
    """The echoes of all scan lines of a linear probe that enter the CT's bone, in one of so many frames."""
    poses = sweep_poses(sequence)
    points = cKDTree(truth.surface.points_reference)
    found = []
    for number in poses.usable[::every]:
        image = np.asarray(sequence.images[number], dtype=np.float32)
        each = _of_frame(truth, points, image, poses.image_to_reference[number])
        if each is not None:
            found.append(each)
    return Echoes(*(np.concatenate([getattr(each, one.name) for each in found]) for one in fields(Echoes)))


def _of_frame(truth: BoneTruth, points: cKDTree, image: np.ndarray, image_to_reference: np.ndarray) -> Echoes | None:
    pitch = float(np.linalg.norm(image_to_reference[:3, 1]))
    columns, rows = np.arange(0, image.shape[1], STEP), np.arange(len(image))
    pixels = np.stack(np.broadcast_arrays(columns[:, None], rows, 0.0), axis=-1).reshape(-1, 3)
    ijk = transform_points(truth.distance.grid.reference_to_ijk @ image_to_reference, pixels)
    distance = ndimage.map_coordinates(truth.distance.array, ijk.T[::-1], order=1, cval=12.0).reshape(len(columns), len(rows))
    surface = (distance <= 0).argmax(axis=1)
    reach, above = round(BAND / pitch), round((ELSEWHERE + BAND + TISSUE[1]) / pitch)
    met = (distance <= 0).any(axis=1) & (surface >= above) & (surface < len(image) - reach - round(SHADOW[0][1] / pitch))
    if met.sum() < 2:
        return None
    columns, surface = columns[met], surface[met]
    at = transform_points(image_to_reference, np.stack([columns, surface, np.zeros(len(columns))], axis=1))
    beam = image_to_reference[:3, 1] / pitch
    cosine = -truth.surface.normals_reference[points.query(at)[1]] @ beam
    profiles = ndimage.uniform_filter1d(image, max(round(0.3 / pitch), 1), axis=0)[:, columns]
    up = surface - round(ELSEWHERE / pitch)
    runs = np.split(np.arange(len(columns)), np.flatnonzero(np.diff(columns) != STEP) + 1)
    peak_at, other_at = (
        np.concatenate([_traced(image, columns[run], about[run], reach, pitch) for run in runs]) for about in (surface, up)
    )
    line = np.arange(len(columns))
    raw = image[:, columns]
    tissue, deviation = _levels(raw, peak_at, -TISSUE[1], -TISSUE[0], pitch)
    behind = [_levels(raw, peak_at, near, far, pitch) for near, far in SHADOW]
    shadow, shadow_deviation = (np.stack([each[n] for each in behind], axis=1) for n in (0, 1))
    angle = np.degrees(np.arccos(np.clip(cosine, 0.0, 1.0)))
    return Echoes(angle, profiles[peak_at, line], profiles[other_at, line], tissue, deviation, shadow, shadow_deviation)


def _traced(image: np.ndarray, columns: np.ndarray, about: np.ndarray, reach: int, pitch: float) -> np.ndarray:
    """Rows of the path of most echo over what follows it, at most `reach` away from `about`, by dynamic programming."""
    smooth = ndimage.gaussian_filter(image, 3)[:, columns]
    summed = np.cumsum(image[:, columns], axis=0)
    offsets, line = np.arange(-reach, reach + 1)[:, None], np.arange(len(columns))
    row = about + offsets
    near, far = (np.minimum(row + round(mm / pitch), len(image) - 1) for mm in (1.0, 6.0))
    score = smooth[row, line] - (summed[far, line] - summed[near, line]) / np.maximum(far - near, 1)
    best, origins = score[:, 0], []
    for column in range(1, len(columns)):
        moved = np.full((2 * BEND + 1, len(offsets)), -np.inf)
        for move in range(-BEND, BEND + 1):
            inside = slice(max(move, 0), len(offsets) + min(move, 0))
            moved[move + BEND, inside] = best[max(-move, 0) : len(offsets) - max(move, 0)]
        origins.append(moved.argmax(axis=0) - BEND)
        best = score[:, column] + moved.max(axis=0)
    path = [int(best.argmax())]
    for origin in reversed(origins):
        path.append(path[-1] - int(origin[path[-1]]))
    return about + np.array(path[::-1]) - reach


def _levels(lines: np.ndarray, row: np.ndarray, near: float, far: float, pitch: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean and deviation of each line from `near` to `far` mm behind its row; NaN where the image ends before."""
    places = row + np.arange(round(near / pitch), round(far / pitch) + 1)[:, None]
    values = lines[np.clip(places, 0, len(lines) - 1), np.arange(lines.shape[1])].astype(np.float64)
    values[:, (places < 0).any(axis=0) | (places >= len(lines)).any(axis=0)] = np.nan
    return values.mean(axis=0), values.std(axis=0)


def angle_rows(echoes: Echoes) -> list[dict[str, float]]:
    """Per range of `ANGLES` with enough lines: their number, mean gray levels, and the echo over tissue as a share of that met squarely."""
    square = echoes.angle < SQUARE
    real = float(np.nanmean(echoes.peak[square] - echoes.tissue[square]))
    simulated, rows = excess(simulated_profiles(SQUARE / 2)), []
    for low, high in pairwise(ANGLES):
        those = (echoes.angle >= low) & (echoes.angle < high)
        if those.sum() < FEWEST:
            continue
        middle = (low + high) / 2
        row = {"low": low, "high": high, "middle": middle, "lines": int(those.sum()), "cosine": float(np.cos(np.radians(middle)))}
        row |= {name: float(np.nanmean(getattr(echoes, name)[those])) for name in ("peak", "elsewhere", "tissue")}
        row |= {f"peak_{part}": float(np.nanpercentile(echoes.peak[those], part)) for part in (25, 75)}
        share = excess(simulated_profiles(middle)) / simulated
        rows.append({**row, "share": (row["peak"] - row["tissue"]) / real, "simulated": share})
    return rows


def shadow_rows(echoes: Echoes) -> list[dict[str, float]]:
    """Per stretch of `SHADOW`: mean gray level behind bone, deviation along the line, and simulated levels without and with clutter."""
    courses = [_simulated_shadow(UltrasoundEffects(clutter=clutter)) for clutter in (False, True)]
    gray, deviation = (np.nanmean(each, axis=0).tolist() for each in (echoes.shadow, echoes.shadow_deviation))
    columns = zip(*zip(*SHADOW, strict=True), gray, deviation, *courses, strict=True)
    return [dict(zip(("near", "far", "gray", "deviation", "black", "clutter"), row, strict=True)) for row in columns]


def _simulated_shadow(effects: UltrasoundEffects) -> list[float]:
    """Mean gray levels behind a simulated flat bone that is met squarely, in the middle of the image."""
    probe = PhasedArray()
    image = simulate_frame(FlatBone(), probe, probe.probe_to_reference(np.eye(4)), np.random.default_rng(1), effects)
    to_image, middle, half = invert(probe.image_to_transducer), probe.columns // 2, round(8.0 / probe.pixel_spacing)
    rows = [[round(to_image[1, 1] * (DEPTH + mm) + to_image[1, 3]) for mm in stretch] for stretch in SHADOW]
    return [float(image[first:last, middle - half : middle + half].mean()) for first, last in rows]


HEAD = (
    "degrees",
    "scan lines",
    "echo",
    "quartiles",
    "tissue",
    "traced 6 mm before",
    "echo over tissue, share",
    "cosine",
    "simulated share",
)
OF_SHADOW = ("mm behind", "gray level", "deviation along the line", "simulated, black", "simulated, with clutter")


def angle_tables(angles: list[dict[str, float]], shadows: list[dict[str, float]]) -> str:
    """Both as Markdown."""
    levels = "{low} to {high}|{lines}|{peak:.0f}|{peak_25:.0f} to {peak_75:.0f}|{tissue:.0f}|{elsewhere:.0f}|"
    of_angle = levels + "{share:.2f}|{cosine:.2f}|{simulated:.2f}"
    of_shadow = "{near:g} to {far:g}|{gray:.0f}|{deviation:.0f}|{black:.0f}|{clutter:.0f}"
    parts = (HEAD, of_angle, angles), (OF_SHADOW, of_shadow, shadows)
    return "\n\n".join(table(head, (form.format(**row).split("|") for row in rows)) for head, form, rows in parts)

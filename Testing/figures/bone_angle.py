"""Numbers of docs/decisions/0008: how bright bone is against the angle at which the beam meets it, in a real recording and simulated.

Run from anywhere: ``python Testing/figures/bone_angle.py``. The recording lies in AIFRECON_DATA_DIR, else in shared/data beside the
repository. Takes a minute.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy import ndimage
from scipy.signal import savgol_filter

from AIFReconLib.geometry.transforms import invert
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.ultrasound import UltrasoundEffects, simulate_frame

REPOSITORY = Path(__file__).resolve().parents[2]
DATA = Path(os.environ.get("AIFRECON_DATA_DIR") or REPOSITORY.parent / "shared" / "data")
PIXEL = 0.085
"""mm."""

FIRST, LAST, STEP = 182, 636, 2
"""Columns of the image that are traced."""

STEEPEST = 8
"""Pixels of depth that the trace may move from one traced column to the next."""

FOOT = 425
"""Row at which the bone's flank ends on other tissue."""

BINS = (0, 10, 20, 30, 40, 45, 50, 55, 60, 65, 70)
OFFSETS = np.arange(-3.0, 8.01, PIXEL)
"""mm before the surface, along its normal in the image."""

NEAR, TISSUE = np.abs(OFFSETS) <= 1.5, OFFSETS >= 3.0
MUSCLE_DB, DEPTH = 18.0, 32.0


@dataclass(frozen=True)
class FlatBone:
    """A plane of bone `DEPTH` mm below the face, turned in the image, in even tissue."""

    angle: float

    @property
    def bone_distance(self) -> Volume:
        grid = VoxelGrid.from_spacing((-70.0, -10.0, -30.0), (71, 61, 31), 2.0)
        _, j, i = np.indices(grid.shape)
        distance = -((2.0 * j - 10 - DEPTH) * np.cos(self.angle) + (2.0 * i - 70) * np.sin(self.angle))
        return Volume(np.clip(distance, -6, 6).astype(np.float32), grid.ijk_to_reference)

    def scattering_db(self, points_reference: np.ndarray, beams_reference: np.ndarray) -> np.ndarray:
        return np.full(points_reference.shape[:-1], MUSCLE_DB, dtype=np.float32)


def trace(image: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """The row of the bone surface in each column: the path of most echo less what follows it, by dynamic programming."""
    echo = ndimage.gaussian_filter(image, 3)
    summed = np.cumsum(image, axis=0)
    start = np.minimum(np.arange(len(image)) + round(1 / PIXEL), len(image) - 1)
    stop = np.minimum(start + round(6 / PIXEL), len(image) - 1)
    score = echo - (summed[stop] - summed[start]) / np.maximum(stop - start, 1)[:, None]
    score[: round(18 / PIXEL)] = score[480:] = -50
    score = score[:, columns]
    best, origins = score[:, 0].copy(), []
    for column in range(1, len(columns)):
        moved = np.full((2 * STEEPEST + 1, len(image)), -1e9)
        for move in range(-STEEPEST, STEEPEST + 1):
            inside = slice(max(move, 0), len(image) + min(move, 0))
            moved[move + STEEPEST, inside] = best[max(-move, 0) : len(image) - max(move, 0)] - 0.4 * abs(move)
        origins.append(moved.argmax(axis=0))
        best = moved.max(axis=0) + score[:, column]
    path = [int(best.argmax())]
    for origin in reversed(origins):
        path.append(path[-1] - (origin[path[-1]] - STEEPEST))
    return np.array(path[::-1], float)


def real_profiles() -> tuple[np.ndarray, np.ndarray]:
    """Angles in the image (n,), degrees, and profiles (n, offsets) of the real bone."""
    columns = np.arange(FIRST, LAST, STEP)
    angles, profiles = [], []
    for image in np.asarray(read_sequence(DATA / "BoneUltrasound_L14.igs.mha").images, dtype=np.float32):
        rows = trace(image, columns)
        slope = savgol_filter(rows, 31, 3, deriv=1, delta=STEP)
        foot = np.flatnonzero(rows > FOOT)
        kept = np.arange(10, min(foot[0] - 4 if foot.size else len(rows), len(rows) - 10))
        across, down = -slope[kept, None] / np.hypot(1, slope[kept, None]), 1 / np.hypot(1, slope[kept, None])
        x, y = columns[kept, None] - across * OFFSETS / PIXEL, rows[kept, None] - down * OFFSETS / PIXEL
        values = ndimage.map_coordinates(image, [y, x], order=1)
        values[(x < FIRST) | (x > LAST)] = np.nan
        angles.append(np.degrees(np.arctan(np.abs(slope[kept]))))
        profiles.append(values)
    return np.concatenate(angles), np.concatenate(profiles)


def simulated_profiles(angle_deg: float, frames: int = 4) -> np.ndarray:
    """Profiles (n, offsets) of a simulated flat bone met at this angle in the middle of the image."""
    probe, angle = PhasedArray(), np.radians(angle_deg)
    to_image = invert(probe.image_to_transducer)
    along = np.arange(-6.0, 6.01)[:, None] * np.cos(angle)
    x, y = along - OFFSETS * np.sin(angle), DEPTH - along * np.tan(angle) - OFFSETS * np.cos(angle)
    pixels = [to_image[1, 1] * y + to_image[1, 3], to_image[0, 0] * x + to_image[0, 3]]
    pose, rng = probe.probe_to_reference(np.eye(4)), np.random.default_rng(1)
    images = (simulate_frame(FlatBone(angle), probe, pose, rng, UltrasoundEffects()) for _ in range(frames))
    return np.concatenate([ndimage.map_coordinates(image.astype(float), pixels, order=1) for image in images])


def excess(profiles: np.ndarray) -> tuple[float, float, float]:
    """Gray levels of the mean profile's peak and of the tissue before it, and the mean peak over the tissue's standard deviation."""
    tissue = profiles[:, TISSUE]
    spread = np.nanstd(tissue - np.nanmean(tissue, axis=1, keepdims=True))
    mean = float(np.nanmean(tissue))
    return float(np.nanmean(profiles, axis=0)[NEAR].max()), mean, float((profiles[:, NEAR].max(axis=1).mean() - mean) / spread)


def main() -> None:
    """Print a line per range of angles."""
    angles, profiles = real_profiles()
    usable = np.isfinite(profiles).mean(axis=1) > 0.8
    usable &= np.isfinite(profiles[:, NEAR]).all(axis=1)
    first = None
    print("angle, degrees   real: n, peak, tissue, of square, CNR   simulated: peak, tissue, of square, CNR")
    for low, high in pairwise(BINS):
        chosen = profiles[usable & (angles >= low) & (angles < high)]
        real, model = excess(chosen), excess(simulated_profiles((low + high) / 2))
        first = first or (real[0] - real[1], model[0] - model[1])
        shares = (real[0] - real[1]) / first[0], (model[0] - model[1]) / first[1]
        print(
            f"{low:2d} to {high:2d}   {len(chosen):4d} {real[0]:5.0f} {real[1]:4.0f} {shares[0]:5.2f} {real[2]:5.1f}"
            f"   {model[0]:5.0f} {model[1]:4.0f} {shares[1]:5.2f} {model[2]:5.1f}"
        )


if __name__ == "__main__":
    main()

"""Simulated bone that is flat, met at any angle: what the curves of real bone by the angle are held against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from AIFReconLib.geometry.transforms import invert
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.ultrasound import UltrasoundEffects, simulate_frame

PIXEL = 0.085
"""mm."""

OFFSETS = np.arange(-3.0, 8.01, PIXEL)
"""mm before the surface, along its normal in the image."""

NEAR, TISSUE = np.abs(OFFSETS) <= 1.5, OFFSETS >= 3.0
MUSCLE_DB, DEPTH = 18.0, 32.0


@dataclass(frozen=True)
class FlatBone:
    """A flat bone `depth` mm below the face along +y, turned by `angle_deg` in the image or out of it ("elevational"), in even tissue."""

    depth: float = DEPTH
    angle_deg: float = 0.0
    axis: str = "in-plane"
    tissue_db: float = MUSCLE_DB

    @property
    def bone_distance(self) -> Volume:
        grid = VoxelGrid.from_spacing((-70.0, -10.0, -30.0), (71, 61, 31), 2.0)
        k, j, i = 2.0 * np.indices(grid.shape)
        side, angle = i - 70 if self.axis == "in-plane" else k - 30, np.radians(self.angle_deg)
        distance = -((j - 10 - self.depth) * np.cos(angle) + side * np.sin(angle))
        return Volume(np.clip(distance, -6, 6).astype(np.float32), grid.ijk_to_reference)

    def scattering_db(self, points_reference: np.ndarray, beams_reference: np.ndarray) -> np.ndarray:
        return np.full(points_reference.shape[:-1], self.tissue_db, dtype=np.float32)


def simulated_profiles(angle_deg: float, frames: int = 4) -> np.ndarray:
    """Profiles (n, offsets) of a simulated flat bone met at this angle in the middle of the image."""
    probe, angle = PhasedArray(), np.radians(angle_deg)
    to_image = invert(probe.image_to_transducer)
    along = np.arange(-6.0, 6.01)[:, None] * np.cos(angle)
    x, y = along - OFFSETS * np.sin(angle), DEPTH - along * np.tan(angle) - OFFSETS * np.cos(angle)
    pixels = [to_image[1, 1] * y + to_image[1, 3], to_image[0, 0] * x + to_image[0, 3]]
    pose, rng = probe.probe_to_reference(np.eye(4)), np.random.default_rng(1)
    images = (simulate_frame(FlatBone(angle_deg=angle_deg), probe, pose, rng, UltrasoundEffects()) for _ in range(frames))
    return np.concatenate([ndimage.map_coordinates(image.astype(float), pixels, order=1) for image in images])


def excess(profiles: np.ndarray) -> float:
    """Gray levels by which the peak of the mean profile exceeds the tissue before it."""
    return float(np.nanmean(profiles, axis=0)[NEAR].max() - np.nanmean(profiles[:, TISSUE]))

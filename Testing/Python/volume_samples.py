"""Volumes, and what is said about bad files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from AIFReconLib.errors import VolumeFormatError
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.volume.files import read_volume


def oblique_matrix(spacing=(0.5, 0.7, 1.1), mirrored: bool = False) -> np.ndarray:
    """A rotated, anisotropic ijk_to_reference, mm."""
    rotation, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    rotation *= np.linalg.det(rotation)
    if mirrored:
        rotation[:, 2] *= -1
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * spacing
    matrix[:3, 3] = (10.0, -20.0, 30.5)
    return matrix


def noise_volume(dtype="u1", mirrored: bool = False) -> Volume:
    array = np.random.default_rng(0).integers(0, 100, (7, 6, 5)).astype(dtype)
    return Volume(array, oblique_matrix(mirrored=mirrored))


def refusal(path: Path, read=read_volume, error=VolumeFormatError) -> str:
    with pytest.raises(error) as caught:
        read(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return message

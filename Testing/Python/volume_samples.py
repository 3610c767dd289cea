"""Volumes, and what is said about bad files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sweeps import rigid

from AIFReconLib.errors import VolumeFormatError
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.volume.files import read_volume


def oblique_matrix(spacing=(0.5, 0.7, 1.1), mirrored: bool = False) -> np.ndarray:
    """A rotated, anisotropic ijk_to_reference, mm."""
    return rigid((35.0, -60.0, 110.0), (10.0, -20.0, 30.5)) @ np.diag([*spacing[:2], -spacing[2] if mirrored else spacing[2], 1.0])


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

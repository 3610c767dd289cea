"""What a reconstruction really allocates, measured, against what it says it needs and what the project promises."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import pytest
from files import calibrated
from sweeps import sphere_bone

from AIFReconLib.compounding.methods.table import BONE_METHODS, METHODS
from AIFReconLib.compounding.state import bytes_per_voxel
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct

GRID = VoxelGrid.from_spacing((-24, -24, -24), (160, 160, 160), 0.3)
PROMISED = {"average": 10, "latest": 7, "maximum": 7}
"""Bytes a voxel of docs/performance.md; of the methods that read a bone map and here keep the cosine too: 32."""


@pytest.fixture(scope="module")
def sequence():
    return calibrated()


def per_voxel(sequence, settings, bone):
    """Bytes a voxel at the peak of a reconstruction, beside the frames and tables of one chunk, a few MB here."""
    settings = replace(settings, probe="linear", clip_px=(0,) * 4)
    # Compiling is done once and for all, and takes memory of its own
    reconstruct(sequence, settings, bone, VoxelGrid.from_spacing((-24, -24, -24), (8, 8, 8), 6.0), beside=())
    tracemalloc.start()
    try:
        reconstruct(sequence, settings, bone, GRID, beside=())
        return (tracemalloc.get_traced_memory()[1] - 8e6) / GRID.voxels
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("hole_limit", [0.0, 0.6])
@pytest.mark.parametrize("method", METHODS)
def test_a_reconstruction_stays_within_its_promised_memory(method, hole_limit, sequence):
    bone = sphere_bone() if method in BONE_METHODS else None
    taken = per_voxel(sequence, ReconstructionSettings(method=method, best_cosine=bone is not None, hole_limit=hole_limit), bone)
    assert taken <= (PROMISED[method] if bone is None else 32)
    assert taken <= 1.05 * bytes_per_voxel(method, bone is not None, bone is not None, whole=True, beside=(), output=1)


def test_weighted_takes_10_bytes_a_voxel_whatever_its_bone_map(sequence):
    assert per_voxel(sequence, ReconstructionSettings(method="weighted", holes="off"), sphere_bone()) <= 10

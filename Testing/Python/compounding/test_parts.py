"""A box worked in parts has the voxels of the box worked as a whole, to the last bit, and keeps within the memory that it is given."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sweeps import oblique_sequence, sphere_bone, turned_grid

from AIFReconLib.compounding.finishing.parts import Costs, cut_into_parts
from AIFReconLib.compounding.methods.table import LINEAR_METHODS, METHODS
from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.errors import InsufficientMemoryError
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.holes.filling import KINDS, HoleFilling
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.machine.threads import optional_module
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.workflows import reconstruct as workflow

ENGINES = ("numpy", "numba") if optional_module("AIFReconLib.compounding.compiled.numba_engine") else ("numpy",)
REGION = ImageRegion(ClipRectangle((1, 2), (31, 22)))
PLANES = 9
VOLUMES = ("intensity", "mask", "score", "hits", "cosine")


def sequence(seed, dtype=np.uint8):
    """A few frames, some of which miss the volume, or most of it."""
    made = oblique_sequence(seed, 6, 3.0, dtype)
    (pose,) = made.records[4].transforms.values()
    pose.matrix[:3, 3] += 500.0
    return made


def volumes_of(sweep, wanted, grid, cuts, monkeypatch, holes=(), **more):
    """All volumes, which frames were left out and what is said, of a box that is cut at these planes."""
    edges = [0, *sorted({cut for cut in cuts if 0 < cut < grid.size[2]}), grid.size[2]]
    with monkeypatch.context() as patched:
        patched.setattr(workflow, "cut_into_parts", lambda *_: list(itertools.pairwise(edges)))
        if holes:
            found = workflow.reconstructor_parts
            patched.setattr(workflow, "reconstructor_parts", lambda *given: _with_holes(found(*given), holes))
        result = reconstruct(
            sweep, replace(wanted, **imaging_fields(REGION, ProbeGeometry("sector", (16.0, -6.0)))), sphere_bone(), grid, **more
        )
    arrays = [None if (volume := getattr(result, name)) is None else volume.array for name in VOLUMES]
    return arrays, (result.skipped, result.frames_inserted, result.messages, result.hole_limit)


def _with_holes(parts, holes):
    object.__setattr__(parts, "holes", holes)
    return parts


@settings(max_examples=12)
@given(
    method=st.sampled_from(METHODS),
    engine=st.sampled_from(ENGINES),
    seed=st.integers(0, 10_000),
    turn=st.tuples(*[st.floats(-180, 180)] * 3),
    size=st.tuples(st.integers(1, 12), st.integers(1, 12)),
    cuts=st.lists(st.integers(1, PLANES - 1), min_size=1, max_size=PLANES - 1),
    output=st.sampled_from(["uint8", "float32"]),
    hole_limit=st.sampled_from([0.0, 2.5, "auto"]),
    linear=st.booleans(),
    dtype=st.sampled_from([np.uint8, np.float32]),
)
@example("weighted", ENGINES[-1], 3, (0.0, 0.0, 0.0), (12, 12), list(range(1, PLANES)), "uint8", "auto", False, np.uint8)
@example("weighted", ENGINES[-1], 5169, (0.0, 0.0, 0.0), (2, 1), [1, 4], "uint8", 0.0, False, np.uint8)
@example("average", ENGINES[-1], 4, (20.0, 30.0, 0.0), (12, 12), [1, 4], "uint8", 2.5, True, np.uint8)
def test_parts_have_the_voxels_of_the_whole(method, engine, seed, turn, size, cuts, output, hole_limit, linear, dtype):
    interpolation = "linear" if linear and method in LINEAR_METHODS else "nearest"
    wanted = ReconstructionSettings(
        method=method,
        engine=engine,
        output_type=output,
        hole_limit=hole_limit,
        interpolation=interpolation,
        best_cosine=interpolation == "nearest",
    )
    sweep, grid = sequence(seed, dtype), turned_grid((0.9, 1.1, 1.3), (*size, PLANES), turn)
    with pytest.MonkeyPatch.context() as patch:
        try:
            whole = volumes_of(sweep, wanted, grid, [], patch)
        except workflow.NoUsableFramesError:
            with pytest.raises(workflow.NoUsableFramesError):
                volumes_of(sweep, wanted, grid, cuts, patch)
            return
        np.testing.assert_equal(volumes_of(sweep, wanted, grid, cuts, patch), whole)


OTHERWISE = {**{kind: {} for kind in KINDS}, "moved": {"speed_of_sound": 1480.0}, "rejected": {"pixel_rejection": 90.0}}


@pytest.mark.parametrize("how", OTHERWISE)
def test_holes_as_plus_fills_them_and_pixels_that_move_or_are_left_out_are_those_of_the_whole(how, monkeypatch):
    holes = (HoleFilling(how, 5),) if how in KINDS else ()
    wanted = ReconstructionSettings(method="average", **OTHERWISE[how], **({"hole_limit": 0.0} if holes else {}))
    sweep, grid = sequence(5), turned_grid(size=(12, 11, PLANES))
    whole = volumes_of(sweep, wanted, grid, [], monkeypatch, holes)
    assert (whole[0][1] == 2).any()
    np.testing.assert_equal(volumes_of(sweep, wanted, grid, [2, 3, 7], monkeypatch, holes), whole)


COSTS = Costs(whole=28, results=2, part=28)


@settings(max_examples=60)
@given(size=st.tuples(*[st.integers(1, 400)] * 3), memory=st.integers(1, 10**9))
def test_parts_lie_side_by_side_and_keep_within_the_memory(size, memory):
    grid = VoxelGrid(size, np.eye(4))
    try:
        parts = cut_into_parts(grid, COSTS, memory)
    except InsufficientMemoryError:
        assert memory < math.prod(size) * COSTS.results + size[0] * size[1] * COSTS.part
        return
    assert [0, *(stop for _, stop in parts)] == [*(first for first, _ in parts), size[2]]
    largest = size[0] * size[1] * max(stop - first for first, stop in parts)
    assert len(parts) == 1 or math.prod(size) * COSTS.results + largest * COSTS.part <= memory
    assert (len(parts) == 1) == (math.prod(size) * COSTS.whole <= memory)


def test_a_box_of_more_voxels_than_can_be_numbered_is_cut_but_not_for_a_method_of_ones_own_that_looks_at_bone():
    assert len(cut_into_parts(VoxelGrid((2001, 1501, 751), np.eye(4)), COSTS, 10**12)) == 2
    with pytest.raises(InsufficientMemoryError, match="needs 28"):
        cut_into_parts(VoxelGrid((100, 100, 100), np.eye(4)), replace(COSTS, parts=False), 10**7)


def test_a_reconstruction_keeps_within_the_memory_that_it_is_given(monkeypatch):
    asked = []
    found = workflow.cut_into_parts
    monkeypatch.setattr(workflow, "cut_into_parts", lambda *given: asked.append(found(*given)) or asked[-1])
    sweep, grid = sequence(8), turned_grid(size=(12, 11, PLANES))
    wanted = ReconstructionSettings(method="weighted", **imaging_fields(REGION, ProbeGeometry("linear")))
    bone = {"bone": sphere_bone(), "grid": grid}
    little = reconstruct(sweep, wanted, **bone, beside=(), memory=2 * grid.voxels + 3 * 8 * 12 * 11)
    plenty = reconstruct(sweep, wanted, **bone)
    assert [len(parts) for parts in asked] == [3, 1]
    np.testing.assert_array_equal(little.intensity.array, plenty.intensity.array)

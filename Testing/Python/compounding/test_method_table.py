"""The table of methods: what is not in it gets nowhere, and what has no kernel is computed all the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sweeps import oblique_frames, sphere_bone, turned_grid

from AIFReconLib.compounding.engine import Job
from AIFReconLib.compounding.methods.table import _TABLE, BONE_METHODS, COMPARED_METHODS, METHODS, method_named
from AIFReconLib.compounding.numpy_engine import NumpyEngine
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.compounding.state import VoxelState, bytes_per_voxel
from AIFReconLib.errors import MethodError
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.recipe.recipe import ReconstructionSettings


def engine_for(name):
    state = VoxelState.empty(8, "average", best_cosine=False)
    state.method = name
    return NumpyEngine(Job(state, (2, 2, 2), (0, 2), ReconstructionSettings(), 255.0))


@pytest.mark.parametrize(
    "ask",
    [
        method_named,
        lambda name: VoxelState.empty(8, name, best_cosine=False),
        lambda name: bytes_per_voxel(name, map_on_grid=False, best_cosine=False),
        engine_for,
    ],
    ids=["table", "state", "memory", "engine"],
)
def test_a_name_that_is_not_in_the_table_is_refused_wherever_it_comes_in(ask):
    with pytest.raises(MethodError, match=r"Method brightest is not known. Choose one of average, latest"):
        ask("brightest")


def test_the_guide_names_the_methods_that_are_compared():
    page = (Path(__file__).resolve().parents[3] / "docs" / "slicer.md").read_text("utf-8")
    *names, last = (f"`{method}`" for method in COMPARED_METHODS)
    assert f"reconstructs the sweep with {', '.join(names)} and {last}" in page


def test_a_method_may_end_in_another_way_than_as_a_quotient(monkeypatch):
    monkeypatch.setitem(_TABLE, "average", replace(method_named("average"), finish=np.negative))
    reconstructor = Reconstructor(turned_grid(), ReconstructionSettings(method="average", hole_limit=0.0, output_type="float32"))
    reconstructor.insert([replace(frame, image=frame.image.astype(np.float32)) for frame in oblique_frames()])
    assert reconstructor.finish().intensity.array.min() < 0


@pytest.mark.parametrize("method", METHODS)
def test_a_method_without_a_kernel_is_computed_by_numpy(method, monkeypatch):
    compiled = pytest.importorskip("AIFReconLib.compounding.compiled.numba_engine").NumbaEngine
    bone, probe = sphere_bone() if method in BONE_METHODS else None, ProbeGeometry("linear")
    wanted = ReconstructionSettings(method=method)
    made = []
    for kernels in (compiled.methods, ()):
        monkeypatch.setattr(compiled, "methods", kernels)
        reconstructor = Reconstructor(turned_grid(), wanted, bone, probe=probe)
        reconstructor.insert(oblique_frames())
        made.append((reconstructor.engine, reconstructor.reconstruction().intensity.array))
    assert [engine for engine, _ in made] == ["numba", "numpy"]
    np.testing.assert_array_equal(made[0][1], made[1][1])

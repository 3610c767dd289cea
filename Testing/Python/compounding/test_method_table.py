"""The table of methods: what is not in it gets nowhere, and what has no kernel is computed all the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sweeps import oblique_frames, sphere_bone, turned_grid

from AIFReconLib.compounding.methods.table import BONE_METHODS, COMPARED_METHODS, METHODS
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.recipe.recipe import ReconstructionSettings


def test_the_guide_names_the_methods_that_are_compared():
    page = (Path(__file__).resolve().parents[3] / "docs" / "slicer.md").read_text("utf-8")
    *names, last = (f"`{method}`" for method in COMPARED_METHODS)
    assert f"reconstructs the sweep with {', '.join(names)} and {last}" in page


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

"""The benchmark: what it measures against is right, and what it prints is what it found. How fast anything is, no test asserts."""

from __future__ import annotations

import json

import numpy as np
import pytest
from sweeps import oblique_frames, sphere_bone, turned_grid

from AIFReconLib import benchmark as benchmark_module
from AIFReconLib.benchmark_cases import fan_sweep, half_empty, labels_of_size
from AIFReconLib.benchmark_first import first_result
from AIFReconLib.benchmark_table import HEADING, BenchmarkResult, Timing
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.geometry.transforms import image_plane_axes
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.machine.threads import optional_module
from AIFReconLib.settings import ReconstructionSettings

LOOPS = optional_module("AIFReconLib.numba_yardstick")
needs_numba = pytest.mark.skipif(LOOPS is None, reason="numba is not installed")
RESULT = BenchmarkResult(
    "a machine",
    "1.0",
    12,
    5,
    0.0,
    (Timing("average", "numba", 2, 0.5, 0.012, 3.25, 1000.0, 4.5, 22), Timing("reading", "file", 1, None, 0.5)),
)


@needs_numba
@pytest.mark.parametrize("method", ["aif", "aif-compensated"])
def test_the_yardstick_gives_the_voxels_of_the_engines(method):
    frames, grid, bone = oblique_frames(), turned_grid(), sphere_bone()
    probe = ProbeGeometry("sector", (16.0, -6.0))
    reconstructor = Reconstructor(grid, ReconstructionSettings(method=method, output_type="float32"), bone, probe=probe)
    reconstructor.insert(frames)
    placed = bone.on_grid(grid)
    value, weight, hits = np.zeros(grid.shape, np.float32), np.zeros(grid.shape, np.float32), np.zeros(grid.shape, np.uint32)
    for frame in frames:
        rows, columns = frame.image.shape
        x, y = (axis.astype(np.float32) for axis in image_plane_axes(frame.image_to_reference))
        beams = probe.directions(columns, rows, (0.4, 0.7))
        factors = np.float32(0.1), np.float32(0.1), np.float32(255), method == "aif-compensated"
        known = placed.probability, placed.directions_reference
        LOOPS.plain_aif(frame.image, grid.reference_to_ijk @ frame.image_to_reference, x, y, beams, *known, *factors, value, weight, hits)
    np.testing.assert_allclose(reconstructor.finish().intensity.array, value, rtol=1e-6)


@needs_numba
def test_there_is_a_yardstick_for_every_method():
    grid = turned_grid((4.0, 4.0, 4.0))
    loops = LOOPS.yardsticks(fan_sweep(2), grid, sphere_bone(), ProbeGeometry("linear"))
    for work in loops.values():
        work()
    assert sorted(loops) == sorted(["average", "latest", "maximum", "aif", "aif-compensated", "weighted"])


def test_everything_is_measured(monkeypatch):
    monkeypatch.setattr(benchmark_module, "seconds_to_first_result", lambda: (2.0, 1.0))
    monkeypatch.setattr(benchmark_module, "FILE_FRAMES", 2)
    result = benchmark_module.benchmark(2, 1, (4.0,), voxels=8000)
    found = {timing.what.split(",")[0] for timing in result.timings}
    assert {"average", "weighted", "hole filling", "bone map from labels", "bone map onto a grid", "reading"} <= found


@needs_numba
def test_what_has_a_yardstick_is_compared_with_it():
    result = benchmark_module.benchmark(2, 1, (4.0,), voxels=0)
    compared = {timing.what for timing in result.timings if timing.times_yardstick}
    assert {"average", "aif-compensated", "weighted"} <= compared


def test_the_table_has_a_row_for_each_timing():
    assert [len(row) for row in RESULT.rows()] == [len(HEADING)] * 3


def test_markdown_is_a_table():
    lines = RESULT.markdown().splitlines()
    assert [line.count("|") for line in lines[-4:]] == [len(HEADING) + 1] * 4


@pytest.mark.parametrize(("busy", "told"), [(0.0, False), (0.4, True)])
def test_a_busy_machine_is_named(busy, told):
    result = BenchmarkResult("a machine", "1.0", 12, 5, busy, ())
    assert ("too slow" in result.heading()) == told


def test_the_numbers_are_json():
    assert json.loads(json.dumps(RESULT.to_dict()))["timings"][0]["threads"] == 2


def test_the_machine_is_named_without_a_place_on_it():
    assert "/" not in benchmark_module._machine()


def test_half_of_the_voxels_to_be_filled_are_empty():
    assert half_empty(27_000)[1].mean() == pytest.approx(0.5, abs=0.02)


def test_labels_have_the_size_asked_for():
    assert labels_of_size(27_000).array.size == 27_000


def test_a_first_result_can_be_had():
    assert first_result() is None

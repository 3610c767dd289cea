"""Hole filling against a search through every voxel."""

from __future__ import annotations

import tracemalloc
from functools import partial

import numpy as np
import pytest
from geometry_strategies import triples
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from AIFReconLib.errors import OperationCanceled
from AIFReconLib.holes import nearest as holes
from AIFReconLib.holes.filling import EMPTY, FILLED, MEASURED

CUBE = np.array([1.0, 1.0, 1.0])


@pytest.fixture
def fill_holes(engine):
    """The library's, with numpy and with numba."""
    return partial(holes.fill_holes, engine=engine)


def filled_by_search(values: np.ndarray, mask: np.ndarray, spacing, limit: float) -> tuple[np.ndarray, np.ndarray]:
    """For each empty voxel look at every measured one, in the order [k, j, i], and take the first of the nearest."""
    result, state = values.copy(), mask.copy()
    sources = np.argwhere(mask == MEASURED)
    for hole in np.argwhere(mask == EMPTY):
        nearest, best = None, None
        for source in sources:
            distance = round(float(np.sqrt((((source - hole) * np.asarray(spacing)[::-1]) ** 2).sum())), 6)
            if distance <= limit + 1e-9 and (best is None or distance < best):
                nearest, best = source, distance
        if nearest is not None:
            result[tuple(hole)] = values[tuple(nearest)]
            state[tuple(hole)] = FILLED
    return result, state


def scattered(shape, share: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Measured voxels here and there, each of another value, and 0 elsewhere."""
    rng = np.random.default_rng(seed)
    mask = (rng.random(shape) < share).astype(np.uint8)
    return np.where(mask == MEASURED, rng.permutation(mask.size).reshape(shape) + 1, 0).astype(np.float32), mask


def line(*measured: float) -> tuple[np.ndarray, np.ndarray]:
    """Voxels along i; 0 is a hole."""
    values = np.array(measured, np.float32).reshape(1, 1, -1)
    return values, (values > 0).astype(np.uint8)


@given(
    shape=st.tuples(st.integers(1, 6), st.integers(1, 6), st.integers(1, 6)),
    share=st.sampled_from([0.02, 0.1, 0.3]),
    seed=st.integers(0, 10**6),
    spacing=st.one_of(st.just((1.0, 1.0, 1.0)), st.just((0.5, 0.5, 1.0)), st.just((0.3, 0.4, 0.5)), triples(0.2, 2.0)),
    limit=st.sampled_from([0.3, 0.5, 1.0, 1.5, 2.0, 3.0, 20.0]),
)
@settings(max_examples=60, suppress_health_check=list(HealthCheck))
def test_filling_equals_the_search_through_every_voxel(fill_holes, shape, share, seed, spacing, limit):
    values, mask = scattered(shape, share, seed)
    expected = filled_by_search(values, mask, spacing, limit)
    fill_holes(values, mask, np.array(spacing), limit)
    np.testing.assert_array_equal(values, expected[0])
    np.testing.assert_array_equal(mask, expected[1])


@pytest.mark.parametrize("block", [1, 4, 5, 64])
def test_the_size_of_what_is_searched_in_one_go_makes_no_difference(fill_holes, monkeypatch, block):
    whole, parts = scattered((17, 9, 12), 0.05, 3), scattered((17, 9, 12), 0.05, 3)
    fill_holes(*whole, CUBE, 2.0)
    monkeypatch.setattr(holes, "BLOCK", block)
    monkeypatch.setattr(holes, "PLANES_AT_ONCE", block)
    fill_holes(*parts, CUBE, 2.0)
    np.testing.assert_array_equal(parts[0], whole[0])
    np.testing.assert_array_equal(parts[1], whole[1])


@pytest.mark.parametrize(
    ("spacing", "limit", "reached"),
    [(1.0, 2.0, 2), (1.0, 1.999, 1), (0.1, 0.3, 3), (0.3, 0.9, 3), (0.7, 2.1, 3), (0.7, 2.09, 2), (1.0, 0.0, 0), (0.01, 20.0, 4)],
)
def test_a_voxel_exactly_at_the_limit_is_filled(fill_holes, spacing, limit, reached):
    values, mask = line(7, 0, 0, 0, 0)
    assert fill_holes(values, mask, np.full(3, spacing), limit) == reached


@pytest.mark.parametrize("tenths", range(1, 21))
def test_a_tie_between_unlike_offsets_is_a_tie(fill_holes, tenths):
    values, mask = np.zeros((4, 4, 4), np.float32), np.zeros((4, 4, 4), np.uint8)
    for number, at in ((5, (1, 2, 2)), (6, (3, 0, 0))):
        values[at], mask[at] = number, MEASURED
    fill_holes(values, mask, np.full(3, tenths * 0.1), 0.3 * tenths)
    assert values[0, 0, 0] == 5


def test_filling_is_stopped_between_two_parts(fill_holes, monkeypatch):
    monkeypatch.setattr(holes, "BLOCK", 20)
    monkeypatch.setattr(holes, "PLANES_AT_ONCE", 20)
    values, mask = scattered((80, 20, 20), 0.02, 1)
    heard = iter([True] * 3)
    with pytest.raises(OperationCanceled):
        fill_holes(values, mask, CUBE, 3.0, lambda *_: next(heard, False), threads=1)
    filled = (mask == FILLED).any(axis=(1, 2))
    assert filled[:60].all()
    assert not filled[60:].any()


def test_the_memory_that_is_needed_beside_the_volume_is_bounded(fill_holes):
    values, mask = np.zeros((150, 150, 150), np.float32), np.zeros((150, 150, 150), np.uint8)
    mask[:, ::5, :] = MEASURED
    tracemalloc.start()
    try:
        fill_holes(values, mask, CUBE, 2.0)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 40e6

"""Plus's ways to fill holes against plain loops over voxels, and in cases whose answer is plain to see."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from AIFReconLib.errors import SettingsError
from AIFReconLib.holes.filling import FILLED, MEASURED, HoleFilling
from AIFReconLib.holes.igsio_hole_filling import fill_holes_by_kind

SHAPE = (6, 7, 8)


def scattered(share: float, seed: int, shape=SHAPE) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    mask = (rng.random(shape) < share).astype(np.uint8)
    return np.where(mask == MEASURED, rng.integers(1, 256, shape), 0).astype(np.float32), mask


def by_loop(values, mask, kind: HoleFilling, score=None) -> np.ndarray:
    """Values of the holes that `kind` fills, NaN elsewhere."""
    result = np.full(values.shape, np.nan)
    one = {"stick": stick_at, "cube": cube_at}.get(kind.kind, average_at)
    for hole in np.argwhere(mask != MEASURED):
        more = {"score": score} if one is average_at else {}
        result[tuple(hole)] = one(values, mask, tuple(int(n) for n in hole), kind, **more)
    return result


def around(mask, at, reach):
    """Known voxels in the cube about `at`, with their offsets."""
    for offset in itertools.product(range(-reach, reach + 1), repeat=3):
        place = tuple(a + o for a, o in zip(at, offset, strict=True))
        if all(0 <= p < n for p, n in zip(place, mask.shape, strict=True)) and mask[place] == MEASURED:
            yield offset, place


def average_at(values, mask, at, kind, score=None):
    total = weight = 0.0
    known = list(around(mask, at, (kind.size - 1) // 2))
    for offset, place in known:
        squared = sum(((kind.size - 1) // 2 + o - (kind.size - 1) / 2) ** 2 for o in offset)
        counts = 1 / np.sqrt(squared) if kind.kind == "inverse distance" else np.exp(-squared / (2 * kind.stdev**2))
        if kind.kind == "gaussian by hits":
            counts *= min(score[place], 65535 / 256)
        total, weight = total + counts * values[place], weight + counts
    return total / weight if known and len(known) / kind.size**3 > kind.known_ratio else np.nan


def cube_at(values, mask, at, kind):
    for reach in range(1, (kind.size - 1) // 2 + 1):
        known = [values[place] for _, place in around(mask, at, reach)]
        if known:
            return np.mean(known) if len(known) / kind.size**3 > kind.known_ratio else np.nan
    return np.nan


def is_ahead(direction) -> bool:
    """Which of the two ways along a stick IGSIO calls forward; it weights the two ends differently. [k, j, i]"""
    k, j, i = direction
    if k and j and i:
        return k > 0
    # Along edges and face diagonals the way in which x rises, else y, else z
    return (i, j, k) > (0, 0, 0)


def stick_at(values, mask, at, kind):
    found = []
    for direction in filter(is_ahead, itertools.product((-1, 0, 1), repeat=3)):
        steps = {}
        for way in (1, -1):
            for taken in range(1, kind.size):
                place = tuple(a + way * taken * d for a, d in zip(at, direction, strict=True))
                if not all(0 <= p < n for p, n in zip(place, mask.shape, strict=True)):
                    break
                if mask[place] == MEASURED:
                    steps[way] = taken, float(values[place])
                    break
        if len(steps) == 2:
            (f, ahead), (r, behind) = steps[1], steps[-1]
            length = f + r + 1
            if length <= kind.size:
                score = 1 / (length * np.sqrt(sum(d * d for d in direction)))
                found.append((round(score, 9), ((r + 1) * ahead + f * behind) / length))
    used = []
    for score in sorted({score for score, _ in found}, reverse=True):
        if len(used) >= kind.sticks:
            break
        used += [(s, v) for s, v in found if s == score]
    return sum(s * v for s, v in used) / sum(s for s, _ in used) if used else np.nan


@pytest.mark.parametrize(
    "kind",
    [
        HoleFilling("stick", 9),
        HoleFilling("stick", 5, sticks=3),
        HoleFilling("stick", 4, sticks=13),
        HoleFilling("stick", 3),
        HoleFilling("gaussian", 5, 0.8),
        HoleFilling("gaussian", 4, 1.0, 0.05),
        HoleFilling("gaussian", 3, 0.5, 0.2),
        HoleFilling("gaussian by hits", 5, 0.8),
        HoleFilling("gaussian by hits", 4, 1.0, 0.05),
        HoleFilling("inverse distance", 5),
        HoleFilling("inverse distance", 4, known_ratio=0.05),
        HoleFilling("cube", 5),
        HoleFilling("cube", 7, known_ratio=0.01),
    ],
    ids=str,
)
@pytest.mark.parametrize("share", [0.05, 0.3])
def test_filling_equals_the_loop_over_voxels(kind, share, engine):
    values, mask = scattered(share, seed=3)
    score = np.random.default_rng(4).choice([0.3, 1.0, 40.0, 300.0], SHAPE).astype(np.float32)
    expected = by_loop(values, mask, kind, score)
    filled = ~np.isnan(expected)
    wanted_values = np.where(filled, expected, values)
    count = fill_holes_by_kind(values, mask, (kind,), engine=engine, score=score)
    assert count == filled.sum()
    np.testing.assert_array_equal(mask == FILLED, filled)
    np.testing.assert_allclose(values, wanted_values, rtol=1e-6)


def test_what_one_way_leaves_is_the_next_ones():
    first, second = HoleFilling("stick", 3), HoleFilling("cube", 3)
    values, mask = scattered(0.1, seed=8)
    sticks, cubes = by_loop(values, mask, first), by_loop(values, mask, second)
    expected = np.where(mask == MEASURED, values, np.where(np.isnan(sticks), np.nan_to_num(cubes), sticks))
    fill_holes_by_kind(values, mask, (first, second))
    np.testing.assert_allclose(values, expected, rtol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("median", 3), "kind of hole filling must be one of cube, gaussian, stick, gaussian by hits, inverse distance; got 'median'"),
        (("cube", 0), "size of hole filling must be 1 to 201 voxels; got 0"),
        (("stick", 1000), "size of hole filling must be 1 to 201 voxels; got 1000"),
        (("gaussian", 3, 0.0), "standard deviation of hole filling must be above 0"),
        (("cube", 3, 1.0, 1.5), "ratio of known voxels must be 0 to 1; got 1.5"),
        (("stick", 3, 1.0, 0.0, 0), "number of sticks must be at least 1; got 0"),
    ],
)
def test_a_way_that_makes_no_sense_is_refused(arguments, expected):
    with pytest.raises(SettingsError, match=expected):
        HoleFilling(*arguments)

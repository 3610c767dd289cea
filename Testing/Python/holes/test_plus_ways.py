"""Plus's ways to fill holes against plain loops over voxels, and in cases whose answer is plain to see."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from AIFReconLib.errors import OperationCanceled, SettingsError
from AIFReconLib.holes import plus_ways
from AIFReconLib.holes.fill import fill_as_asked
from AIFReconLib.holes.filling import KINDS, HoleFilling
from AIFReconLib.holes.nearest import FILLED, MEASURED, fill_holes
from AIFReconLib.holes.plus_ways import fill_holes_by_kind
from AIFReconLib.machine.threads import optional_module
from AIFReconLib.recipe.recipe import ReconstructionSettings

SHAPE = (6, 7, 8)
SPACING = np.array([0.5, 0.5, 0.5])


@pytest.fixture(params=["numpy", "numba"])
def engine(request):
    if request.param == "numba" and optional_module("AIFReconLib.holes.numba_sticks") is None:
        pytest.skip("numba is not installed")
    return request.param


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


@pytest.mark.parametrize("planes", [1, 2, 3])
@pytest.mark.parametrize(
    "kind",
    [
        HoleFilling("stick", 6),
        HoleFilling("gaussian", 5, 1.0),
        HoleFilling("gaussian by hits", 5, 1.0),
        HoleFilling("inverse distance", 5),
        HoleFilling("cube", 5),
    ],
    ids=str,
)
def test_slabs_make_no_difference(kind, planes, monkeypatch):
    whole, slabs = scattered(0.15, seed=5), scattered(0.15, seed=5)
    score = np.random.default_rng(4).integers(1, 9, SHAPE)
    fill_holes_by_kind(*whole, (kind,), score=score)
    monkeypatch.setattr(plus_ways, "VOXELS_AT_ONCE", planes * SHAPE[1] * SHAPE[2])
    monkeypatch.setattr(plus_ways, "HOLES_AT_ONCE", 17)
    fill_holes_by_kind(*slabs, (kind,), score=score)
    # Fourier transforms of slabs round differently
    np.testing.assert_allclose(slabs[0], whole[0], rtol=1e-6 if kind.kind == "inverse distance" else 0)
    np.testing.assert_array_equal(slabs[1], whole[1])


def test_of_two_neighbors_a_hole_takes_after_the_nearer_one():
    values = np.array([[[90, 0, 0, 30]]], np.float32)
    fill_holes_by_kind(values, (values > 0).astype(np.uint8), (HoleFilling("inverse distance", 5),))
    np.testing.assert_allclose(values, [[[90, (2 * 90 + 30) / 3, (90 + 2 * 30) / 3, 30]]])


def test_of_two_neighbors_a_hole_takes_after_the_one_with_more_pixels():
    values, score = np.array([[[90, 0, 30]]], np.float32), np.array([[[1, 0, 5]]])
    fill_holes_by_kind(values, (values > 0).astype(np.uint8), (HoleFilling("gaussian by hits", 3, 1.0),), score=score)
    assert values[0, 0, 1] == pytest.approx((90 + 5 * 30) / 6)


def test_what_one_way_leaves_is_the_next_ones():
    first, second = HoleFilling("stick", 3), HoleFilling("cube", 3)
    values, mask = scattered(0.1, seed=8)
    sticks, cubes = by_loop(values, mask, first), by_loop(values, mask, second)
    expected = np.where(mask == MEASURED, values, np.where(np.isnan(sticks), np.nan_to_num(cubes), sticks))
    fill_holes_by_kind(values, mask, (first, second))
    np.testing.assert_allclose(values, expected, rtol=1e-6)


def test_a_stick_interpolates_between_its_ends():
    values = np.array([[[90, 0, 0, 0, 10]]], np.float32)
    mask = (values > 0).astype(np.uint8)
    fill_holes_by_kind(values, mask, (HoleFilling("stick", 5),))
    # IGSIO weights the far end with the steps to the near one plus 1, out of their sum plus 1
    np.testing.assert_allclose(values, [[[90, (3 * 90 + 2 * 10) / 5, (2 * 90 + 3 * 10) / 5, (1 * 90 + 4 * 10) / 5, 10]]])


def test_a_stick_does_not_bridge_a_longer_gap():
    values = np.array([[[90, 0, 0, 0, 10]]], np.float32)
    mask = (values > 0).astype(np.uint8)
    assert fill_holes_by_kind(values, mask, (HoleFilling("stick", 4),)) == 0


@pytest.mark.parametrize("kind", ["gaussian", "gaussian by hits", "inverse distance", "cube"])
def test_equal_neighbors_average_to_themselves(kind):
    values, mask = scattered(0.2, seed=1)
    values[mask == MEASURED] = 77
    fill_holes_by_kind(values, mask, (HoleFilling(kind, 7, 1.3),), score=np.arange(values.size).reshape(SHAPE) + 1)
    np.testing.assert_allclose(values[mask == FILLED], 77, rtol=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_a_volume_without_measured_voxels_stays_empty(kind):
    values, mask = np.zeros((2, *SHAPE), np.float32)[0], np.zeros(SHAPE, np.uint8)
    assert fill_holes_by_kind(values, mask, (HoleFilling(kind, 5),)) == 0


@pytest.mark.parametrize("kind", KINDS)
def test_a_size_of_one_voxel_reaches_nothing(kind):
    values, mask = scattered(0.3, seed=2)
    assert fill_holes_by_kind(values, mask, (HoleFilling(kind, 1),)) == 0


def test_gray_levels_are_rounded_where_a_volume_holds_them():
    values = np.array([[[10, 0, 11]]], np.uint8)
    fill_holes_by_kind(values, np.array([[[1, 0, 1]]], np.uint8), (HoleFilling("stick", 3),))
    assert values.tolist() == [[[10, 11, 11]]]


def test_filling_can_be_stopped():
    with pytest.raises(OperationCanceled):
        fill_holes_by_kind(*scattered(0.3, seed=2), (HoleFilling("stick", 5),), lambda fraction, text: False)


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


# What the settings ask for


def asked(configured=(), **settings):
    values, mask = scattered(0.1, seed=4)
    fill_as_asked(values, mask, SPACING, ReconstructionSettings(**{"hole_limit": 0.0, **settings}), configured)
    return values, mask


def expected_of(*kinds):
    values, mask = scattered(0.1, seed=4)
    fill_holes_by_kind(values, mask, kinds)
    return values, mask


STICK = HoleFilling("stick", 9)


@pytest.mark.parametrize(
    ("configured", "settings", "kinds"),
    [
        ((), {}, ()),
        ((STICK,), {}, (STICK,)),
        ((STICK,), {"holes": "off"}, ()),
        ((STICK,), {"holes": "off", "hole_limit": 1.0}, ()),
        ((STICK,), {"holes": "cube", "hole_limit": 1.0}, (HoleFilling("cube", 5),)),
        ((), {"holes": "stick", "hole_limit": 1.2}, (HoleFilling("stick", 5),)),
        ((), {"holes": "gaussian", "hole_limit": 1.5}, (HoleFilling("gaussian", 7, 1.5),)),
        ((), {"holes": "stick", "hole_limit": 0.4}, ()),
    ],
)
def test_settings_come_before_the_configuration(configured, settings, kinds):
    for ours, theirs in zip(asked(configured, **settings), expected_of(*kinds), strict=True):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("settings", [{"hole_limit": 1.0}, {"hole_limit": 1.0, "holes": "nearest"}])
def test_a_limit_alone_means_the_nearest_measured_voxel(settings):
    values, mask = scattered(0.1, seed=4)
    fill_holes(values, mask, SPACING, 1.0)
    for ours, theirs in zip(asked((STICK,), **settings), (values, mask), strict=True):
        np.testing.assert_array_equal(ours, theirs)

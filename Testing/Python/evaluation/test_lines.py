"""Lines past a plate of bone with a hole, and how well a number tells free ones from blocked ones: answers known without computing."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import places

from AIFReconLib.bone.canal import canals_of
from AIFReconLib.evaluation.lines import FEWEST, StraightLines, lines_to_canal, told_apart
from AIFReconLib.geometry.volume import Volume, VoxelGrid

GRID = VoxelGrid.from_spacing((-30.0, 0.0, -30.0), (61, 61, 61), 1.0)
X, Y, Z = np.moveaxis(places(GRID), -1, 0)
MANY = np.arange(100.0)


@pytest.mark.parametrize(
    ("free", "blocked", "expected"),
    [
        (MANY + 200, MANY, (1.0, 0.0)),
        (np.ones(50), np.ones(70), (0.5, 1.0)),
        (MANY, MANY, (0.5, 0.9)),
        (MANY[: FEWEST - 1], MANY, (np.nan, np.nan)),
        (MANY, MANY[:3], (np.nan, np.nan)),
    ],
    ids=["all apart", "all alike", "nothing told", "few free", "few blocked"],
)
def test_how_well_a_number_tells_free_lines_from_blocked_ones(free, blocked, expected):
    assert told_apart(free, blocked) == pytest.approx(expected, nan_ok=True)


def test_the_area_is_the_share_of_pairs_in_the_right_order():
    rng = np.random.default_rng(0)
    free, blocked = rng.integers(3, 12, 40), rng.integers(0, 9, 60)
    pairs = np.mean([(one > other) + 0.5 * (one == other) for one in free for other in blocked])
    assert told_apart(free, blocked)[0] == pytest.approx(pairs)


def test_lines_through_a_hole_are_free_and_the_others_blocked():
    plate = Volume(np.maximum(np.abs(Y - 20.0) - 2.0, 6.0 - np.hypot(X, Z)).astype(np.float32), GRID.ijk_to_reference)
    x = np.linspace(-20.0, 20.0, 81)
    entries = np.stack([x, np.zeros_like(x), np.zeros_like(x)], axis=1)
    lines = StraightLines.past(plate, entries, entries + np.array([0.0, 40.0, 0.0]))
    np.testing.assert_array_equal(lines.free, np.abs(x) <= 5.0)
    np.testing.assert_array_equal(lines.blocked, np.abs(x) >= 6.0)
    shown = Volume(np.where(plate.array <= 0, 200, 10).astype(np.uint8), GRID.ijk_to_reference)
    assert lines.brightest(shown)[lines.blocked].min() > lines.brightest(shown)[lines.free].max()


def rings() -> Volume:
    """Two vertebrae, one above the other, whose canal runs along z at x = 0, y = 40."""
    radius = np.hypot(X, Y - 40.0)
    ring = (radius > 8) & (radius < 13)
    levels = np.select([ring & (np.abs(Z + 17.5) < 7.5), ring & (np.abs(Z - 17.5) < 7.5)], [2, 1])
    return Volume(levels.astype(np.uint8), GRID.ijk_to_reference)


def test_lines_run_from_below_the_skin_to_the_canal_between_neighbors():
    canals = canals_of(rings(), np.array([1, 2, 7]))
    assert canals.shape == (1, 2, 3)
    assert canals[0, :, :2] == pytest.approx(np.array([[0.0, 40.0]] * 2), abs=0.7)
    assert sorted(np.abs(canals[0, :, 2])) == pytest.approx([17.5, 17.5], abs=0.7)
    x, z = (axis.ravel() for axis in np.meshgrid(np.arange(-30, 31, 2.0), np.arange(-30, 31, 2.0)))
    nothing = Volume(np.full(GRID.shape, 9.0, np.float32), GRID.ijk_to_reference)
    lines = lines_to_canal(np.stack([x, np.zeros_like(x), z], axis=1), canals, nothing)
    assert len(lines.entries) > 500
    assert np.hypot(lines.ends[:, 0], lines.ends[:, 1] - 40.0).max() < 5.8
    assert np.abs(lines.ends[:, 2]).max() < 23.5
    assert lines.entries[:, 1].min() > 3.4


def test_labels_without_a_canal_have_no_lines():
    assert not len(canals_of(Volume((rings().array == 1).astype(np.uint8), GRID.ijk_to_reference), np.array([1])))
    assert lines_to_canal(np.zeros((5, 3)), np.empty((0, 2, 3)), rings()) is None

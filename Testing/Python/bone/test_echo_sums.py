"""The surface that echoes lie on, by sums in cubes, against loops over echoes."""

from __future__ import annotations

from math import exp

import numpy as np
import pytest
from seen_planes import bent

from AIFReconLib.bone.echoes.found import SweepEchoes
from AIFReconLib.bone.echoes.surface import surface_of
from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.transforms import transform_points


def around(place, of, sigma):
    """What each of these cubes counts at a place: a Gaussian that ends three deviations away along each axis."""
    apart = [max(abs(a - b) for a, b in zip(place, cube)) for cube in of]
    return [
        exp(-0.5 * sum((a - b) ** 2 for a, b in zip(place, cube)) / sigma**2) if far <= 3 * sigma else 0.0 for cube, far in zip(of, apart)
    ]


def trusts_by_loops(echoes: SweepEchoes) -> list[float]:
    """Of each echo: how much is shown at its place, against how much of it lies in shadows."""
    cubes, scores = [tuple(np.rint(point)) for point in echoes.points], echoes.scores.tolist()
    dark, trust = crossed_by_loops(echoes, 1), []
    for cube in cubes:
        shown = sum(s * w for s, w in zip(scores, around(cube, cubes, 1)))
        shadow = sum(s * w for (_, s), w in zip(dark, around(cube, [where for where, _ in dark], 1)))
        trust.append(shown / (shown + 0.2 * shadow))
    return trust


def crossed_by_loops(echoes: SweepEchoes, side: int) -> list[tuple]:
    """Cubes that beams cross before (-1) and behind (1) their echoes, with the scores of these."""
    return [
        (tuple(np.rint(point + side * (2.5 + n) * beam)), score)
        for point, beam, score in zip(echoes.points, echoes.beams, echoes.scores.tolist())
        for n in range(23)
    ]


def between_by_loops(dark: list[tuple], passed: list[tuple], place) -> tuple[float, np.ndarray]:
    """Probability of bone on the border between what beams passed and what lies in shadow, and its normal, at a whole millimeter."""
    whole = sum(exp(-0.5 * n**2) for n in range(-3, 4)) ** 3

    def at(way, where):
        return sum(score * w for (_, score), w in zip(way, around(where, [cube for cube, _ in way], 1))) / whole

    def share(where):
        return at(passed, where) / max(at(passed, where) + at(dark, where), 1e-9)

    slope = np.array([share(place + step) - share(place - step) for step in np.eye(3)]) / 2
    steep = max(float(np.linalg.norm(slope)), 1e-6)
    known = min(at(dark, place), at(passed, place)) > 0.2
    return exp(-0.5 * ((0.5 - share(place)) / steep / 0.8) ** 2) if known else 0.0, -slope / steep


def by_loops(echoes: SweepEchoes, trust: list[float], place) -> tuple[float, np.ndarray]:
    """Probability by the plane through the echoes around, and its normal, at a whole millimeter."""
    cubes, scores = [tuple(np.rint(point)) for point in echoes.points], echoes.scores.tolist()
    kept = [n for n, value in enumerate(trust) if value >= 0.35]
    counts = np.array([trust[n] * scores[n] * w for n, w in zip(kept, around(place, [cubes[n] for n in kept], 2))])
    points, beams = echoes.points[kept], echoes.beams[kept]
    mean = counts @ points / counts.sum()
    vectors = np.linalg.eigh(((points - mean).T * counts) @ (points - mean))[1]
    facing = counts @ beams / counts.sum()
    normal = vectors[:, 0] * (1 if vectors[:, 0] @ facing >= 0 else -1)
    away = min(np.linalg.norm(np.array(place) - cubes[n]) for n in kept)
    height = (np.array(place) - mean) @ normal
    probability = exp(-0.5 * (height / 0.8) ** 2 - 0.5 * (away / 2.0) ** 2) if away <= 3 else 0.0
    return probability, normal


def test_the_surface_is_that_of_loops_over_echoes():
    echoes = bent(150)
    found = surface_of(echoes)
    random, grid, trust = np.random.default_rng(2), found.probability.grid, trusts_by_loops(echoes)
    dark, passed = crossed_by_loops(echoes, 1), crossed_by_loops(echoes, -1)
    k, j, i = np.nonzero(found.probability.array[1:-1, 1:-1, 1:-1] > 0.05)
    borders = 0
    for n in random.choice(len(k), 40, replace=False):
        at = k[n] + 1, j[n] + 1, i[n] + 1
        place = transform_points(grid.ijk_to_reference, at[::-1]).round(6)
        probability, normal = by_loops(echoes, trust, place)
        between, across = between_by_loops(dark, passed, place)
        borders += between > probability
        assert found.probability.array[at] == pytest.approx(max(between, probability), abs=1e-5)
        np.testing.assert_allclose(found.slopes[(slice(None), *at)], across if between > probability else normal, atol=1e-5)
    assert 0 < borders < 40


def test_of_no_echoes_there_is_no_surface():
    with pytest.raises(GeometryError, match="No frame shows an echo"):
        surface_of(SweepEchoes.joined([]))

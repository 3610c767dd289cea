"""Beam directions: straight down for a linear array, away from the apex in mm for a sector."""

from __future__ import annotations

import math

import numpy as np
import pytest
from geometry_strategies import numbers
from hypothesis import given, settings
from hypothesis import strategies as st

from AIFReconLib.errors import BeamGeometryError
from AIFReconLib.imaging.beams import LINEAR, SECTOR, ProbeGeometry

apexes = st.tuples(numbers(-50, 50), numbers(-50, 50))
pitches = st.tuples(numbers(0.05, 2), numbers(0.05, 2))


def direction_by_loop(apex, column, row, spacing) -> list[float]:
    """From the apex to a pixel, in mm, divided by its length."""
    x, y = (column - apex[0]) * spacing[0], (row - apex[1]) * spacing[1]
    length = math.hypot(x, y)
    return [x / length, y / length] if length > 0 else [0.0, 0.0]


def test_every_beam_of_a_linear_array_goes_down_its_column():
    directions = ProbeGeometry(LINEAR).directions(5, 4, (0.1, 0.7))
    np.testing.assert_array_equal(directions, np.broadcast_to([0.0, 1.0], (4, 5, 2)))


@given(apexes, pitches)
@settings(max_examples=50)
def test_beams_of_a_sector_equal_the_plain_loop(apex, spacing):
    directions = ProbeGeometry(SECTOR, apex).directions(7, 6, spacing)
    expected = [[direction_by_loop(apex, column, row, spacing) for column in range(7)] for row in range(6)]
    np.testing.assert_allclose(directions, expected, atol=1e-6)


@pytest.mark.parametrize("apex", [None, (math.nan, 0.0), (0.0, math.inf), (1.0,), (1.0, 2.0, 3.0)])
def test_a_sector_without_an_apex_is_refused(apex):
    with pytest.raises(BeamGeometryError, match="must be a column and a row"):
        ProbeGeometry(SECTOR, apex)

"""Boxes around chosen voxels, and on planes."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import rigid

from AIFReconLib.geometry.box import box_around, corners_of, middle_on_plane


@pytest.mark.parametrize("margin", [0, 2, np.array([1, 0, 40])])
def test_it_holds_every_voxel_and_the_margin_that_fits(margin):
    mask = np.zeros((9, 12, 30), bool)
    mask[2, 3, 4] = mask[5, 10, 20] = True
    box = box_around(mask, margin)
    k, j, i = np.broadcast_to(margin, 3)
    assert box == (slice(2 - k, min(6 + k, 9)), slice(3 - j, min(11 + j, 12)), slice(max(4 - i, 0), min(21 + i, 30)))
    assert mask[box].sum() == 2


def test_around_nothing_it_is_the_first_voxel():
    assert box_around(np.zeros((3, 4, 5), bool)) == (slice(0, 1),) * 3


def test_its_middle_is_told_on_planes_that_are_near_it():
    corners = corners_of(np.array([[0.0, 2.0], [10.0, 20.0], [-5.0, 5.0]]))
    assert len({*map(tuple, corners)}) == 8
    for away, expected in ((2.9, (1.0, 15.0, 2.9)), (3.1, None)):
        middle = middle_on_plane(corners, rigid(translation=(0.0, 0.0, away)))
        assert middle is None if expected is None else middle == pytest.approx(expected)

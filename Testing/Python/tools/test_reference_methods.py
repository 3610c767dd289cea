"""The methods of others that the studies compare with: limits that are known without computing."""

from __future__ import annotations

import numpy as np
import pytest
from study.reference_methods import incidence_weighted, largest_contrast, random_walk_confidence

from AIFReconLib.compounding.state import Reconstruction
from AIFReconLib.geometry.volume import Volume


def test_confidence_is_low_behind_a_bright_line_and_unchanged_beside_it():
    image = np.full((40, 60), 60.0)
    image[15:17, 10:30], image[17:, 10:30] = 255.0, 5.0
    confidence = random_walk_confidence(image)
    assert confidence[25, 20] < 0.1 * confidence[25, 50]
    assert confidence[8, 20] > 0.9 * confidence[8, 50]


def test_a_beam_that_meets_bone_squarely_counts_a_hundred_times_one_that_grazes_it():
    weight, value = incidence_weighted(np.array([90.0, 30.0]), np.array([1.0, 0.0]))
    assert weight[0] == pytest.approx(101 * weight[1])
    assert value.tolist() == [90.0, 30.0]


def view(gray, measured=None):
    mask = np.ones(gray.shape, np.uint8) if measured is None else measured.astype(np.uint8)
    intensity = Volume(np.where(mask > 0, gray, 0).astype(np.uint8), np.eye(4))
    return Reconstruction(intensity, None, None, Volume(mask, np.eye(4)), None, "average", 1, {})


def test_a_line_that_one_of_two_views_shows_stays_brighter_than_in_their_mean():
    dark = np.full((14, 15, 16), 40)
    line = dark.copy()
    line[7] = 240
    assert largest_contrast([view(line), view(dark)]).intensity.array[7, 5:10, 5:10].min() > 200

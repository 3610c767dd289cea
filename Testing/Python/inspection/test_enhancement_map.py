"""What a method has added to the brightness of its echoes is told, and rounding is not taken for it."""

from __future__ import annotations

import numpy as np
import pytest

from AIFReconLib.geometry.volume import Volume
from AIFReconLib.inspection.enhancement_map import BANDS, raised_bands, raised_share


def volume(levels, dtype=np.uint8, spacing=1.0):
    """Some gray levels in a row, and one of 255."""
    return Volume(np.array([[[*levels, 255]]], dtype=dtype), np.diag([spacing, spacing, spacing, 1.0]))


def test_a_voxel_three_times_as_bright_as_its_echoes_owes_two_thirds_to_the_method():
    assert raised_share(np.array([150], np.uint8), np.array([50], np.uint8)) == pytest.approx(2 / 3)


def test_only_what_is_as_bright_as_bone_and_brighter_than_its_echoes_is_marked():
    assert raised_bands(volume([80, 80, 0, 120]), volume([80, 90, 0, 20])).max() == 0
    assert raised_bands(volume([130]), volume([20])).max() > 0


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_bands_are_those_of_the_share(dtype):
    plain = [200 * (1 - share) for share in (0.05, *(each + 0.05 for each in BANDS))]
    bands = raised_bands(volume([200] * 5, dtype), volume(np.rint(plain), dtype))
    assert bands.ravel().tolist() == [0, 1, 2, 3, 4, 0]

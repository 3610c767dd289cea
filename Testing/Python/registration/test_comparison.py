"""How CT and sweep agree, and the width of the bone map that follows; what commands say of it is tested with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from files import tracked_sequence, write_patient

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.bone.widths import UNKNOWN_WIDTH
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.imaging.beams import LINEAR
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.registration.comparison import EchoFit, agreement_of, compared
from AIFReconLib.registration.labeled_bone import LabeledBone


@pytest.fixture
def sequence(tmp_path):
    """A sweep without bone."""
    return replace(tracked_sequence(), configuration=read_plus_configuration(write_patient(tmp_path).config))


@pytest.fixture
def labels():
    array = np.zeros((9, 9, 9), np.uint8)
    array[3:6, 3:6, 3:6] = 1
    return Volume(array, np.eye(4))


def test_a_sweep_without_bone_is_said_to_be_not_compared(sequence, labels):
    (line,) = compared(sequence, labels, np.eye(4), Recipe(probe=LINEAR)).lines
    assert line.startswith("CT and sweep were not compared. ")
    assert "too few" in line


# ---- the width of the bone map


def width_of(distances, reachable=True) -> float:
    """The width for echoes so far from bone, mm."""
    distances = np.asarray(distances, dtype=float)
    fit = EchoFit(distances, np.broadcast_to(np.asarray(reachable), distances.shape))
    return agreement_of(fit, np.ones(len(distances), np.int64)).bone_width


@pytest.mark.parametrize(("off", "width"), [(0.1, 1.5), (0.5, 1.5), (0.8, 2.4), (-1.5, 4.5), (1.99, 6.0), (7.0, 6.0)])
def test_the_map_is_three_times_as_wide_as_the_echoes_lie_off_from_1_5_to_6_mm(off, width):
    assert width_of([off] * 9) == pytest.approx(width)


def test_of_spread_echoes_three_quarters_count():
    assert width_of([0.0] * 70 + [1.0] * 10 + [9.0] * 20) == pytest.approx(3.0)


def test_echoes_that_bone_could_not_send_back_do_not_widen_the_map():
    assert width_of([0.7] * 10 + [5.0] * 30, [True] * 10 + [False] * 30) == pytest.approx(2.1)


def test_a_map_that_should_be_wider_than_2_mm_is_believed_by_2_mm_over_that_width():
    def belief(off):
        fit = EchoFit(np.full(9, off), np.ones(9, bool))
        return agreement_of(fit, np.ones(9, np.int64)).bone_belief

    assert [belief(off) for off in (0.1, 0.6, 1.0, 2.0)] == pytest.approx([1.0, 1.0, 0.67, 0.33])
    assert belief(5.0) == pytest.approx(0.13), "the width has its limit, the doubt has none"


def test_the_widest_map_stands_where_no_echo_lies_near_bone():
    assert width_of([15.0] * 9) == 6.0


def test_only_weighted_leaves_its_width_to_the_sweep(sequence, labels):
    """This sweep shows no bone, so nothing is known of the CT's place."""
    bone = LabeledBone(labels, None, sequence, Recipe(probe=LINEAR))
    assert bone.settings("weighted") == {"bone_sigma_mm": UNKNOWN_WIDTH}
    for method in ("aif", "aif-compensated", "average"):
        assert bone.settings(method) == {"bone_sigma_voxels": 10.0}
    np.testing.assert_array_equal(bone.map("weighted").probability.array, BoneMap.from_labels(labels, sigma_mm=4.0).probability.array)
    np.testing.assert_array_equal(bone.map("aif").probability.array, BoneMap.from_labels(labels).probability.array)


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ({"bone_sigma_mm": 2.5}, {"bone_sigma_mm": 2.5}),
        ({"bone_sigma_voxels": 3.0}, {"bone_sigma_voxels": 3.0}),
        ({"bone_sigma_mm": "auto"}, {"bone_sigma_mm": UNKNOWN_WIDTH}),
    ],
)
@pytest.mark.parametrize("method", ["aif", "weighted"])
def test_a_width_that_is_given_holds_for_every_method(given, kept, method, labels):
    assert LabeledBone(labels, recipe=Recipe(**given)).settings(method) == kept


def test_a_map_that_is_believed_by_half_has_half_the_probability(labels):
    half = LabeledBone(labels, recipe=Recipe(bone_sigma_mm=2.0, bone_belief=0.5))
    assert half.settings("weighted") == {"bone_sigma_mm": 2.0, "bone_belief": 0.5}
    np.testing.assert_allclose(half.map("weighted").probability.array, 0.5 * BoneMap.from_labels(labels, sigma_mm=2.0).probability.array)

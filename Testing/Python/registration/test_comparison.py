"""How CT and sweep agree, and the width of the bone map that follows; what commands say of it is tested with them."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from files import tracked_sequence, write_patient
from study.method_cases import configured, simulated_scan
from sweeps import rigid

from AIFReconLib.bone.echoes.surface import bone_from_sweep
from AIFReconLib.bone.field import BoneField
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.bone.widths import UNKNOWN_WIDTH
from AIFReconLib.compounding.own.method import register_method
from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.labels import Labels
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.imaging.beams import LINEAR
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.message import advised
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.registration.agreement import Agreement
from AIFReconLib.registration.comparison import EchoFit, agreement_of, compared
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.simulation.anatomy import LumbarAnatomy, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep, simulate_sweep


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


def agreeing(distances, reachable=True) -> Agreement:
    """With echoes so far from bone, mm."""
    distances = np.asarray(distances, dtype=float)
    fit = EchoFit(distances, np.broadcast_to(np.asarray(reachable), distances.shape))
    return agreement_of(fit, np.ones(len(distances), np.int64))


@pytest.mark.parametrize(
    ("off", "width", "belief", "misplaced"),
    [
        (0.1, 1.0, 1.0, False),
        (0.5, 1.0, 1.0, False),
        (0.8, 1.6, 0.87, False),
        (1.0, 2.0, 0.7, False),
        (1.4, 2.8, 0.5, False),
        (-1.5, 3.0, 0.47, False),
        (1.6, 3.0, 0.44, True),
        (5.0, 3.0, 0.14, True),
        (15.0, 3.0, 0.0, True),
    ],
)
def test_width_and_belief_follow_how_far_the_echoes_lie_off_and_beyond_1_5_mm_they_tell_bone(off, width, belief, misplaced):
    """The width is twice that, from 1 to 3 mm; the belief 0.7 mm over it: the width has its limit, the doubt has none."""
    found = agreeing([off] * 9)
    assert (found.bone_width, found.bone_belief, found.misplaced) == (pytest.approx(width), pytest.approx(belief), misplaced)


def test_of_spread_echoes_three_quarters_count_of_those_that_bone_could_send_back():
    assert agreeing([0.0] * 70 + [1.0] * 10 + [9.0] * 20).bone_width == pytest.approx(2.0)
    assert agreeing([0.7] * 10 + [5.0] * 30, [True] * 10 + [False] * 30).bone_width == pytest.approx(1.4)


def test_only_weighted_leaves_its_width_to_the_sweep(sequence, labels):
    """This sweep shows no bone, so nothing is known of the CT's place."""
    bone = LabeledBone(labels, None, sequence, Recipe(probe=LINEAR))
    assert bone.settings("weighted") == {"bone_sigma_mm": UNKNOWN_WIDTH}
    for method in ("aif", "aif-compensated", "average"):
        assert bone.settings(method) == {"bone_sigma_voxels": 10.0}
    of_field = BoneMap.from_field(BoneField.from_labels(labels), UNKNOWN_WIDTH)
    np.testing.assert_array_equal(bone.map("weighted").probability.array, of_field.probability.array)
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
    whole = BoneMap.from_field(BoneField.from_labels(labels), 2.0)
    np.testing.assert_allclose(half.map("weighted").probability.array, 0.5 * whole.probability.array)


def test_a_method_of_ones_own_is_told_that_its_map_has_the_papers_width(labels):
    @register_method
    def by_bone(intensity, probability):
        return probability, intensity

    (told,) = LabeledBone(labels).lines(by_bone.name)
    assert advised(told).startswith("The bone map is 10 voxels of the labels wide, as the paper has it. bone_sigma_mm=")
    assert not LabeledBone(labels).lines("aif")
    assert not LabeledBone(labels, recipe=Recipe(bone_sigma_mm=1.0)).lines(by_bone.name)


@pytest.mark.parametrize(
    ("tenth", "elsewhere", "reach"),
    [(2.0, 25, 3.0), (2.0, 40, np.inf), (5.5, 0, np.inf), (np.nan, 0, np.inf)],
)
def test_echoes_far_from_a_ct_that_is_a_little_off_are_no_bone(tenth, elsewhere, reach):
    assert Agreement(0.5, 1.0, 100, elsewhere, upper_tenth=tenth).reach == reach


@pytest.fixture(scope="module")
def phantom():
    return make_lumbar_phantom(LumbarAnatomy.from_seed(1), spacing=1.5)


@pytest.fixture(scope="module")
def scanned(phantom):
    return simulated_scan(phantom, PhasedArray(), multi_angle_sweep(phantom, 27), 1).sequence


def test_a_ct_that_is_a_little_off_leaves_out_the_echoes_far_from_it(phantom, scanned):
    # Of the uppermost vertebra few echoes come, and this CT lacks it
    labels = Labels(phantom.labels.array, phantom.labels.ijk_to_reference)
    lacking = labels.only(labels.numbers()[1:])
    bone = LabeledBone(lacking, rigid(translation=(0.0, 2.5, 0.0)), scanned)
    assert bone.comparison().agreement.misplaced
    assert np.isfinite(bone.comparison().agreement.reach)
    made, every = bone.map("weighted").probability, bone_from_sweep(scanned).probability
    far = [_far_from(BoneField.from_labels(lacking), each) for each in (made, every)]
    assert far[0] == 0 < far[1]


NO_BONE = r"the images show hardly any bone, \d+ echoes in 27 frames|\d+ bone echoes, .* are too few"


def test_tissue_alone_makes_no_bone_and_says_so(phantom, monkeypatch):
    far = Volume(np.full_like(phantom.bone_distance.array, 6.0), phantom.bone_distance.ijk_to_reference)
    probe = PhasedArray()
    images = simulate_sweep(replace(phantom, bone_distance=far), probe, multi_angle_sweep(phantom, 27), seed=1)
    sequence = configured(images, probe)
    with pytest.raises(GeometryError, match=NO_BONE):
        bone_from_sweep(sequence)
    bone = LabeledBone(phantom.labels, None, sequence)
    monkeypatch.setattr(bone, "taken_from_echoes", lambda *_: True)  # as where the CT lies far from what resembles bone
    assert not bone.map("weighted").probability.array.any()
    assert re.search(NO_BONE, bone.map("weighted").notes[0])


def _far_from(bone, probability) -> int:
    """How many voxels of a map are bone more than 12 mm from these."""
    k, j, i = np.nonzero(probability.array > 0.5)
    points = np.column_stack([i, j, k]) @ probability.ijk_to_reference[:3, :3].T + probability.ijk_to_reference[:3, 3]
    return int(np.count_nonzero(bone.distances(points) > 12.0))


def test_weighted_with_a_misplaced_ct_is_weighted_with_the_echoes_of_the_sweep(phantom, scanned):
    off = rigid(translation=(3.0, 5.0, -2.0))
    right, wrong = LabeledBone(phantom.labels, None, scanned), LabeledBone(phantom.labels, off, scanned)
    assert not right.taken_from_echoes("weighted")
    np.testing.assert_array_equal(wrong.map("weighted").probability.array, bone_from_sweep(scanned).probability.array)
    assert wrong.settings("weighted") == {"bone_sigma_mm": "auto"}
    assert wrong.lines("weighted")[-1].startswith("Bone is taken from the sweep's own echoes")
    fixed = LabeledBone(phantom.labels, off, scanned, Recipe(bone_sigma_mm=2.0))
    assert not fixed.taken_from_echoes("weighted"), "who gives a width is believed"
    assert not wrong.taken_from_echoes("aif"), "the paper's methods are the paper's"

"""A CT laid upon bone echoes: whether it is right, brought there, found, and what the sweep does not hold."""

from __future__ import annotations

import math

import numpy as np
import pytest
from ray_echoes import ray_echoes, spine, spine_of_equal_levels
from scipy.spatial.transform import Rotation
from sweeps import rigid

from AIFReconLib.bone.echoes.found import SweepEchoes
from AIFReconLib.bone.field import FARTHEST_KNOWN, BoneField
from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.labels import Labels
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.registration.certainty import not_held
from AIFReconLib.registration.comparison import check
from AIFReconLib.registration.refine import refine
from AIFReconLib.registration.registration import register, register_echoes
from AIFReconLib.registration.search import level_shifts
from AIFReconLib.registration.segments import fields_of_labels, fit_segments, placed_labels
from AIFReconLib.simulation.scan import random_rigid
from AIFReconLib.terminal.remedies import in_options


@pytest.fixture(scope="module")
def echoes():
    return ray_echoes(spine().bone_distance, noise=0.2)


@pytest.fixture(scope="module")
def bone():
    return BoneField.from_labels(spine().labels)


CENTER = np.array([3.0, -2.0, 5.0])


def ball(radius=8.0, spacing=0.5, turn=(10.0, -20.0, 30.0), center=tuple(CENTER)) -> Volume:
    """A ball of bone, label 1, on a turned grid."""
    size = int(2 * radius / spacing) + 5
    matrix = rigid(turn) @ np.diag([spacing, spacing, spacing, 1.0])
    matrix[:3, 3] = np.asarray(center) - matrix[:3, :3] @ np.full(3, (size - 1) / 2)
    k, j, i = np.indices((size,) * 3)
    inside = np.sqrt(((np.stack([i, j, k]) - (size - 1) / 2) ** 2).sum(axis=0)) * spacing < radius
    return Volume(inside.astype(np.uint8), matrix)


def rod(length=120, radius=5.0) -> Volume:
    """A round shaft along z."""
    k, j, i = np.indices((length, 24, 24))
    inside = (np.hypot(i - 11.5, j - 11.5) < radius) & (k > 0) & (k < length - 1)
    return Volume(inside.astype(np.uint8), move(-11.5, -11.5, -length / 2))


def off_by(one, other, points) -> float:
    return float(np.linalg.norm(transform_points(one, points) - transform_points(other, points), axis=1).mean())


def move(x=0.0, y=0.0, z=0.0) -> np.ndarray:
    return rigid(translation=(x, y, z))


# The field


def test_places_beyond_the_box_are_as_far_as_is_known():
    distances, slopes = BoneField.from_labels(ball()).sample(np.array([[500.0, 0.0, 0.0], [np.nan, 0.0, 0.0]]))
    np.testing.assert_array_equal(distances, FARTHEST_KNOWN)
    np.testing.assert_array_equal(slopes, 0.0)


# The check


def test_the_right_place_agrees(echoes, bone):
    agreement = check(echoes, bone, np.eye(4))
    assert agreement.share > 0.9
    assert agreement.enough
    assert agreement.warning() is None


@pytest.mark.parametrize("wrong", [move(x=5), move(y=5), move(z=5), rigid((0, 0, 10)), rigid((10, 0, 0)), move(z=37)])
def test_a_wrong_place_is_told(wrong, echoes, bone):
    # About the middle of the echoes, as a user would turn it
    center = move(*echoes.points.mean(axis=0))
    assert check(echoes, bone, center @ wrong @ np.linalg.inv(center)).warning() is not None


def test_the_ct_of_another_patient_is_told(echoes):
    stranger = spine(seed=2)
    bone = BoneField.from_labels(stranger.labels)
    assert not register_echoes(echoes, bone, np.eye(4)).accepted


def test_bone_that_lies_behind_bone_does_not_agree(bone, echoes):
    # The front of the bodies, reached by no beam from behind
    k, j, i = np.nonzero((bone.labels.array > 0) & (np.pad(bone.labels.array, ((0, 0), (0, 1), (0, 0)))[:, 1:] == 0))
    front = transform_points(bone.labels.ijk_to_reference, np.column_stack([i, j, k]).astype(float))
    front = front[front[:, 1] > front[:, 1].max() - 10.0][:300]
    beams = np.tile([0.0, 1.0, 0.0], (len(front), 1))
    hidden = SweepEchoes(front, beams, np.ones(len(front), np.float32), np.zeros(len(front), np.int64))
    assert check(hidden, bone, np.eye(4)).share < 0.05


def test_echoes_of_bone_that_the_labels_lack_do_not_count_against_it(echoes, bone):
    far = SweepEchoes(echoes.points + np.array([200.0, 0, 0]), echoes.beams, echoes.scores, echoes.frames)
    both = check(SweepEchoes.joined([echoes, far]), bone, np.eye(4))
    assert both.share == check(echoes, bone, np.eye(4)).share
    assert both.elsewhere == len(far)


# Refinement


@pytest.mark.parametrize("seed", range(6))
def test_ten_millimeters_and_ten_degrees_off_come_back(seed, echoes, bone):
    start = random_rigid(10.0, 10.0, np.random.default_rng(seed), about=echoes.points.mean(axis=0))
    found = register_echoes(echoes, bone, start)
    assert found.accepted
    assert off_by(found.transform, np.eye(4), echoes.points) < 0.3


def test_a_third_of_echoes_from_elsewhere_does_no_harm(echoes, bone):
    rng = np.random.default_rng(0)
    count = len(echoes) // 2
    low, high = echoes.points.min(axis=0), echoes.points.max(axis=0)
    noise = SweepEchoes(rng.uniform(low, high, (count, 3)), echoes.beams[:count], echoes.scores[:count], echoes.frames[:count])
    start = random_rigid(5.0, 5.0, rng, about=echoes.points.mean(axis=0))
    place = refine(SweepEchoes.joined([echoes, noise]), bone, start)
    assert off_by(place, np.eye(4), echoes.points) < 0.5


# What is not held


def rod_echoes() -> SweepEchoes:
    """A shaft seen from three sides, far from its ends."""
    points, beams = [], []
    for angle in np.radians((-30, 0, 30)):
        beam = np.array([math.sin(angle), math.cos(angle), 0.0])
        for phi in np.radians(np.arange(-60, 61, 10)):
            side = Rotation.from_euler("z", phi).apply(-beam)
            z = np.arange(-40.0, 40.0, 2.0)
            points.append(5.0 * side + z[:, None] * (0, 0, 1.0))
            beams.append(np.tile(beam, (len(z), 1)))
    count = sum(map(len, points))
    return SweepEchoes(np.concatenate(points), np.concatenate(beams), np.ones(count, np.float32), np.zeros(count, np.int64))


def test_a_shaft_is_not_held_along_and_about_its_axis():
    bone, seen = BoneField.from_labels(rod()), rod_echoes()
    loose = not_held(seen, bone, refine(seen, bone, move(x=2.0)))
    assert sorted(one.kind for one in loose) == ["slide", "turn"]
    assert all(abs(one.axis[2]) > 0.99 for one in loose)
    assert all("head-feet axis" in one.sentence for one in loose)


def test_a_shaft_comes_back_across_its_axis():
    bone, seen = BoneField.from_labels(rod()), rod_echoes()
    found = register_echoes(seen, bone, move(x=7.0, y=-7.0))
    assert np.hypot(*found.transform[:2, 3]) < 0.3


# Without a start


def test_a_ct_finds_its_place_without_a_start():
    phantom = spine(1)
    motion = random_rigid(300.0, 170.0, np.random.default_rng(1))
    seen = ray_echoes(phantom.bone_distance, noise=0.2)
    seen = SweepEchoes(transform_points(motion, seen.points), seen.beams @ motion[:3, :3].T, seen.scores, seen.frames)
    found = register_echoes(seen, BoneField.from_labels(phantom.labels))
    assert found.accepted
    assert off_by(found.transform, motion, phantom.bone_distance.grid.corners()) < 1.0


def test_levels_that_fit_equally_well_are_ambiguous():
    """A spine of equal vertebrae of which the sweep shows a part in the middle."""
    same = spine_of_equal_levels()
    labels = kept(same.labels, 2, 3)
    middle = transform_points(labels.ijk_to_reference, np.argwhere(labels.array)[:, ::-1].astype(float))[:, 2]
    seen = ray_echoes(same.bone_distance, z_range=(middle.min() - 25.0, middle.max() + 25.0), noise=0.2)
    found = register_echoes(seen, BoneField.from_labels(labels), np.eye(4))
    assert [other.levels for other in found.alternatives if other.agreement.enough] != []
    assert not found.accepted
    assert "--level N" in in_options(found.reason)
    assert "choose one with level=n, or take the best with found.transform." in found.refusal


def test_a_start_one_level_off_does_not_stay_there(echoes, bone):
    found = register_echoes(echoes, bone, move(*level_shifts(bone)[1]))
    assert off_by(found.transform, np.eye(4), echoes.points) < 0.5


def kept(labels: Volume, *numbers: int) -> Volume:
    return Labels(labels.array, labels.ijk_to_reference).only(numbers)


@pytest.mark.parametrize("label", [1, 2, 3])
def test_one_vertebra_of_three_is_never_accepted_a_level_off(label, echoes):
    bone = BoneField.from_labels(kept(spine(0).labels, label))
    found = register_echoes(echoes, bone)
    assert off_by(found.transform, np.eye(4), [bone.middle]) < 1.0 or not found.accepted


def test_one_vertebra_that_the_sweep_does_not_show_is_refused_on_its_neighbor(echoes):
    phantom = spine(0)
    alone, rest = (BoneField.from_labels(kept(phantom.labels, *numbers)) for numbers in ((2,), (1, 3)))
    found = register_echoes(echoes[alone.distances(echoes.points) > rest.distances(echoes.points)], alone)
    assert not found.accepted


def test_two_vertebrae_of_three_find_their_place(echoes):
    found = register_echoes(echoes, BoneField.from_labels(kept(spine(0).labels, 1, 2)))
    assert found.accepted
    assert off_by(found.transform, np.eye(4), echoes.points) < 1.0


def test_a_mirrored_ct_is_refused(echoes):
    labels = spine(0).labels
    mirrored = Volume(np.ascontiguousarray(labels.array[:, :, ::-1]), labels.ijk_to_reference)
    found = register_echoes(echoes, BoneField.from_labels(kept(mirrored, 1, 2)), np.eye(4))
    assert not found.accepted


# Bone by bone


@pytest.fixture(scope="module")
def bent():
    return spine(0, 3, flexion_deg=5.0)


def test_vertebrae_of_a_bent_spine_each_find_their_place(bent):
    seen = ray_echoes(bent.bone_distance, noise=0.2)
    fields = fields_of_labels(bent.labels)
    one = refine(seen, BoneField.from_labels(bent.labels), np.eye(4))
    each = fit_segments(seen, fields, one).transforms
    motions = bent.motions_since_ct()
    errors = [off_by(each[label], motions[label], fields[label].distance.grid.corners()) for label in fields]
    rigidly = [off_by(one, motions[label], fields[label].distance.grid.corners()) for label in fields]
    assert np.median(errors) < 0.7
    assert max(rigidly) > 2.0
    assert max(errors) < max(rigidly)


def test_placed_labels_are_where_their_motions_put_them():
    labels = Volume(np.zeros((20, 20, 20), np.uint8), move(-10, -10, -10))
    labels.array[4:8, 4:8, 4:8], labels.array[12:16, 4:8, 4:8] = 1, 2
    placed = placed_labels(labels, {1: np.eye(4), 2: move(z=5.0)})
    kji = np.argwhere(placed.array == 2)
    center = transform_points(placed.ijk_to_reference, kji[:, ::-1].astype(float)).mean(axis=0)
    np.testing.assert_allclose(center, (-4.5, -4.5, 8.5))
    assert (placed.array == 1).sum() == (placed.array == 2).sum() == 64


# Refusals


@pytest.mark.parametrize(
    ("start", "words"), [(np.diag([2.0, 2.0, 2.0, 1.0]), "rigid"), (np.full((4, 4), np.nan), "finite"), (np.diag([-1.0, 1, 1, 1]), "rigid")]
)
def test_a_start_that_is_no_pose_is_refused_before_the_sweep_is_read(start, words):
    with pytest.raises(GeometryError, match=words):
        register([], ball(), start)

"""Bone as it is colored: every corner of the surface says how squarely the point that it stands for was met."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import rigid, two_vertebrae

from AIFReconLib.guidance.bone import guided_bone
from AIFReconLib.guidance.mesh import ASLANT, GRAZED, NOT_MET, OUT_OF_REACH, SQUARELY, ColoredBone

MOTION = rigid((10.0, -20.0, 30.0), (5.0, 6.0, 7.0))


@pytest.fixture(scope="module")
def colored(bone):
    return ColoredBone.of(bone)


@pytest.mark.parametrize(
    ("angle", "level"), [(np.nan, NOT_MET), (80.0, GRAZED), (61.0, GRAZED), (50.0, ASLANT), (44.0, SQUARELY), (0.0, SQUARELY)]
)
def test_bone_has_the_color_of_its_best_angle(bone, colored, angle, level):
    levels = colored.levels(np.full(len(bone), np.cos(np.radians(angle))))
    assert set(levels[colored.nearest >= 0]) == {level}


def test_bone_that_no_beam_from_the_back_reaches_has_a_color_of_its_own(bone, colored):
    levels = colored.levels(np.ones(len(bone)))
    x, y, z = colored.mesh.points_reference.T
    front = (y > 18.0) & (np.abs(x) < 8.0) & (np.abs(z + 20.0) < 6.0)
    assert front.any()
    assert set(levels[front]) == {OUT_OF_REACH}


def test_what_was_met_colors_the_bone_right_there_and_no_other(bone, colored):
    best = np.full(len(bone), np.nan)
    place = bone.surface.points_reference[len(bone) // 2]
    best[np.linalg.norm(bone.surface.points_reference - place, axis=1) < 3.0] = 1.0
    squarely = colored.levels(best) == SQUARELY
    assert squarely.any()
    assert np.linalg.norm(colored.mesh.points_reference[squarely] - place, axis=1).max() < 3.0 + 2.5


def test_bone_that_was_moved_is_the_bone_of_the_moved_ct(bone):
    moved, expected = bone.placed_by(MOTION), guided_bone(two_vertebrae(), MOTION)
    np.testing.assert_allclose(moved.surface.points_reference, expected.surface.points_reference, atol=1e-6)
    np.testing.assert_allclose(moved.surface.normals_reference, expected.surface.normals_reference, atol=1e-5)
    np.testing.assert_allclose(moved.patient_to_reference, expected.patient_to_reference, atol=1e-6)
    np.testing.assert_allclose(moved.distance.ijk_to_reference, expected.distance.ijk_to_reference, atol=1e-9)
    np.testing.assert_allclose(moved.centers[2], expected.centers[2], atol=1e-6)


def test_a_scan_aims_at_the_gaps_and_where_no_labels_tell_them_at_what_faces_the_back(bone):
    one = two_vertebrae()
    one.array[one.array > 0] = 1
    assert (bone.aim, guided_bone(one).aim) == ("interspinous", "posterior")

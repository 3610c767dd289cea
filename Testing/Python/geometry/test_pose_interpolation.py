"""The pose between two poses: against scipy's slerp, and by what must hold for any two."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp
from sweeps import image_pose, rigid

from AIFReconLib.geometry.pose_interpolation import interpolate_pose, pose_change

vectors = st.tuples(*[st.floats(-170, 170)] * 3)
fractions = st.floats(0, 1)


@given(vectors, vectors, fractions)
@settings(max_examples=60)
def test_rotations_follow_scipys_slerp(a, b, fraction):
    turns = Rotation.from_rotvec(np.deg2rad([a, b]))
    if (turns[0].inv() * turns[1]).magnitude() > np.pi - 1e-3:
        return  # two ways are equally short
    expected = Slerp([0, 1], turns)(fraction).as_matrix()
    np.testing.assert_allclose(interpolate_pose(rigid(a), rigid(b), fraction)[:3, :3], expected, atol=1e-7)


@given(vectors, vectors, fractions)
@settings(max_examples=60)
def test_the_way_back_passes_the_same_pose(a, b, fraction):
    first, second = rigid(a, b), rigid(b, a)
    if pose_change(first, second)[1] > np.pi - 1e-3:
        return
    np.testing.assert_allclose(interpolate_pose(first, second, fraction), interpolate_pose(second, first, 1 - fraction), atol=1e-6)


def test_the_ends_are_the_samples_to_the_bit_and_between_them_pixels_keep_their_size():
    first, second = rigid((10, 20, 30), (1, 2, 3)), rigid((-40, 5, 60), (7, 8, 9))
    np.testing.assert_array_equal(interpolate_pose(first, second, 0.0), first)
    np.testing.assert_array_equal(interpolate_pose(first, second, 1.0), second)
    pose = interpolate_pose(image_pose((0.4, 0.7), (0, 0, 0)), image_pose((0.4, 0.7), (0, 80, 30)), 0.3)
    np.testing.assert_allclose(np.linalg.norm(pose[:3, :2], axis=0), (0.4, 0.7), atol=1e-12)
    half = interpolate_pose(np.eye(4), rigid((180, 0, 0)), 0.5)
    assert abs(pose_change(np.eye(4), half)[1] - np.pi / 2) < 1e-6

"""An image is shown where its calibration puts it, as nearly as a volume node can hold it."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import rigid

pytest.importorskip("slicer", reason="slicer-core is not installed")
import tinyScene

COLUMNS, ROWS = 800, 600


def sheared(degrees: float) -> np.ndarray:
    """An image pose whose second axis leans by so many degrees, with pixels that are not square."""
    lean = np.radians(degrees)
    axes = np.column_stack([(1.0, 0.0, 0.0), (np.sin(lean), np.cos(lean), 0.0), (0.0, 0.0, 1.0)])
    matrix = np.eye(4)
    matrix[:3, :3] = axes * (0.09, 0.08, 0.5)
    return rigid((20.0, -30.0, 50.0), (40.0, 5.0, -60.0)) @ matrix


def placed(pose: np.ndarray) -> np.ndarray:
    from AIFReconLib.geometry.transforms import at_right_angles

    return at_right_angles(pose, COLUMNS, ROWS)


def directions(matrix: np.ndarray) -> np.ndarray:
    return matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)


@pytest.mark.parametrize("mirrored", [False, True])
def test_an_image_at_right_angles_stays_where_it_is(mirrored):
    pose = sheared(0.0) @ np.diag([1.0, 1.0, -1.0 if mirrored else 1.0, 1.0])
    np.testing.assert_allclose(placed(pose), pose, atol=1e-12)


def test_axes_that_lean_turn_by_half_of_that_each_about_the_middle_of_the_image_in_its_plane():
    pose = sheared(2.7)
    after = placed(pose)
    axes, before = directions(after), directions(pose)
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    assert [np.degrees(np.arccos(before[:, axis] @ axes[:, axis])) for axis in (0, 1)] == pytest.approx([1.35, 1.35])
    middle = [(COLUMNS - 1) / 2, (ROWS - 1) / 2, 0.0, 1.0]
    np.testing.assert_allclose(after @ middle, pose @ middle, atol=1e-12)
    np.testing.assert_allclose(directions(after)[:, 2], directions(pose)[:, 2], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(after[:3, :3], axis=0), np.linalg.norm(pose[:3, :3], axis=0))


def test_a_third_column_that_is_nothing_or_leans_does_not_matter():
    pose = sheared(2.7)
    flat, leaning = pose.copy(), pose.copy()
    flat[:3, 2] = 0.0
    leaning[:3, 2] += 0.2 * pose[:3, 0]
    for other in (flat, leaning):
        np.testing.assert_allclose(placed(other)[:3, :2], placed(pose)[:3, :2], atol=1e-12)


def test_an_image_under_a_transform_that_warps_is_refused_and_the_scan_goes_on(scene):
    from AIFReconScene.live.nodeImages import NodeImages

    image = tinyScene.addVolume("vtkMRMLScalarVolumeNode", "Image", np.ones((1, 4, 5), np.uint8), np.eye(4))
    images = NodeImages(image)
    tinyScene.addWarping(image)
    image.GetImageData().Modified()
    message = images.take()
    images.stop()
    assert (message.kind, "must be linear" in str(message.detail)) == ("refused", True)

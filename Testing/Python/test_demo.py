"""The demo, made small: every file it promises is there, and the figure shows the bone where the CT has it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import ndimage
from sweeps import rigid

from AIFReconLib.cli import main
from AIFReconLib.commands import demo
from AIFReconLib.evaluation.slices import AXIAL, CORONAL, SAGITTAL, cut
from AIFReconLib.io.transform_files import read_transform
from AIFReconLib.io.volume_files import read_labels, read_volume
from AIFReconLib.settings import METHODS
from AIFReconLib.volume import Volume


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("demo")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(demo, "FRAMES", 72)
        patch.setattr(demo, "SPACING", 1.5)
        patch.setattr(demo, "HOLE_LIMIT", 3.0)
        assert main(["demo", "--output", str(folder)]) == 0
    return folder


@pytest.mark.parametrize("name", ["sweep.igs.mha", "PlusDeviceSet.xml", "ct.nrrd", "lumbar-segmentation.nrrd", "CTToReference.tfm"])
def test_the_demo_writes_its_inputs_as_a_user_would_have_them(folder, name):
    assert (folder / name).stat().st_size > 100


@pytest.mark.parametrize("method", METHODS)
def test_the_demo_writes_a_volume_for_every_method(folder, method):
    assert read_volume(folder / f"reconstruction-{method}.nrrd").array.max() > 150


def test_the_demos_figure_is_a_picture(folder):
    assert (folder / "comparison.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_bright_voxels_lie_on_the_registered_bone(folder):
    """The echo of bone is where the CT, moved by its registration file, has its surface."""
    volume = read_volume(folder / "reconstruction-weighted.nrrd")
    labels = read_labels(folder / "lumbar-segmentation.nrrd").placed_by(read_transform(folder / "CTToReference.tfm"))
    bone = labels.array > 0
    surface = bone & ndimage.binary_dilation(~bone)
    away = Volume(ndimage.distance_transform_edt(~surface).astype(np.float32), labels.ijk_to_reference)
    k, j, i = np.nonzero(volume.array >= 180)
    points = np.stack([i, j, k], axis=1) @ volume.ijk_to_reference[:3, :3].T + volume.ijk_to_reference[:3, 3]
    deep = points[:, 1] > points[:, 1].min() + 25  # below the skin, which is bright too
    ijk = points[deep] @ away.grid.reference_to_ijk[:3, :3].T + away.grid.reference_to_ijk[:3, 3]
    distance = ndimage.map_coordinates(away.array, ijk[:, ::-1].T, order=1, mode="nearest")
    assert deep.sum() > 100
    assert np.median(distance) < 1.5


@pytest.mark.parametrize("plane", [SAGITTAL, AXIAL, CORONAL], ids=lambda plane: plane.name)
def test_a_cut_shows_a_point_where_it_is(plane):
    """A bright voxel of a rotated volume, 6 mm right of and 4 mm below the middle of the picture."""
    matrix = rigid((20.0, 10.0, 30.0), (-12.0, -13.0, -11.0))
    center = np.array([1.0, 2.0, 3.0])
    place = center + 6.0 * np.array(plane.right_ras) + 4.0 * np.array(plane.down_ras)
    ijk = np.linalg.inv(matrix) @ (*place, 1.0)
    k, j, i = np.indices((40, 40, 40))
    blob = np.exp(-((i - ijk[0]) ** 2 + (j - ijk[1]) ** 2 + (k - ijk[2]) ** 2) / 4)
    picture = cut(Volume(blob, matrix), plane, center, 30.0, 24.0, pitch=0.5)
    row, column = np.unravel_index(np.nanargmax(picture), picture.shape)
    assert (column - 29.5) * 0.5 == pytest.approx(6.0, abs=0.5)
    assert (row - 23.5) * 0.5 == pytest.approx(4.0, abs=0.5)

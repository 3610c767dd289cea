"""The demo, made small: every file it promises is there, and the figure shows the bone where the CT has it."""

from __future__ import annotations

import contextlib
import csv
import io

import numpy as np
import pytest
from scipy import ndimage
from sweeps import rigid

from AIFReconLib.commands import demo
from AIFReconLib.commands.parser import main
from AIFReconLib.compounding.methods.table import METHODS
from AIFReconLib.evaluation.slices import AXIAL, CORONAL, SAGITTAL, cut
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.transform.files import read_transform
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.io.volume.label_files import read_labels


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the demo wrote, and what it printed."""
    folder = tmp_path_factory.mktemp("demo")
    printed = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(printed):
        patch.setattr(demo, "FRAMES", 72)
        patch.setattr(demo, "SPACING", 1.5)
        patch.setattr(demo, "HOLE_LIMIT", 3.0)
        assert main(["demo", "--seed", "0", "--output", str(folder)]) == 0
    (folder / "printed.txt").write_text(printed.getvalue())
    return folder


@pytest.fixture(scope="module")
def printed(folder):
    return (folder / "printed.txt").read_text().splitlines()


@pytest.fixture(scope="module")
def rows(folder):
    with (folder / "metrics.csv").open(newline="") as file:
        return {row["volume"]: row for row in csv.DictReader(file)}


def test_the_demo_says_where_its_picture_is_first_and_its_page_names_no_place_on_this_machine(printed, folder):
    assert printed[0] == f"look at {folder / 'comparison.png'}; the other methods and the report follow"
    assert folder.name not in (folder / "report.html").read_text("utf-8")


@pytest.mark.parametrize("method", METHODS)
def test_the_demo_writes_and_measures_a_volume_for_every_method(folder, rows, method):
    assert read_volume(folder / f"reconstruction-{method}.nrrd").array.max() > 150
    row = rows[method]
    assert (row["reachability"], float(row["bone_area"]) > 1000, 0 < float(row["bone_coverage"]) < 1) == ("sweep", True, True)


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

"""Linear transform files as Slicer saves them: the node's matrix in RAS, both ways."""

from __future__ import annotations

import numpy as np
import pytest
import SimpleITK as sitk
from hdf5_samples import COMPRESSED_HDF5, OLDER_HDF5
from volume_samples import noise_volume, oblique_matrix, refusal

from AIFReconLib.errors import FileFormatError, GeometryError, OutputError
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.io.transform.files import read_transform, write_transform
from AIFReconLib.io.volume.files import read_volume, write_volume


def ras_matrix(path) -> np.ndarray:
    """What a file's transform does to points, by least squares; the way back, in RAS."""
    transform = sitk.ReadTransform(str(path))
    points = np.random.default_rng(5).normal(size=(20, 3)) * 100
    moved = np.array([transform.TransformPoint(point.tolist()) for point in points])
    solution, *_ = np.linalg.lstsq(np.column_stack([points, np.ones(20)]), moved, rcond=None)
    flip = np.diag([-1.0, -1.0, 1.0, 1.0])
    return flip @ np.linalg.inv(np.vstack([solution.T, (0, 0, 0, 1)])) @ flip


SAVED_BY_SLICER = """#Insight Transform File V1.0
#Transform 0
Transform: AffineTransform_double_3_3
Parameters: 1 0 0 0 1 0 0 0 1 10 20 -30
FixedParameters: 0 0 0
"""


TURN = [0.1, 0.2, 0.3]
AFFINE = [1, 0.2, 0, -0.1, 0.9, 0, 0.1, 0.3, 1.2, 4, 5, 6]
LINEAR_KINDS = {
    "AffineTransform": AFFINE,
    "Euler3DTransform": [*TURN, 4, 5, 6],
    "Similarity3DTransform": [*TURN, 4, 5, 6, 1.5],
    "TranslationTransform": [4, 5, 6],
    "IdentityTransform": [],
}
"""Of those that SimpleITK reads, with numbers."""


def itk_text(kind: str, parameters, fixed, number: int = 0) -> str:
    numbers = (" ".join(map(str, some)) for some in (parameters, fixed))
    return "#Transform {}\nTransform: {}_double_3_3\nParameters: {}\nFixedParameters: {}\n".format(number, kind, *numbers)


@pytest.mark.parametrize("last", [(), (0,), (1,)], ids=["", "zxy", "zyx"])
@pytest.mark.parametrize("kind", LINEAR_KINDS)
def test_every_linear_kind_of_itk_moves_points_as_itk_does(tmp_path, kind, last):
    fixed = [] if kind in ("TranslationTransform", "IdentityTransform") else [10, -20, 30, *(last if "Euler" in kind else ())]
    head, one = "#Insight Transform File V1.0\n", itk_text(kind, LINEAR_KINDS[kind], fixed, 1)
    (tmp_path / "one.tfm").write_text(head + one)
    (tmp_path / "composite.tfm").write_text(head + itk_text("CompositeTransform", (), ()) + one)
    (tmp_path / "two.tfm").write_text(
        head + itk_text("CompositeTransform", (), ()) + one + itk_text("AffineTransform", AFFINE, (1, 2, 3), 2)
    )
    oracle = ras_matrix(tmp_path / "composite.tfm")
    np.testing.assert_allclose(read_transform(tmp_path / "one.tfm"), oracle, atol=1e-9)
    # As .h5 and .txt, and several in one
    for name in ("composite.tfm", "two.tfm"):
        for suffix in (".tfm", ".txt", ".h5"):
            path = tmp_path / f"again{suffix}"
            sitk.WriteTransform(sitk.ReadTransform(str(tmp_path / name)), str(path))
            np.testing.assert_allclose(read_transform(path), ras_matrix(tmp_path / name), atol=1e-9)


@pytest.mark.parametrize("content", [OLDER_HDF5, COMPRESSED_HDF5], ids=["older", "compressed"])
def test_hdf5_of_other_programs_is_read_as_simpleitk_reads_it(tmp_path, content):
    path = tmp_path / "move.h5"
    path.write_bytes(content)
    np.testing.assert_allclose(read_transform(path), ras_matrix(path), atol=1e-9)


FAR = oblique_matrix(spacing=(0.1, 1, 10))
FAR[:3, 3] = (1e6, -2e6, 0.123)


@pytest.mark.parametrize("suffix", [".tfm", ".txt", ".h5"])
@pytest.mark.parametrize("matrix", [oblique_matrix(), FAR], ids=["near", "over a kilometer away"])
def test_a_written_transform_reads_back(tmp_path, suffix, matrix):
    write_transform(matrix, tmp_path / f"move{suffix}")
    np.testing.assert_allclose(read_transform(tmp_path / f"move{suffix}"), matrix, atol=1e-12 if matrix is not FAR else 1e-6)
    with pytest.raises(GeometryError):
        write_transform(np.zeros((4, 4)), tmp_path / "move.tfm")
    with pytest.raises(OutputError, match=r"\.tfm, \.txt, \.h5"):
        write_transform(matrix, tmp_path / "move.mat")


def test_a_ct_placed_by_its_transform_lies_where_slicer_shows_it(tmp_path):
    """Resampling with the file's transform, as ITK does it, must agree with moving the grid by the node's matrix."""
    write_volume(noise_volume(), tmp_path / "ct.nrrd")
    move = oblique_matrix(spacing=(1, 1, 1))
    write_transform(move, tmp_path / "registration.tfm")
    ct = read_volume(tmp_path / "ct.nrrd")
    moved_point_ras = transform_points(ct.placed_by(read_transform(tmp_path / "registration.tfm")).ijk_to_reference, (1, 2, 3))
    back_lps = sitk.ReadTransform(str(tmp_path / "registration.tfm")).TransformPoint((moved_point_ras * (-1, -1, 1)).tolist())
    index = sitk.ReadImage(str(tmp_path / "ct.nrrd")).TransformPhysicalPointToContinuousIndex(back_lps)
    np.testing.assert_allclose(index, (1, 2, 3), atol=1e-9)


NO_REGISTRATIONS = {
    "bent.h5": (sitk.BSplineTransform(3), "must be linear"),
    "field.h5": (sitk.DisplacementFieldTransform(sitk.Image([3, 3, 3], sitk.sitkVectorFloat64)), "must be linear"),
    "flat.h5": (sitk.Euler2DTransform(), "must be linear and 3D"),
    "singular.h5": (sitk.ScaleTransform(3, (1.0, 1.0, 0.0)), "singular"),
}
ONE_NUMBER = SAVED_BY_SLICER.replace("1 0 0 0 1 0 0 0 1 10 20 -30", "1")
CENTERED = "#Insight Transform File V1.0\n" + itk_text("CenteredEuler3DTransform", range(9), (0, 0, 0))
UNREADABLE = "SimpleITK cannot read it"


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        *((name, transform, expected) for name, (transform, expected) in NO_REGISTRATIONS.items()),
        ("missing.tfm", None, "no such file"),
        ("move.tfm", "hello", "not an ITK transform file"),
        ("move.h5", "hello", "not an ITK transform file"),
        ("move.mat", "hello", "suffix must be one of"),
        ("move.tfm", ONE_NUMBER, "Error setting parameters"),
        ("move.tfm", "#Insight Transform File V1.0\n", UNREADABLE),
        ("move.tfm", SAVED_BY_SLICER.replace("Parameters: 1", "Parameters: one"), UNREADABLE),
        ("move.tfm", SAVED_BY_SLICER + "hello\n", "Tags must be delimited by"),
        ("move.tfm", SAVED_BY_SLICER + SAVED_BY_SLICER, "several in a composite; got 2"),
        ("move.tfm", SAVED_BY_SLICER[:-25], "cut short"),
        ("move.tfm", SAVED_BY_SLICER.replace("AffineTransform_double_3_3", "Affine"), UNREADABLE),
        ("move.tfm", CENTERED, UNREADABLE),
        ("move.h5", COMPRESSED_HDF5[:2000], UNREADABLE),
    ],
)
def test_a_file_that_holds_no_transform_is_refused(tmp_path, name, content, expected):
    path = tmp_path / name
    if isinstance(content, sitk.Transform):
        sitk.WriteTransform(content, str(path))
    elif content is not None:
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    assert expected in refusal(path, read_transform, FileFormatError)

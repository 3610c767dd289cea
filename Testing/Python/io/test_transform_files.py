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


def lps_matrix(transform: sitk.Transform) -> np.ndarray:
    """The 4x4 matrix of a linear transform from what it does to points, by least squares."""
    points = np.random.default_rng(5).normal(size=(20, 3)) * 100
    moved = np.array([transform.TransformPoint(point.tolist()) for point in points])
    solution, *_ = np.linalg.lstsq(np.column_stack([points, np.ones(20)]), moved, rcond=None)
    return np.vstack([solution.T, (0, 0, 0, 1)])


def linear_transforms() -> list[sitk.Transform]:
    affine = sitk.AffineTransform(3)
    affine.SetMatrix([1.1, 0.2, 0.0, -0.1, 0.9, 0.1, 0.0, 0.3, 1.2])
    affine.SetTranslation([5.0, -6.0, 7.0])
    affine.SetCenter([10.0, 20.0, 30.0])
    euler = sitk.Euler3DTransform([1.0, 2.0, 3.0], 0.1, 0.2, 0.3, [4.0, 5.0, 6.0])
    versor = sitk.VersorRigid3DTransform([0.1, 0.2, 0.3, 0.927], [4.0, 5.0, 6.0], [1.0, 2.0, 3.0])
    similarity = sitk.Similarity3DTransform(1.5, [0.1, 0.2, 0.3, 0.927], [4.0, 5.0, 6.0], [1.0, 2.0, 3.0])
    translation = sitk.TranslationTransform(3, [4.0, 5.0, 6.0])
    composite = sitk.CompositeTransform([affine, euler, translation])
    return [affine, euler, versor, similarity, translation, sitk.Transform(3, sitk.sitkIdentity), composite]


SAVED_BY_SLICER = """#Insight Transform File V1.0
#Transform 0
Transform: AffineTransform_double_3_3
Parameters: 1 0 0 0 1 0 0 0 1 10 20 -30
FixedParameters: 0 0 0
"""


def test_a_transform_saved_by_slicer_is_its_node_in_ras(tmp_path):
    # A node that moves its content 10 mm right, 20 anterior, 30 superior: Slicer writes the way back, in LPS.
    path = tmp_path / "registration.tfm"
    path.write_text(SAVED_BY_SLICER)
    np.testing.assert_allclose(read_transform(path)[:3, 3], (10, 20, 30))


def test_a_rotation_saved_by_slicer_turns_the_right_way(tmp_path):
    # A node that turns right into anterior (about superior): F inv(R) F = R^T, which the file holds.
    path = tmp_path / "registration.tfm"
    path.write_text(SAVED_BY_SLICER.replace("1 0 0 0 1 0 0 0 1 10 20 -30", "0 1 0 -1 0 0 0 0 1 0 0 0"))
    np.testing.assert_allclose(read_transform(path)[:3, :3] @ (1, 0, 0), (0, 1, 0), atol=1e-12)


@pytest.mark.parametrize("suffix", [".tfm", ".txt", ".h5"])
@pytest.mark.parametrize("transform", linear_transforms(), ids=lambda transform: transform.GetName())
def test_every_linear_kind_is_read(tmp_path, suffix, transform):
    path = tmp_path / f"transform{suffix}"
    sitk.WriteTransform(transform, str(path))
    flip = np.diag([-1.0, -1.0, 1.0, 1.0])
    np.testing.assert_allclose(read_transform(path), flip @ np.linalg.inv(lps_matrix(transform)) @ flip, atol=1e-9)


TURN = [0.1, 0.2, 0.3]
AFFINE = [1, 0.2, 0, -0.1, 0.9, 0, 0.1, 0.3, 1.2, 4, 5, 6]
LINEAR_KINDS = {
    "AffineTransform": AFFINE,
    "MatrixOffsetTransformBase": AFFINE,
    "Euler3DTransform": [*TURN, 4, 5, 6],
    "VersorRigid3DTransform": [*TURN, 4, 5, 6],
    "QuaternionRigidTransform": [*TURN, 0.927, 4, 5, 6],
    "ScaleLogarithmicTransform": TURN,
    "ScaleTransform": [1.1, 0.8, 2],
    "VersorTransform": TURN,
    "Similarity3DTransform": [*TURN, 4, 5, 6, 1.5],
    "ScaleVersor3DTransform": [*TURN, 4, 5, 6, 1.1, 0.8, 2],
    "ScaleSkewVersor3DTransform": [*TURN, 4, 5, 6, 1.1, 0.8, 2, *TURN, *TURN],
    "TranslationTransform": [4, 5, 6],
    "IdentityTransform": [],
}
"""All that SimpleITK reads, with numbers."""


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
    flip = np.diag([-1.0, -1.0, 1.0, 1.0])
    oracle = lps_matrix(sitk.ReadTransform(str(tmp_path / "composite.tfm")))
    np.testing.assert_allclose(read_transform(tmp_path / "one.tfm"), flip @ np.linalg.inv(oracle) @ flip, atol=1e-9)


def test_a_kind_that_simpleitk_does_not_have_is_refused(tmp_path):
    (tmp_path / "one.tfm").write_text("#Insight Transform File V1.0\n" + itk_text("CenteredEuler3DTransform", range(9), (0, 0, 0)))
    assert "SimpleITK cannot read it" in refusal(tmp_path / "one.tfm", read_transform, FileFormatError)


@pytest.mark.parametrize("content", [OLDER_HDF5, COMPRESSED_HDF5], ids=["older", "compressed"])
def test_hdf5_of_other_programs_is_read_as_simpleitk_reads_it(tmp_path, content):
    path = tmp_path / "move.h5"
    path.write_bytes(content)
    flip = np.diag([-1.0, -1.0, 1.0, 1.0])
    np.testing.assert_allclose(read_transform(path), flip @ np.linalg.inv(lps_matrix(sitk.ReadTransform(str(path)))) @ flip, atol=1e-9)


def test_a_cut_hdf5_is_refused(tmp_path):
    (tmp_path / "move.h5").write_bytes(COMPRESSED_HDF5[:2000])
    assert "SimpleITK cannot read it" in refusal(tmp_path / "move.h5", read_transform, FileFormatError)


@pytest.mark.parametrize("suffix", [".tfm", ".txt", ".h5"])
def test_a_written_transform_reads_back(tmp_path, suffix):
    write_transform(oblique_matrix(), tmp_path / f"move{suffix}")
    np.testing.assert_allclose(read_transform(tmp_path / f"move{suffix}"), oblique_matrix(), atol=1e-12)


@pytest.mark.parametrize("suffix", [".tfm", ".h5"])
def test_a_transform_over_a_kilometer_is_written(tmp_path, suffix):
    far = oblique_matrix(spacing=(0.1, 1, 10))
    far[:3, 3] = (1e6, -2e6, 0.123)
    write_transform(far, tmp_path / f"move{suffix}")
    np.testing.assert_allclose(read_transform(tmp_path / f"move{suffix}"), far, atol=1e-6)


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


@pytest.mark.parametrize(
    ("transform", "expected"),
    [
        (sitk.BSplineTransform(3), "must be linear"),
        (sitk.DisplacementFieldTransform(sitk.Image([3, 3, 3], sitk.sitkVectorFloat64)), "must be linear"),
        (sitk.Euler2DTransform(), "must be linear and 3D"),
        (sitk.ScaleTransform(3, (1.0, 1.0, 0.0)), "singular"),
    ],
)
def test_a_transform_that_is_no_registration_is_refused(tmp_path, transform, expected):
    sitk.WriteTransform(transform, str(tmp_path / "move.h5"))
    assert expected in refusal(tmp_path / "move.h5", read_transform, FileFormatError)


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("move.tfm", b"hello", "not an ITK transform file"),
        ("move.h5", b"hello", "not an ITK transform file"),
        ("move.mat", b"hello", "suffix must be one of"),
        ("move.tfm", SAVED_BY_SLICER.replace("1 0 0 0 1 0 0 0 1 10 20 -30", "1").encode(), "Error setting parameters"),
        ("move.tfm", b"#Insight Transform File V1.0\n", "SimpleITK cannot read it"),
        ("move.tfm", SAVED_BY_SLICER.replace("Parameters: 1", "Parameters: one").encode(), "SimpleITK cannot read it"),
        ("move.tfm", (SAVED_BY_SLICER + "hello\n").encode(), "Tags must be delimited by"),
        ("move.tfm", (SAVED_BY_SLICER + SAVED_BY_SLICER).encode(), "several in a composite; got 2"),
        ("move.tfm", SAVED_BY_SLICER[:-25].encode(), "cut short"),
        ("move.tfm", SAVED_BY_SLICER.replace("AffineTransform_double_3_3", "Affine").encode(), "SimpleITK cannot read it"),
    ],
)
def test_a_file_that_holds_no_transform_is_refused(tmp_path, name, content, expected):
    (tmp_path / name).write_bytes(content)
    assert expected in refusal(tmp_path / name, read_transform, FileFormatError)


def test_a_missing_transform_is_named(tmp_path):
    assert "no such file" in refusal(tmp_path / "move.tfm", read_transform, FileFormatError)


def test_a_singular_matrix_is_not_written(tmp_path):
    with pytest.raises(GeometryError):
        write_transform(np.zeros((4, 4)), tmp_path / "move.tfm")


def test_an_unknown_transform_suffix_lists_those_that_are_known(tmp_path):
    with pytest.raises(OutputError, match=r"\.tfm, \.txt, \.h5"):
        write_transform(np.eye(4), tmp_path / "move.mat")

"""Volume files: the place in space, both ways, and nothing that is damaged passes for whole."""

from __future__ import annotations

import gzip
import struct
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
import SimpleITK as sitk
from sequence_samples import nrrd
from volume_samples import noise_volume, refusal

from AIFReconLib.commands.parser import main
from AIFReconLib.errors import OutputError
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.volume.files import read_volume, write_volume
from AIFReconLib.io.volume.label_files import read_label_names, read_labels

SUFFIXES = (".nrrd", ".mha", ".mhd", ".nii", ".nii.gz")


def write_nrrd(path: Path, space: str, directions: str = "(1,0,0) (0,2,0) (0,0,3)") -> Path:
    """A hand-written volume of 4 x 3 x 2 voxels, 1 x 2 x 3 mm, voxel (0, 0, 0) at 10, 20, 30."""
    pixels = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
    placed: dict[str, Any] = {"space": space, "space_directions": directions, "space_origin": "(10,20,30)", "kinds": "domain domain domain"}
    return nrrd(path, pixels, {}, **placed)


# The place in space


@pytest.mark.parametrize("dtype", ["?", "u1", "i1", "u2", "i2", "i4", "f4", "f8"])
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_round_trip_keeps_every_voxel_its_type_and_its_place_which_files_hold_in_lps(tmp_path, suffix, dtype):
    for mirrored in (False, True):
        volume, path = noise_volume(dtype, mirrored), tmp_path / f"{mirrored}{suffix}"
        write_volume(volume, path)
        copy, image = read_volume(path), sitk.ReadImage(str(path))
        np.testing.assert_array_equal(copy.array, volume.array)
        assert copy.array.dtype == (np.uint8 if dtype == "?" else volume.array.dtype)
        # NIfTI holds its matrix in single precision.
        np.testing.assert_allclose(copy.ijk_to_reference, volume.ijk_to_reference, atol=1e-5 if ".nii" in suffix else 1e-12)
        x, y, z = transform_points(volume.ijk_to_reference, (4, 2, 6))
        np.testing.assert_allclose(image.TransformIndexToPhysicalPoint((4, 2, 6)), (-x, -y, z), atol=1e-4)
        assert image[4, 2, 6] == volume.array[6, 2, 4]
    suffixes = (".mhd", ".zraw") if suffix == ".mhd" else (suffix,)
    assert {file.name for file in tmp_path.iterdir()} == {f"{name}{each}" for name in (False, True) for each in suffixes}


# Writing


@pytest.mark.parametrize(
    ("dtype", "name", "message"),
    [
        ("u1", "volume.vtk", r"\.nrrd, \.mha, \.mhd, \.nii, \.nii\.gz"),
        ("f2", "volume.nrrd", "cannot hold float16"),
        ("u1", "missing/volume.nrrd", "does not exist"),
    ],
)
def test_what_cannot_be_written_is_refused_with_the_reason(tmp_path, dtype, name, message):
    with pytest.raises(OutputError, match=message):
        noise_volume(dtype).write(tmp_path / name)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_file_that_came_out_incomplete_or_failed_does_not_get_its_name(tmp_path, monkeypatch, suffix):
    write = sitk.WriteImage

    def write_half(image, name, **keywords):
        write(image, name, **keywords)
        data = max(Path(name).parent.iterdir(), key=lambda path: (path.suffix in (".raw", ".zraw"), path.name))
        data.write_bytes(data.read_bytes()[:-20])

    fail = Mock(side_effect=RuntimeError("Exception thrown in SimpleITK\nitk.cxx:1:\nITK ERROR: ImageIO(0x55): no space left"))
    for writes, said in ((write_half, "incomplete"), (fail, r"volume\S*: ImageIO: no space left\. Check")):
        monkeypatch.setattr(sitk, "WriteImage", writes)
        with pytest.raises(OutputError, match=said):
            write_volume(noise_volume(), tmp_path / f"volume{suffix}")
        assert list(tmp_path.iterdir()) == []


# Damaged and unsuitable files


@pytest.mark.parametrize("suffix", [".nrrd", ".mha", ".nii.gz", ".nii"])
@pytest.mark.parametrize("kept", [0.3, 0.8, 0.97, -1])
def test_a_truncated_volume_is_never_read_as_zeros(tmp_path, suffix, kept):
    path = tmp_path / f"volume{suffix}"
    write_volume(noise_volume("f8"), path)
    content = path.read_bytes()
    path.write_bytes(content[: kept if kept < 0 else int(kept * len(content))])
    said = "the voxels are cut short or corrupt (of 7 slices 6 are whole)" if suffix == ".nii" else "cut short"
    assert said in refusal(path) or kept > 0


NO_NIFTI = [b"", b"abc", b"\0" * 600, struct.pack("<i", 348) + b"\0" * 400, struct.pack(">i", 540) + b"\0" * 600]


@pytest.mark.parametrize("content", [*NO_NIFTI, struct.pack("<i4s", 540, b"n+2\0") + bytes(600)])
def test_a_nifti_without_a_sensible_header_is_refused(tmp_path, content):
    for suffix in (".nii", ".nii.gz"):
        path = tmp_path / f"volume{suffix}"
        path.write_bytes(gzip.compress(content) if suffix == ".nii.gz" else content)
        assert "as NIfTI-1" in refusal(path)


def test_what_is_no_volume_is_told_in_one_line_with_the_path(tmp_path, real_data):
    for directions in ("(1,0,0) (1,0,0) (0,0,3)", "(1,0,0) (1,2,0) (0,0,3)"):
        refusal(write_nrrd(tmp_path / "ct.nrrd", "left-posterior-superior", directions))
    for name, said in (("none.nrrd", "no such file"), ("ct.dcm", ".nii.gz")):
        assert said in refusal(tmp_path / name)
    assert "Give a sequence as a sequence" in refusal(real_data("SpinePhantomFreehand.igs.mha"))
    volume = read_volume(real_data("Reference_NNMEAN.mha"))
    assert volume.grid.size == (147, 106, 105)
    np.testing.assert_allclose(volume.grid.origin, (74.5217, -165.573, 29.072))


@pytest.mark.parametrize(
    ("image", "suffixes", "expected"),
    [
        (sitk.Image([4, 3, 2], sitk.sitkVectorUInt8, 3), (".nrrd", ".mha", ".nii.gz"), "single numbers; got 3"),
        (sitk.Image([4, 3, 2, 2], sitk.sitkUInt8), (".nrrd", ".mha", ".nii.gz"), "3D"),
        (sitk.Image([4, 3], sitk.sitkUInt8), (".nrrd", ".mha", ".nii.gz"), "3D"),
        (sitk.Image([4, 3, 2], sitk.sitkComplexFloat32), (".nii",), "real numbers"),
    ],
)
def test_only_scalar_3d_volumes_are_read(tmp_path, image, suffixes, expected):
    for suffix in suffixes:
        sitk.WriteImage(image, str(tmp_path / f"image{suffix}"))
        assert expected in refusal(tmp_path / f"image{suffix}")


# Labels


@pytest.mark.parametrize("dtype", ["u1", "i2", "f4", "f8"])
def test_labels_are_whole_numbers_whatever_the_file_holds(tmp_path, dtype):
    volume = noise_volume(dtype)
    rounded = volume.array + (1.7e-4 if dtype[0] == "f" else 0)
    write_volume(Volume(rounded.astype(dtype), volume.ijk_to_reference), tmp_path / "labels.nrrd")
    labels = read_labels(tmp_path / "labels.nrrd", labels="1-99")
    np.testing.assert_array_equal(labels.array, volume.array)
    assert labels.array.dtype.kind in "iu"


NO_LABELS = {
    0.5: "BoneMap.from_probability",
    28.5: "Export them without smoothing",
    np.nan: "whole numbers",
    1e12: "whole numbers",
    -1000: "CT",
}


@pytest.mark.parametrize(("value", "expected"), NO_LABELS.items())
def test_what_cannot_be_labels_is_refused(tmp_path, value, expected):
    array = np.zeros((2, 3, 4), np.float32)
    array[1, 1, 1] = value
    write_volume(Volume(array, np.eye(4)), tmp_path / "labels.nrrd")
    assert expected in refusal(tmp_path / "labels.nrrd", read_labels)


def layered_segmentation(path: Path, metadata: str) -> Path:
    """Two layers, as Slicer saves overlapping segments: voxel i=1 in the first, voxel i=2 in the second."""
    layers = np.zeros((2, 3, 4, 2), np.uint8)
    layers[0, 0, 1, 0] = 1
    layers[0, 0, 2, 1] = 2
    header = "NRRD0004\ntype: uint8\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 4 3 2\n"
    header += "space directions: none (1,0,0) (0,2,0) (0,0,3)\nkinds: list domain domain domain\nencoding: gzip\n"
    header += f"space origin: (10,20,30)\n{metadata}\n"
    path.write_bytes(header.encode() + gzip.compress(layers.tobytes()))
    return path


def test_overlapping_segments_are_merged_and_lose_their_names(tmp_path):
    fields = "".join(f"Segment{n}_Layer:={n}\nSegment{n}_LabelValue:=1\nSegment{n}_Name:={name}\n" for n, name in enumerate("ab"))
    path = layered_segmentation(tmp_path / "bone.seg.nrrd", fields)
    labels = read_labels(path, labels="1-99")
    assert np.argwhere(labels.array).tolist() == [[0, 0, 1], [0, 0, 2]]
    np.testing.assert_allclose(labels.grid.origin, (-10, -20, 30))
    assert read_label_names(path) == {}
    assert "label volume" in refusal(layered_segmentation(tmp_path / "color.nrrd", ""), read_labels)
    Volume(np.ones((2, 3, 4), np.uint8), np.eye(4), {}).write(path)
    fields = "Segment0_LabelValue:=7\nSegment0_Layer:=0\nSegment0_Name:=vertebra L3\nSegment1_Name:=no number\n"
    fields += f"Segment2_Name:=too long\nSegment2_LabelValue:={'7' * 5000}\n"
    path.write_bytes(path.read_bytes().replace(b"\n\n", b"\n" + fields.encode() + b"\n", 1))
    assert read_label_names(path) == {7: "vertebra L3"}


def two_forms(path: Path, codes=(1, 1), moved=(0.0, 0.0, 0.0), stretched=1.0) -> Path:
    """A NIfTI file whose sform is not its qform."""
    write_volume(noise_volume(), path)
    head = bytearray(path.read_bytes())
    struct.pack_into("<2h", head, 252, *codes)
    rows = np.reshape(struct.unpack_from("<12f", head, 280), (3, 4)) * stretched
    rows[:, 3] += moved
    struct.pack_into("<12f", head, 280, *rows.ravel())
    path.write_bytes(head)
    return path


APART = "its qform and sform place voxels up to {} mm apart. The {} is taken, as ITK does; if"


@pytest.mark.parametrize(
    ("codes", "moved", "said"),
    [
        *(((code, 1), (3.0, -4.0, 0.0), APART.format(5, "sform")) for code in (1, 2)),
        ((1, 2), (3.0, -4.0, 0.0), APART.format(5, "qform")),
        ((0, 0), (0.0, 0.0, 0.0), "both form codes are 0"),
        ((1, 1), (0.0, 0.0, 0.0), None),
        ((1, 1), (0.1, 0.0, 0.0), None),
        ((0, 1), (3.0, 0.0, 0.0), None),
    ],
)
def test_a_nifti_whose_forms_contradict_each_other_lies_where_itk_puts_it_and_is_noted(tmp_path, caplog, codes, moved, said):
    path = two_forms(tmp_path / "ct.nii", codes, moved)
    found = read_volume(path)
    assert [said in message and message.startswith(f"{path}: ") for message in caplog.messages] == [True] * (said is not None)
    np.testing.assert_allclose(found.ijk_to_reference[:3, 3] * (-1, -1, 1), sitk.ReadImage(str(path)).GetOrigin(), atol=1e-5)
    # A quaternion that is no number does not count
    head = bytearray(path.read_bytes())
    struct.pack_into("<f", head, 256, np.nan)
    path.write_bytes(head)
    np.testing.assert_allclose(read_volume(path).ijk_to_reference[:3, 3] * (-1, -1, 1), sitk.ReadImage(str(path)).GetOrigin(), atol=1e-5)


def test_the_forms_of_a_nifti_are_told_in_one_line_without_those_of_itk(tmp_path, capfd):
    path = two_forms(tmp_path / "labels.nii", stretched=1.2)
    main(["bone-map", str(path), "--labels", "1-99", "--output", str(tmp_path / "map.nrrd")])
    assert [line.partition(" place")[0] for line in capfd.readouterr().err.splitlines()] == [f"{path}: its qform and sform"]

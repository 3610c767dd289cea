"""MetaImage and NRRD volumes lie where SimpleITK puts them, voxel for voxel, and headers made to mislead it do not mislead us."""

from __future__ import annotations

import gc
import gzip
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from volume_samples import refusal

from AIFReconLib.errors import InsufficientMemoryError
from AIFReconLib.geometry.transforms import LPS_FROM_RAS
from AIFReconLib.io.disk import itk
from AIFReconLib.io.volume import itk_reading
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.io.volume.itk_reading import read_metafile_volume

DATA = bytes(range(96))


def nrrd(path: Path, payload: bytes = DATA, **changes: str | None) -> Path:
    header = {
        "type": "short",
        "dimension": "3",
        "space": "left-posterior-superior",
        "space dimension": None,
        "sizes": "4 3 4",
        "space directions": "(0,0.5,0) (0,0,-1) (2,0,0)",
        "kinds": "domain domain domain",
        "encoding": "raw",
        "endian": "little",
        "space origin": "(10,-20.5,3e1)",
        **{key.replace("_", " "): value for key, value in changes.items()},
    }
    lines = "".join(f"{key}: {value}\n" for key, value in header.items() if value is not None)
    path.write_bytes(b"NRRD0005\n" + lines.encode() + b"\n" + payload)
    return path


def metaimage(path: Path, payload: bytes = DATA, first: str = "", **changes: str | None) -> Path:
    header = {
        "ObjectType": "Image",
        "NDims": "3",
        "BinaryData": "True",
        "BinaryDataByteOrderMSB": "False",
        "CompressedData": "False",
        "TransformMatrix": "0 1 0 0 0 -1 1 0 0",
        "Offset": "10 -20.5 3e1",
        "ElementSpacing": "0.5 1 2",
        "DimSize": "4 3 4",
        "ElementType": "MET_SHORT",
        **{key: value for key, value in changes.items() if key != "ElementDataFile"},
        "ElementDataFile": changes.get("ElementDataFile", "LOCAL"),
    }
    lines = "".join(f"{key} = {value}\n" for key, value in header.items() if value is not None)
    path.write_bytes((first + lines).encode() + payload)
    return path


def assert_as_simpleitk_reads_it(path: Path) -> None:
    array, ijk_to_lps, _ = read_metafile_volume(path)
    image = sitk.ReadImage(str(path))
    np.testing.assert_array_equal(array, sitk.GetArrayFromImage(image))
    assert array.dtype == sitk.GetArrayFromImage(image).dtype
    directions = np.array(image.GetDirection()).reshape(3, 3) * image.GetSpacing()
    np.testing.assert_allclose(ijk_to_lps[:3, :3], directions, atol=1e-12)
    np.testing.assert_allclose(ijk_to_lps[:3, 3], image.GetOrigin(), atol=1e-12)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"space": "right-anterior-superior"},
        {"space": "RAS"},
        {"space": "left-anterior-superior"},
        {"space": "scanner-xyz"},
        {"space": None, "space_dimension": "3"},
        {"space": None, "space_directions": None, "space_origin": None},
        {"space": None, "space_directions": None, "space_origin": None, "spacings": "0.5 1 2", "kinds": None},
        {"space_origin": None},
        {"kinds": "space space space"},
        {"kinds": None},
        {"endian": "big"},
        {"encoding": "gzip"},
        {"type": "unsigned char", "sizes": "4 6 4", "endian": None},
        {"type": "double", "sizes": "1 3 4"},
        {"type": "int64", "sizes": "1 3 4"},
        {"dimension": "4", "sizes": "2 2 3 4", "kinds": "list domain domain domain", "space_directions": "none (1,0,0) (0,1,0) (0,0,1)"},
        {"dimension": "4", "sizes": "3 2 2 4", "kinds": "vector domain domain domain", "space_directions": "none (1,0,0) (0,1,0) (0,0,1)"},
        {"dimension": "4", "sizes": "2 3 4 2", "kinds": "domain domain domain list", "space_directions": "(1,0,0) (0,1,0) (0,0,1) none"},
    ],
    ids=lambda changes: " ".join(f"{key}={value}" for key, value in changes.items()) or "plain",
)
def test_an_nrrd_volume_is_read_as_simpleitk_reads_it(tmp_path, changes):
    assert_as_simpleitk_reads_it(
        nrrd(tmp_path / "ct.nrrd", gzip.compress(DATA, mtime=0) if changes.get("encoding") == "gzip" else DATA, **changes)
    )


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"TransformMatrix": None, "Rotation": "0 1 0 1 0 0 0 0 1"},
        {"TransformMatrix": None, "Offset": None, "Position": "1 2 3"},
        {"ElementSpacing": None},
        {"ElementSpacing": None, "ElementSize": "3 2 1"},
        {"BinaryDataByteOrderMSB": "True"},
        {"CompressedData": "True", "CompressedDataSize": "104"},
        {"ElementType": "MET_FLOAT", "DimSize": "2 3 4"},
        {"ElementNumberOfChannels": "2", "DimSize": "2 3 4"},
        {"AnatomicalOrientation": "RAI", "CenterOfRotation": "5 5 5"},
    ],
    ids=lambda changes: " ".join(f"{key}={value}" for key, value in changes.items()) or "plain",
)
def test_a_metaimage_volume_is_read_as_simpleitk_reads_it(tmp_path, changes):
    payload = DATA
    if "CompressedData" in changes:
        payload = zlib.compress(DATA)
        changes = changes | {"CompressedDataSize": str(len(payload))}
    assert_as_simpleitk_reads_it(metaimage(tmp_path / "ct.mha", payload, **changes))


FOREIGN = b"scanner's own header \0\xff"
"""What other programs write before the pixels."""


@pytest.mark.parametrize("skip", [str(len(FOREIGN)), "-1"])
@pytest.mark.parametrize("suffix", [".mhd", ".nhdr"])
def test_a_raw_file_with_a_header_of_its_own_is_read_as_simpleitk_reads_it(tmp_path, suffix, skip):
    (tmp_path / "ct.raw").write_bytes(FOREIGN + DATA)
    if suffix == ".mhd":
        path = metaimage(tmp_path / "ct.mhd", b"", HeaderSize=skip, ElementDataFile="ct.raw")
    else:
        path = nrrd(tmp_path / "ct.nhdr", b"", byte_skip=skip, data_file="ct.raw")
    assert_as_simpleitk_reads_it(path)


@pytest.mark.parametrize(
    ("skip", "expected"),
    [
        (str(len(FOREIGN) + 1), "the pixel data are cut short"),
        (str(len(FOREIGN) - 1), "there are 1 bytes more"),
        ("9" * 18, "the pixel data are cut short"),
        ("-2", "must be a whole number from 0"),
        ("1e1", "must be a whole number from 0"),
    ],
)
def test_a_raw_file_whose_header_is_of_another_length_is_refused(tmp_path, skip, expected):
    (tmp_path / "ct.raw").write_bytes(FOREIGN + DATA)
    for path in (
        metaimage(tmp_path / "ct.mhd", b"", HeaderSize=skip, ElementDataFile="ct.raw"),
        nrrd(tmp_path / "ct.nhdr", b"", byte_skip=skip, data_file="ct.raw"),
    ):
        assert expected in refusal(path)


@pytest.mark.parametrize("length", [0, 95])
def test_a_raw_file_that_is_too_short_is_refused_however_much_of_it_is_to_be_skipped(tmp_path, length):
    (tmp_path / "ct.raw").write_bytes(DATA[:length])
    assert f"needs 96 bytes, there are {length}" in refusal(metaimage(tmp_path / "ct.mhd", b"", HeaderSize="-1", ElementDataFile="ct.raw"))


def test_bytes_cannot_be_skipped_before_compressed_pixels(tmp_path):
    (tmp_path / "ct.raw").write_bytes(FOREIGN + gzip.compress(DATA))
    path = nrrd(tmp_path / "ct.nhdr", b"", byte_skip=str(len(FOREIGN)), data_file="ct.raw", encoding="gzip")
    assert "byte skip must be 0 where pixels are compressed or follow the header" in refusal(path)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"space": None, "space_dimension": "3"}, "does not say which"),
        ({"space": "scanner-xyz"}, "says 'scanner-xyz'"),
        ({"space": "RAS"}, None),
        ({"space": "left-anterior-superior"}, None),
    ],
)
def test_a_frame_that_is_not_named_is_noted(tmp_path, caplog, changes, said):
    read_volume(nrrd(tmp_path / "ct.nrrd", **changes))
    assert [said in message and "is taken to be LPS" in message for message in caplog.messages] == [True] * (said is not None)


def test_a_volume_is_held_once(tmp_path):
    """The array is the memory of SimpleITK's image, which lives as long as it."""
    (k, j, i), (stored, _, _) = (4, 3, 4), read_metafile_volume(nrrd(tmp_path / "ct.nrrd"))
    expected = np.frombuffer(DATA, "<i2").reshape(k, j, i)
    gc.collect()
    np.testing.assert_array_equal(stored, expected)
    assert not stored.flags.owndata
    stored[0, 0, 0] = 7
    assert stored[0, 0, 0] == 7


@pytest.mark.skipif(sys.platform == "win32", reason="stands in for Windows")
def test_on_windows_names_beyond_ascii_are_read(tmp_path, monkeypatch):
    monkeypatch.setattr(itk.sys, "platform", "win32")
    read, read_image = [], sitk.ReadImage
    monkeypatch.setattr(sitk, "ReadImage", lambda name, **given: read.append(name) or read_image(name, **given))
    (tmp_path / "Müller").mkdir()
    (tmp_path / "Müller" / "ct.raw").write_bytes(DATA)
    path = metaimage(tmp_path / "Müller" / "ct.mhd", b"", ElementDataFile="ct.raw")
    assert read_volume(path).shape == (4, 3, 4)
    assert read[0].isascii()


def test_the_place_is_brought_from_lps_to_ras(tmp_path):
    volume = read_volume(nrrd(tmp_path / "ct.nrrd"))
    np.testing.assert_array_equal(volume.grid.origin, (-10, 20.5, 30))
    np.testing.assert_array_equal((LPS_FROM_RAS @ volume.ijk_to_reference)[:3, 0], (0, 0.5, 0))


def test_compressed_pixels_of_unknown_length_are_refused(tmp_path):
    """MetaIO reads other voxels then."""
    path = metaimage(tmp_path / "ct.mha", zlib.compress(DATA), CompressedData="True")
    assert "CompressedDataSize is missing" in refusal(path)


def test_a_note_of_any_length_is_read(tmp_path):
    path = nrrd(tmp_path / "ct.nrrd")
    path.write_bytes(path.read_bytes().replace(b"\n", b"\nAIFRecon_note:=" + b'{"a": 1}' * 1000 + b"\n", 1))
    assert read_volume(path).fields == {"AIFRecon_note": '{"a": 1}' * 1000}


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"space": "left-posterior-superior-time"}, "space dimension is 4"),
        ({"space_directions": "(1,0,0) (0,1,0)"}, "space directions must be a vector"),
        ({"space_directions": "(1,0,0) (0,1,0) none"}, "space directions must be a vector"),
        ({"space_directions": "(1,0,0) (0,1,0) (0,0)"}, "SimpleITK cannot read it: "),
        ({"space_directions": "(1,0,0) (0,1,0) (0,0,nan)"}, "SimpleITK cannot read it: "),
        ({"space_origin": "1 2 3"}, "SimpleITK cannot read it: "),
        ({"space_directions": None}, "no space directions"),
        ({"space_directions": None, "space_origin": None, "spacings": "1 1"}, "SimpleITK cannot read it: "),
        ({"space_directions": None, "space_origin": None, "spacings": "1 1 0"}, "SimpleITK cannot read it: "),
        ({"kinds": "domain domain list"}, "it must be one 3D volume; got axes of the kinds"),
        ({"dimension": "4", "sizes": "4 3 2 2", "kinds": "domain domain domain time"}, "it must be one 3D volume; got axes of the kinds"),
    ],
)
def test_a_place_that_cannot_be_told_is_refused(tmp_path, changes, expected):
    assert expected in refusal(nrrd(tmp_path / "ct.nrrd", **changes))


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"ElementSpacing": "1 1"}, "ElementSpacing must be 3 finite numbers"),
        ({"ElementSpacing": "1 -1 1"}, "ElementSpacing must be positive"),
        ({"TransformMatrix": "1 0 0 0 1 0"}, "TransformMatrix must be 9 finite numbers"),
        ({"Offset": "1 2 nowhere"}, "Offset must be 3 finite numbers"),
        ({"NDims": "2", "DimSize": "12 4"}, "it must be one 3D volume; got axes of the kinds"),
    ],
)
def test_a_metaimage_without_a_usable_place_is_refused(tmp_path, changes, expected):
    assert expected in refusal(metaimage(tmp_path / "ct.mha", **changes))


def test_voxels_that_do_not_fit_into_memory_are_refused_before_they_are_read(tmp_path, monkeypatch):
    path = nrrd(tmp_path / "ct.nrrd")
    monkeypatch.setattr(itk_reading, "available_memory", lambda: 50)
    with pytest.raises(InsufficientMemoryError, match=r"ct.nrrd: its voxels need"):
        read_volume(path)

"""MetaImage and NRRD volumes lie where SimpleITK puts them, voxel for voxel, and headers made to mislead it do not mislead us."""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sequence_samples
import SimpleITK as sitk
from volume_samples import refusal

from AIFReconLib.errors import InsufficientMemoryError
from AIFReconLib.geometry.transforms import LPS_FROM_RAS
from AIFReconLib.io.disk import itk
from AIFReconLib.io.volume import itk_reading
from AIFReconLib.io.volume.files import read_volume, write_volume
from AIFReconLib.io.volume.itk_reading import read_metafile_volume

DATA = bytes(range(96))


VOXELS = np.frombuffer(DATA, "<i2").reshape(4, 3, 4)


def nrrd(path: Path, payload: bytes = DATA, **changes: str | None) -> Path:
    # The dimension must stand before the directions
    space: dict[str, Any] = {"space": "left-posterior-superior", "space_dimension": None, "space_directions": "(0,0.5,0) (0,0,-1) (2,0,0)"}
    placed = {**space, "space_origin": "(10,-20.5,3e1)", "kinds": "domain domain domain"}
    return sequence_samples.nrrd(path, VOXELS, {}, data=payload, **{**placed, **changes})


def metaimage(path: Path, payload: bytes = DATA, **changes: str | None) -> Path:
    placed: dict[str, Any] = {"TransformMatrix": "0 1 0 0 0 -1 1 0 0", "Offset": "10 -20.5 3e1", "ElementSpacing": "0.5 1 2", "Kinds": None}
    return sequence_samples.metaimage(path, VOXELS, {}, data=payload, **{"UltrasoundImageOrientation": None, **placed, **changes})


def assert_as_simpleitk_reads_it(path: Path) -> None:
    array, ijk_to_lps, _ = read_metafile_volume(path)
    image = sitk.ReadImage(str(path))
    np.testing.assert_array_equal(array, sitk.GetArrayFromImage(image))
    assert array.dtype == sitk.GetArrayFromImage(image).dtype
    directions = np.array(image.GetDirection()).reshape(3, 3) * image.GetSpacing()
    np.testing.assert_allclose(ijk_to_lps[:3, :3], directions, atol=1e-12)
    np.testing.assert_allclose(ijk_to_lps[:3, 3], image.GetOrigin(), atol=1e-12)


NOWHERE = {"space": None, "space_directions": None, "space_origin": None}
OF_TWO = {"dimension": "4", "space_directions": "none (1,0,0) (0,1,0) (0,0,1)"}
NRRDS = [
    {},
    {"space": "right-anterior-superior"},
    {"space": "left-anterior-superior"},
    {"space": "scanner-xyz"},
    {"space": None, "space_dimension": "3"},
    NOWHERE,
    {**NOWHERE, "spacings": "0.5 1 2", "kinds": None},
    {"space_origin": None},
    {"kinds": None},
    {"endian": "big"},
    {"encoding": "gzip"},
    {"type": "unsigned char", "sizes": "4 6 4", "endian": None},
    {"type": "double", "sizes": "1 3 4"},
    {**OF_TWO, "sizes": "2 2 3 4", "kinds": "list domain domain domain"},
    {**OF_TWO, "sizes": "3 2 2 4", "kinds": "vector domain domain domain"},
    {**OF_TWO, "sizes": "2 3 4 2", "kinds": "domain domain domain list", "space_directions": "(1,0,0) (0,1,0) (0,0,1) none"},
]
METAIMAGES = [
    {},
    {"TransformMatrix": None, "Rotation": "0 1 0 1 0 0 0 0 1"},
    {"TransformMatrix": None, "Offset": None, "Position": "1 2 3"},
    {"ElementSpacing": None},
    {"ElementSpacing": None, "ElementSize": "3 2 1"},
    {"BinaryDataByteOrderMSB": "True"},
    {"CompressedData": "True", "CompressedDataSize": str(len(zlib.compress(DATA)))},
    {"ElementType": "MET_FLOAT", "DimSize": "2 3 4"},
    {"ElementNumberOfChannels": "2", "DimSize": "2 3 4"},
    {"AnatomicalOrientation": "RAI", "CenterOfRotation": "5 5 5"},
]


@pytest.mark.parametrize(("write", "changes"), [*((nrrd, changes) for changes in NRRDS), *((metaimage, changes) for changes in METAIMAGES)])
def test_a_volume_is_read_as_simpleitk_reads_it(tmp_path, write, changes):
    payload = gzip.compress(DATA, mtime=0) if "encoding" in changes else zlib.compress(DATA) if "CompressedData" in changes else DATA
    path = write(tmp_path / ("ct.nrrd" if write is nrrd else "ct.mha"), payload, **changes)
    assert_as_simpleitk_reads_it(path)
    if not changes:
        volume = read_volume(path)
        np.testing.assert_array_equal(volume.grid.origin, (-10, 20.5, 30))
        np.testing.assert_array_equal((LPS_FROM_RAS @ volume.ijk_to_reference)[:3, 0], (0, 0.5, 0))


FOREIGN = b"scanner's own header \0\xff"
"""What other programs write before the pixels."""


def detached(folder: Path, skip: str) -> tuple[Path, Path]:
    """A header of either kind whose pixels lie in ct.raw, behind so many bytes."""
    return (
        metaimage(folder / "ct.mhd", b"", HeaderSize=skip, ElementDataFile="ct.raw"),
        nrrd(folder / "ct.nhdr", b"", byte_skip=skip, data_file="ct.raw"),
    )


@pytest.mark.parametrize("skip", [str(len(FOREIGN)), "-1"])
def test_a_raw_file_with_a_header_of_its_own_is_read_as_simpleitk_reads_it(tmp_path, skip):
    (tmp_path / "ct.raw").write_bytes(FOREIGN + DATA)
    for path in detached(tmp_path, skip):
        assert_as_simpleitk_reads_it(path)


@pytest.mark.parametrize(
    ("skip", "data", "expected"),
    [
        (str(len(FOREIGN) + 1), FOREIGN + DATA, "the pixel data are cut short"),
        (str(len(FOREIGN) - 1), FOREIGN + DATA, "there are 1 bytes more"),
        ("9" * 18, FOREIGN + DATA, "the pixel data are cut short"),
        ("1e1", FOREIGN + DATA, "must be a whole number from 0"),
        ("-1", b"", "needs 96 bytes, there are 0"),
        ("-1", DATA[:95], "needs 96 bytes, there are 95"),
    ],
)
def test_a_raw_file_whose_header_is_of_another_length_is_refused(tmp_path, skip, data, expected):
    (tmp_path / "ct.raw").write_bytes(data)
    for path in detached(tmp_path, skip):
        assert expected in refusal(path)


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


def test_a_note_of_any_length_is_read(tmp_path):
    path = nrrd(tmp_path / "ct.nrrd")
    path.write_bytes(path.read_bytes().replace(b"\n", b"\nAIFRecon_note:=" + b'{"a": 1}' * 1000 + b"\n", 1))
    assert read_volume(path).fields == {"AIFRecon_note": '{"a": 1}' * 1000}


UNREADABLE = "SimpleITK cannot read it: "
NO_VOLUME = "it must be one 3D volume; got axes of the kinds"


@pytest.mark.parametrize(
    ("write", "changes", "expected"),
    [
        (nrrd, {"space": "left-posterior-superior-time"}, "space dimension is 4"),
        (nrrd, {"space_directions": "(1,0,0) (0,1,0)"}, "space directions must be a vector"),
        (nrrd, {"space_directions": "(1,0,0) (0,1,0) none"}, "space directions must be a vector"),
        (nrrd, {"space_directions": "(1,0,0) (0,1,0) (0,0,nan)"}, UNREADABLE),
        (nrrd, {"space_origin": "1 2 3"}, UNREADABLE),
        (nrrd, {"space_directions": None}, "no space directions"),
        (nrrd, {**NOWHERE, "space": "LPS", "spacings": "1 1 0"}, UNREADABLE),
        (nrrd, {"kinds": "domain domain list"}, NO_VOLUME),
        (nrrd, {"dimension": "4", "sizes": "4 3 2 2", "kinds": "domain domain domain time"}, NO_VOLUME),
        (nrrd, {"encoding": "gzip", "byte_skip": "7"}, "byte skip must be 0 where pixels are compressed or follow the header"),
        (metaimage, {"ElementSpacing": "1 1"}, "ElementSpacing must be 3 finite numbers"),
        (metaimage, {"ElementSpacing": "1 -1 1"}, "ElementSpacing must be positive"),
        (metaimage, {"TransformMatrix": "1 0 0 0 1 0"}, "TransformMatrix must be 9 finite numbers"),
        (metaimage, {"Offset": "1 2 nowhere"}, "Offset must be 3 finite numbers"),
        (metaimage, {"NDims": "2", "DimSize": "12 4"}, NO_VOLUME),
        (metaimage, {"CompressedData": "True", "CompressedDataSize": None}, "CompressedDataSize is missing"),
    ],
)
def test_a_place_or_voxels_that_cannot_be_told_are_refused(tmp_path, write, changes, expected):
    assert expected in refusal(write(tmp_path / ("ct.nrrd" if write is nrrd else "ct.mha"), **changes))


def test_voxels_that_do_not_fit_into_memory_are_refused_before_they_are_read(tmp_path, monkeypatch):
    nrrd(tmp_path / "ct.nrrd")
    write_volume(read_volume(tmp_path / "ct.nrrd"), tmp_path / "ct.nii.gz")
    monkeypatch.setattr(itk_reading, "available_memory", lambda: 50)
    for name in ("ct.nrrd", "ct.nii.gz"):
        with pytest.raises(InsufficientMemoryError, match=rf"{name}: its voxels need"):
            read_volume(tmp_path / name)


def test_on_windows_names_beyond_ascii_are_read(tmp_path, monkeypatch):
    monkeypatch.setattr(itk.sys, "platform", "win32")
    read, read_image = [], sitk.ReadImage
    monkeypatch.setattr(sitk, "ReadImage", lambda name, **given: read.append(name) or read_image(name, **given))
    (tmp_path / "Müller").mkdir()
    (tmp_path / "Müller" / "ct.raw").write_bytes(DATA)
    path = metaimage(tmp_path / "Müller" / "ct.mhd", b"", ElementDataFile="ct.raw")
    assert read_volume(path).shape == (4, 3, 4)
    assert read[0].isascii()

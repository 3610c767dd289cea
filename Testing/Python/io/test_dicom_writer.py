"""Volumes as DICOM: read back by SimpleITK where they were, in the study that they were added to."""

from __future__ import annotations

import numpy as np
import pydicom
import pytest
import SimpleITK as sitk
from dicom_samples import write_dicom
from sweeps import rigid

from AIFReconLib.errors import FileFormatError, OutputError
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.volume import dicom_writer
from AIFReconLib.io.volume.files import check_volume_path, read_volume, write_volume
from AIFReconLib.io.volume.itk_images import from_sitk

PLACE = rigid((20.0, 10.0, 30.0), (-12.0, -13.0, -11.0)) @ np.diag([0.5, 0.7, 0.9, 1.0])


def volume(dtype=np.uint8, place=PLACE) -> Volume:
    levels = np.random.default_rng(0).integers(0, np.iinfo(dtype).max, (7, 9, 11), dtype=dtype)
    return Volume(levels, place, {"AIFRecon_method": "weighted"})


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("mirrored", [False, True])
def test_voxels_and_their_place_come_back_and_it_says_that_it_is_derived_and_for_research(tmp_path, dtype, mirrored):
    made = volume(dtype, PLACE @ np.diag([1.0, 1.0, -1.0 if mirrored else 1.0, 1.0]))
    write_volume(made, tmp_path / "v.dcm")
    found = from_sitk(sitk.ReadImage(str(tmp_path / "v.dcm")))
    np.testing.assert_array_equal(found.array, made.array)
    np.testing.assert_allclose(found.ijk_to_reference, made.ijk_to_reference, atol=1e-9)
    data = pydicom.dcmread(tmp_path / "v.dcm")
    assert (data.ImageType[0], data.Modality) == ("DERIVED", "US")
    assert "research use" in data.SeriesDescription
    assert "not for diagnosis" in data.DerivationDescription
    assert "AIFRecon_method: weighted" in data.ImageComments


def test_it_joins_the_study_of_the_ct(tmp_path):
    (tmp_path / "ct").mkdir()
    (tmp_path / "ct" / "a.txt").write_text("no DICOM")
    named = {"Modality": "CT", "PatientName": "Doe^Jane", "PatientID": "7"}
    uids = {name: pydicom.uid.generate_uid() for name in ("StudyInstanceUID", "FrameOfReferenceUID", "SeriesInstanceUID")}
    ct = pydicom.dcmread(write_dicom(tmp_path / "ct" / "slice.dcm", np.zeros((4, 4), np.uint8), **named, **uids))
    write_volume(volume(), tmp_path / "v.dcm", tmp_path / "ct")
    data = pydicom.dcmread(tmp_path / "v.dcm")
    for name in ("PatientName", "PatientID", "StudyInstanceUID"):
        assert data[name] == ct[name]
    # It lies in Reference, which need not be the frame of the CT
    for name in ("SeriesInstanceUID", "FrameOfReferenceUID"):
        assert data[name].value != ct[name].value


@pytest.mark.parametrize("dtype", [np.float32, np.uint32])
def test_what_dicom_does_not_hold_is_refused_before_the_work(tmp_path, monkeypatch, dtype):
    path, said = tmp_path / "v.dcm", "whole numbers of 8 or 16 bits"
    with pytest.raises(OutputError, match=said):
        check_volume_path(path, np.dtype(dtype).name)
    with pytest.raises(OutputError, match=said):
        write_volume(Volume(np.zeros((3, 3, 3), dtype), PLACE), path)
    with pytest.raises(FileFormatError, match="no DICOM file that names its study"):
        write_volume(volume(), path, tmp_path)
    assert not path.exists()
    monkeypatch.setattr(dicom_writer, "find_spec", lambda name: None)
    with pytest.raises(OutputError, match="pip install pydicom"):
        check_volume_path(path)


def test_nifti_keeps_its_fields_in_a_file_beside_it(tmp_path):
    write_volume(volume(), tmp_path / "v.nii.gz")
    assert dict(read_volume(tmp_path / "v.nii.gz").fields) == {"AIFRecon_method": "weighted"}
    (tmp_path / "v.json").write_text("[1, 2")
    assert dict(read_volume(tmp_path / "v.nii.gz").fields) == {}

"""Volumes as DICOM: one multi-frame file, placed in the patient's frame, that says it is derived and for research only."""

from __future__ import annotations

import json
from contextlib import suppress
from datetime import datetime
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import FileFormatError, OutputError
from ...geometry.transforms import LPS_FROM_RAS
from ...geometry.volume import Volume
from ..disk.regular_files import files_in

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

SUFFIX = ".dcm"
CLASSES = {"uint8": "1.2.840.10008.5.1.4.1.1.7.2", "uint16": "1.2.840.10008.5.1.4.1.1.7.3"}
"""SOP class of each type of voxel: multi-frame grayscale byte and word secondary capture image storage (PS3.4, B.5)."""

LITTLE_ENDIAN = "1.2.840.10008.1.2.1"

_TAGS = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))

OF_THE_STUDY: list[str] = _TAGS["of_the_study"]
"""What is taken from a file of the study that the volume is added to."""

SAID: dict[str, Any] = _TAGS["said"]
"""What every file says."""


def write_dicom(volume: Volume, path: Path, temporary: Path, study: Path | None = None) -> None:
    """Write a volume of 8 or 16 bits to a file that will be named `path`.

    Raises OutputError when voxels are of another type, the file holds more than DICOM can, or pydicom is not installed; FileFormatError
    when the study cannot be read.

    Parameters
    ----------
    volume : Volume
        Its fields go into the image comments, as far as they fit (10240 characters).
    study : Path or None
        A DICOM file of the patient, or a folder of such: patient and study are taken from it, the frame of reference is not.
    """
    check_dicom(path, volume.array.dtype)
    array = volume.array.astype(np.uint8) if volume.array.dtype == bool else volume.array
    if array.nbytes >= 2**32 - 1:
        raise OutputError(f"Cannot write {path}: a DICOM file holds 4 GB at most. Use a larger spacing, or a .nrrd file.")
    data = _described(volume, array, None if study is None else _of_study(study))
    data.save_as(temporary, enforce_file_format=True)


def check_dicom(path: Path, dtype: np.dtype[Any] | type | str) -> None:
    """Return if voxels of this type can be written as DICOM here; to be asked before a long computation."""
    if find_spec("pydicom") is None:
        raise OutputError(f"Cannot write {path}: that takes the Python package pydicom. Install it: pip install pydicom.")
    if np.dtype(dtype).name not in (*CLASSES, "bool"):
        got = np.dtype(dtype).name
        raise OutputError(f"Cannot write {path}: DICOM holds whole numbers of 8 or 16 bits here; got {got}. Choose a .nrrd file.")


def _of_study(study: Path) -> Dataset:
    pydicom = import_module("pydicom")
    files = files_in(study, "**/*") if study.is_dir() else [study]
    for file in files:
        with suppress(pydicom.errors.InvalidDicomError, OSError, ValueError, EOFError):
            found: Dataset = pydicom.dcmread(file, stop_before_pixels=True, specific_tags=[*OF_THE_STUDY])
            if "StudyInstanceUID" in found:
                return found
    raise FileFormatError(f"{study}: no DICOM file that names its study. Give a file of the CT's series, or its folder.")


def _described(volume: Volume, array: np.ndarray[Any, Any], study: Dataset | None) -> Dataset:
    """The data set, without what the study says where there is none."""
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import generate_uid

    now, kind = datetime.now(), CLASSES[array.dtype.name]
    data, data.file_meta = Dataset(), FileMetaDataset()
    data.file_meta.MediaStorageSOPClassUID = data.SOPClassUID = kind
    data.file_meta.MediaStorageSOPInstanceUID = data.SOPInstanceUID = generate_uid()
    data.file_meta.TransferSyntaxUID = LITTLE_ENDIAN
    taken = {name: "" if study is None else study.get(name, "") for name in OF_THE_STUDY}
    for name, value in {**SAID, **taken}.items():
        setattr(data, name, value)
    data.StudyInstanceUID = data.StudyInstanceUID or generate_uid()
    data.FrameOfReferenceUID, data.SeriesInstanceUID = generate_uid(), generate_uid()
    data.ContentDate = data.SeriesDate = now.strftime("%Y%m%d")
    data.ContentTime = data.SeriesTime = now.strftime("%H%M%S")
    data.ImageComments = "\n".join([SAID["DerivationDescription"], *(f"{key}: {text}" for key, text in volume.fields.items())])[:10240]
    data.NumberOfFrames, data.Rows, data.Columns = array.shape
    data.BitsAllocated = data.BitsStored = 8 * array.dtype.itemsize
    data.HighBit = data.BitsStored - 1
    _place(data, LPS_FROM_RAS @ volume.ijk_to_reference, len(array))
    data.PixelData = np.ascontiguousarray(array.astype(array.dtype.newbyteorder("<"))).tobytes() + b"\0" * (array.nbytes % 2)
    return data


def _place(data: Dataset, ijk_to_lps: np.ndarray[Any, Any], frames: int) -> None:
    """Where the frames lie, one for each k: their orientation and pixel size for all, their positions one by one (PS3.3, C.7.6.16)."""
    from pydicom.dataset import Dataset
    from pydicom.valuerep import format_number_as_ds as decimal

    spacing = np.linalg.norm(ijk_to_lps[:3, :3], axis=0)
    shared, orientation, measures = Dataset(), Dataset(), Dataset()
    orientation.ImageOrientationPatient = [decimal(v) for v in (ijk_to_lps[:3, :2] / spacing[:2]).T.ravel()]
    measures.PixelSpacing = [decimal(spacing[1]), decimal(spacing[0])]
    measures.SliceThickness = measures.SpacingBetweenSlices = decimal(spacing[2])
    shared.PlaneOrientationSequence, shared.PixelMeasuresSequence = [orientation], [measures]
    data.SharedFunctionalGroupsSequence = [shared]
    data.PerFrameFunctionalGroupsSequence = [Dataset() for _ in range(frames)]
    for k, frame in enumerate(data.PerFrameFunctionalGroupsSequence):
        position, content = Dataset(), Dataset()
        position.ImagePositionPatient = [decimal(v) for v in ijk_to_lps[:3, 3] + k * ijk_to_lps[:3, 2]]
        content.StackID, content.InStackPositionNumber = "1", k + 1
        frame.PlanePositionSequence, frame.FrameContentSequence = [position], [content]

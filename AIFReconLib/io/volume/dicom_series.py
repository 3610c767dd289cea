"""A CT as scanners and archives give it: a folder or a file of DICOM, read by SimpleITK (GDCM), or a volume file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import SimpleITK as sitk

from ...arrays import Floats
from ...errors import VolumeFormatError
from ...geometry.transforms import LPS_FROM_RAS
from ...geometry.volume import Volume
from ...machine.memory import available_memory, require_bytes
from ..disk.itk import itk_path, short_cause, without_warnings
from .files import READABLE_SUFFIXES, read_volume, suffix_of
from .itk_images import ijk_to_lps

POSITION, MODALITY, SERIES, SYNTAX = "0020|0032", "0008|0060", "0020|000e", "0008|103e"

UNEVEN = 0.1
"""Of the distance between slices, by which one may be off."""

_COPIES = 3


def read_ct(path: str | Path) -> Volume:
    """The CT in a volume file, in a folder of DICOM, or in the series that a DICOM file belongs to, placed in RAS.

    Raises
    ------
    VolumeFormatError
        When it is damaged or incomplete, no CT, or slices are missing or do not lie behind each other.
    """
    path = Path(path)
    if path.is_dir():
        return _series(path, None)
    if suffix_of(path) in READABLE_SUFFIXES:
        return read_volume(path)
    header = _header(path)
    if header.GetSize()[2:] and header.GetSize()[2] > 1:
        return _volume(path, _read([path]))
    return _series(path.parent, _said(header, SERIES))


def _said(header: sitk.ImageFileReader, key: str) -> str:
    return str(header.GetMetaData(key)).strip() if header.HasMetaDataKey(key) else ""


def _header(path: Path) -> sitk.ImageFileReader:
    reader = sitk.ImageFileReader()
    reader.SetImageIO("GDCMImageIO")
    reader.SetFileName(itk_path(path, VolumeFormatError))
    try:
        with without_warnings():
            reader.ReadImageInformation()
    except RuntimeError as error:
        raise VolumeFormatError(
            f"{path}: it is neither a volume ({', '.join(READABLE_SUFFIXES)}) nor DICOM ({short_cause(error)}). Give the CT's file "
            "or folder."
        ) from error
    modality = _said(reader, MODALITY)
    if modality and modality != "CT":
        raise VolumeFormatError(f"{path}: it is of the kind {modality}, not CT. Give the CT.")
    return reader


def series_files(path: Path) -> list[Path]:
    """The files of the series that a file of DICOM belongs to; nothing for other files."""
    try:
        wanted = _said(_header(path), SERIES) if suffix_of(path) not in READABLE_SUFFIXES else ""
    except VolumeFormatError:
        return []
    return [file for files in _series_in(path.parent, wanted) for file in files] if wanted else []


def _series_in(folder: Path, wanted: str | None) -> list[list[Path]]:
    """The files of each series in a folder, or of those of that number."""
    name = itk_path(folder, VolumeFormatError)
    with without_warnings():
        numbers = [number for number in sitk.ImageSeriesReader.GetGDCMSeriesIDs(name) if number.startswith(wanted or "")]
        return [[Path(file) for file in sitk.ImageSeriesReader.GetGDCMSeriesFileNames(name, number)] for number in numbers]


def _series(folder: Path, wanted: str | None) -> Volume:
    """The series of that number in a folder; without one, the one of most slices."""
    series = _series_in(folder, wanted) or _series_in(folder, None)
    if not series:
        raise VolumeFormatError(
            f"{folder}: it holds no DICOM images. Give the folder whose files are the slices of the CT; a folder of masks is one of labels."
        )
    files = max(series, key=len)
    if len(files) < 3:
        raise VolumeFormatError(f"{folder}: its longest series has {len(files)} slices. Give the folder with the slices of the CT.")
    headers = [_header(file) for file in files]
    places = [np.array([float(n) for n in _said(header, POSITION).split("\\")]) for header in headers if _said(header, POSITION)]
    if len(places) == len(files) and places[0].size == 3:
        _check_even(folder, np.array(places))
    require_bytes(folder, _COPIES * len(files) * int(np.prod(headers[0].GetSize()[:2])) * 4, available_memory())
    return _volume(folder, _read(files))


def _check_even(folder: Path, places: Floats) -> None:
    """Return if slices lie behind each other at one distance."""
    steps = np.diff(places, axis=0)
    typical = np.median(steps, axis=0)
    length = float(np.linalg.norm(typical))
    off = np.linalg.norm(steps - typical, axis=1)
    if length < 1e-3 or off.max() > UNEVEN * length + 0.01:
        raise VolumeFormatError(
            f"{folder}: its slices are not evenly spaced ({length:.3g} mm, once {np.linalg.norm(steps[off.argmax()]):.3g} mm). Export the "
            "series again, whole, or save it from Slicer as a volume."
        )


def _read(files: list[Path]) -> sitk.Image:
    reader = sitk.ImageSeriesReader()
    reader.SetImageIO("GDCMImageIO")
    reader.SetFileNames([itk_path(file, VolumeFormatError) for file in files])
    try:
        with without_warnings():
            return reader.Execute()
    except RuntimeError as error:
        raise VolumeFormatError(f"{files[0].parent}: GDCM cannot read it: {short_cause(error)}. Export the series again.") from error


def _volume(path: Path, image: sitk.Image) -> Volume:
    if image.GetDimension() == 4 and image.GetSize()[3] == 1:
        image = image[:, :, :, 0]
    if image.GetDimension() != 3 or image.GetNumberOfComponentsPerPixel() != 1:
        raise VolumeFormatError(f"{path}: it must be one gray 3D volume. Give the CT's slices.")
    return Volume(sitk.GetArrayFromImage(image), LPS_FROM_RAS @ ijk_to_lps(image))

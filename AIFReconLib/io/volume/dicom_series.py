"""A CT as scanners and archives give it: a folder or a file of DICOM, read by SimpleITK (GDCM), or a volume file."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import scipy
import SimpleITK as sitk

from ...arrays import Floats, Numbers
from ...errors import VolumeFormatError
from ...geometry.transforms import LPS_FROM_RAS
from ...geometry.volume import Volume
from ...machine.memory import available_memory, require_bytes
from ..disk.itk import itk_path, itk_reads
from ..disk.regular_files import files_in
from .files import READABLE_SUFFIXES, read_volume, suffix_of
from .itk_images import array_of

logger = logging.getLogger(__name__)

POSITION, ORIENTATION, PIXELS = "0020|0032", "0020|0037", "0028|0030"
MODALITY, SERIES, NUMBER, IMAGE_TYPE = "0008|0060", "0020|000e", "0020|0011", "0008|0008"

UNEVEN = 0.1
"""Of the distance between slices, by which one may be off."""

_SAID = 13
"""Numbers that say where a slice lies: the middle of its first pixel, LPS, mm; directions of rows and of columns; from row to row and from
column to column; columns and rows."""

_ALIKE = {"the direction of the slices": slice(3, 9), "the size of the pixels": slice(9, 11), "the size of the slices": slice(11, 13)}
"""What of it may not change."""

ALIKE = 1e-3
"""By which directions, and sizes of pixels in mm, of two slices may differ."""

SHEARED = 0.02
"""mm sideways for each mm between slices, above which slices are moved to where they lie: 0.02 is 1 degree of a tilted gantry."""

_COPIES = 2
"""The slices, and what is made of them."""

REGULAR = (
    "Load it into Slicer with its DICOM module (Application settings, DICOM, acquisition geometry regularization: apply regularization "
    "transform), harden the transform, and save the volume as .nrrd."
)


def read_ct(path: str | Path) -> Volume:
    """The CT in a volume file, in a folder of DICOM, or in the series that a DICOM file belongs to, placed in RAS.

    Raises
    ------
    VolumeFormatError
        When it is damaged or incomplete, no CT, slices are missing or do not lie behind each other, or headers leave out where they lie.

    Notes
    -----
    Of several series in a folder the one of most slices is taken, and a note tells of the others. Slices of a tilted gantry are moved
    sideways to where they lie, by linear interpolation.
    """
    path = Path(path)
    if path.is_dir():
        return _series(path, None)
    if suffix_of(path) in READABLE_SUFFIXES:
        return read_volume(path)
    header = _header(path)
    if header is None or _said(header, MODALITY) not in ("", "CT"):
        neither = f"neither a volume ({', '.join(READABLE_SUFFIXES)}) nor DICOM"
        what = neither if header is None else f"of the kind {_said(header, MODALITY)}, not CT"
        raise VolumeFormatError(f"{path}: it is {what}. Give the CT's file or folder.")
    if header.GetSize()[2:] and header.GetSize()[2] > 1:
        return _placed(path, [path], _frames(path, header.GetSize()[2]))
    return _series(path.parent, _said(header, SERIES))


def _said(header: sitk.ImageFileReader, key: str) -> str:
    return str(header.GetMetaData(key)).strip() if header.HasMetaDataKey(key) else ""


def _header(path: Path) -> sitk.ImageFileReader | None:
    """What the headers of a DICOM image say; None where it is none."""
    reader = sitk.ImageFileReader()
    reader.SetImageIO("GDCMImageIO")
    itk_path(path, VolumeFormatError)  # a name that cannot be said is no reason to take the file for another
    try:
        with itk_reads(path, VolumeFormatError, "") as name:
            reader.SetFileName(name)
            reader.ReadImageInformation()
    except VolumeFormatError:
        return None
    return reader


def series_files(path: Path) -> list[Path]:
    """The files of the series that a file of DICOM belongs to; nothing for other files."""
    header = _header(path) if suffix_of(path) not in READABLE_SUFFIXES else None
    return [] if header is None else list(_series_in(path.parent)[0].get(_said(header, SERIES), {}))


def _series_in(folder: Path) -> tuple[dict[str, dict[Path, sitk.ImageFileReader]], set[str]]:
    """The images of each series of CT in a folder, by its UID, but for localizers; and the kinds of other images there."""
    series: dict[str, dict[Path, sitk.ImageFileReader]] = {}
    others = set()
    for file in files_in(folder):
        header = _header(file)
        if header is None or "LOCALIZER" in _said(header, IMAGE_TYPE):
            continue
        if (kind := _said(header, MODALITY)) in ("", "CT"):
            series.setdefault(_said(header, SERIES), {})[file] = header
        else:
            others.add(kind)
    return series, others


def _series(folder: Path, wanted: str | None) -> Volume:
    """The series of that UID in a folder; without one, the CT of most slices."""
    series, kinds = _series_in(folder)
    if not series:
        why = f"it is of the kind {', '.join(sorted(kinds))}, not CT" if kinds else "it holds no DICOM images"
        hint = "Give the folder whose files are the slices of the CT; a folder of masks is one of labels."
        raise VolumeFormatError(f"{folder}: {why}. {hint}")
    files = series.pop(max(series, key=lambda uid: len(series[uid])) if wanted is None else wanted)
    if wanted is None and series:
        others = "; ".join(map(_called, series.values()))
        text = "%s: the series %s is taken. Also there: %s. To take another, give one of its files"
        logger.warning(text, folder, _called(files), others)
    if len(files) == 1 and next(iter(files.values())).GetSize()[2:] > (1,):
        return read_ct(next(iter(files)))
    if len(files) < 3:
        raise VolumeFormatError(f"{folder}: its longest series has {len(files)} slices. Give the folder with the slices of the CT.")
    keys = (POSITION, ORIENTATION, PIXELS)
    rows = [_row(folder, *(_said(header, key).split("\\") for key in keys), header.GetSize()[:2]) for header in files.values()]
    return _placed(folder, list(files), np.array(rows))


def _called(files: dict[Path, sitk.ImageFileReader]) -> str:
    """A series in words: its number, how many slices, and one of them."""
    file, header = next(iter(files.items()))
    return f"{_said(header, NUMBER) or 'without number'} ({len(files)} slices, {file.name} ...)"


def _row(path: Path, *stated: Iterable[Any]) -> list[float]:
    """The numbers that say where a slice lies, if the header says them all."""
    row: list[float] = []
    with contextlib.suppress(ValueError):
        row = [float(value) for values in stated for value in values]
    if len(row) != _SAID or not np.isfinite(row).all():
        told = "its headers do not all say where slices lie, which way slices lie and how large pixels are"
        raise VolumeFormatError(f"{path}: {told}. Export the series again as the scanner made it.")
    return row


def _frames(path: Path, count: int) -> Floats:
    """The slices in a file of many frames, a row each, as its functional groups place them (PS3.3, C.7.6.16)."""
    if find_spec("pydicom") is None:
        raise VolumeFormatError(f"{path}: a DICOM file of many frames takes pydicom. Install it: pip install pydicom.")
    pydicom = import_module("pydicom")
    data = pydicom.dcmread(path, stop_before_pixels=True, force=True)
    shared = [*data.get("SharedFunctionalGroupsSequence", [])]
    frames = [*data.get("PerFrameFunctionalGroupsSequence", [])] or [pydicom.Dataset()] * count

    def of(frame: Any, group: str, name: str) -> Iterable[Any]:
        parts: list[Any] = next((one[group].value for one in (frame, *shared) if group in one), [])
        return (parts[0].get(name) if parts else None) or []

    groups = {"PlanePosition": "ImagePositionPatient", "PlaneOrientation": "ImageOrientationPatient", "PixelMeasures": "PixelSpacing"}
    size = data.get("Columns", ""), data.get("Rows", "")
    return np.array([_row(path, *(of(frame, f"{group}Sequence", name) for group, name in groups.items()), size) for frame in frames])


def _placed(path: Path, files: list[Path], slices: Floats) -> Volume:
    """The volume of slices, a row of each, each a file or all in one, in the order of their places."""
    for what, columns in _ALIKE.items():
        if np.ptp(slices[:, columns], axis=0).max() > ALIKE:
            raise VolumeFormatError(f"{path}: {what} changes within the series. Give a folder that holds one scan alone.")
    places, directions, pixel = slices[:, :3], slices[0, 3:9].reshape(2, 3), slices[0, 9:11]
    normal = np.cross(*directions)
    order = np.argsort(places @ normal, kind="stable")
    step = _step(path, places[order], directions)
    require_bytes(path, _COPIES * len(slices) * int(slices[0, 11:].prod()) * 4, available_memory())
    array = _read(path, [files[n] for n in order] if len(files) > 1 else files)
    if len(array) != len(slices):
        raise VolumeFormatError(f"{path}: {len(slices)} slices are promised, {len(array)} are there. Export the series again.")
    if len(files) == 1 and (order != np.arange(len(order))).any():
        array = array[order]
    matrix = np.eye(4)
    matrix[:3, :3] = np.column_stack([directions[0] * pixel[1], directions[1] * pixel[0], normal * (step @ normal)])
    matrix[:3, 3] = places[order[0]]
    sideways = directions @ step
    if np.abs(sideways).max() > SHEARED * float(step @ normal):
        angle = np.rad2deg(np.arctan2(float(np.linalg.norm(sideways)), float(step @ normal)))
        logger.warning("%s: its slices are sheared by %.3g degrees (a tilted gantry); they are moved to where they lie", path, angle)
        array, first = _unsheared(array, sideways / (pixel[1], pixel[0]))
        matrix[:3, 3] += matrix[:3, :2] @ first
    return Volume(array, LPS_FROM_RAS @ matrix)


def _step(path: Path, places: Floats, directions: Floats) -> Floats:
    """From slice to slice, (3,) mm, if that is the same throughout. `places` (n, 3) are in the order of the slices."""
    steps = np.diff(places, axis=0)
    typical = np.median(steps, axis=0)
    length = float(np.linalg.norm(typical))
    if length < ALIKE or np.linalg.norm(steps, axis=1).min() < ALIKE:
        raise VolumeFormatError(f"{path}: slices lie at the same place. Give a folder that holds one scan alone, once.")
    off = np.linalg.norm(steps - typical, axis=1)
    if off.max() > UNEVEN * length + 0.01:
        once = f"{length:.3g} mm, once {np.linalg.norm(steps[off.argmax()]):.3g} mm"
        raise VolumeFormatError(f"{path}: its slices are not evenly spaced ({once}). Export the series again, whole. {REGULAR}")
    mean: Floats = (places[-1] - places[0]) / (len(places) - 1)
    if float(mean @ np.cross(*directions)) < length / 2:
        raise VolumeFormatError(f"{path}: its slices do not lie behind each other. {REGULAR}")
    return mean


def _unsheared(array: Numbers, sideways: Floats) -> tuple[Numbers, Floats]:
    """Slices [k, j, i] moved by k times `sideways`, (x, y) pixels, in a larger array; and where its first pixel lies in the first slice."""
    far, outside = sideways * (len(array) - 1), array.min()
    first, more = np.floor(np.minimum(far, 0)), np.ceil(np.abs(far)).astype(int)
    moved = np.full((len(array), array.shape[1] + more[1], array.shape[2] + more[0]), outside, array.dtype)
    for k, plane in enumerate(array):
        x, y = first - k * sideways
        scipy.ndimage.affine_transform(plane, np.ones(2), (y, x), output=moved[k], output_shape=moved[k].shape, order=1, cval=outside)
    return moved, first


def _read(path: Path, files: list[Path]) -> Numbers:
    """The voxels [k, j, i] of files in this order."""
    with itk_reads(files[0], VolumeFormatError, "Export the series again.") as first:
        rest = [itk_path(file, VolumeFormatError) for file in files[1:]]
        image = sitk.ReadImage([first, *rest] if rest else first, imageIO="GDCMImageIO")
    if image.GetDimension() != 3 or image.GetNumberOfComponentsPerPixel() != 1:
        raise VolumeFormatError(f"{path}: it must be one gray 3D volume. Give the CT's slices.")
    return array_of(image)

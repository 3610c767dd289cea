"""Volumes as SimpleITK reads them, from files that were looked at first.

ITK fills up with zeros what is missing of a file, opens what a header names, and ends the program at some headers.
"""

from __future__ import annotations

import itertools
import logging
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import SimpleITK as sitk

from ...arrays import Floats, Matrix, Numbers
from ...errors import VolumeFormatError
from ...geometry.transforms import LPS_FROM_RAS
from ...machine.memory import available_memory, require_bytes
from ...message import shorten
from ..disk.itk import itk_path, short_cause, without_warnings
from ..disk.regular_files import file_stamp
from ..disk.small_files import local_copy
from ..metafile.metafile import RAW, Metafile
from ..metafile.metaimage import FORMAT_KEYS
from ..metafile.opening import METAIMAGE_SUFFIXES, read_metafile
from ..metafile.payload import check_payload
from ..metafile.text_values import parse_numbers
from .itk_images import ijk_to_lps
from .nifti_payload import ITK_COPIES, check_nifti, nifti_forms

logger = logging.getLogger(__name__)

FORMS_APART = 0.5
"""mm between the places of a voxel by qform and sform that are worth a note; both are rounded."""

LONGEST_FIELD = 500
"""Bytes of a line of an NRRD header, or of a key. At 1000 ITK's reader writes beyond the end of its message and ends the program."""

_IN_SPACE = ("domain", "space")
_METAIMAGE_NUMBERS = {
    **dict.fromkeys(("ElementSpacing", "ElementSize", "Offset", "Position", "Origin"), 3),
    **dict.fromkeys(("TransformMatrix", "Rotation", "Orientation"), 9),
}
"""How many numbers each has; ITK takes what is missing or no number for something."""


class StoredVolume(NamedTuple):
    """Voxels [k, j, i], or [k, j, i, n] for several values each, their place (not checked yet, mm), and the file's own fields."""

    array: Numbers
    ijk_to_lps: Matrix
    fields: dict[str, str]


def read_nifti(path: Path) -> StoredVolume:
    """The volume in a .nii or .nii.gz file.

    Raises VolumeFormatError when it is damaged, or no 3D volume of real numbers; InsufficientMemoryError.
    """
    seen = file_stamp(path)
    head = check_nifti(path, VolumeFormatError)
    image = _read(path, seen, "NiftiImageIO")
    stored = StoredVolume(sitk.GetArrayFromImage(image), ijk_to_lps(image), {})
    _note_contradiction(path, head, LPS_FROM_RAS @ stored.ijk_to_lps, image.GetSize())
    return stored


def read_metafile_volume(path: Path) -> StoredVolume:
    """The volume in a MetaImage or NRRD file, by its suffix.

    Raises VolumeFormatError when it is damaged, no 3D volume, or its place in space cannot be understood; InsufficientMemoryError.
    """
    seen = file_stamp(path)
    metafile = read_metafile(path, VolumeFormatError)
    is_metaimage = path.suffix.lower() in METAIMAGE_SUFFIXES
    kinds = metafile.kinds or ("domain",) * len(metafile.size)
    if sum(kind in _IN_SPACE for kind in kinds) != 3 or "time" in kinds or len(kinds) > 4:
        raise metafile.failure(
            f"it must be one 3D volume; got axes of the kinds {' '.join(kinds)}. If it is a sequence of frames, give it as a sequence."
        )
    require_bytes(path, ITK_COPIES * metafile.pixel_bytes, available_memory())
    if is_metaimage:
        _check_metaimage(metafile)
    else:
        _check_nrrd(metafile)
    directions = None if is_metaimage else _directions(metafile)
    check_payload(metafile)
    data = metafile.data_path if metafile.data_path != path else None
    image = _read(path, seen, "MetaImageIO" if is_metaimage else "NrrdImageIO", data)
    array, place = sitk.GetArrayFromImage(image), ijk_to_lps(image)
    if array.nbytes != metafile.pixel_bytes:
        raise metafile.failure("SimpleITK takes it for another size. Save the volume from Slicer again.")
    if directions is not None:
        # ITK takes these apart and multiplies them again, which rounds their last digit
        place[:3, :3] = np.copysign(directions.T, place[:3, :3])
    return StoredVolume(array, place, metafile.fields)


def _read(path: Path, seen: tuple[int, int] | None, reader: str, data: Path | None = None) -> sitk.Image:
    """The image, from a copy: SimpleITK takes what a failing disk does not give for zeros, and on Windows finds no names beyond ASCII."""
    with local_copy(path, VolumeFormatError, seen, data) as copy, without_warnings():
        try:
            # Left to look for a reader itself, it asks others too
            image = sitk.ReadImage(itk_path(copy, VolumeFormatError), imageIO=reader)
        except RuntimeError as error:
            raise VolumeFormatError(f"{path}: SimpleITK cannot read it: {short_cause(error)}. Export the volume again.") from error
    if image.GetDimension() != 3:
        raise VolumeFormatError(f"{path}: it must be a 3D volume; got {image.GetDimension()} dimensions. Export one 3D volume.")
    if "complex" in image.GetPixelIDTypeAsString():
        raise VolumeFormatError(f"{path}: its voxels must be real numbers; got complex ones. Export the magnitude.")
    return image


def _check_metaimage(metafile: Metafile) -> None:
    """Return if ITK finds the entries that `read_metafile` found, and all that it needs."""
    hidden = next((key for key in metafile.fields if key.partition(":")[0].strip() in FORMAT_KEYS), None)
    if hidden is not None:
        raise metafile.failure(f"{shorten(hidden)} would be taken for another key of the format. Remove the line from the header.")
    if metafile.encoding != RAW and not int(metafile.entries.get("CompressedDataSize") or 0):
        raise metafile.failure("CompressedDataSize is missing, without which ITK reads other voxels. Save the volume from Slicer again.")
    for key, count in _METAIMAGE_NUMBERS.items():
        numbers = _finite(metafile, key, metafile.entries[key], count) if key in metafile.entries else np.ones(1)
        if key in ("ElementSpacing", "ElementSize") and numbers.min() <= 0:
            raise metafile.failure(f"{key} must be positive; got {numbers.tolist()}. Correct the header.")


def _finite(metafile: Metafile, key: str, text: str, count: int) -> Floats:
    """The finite numbers of an entry; NaN stands for an axis that is none of space."""
    try:
        numbers = np.array(parse_numbers(text.strip("() ").replace(",", " ")))
    except ValueError:
        numbers = np.array([])
    numbers = numbers[~np.isnan(numbers)] if key == "spacings" else numbers
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise metafile.failure(f"{key} must be {count} finite numbers; got {shorten(text)!r}. Correct the header.")
    return numbers


def _check_nrrd(metafile: Metafile) -> None:
    """Return if ITK's reader survives the header."""
    with open(metafile.path, "rb") as file:
        for line in itertools.takewhile(bytes.strip, file):
            key, _, value = line.partition(b":")
            if len(key if value.startswith(b"=") else line) > LONGEST_FIELD and not line.startswith(b"#"):
                raise metafile.failure(
                    f"{shorten(line.decode('utf-8', 'replace'))!r} is longer than {LONGEST_FIELD} bytes. The header is damaged: "
                    "copy the file again."
                )


def _directions(metafile: Metafile) -> Floats | None:
    """The vectors of an NRRD header, (3, 3), one a row, as they are written; None where it has none, and no place."""
    text, origin, spacings = (metafile.entries.get(key) for key in ("space directions", "space origin", "spacings"))
    if origin is not None:
        _finite(metafile, "space origin", origin, 3)
    if text is None:
        if {"space origin", "axis mins", "axis maxs"} & set(metafile.entries):
            raise metafile.failure(
                "it has a place but no space directions, so which way it lies is not known. Save the volume from Slicer again."
            )
        if spacings is not None:
            _finite(metafile, "spacings", spacings, 3)
        return None
    vectors = re.findall(r"\([^()]*\)", text)
    if len(vectors) != 3:
        raise metafile.failure(
            f"space directions must be a vector for each axis in space, none for others; got {shorten(text)!r}. Save the volume from "
            "Slicer again."
        )
    return np.array([_finite(metafile, "space directions", vector, 3) for vector in vectors])


def _note_contradiction(path: Path, head: bytes, ijk_to_ras: Matrix, size: tuple[int, ...]) -> None:
    """Note a NIfTI header whose two forms do not place the voxels alike, and which of them ITK took, (4, 4)."""
    corners = np.array([(*corner, 1.0) for corner in itertools.product(*((0, count - 1) for count in size))]).T
    with np.errstate(all="ignore"):
        off = {name: float(np.linalg.norm((form - ijk_to_ras) @ corners, axis=0).max()) for name, form in nifti_forms(head).items()}
    if len(off) == 2 and max(off.values()) > FORMS_APART:
        logger.warning(
            "%s: its qform and sform place voxels up to %.3g mm apart. The %s is taken, as ITK does; if it lies wrong, export it again",
            path,
            max(off.values()),
            min(off, key=lambda name: off[name]),
        )

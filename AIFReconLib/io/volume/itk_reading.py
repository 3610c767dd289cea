"""Volumes as SimpleITK reads them, from files that were looked at first: it takes what is missing or not said for something."""

from __future__ import annotations

import contextlib
import itertools
import logging
import re
import sys
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
from ..disk.small_files import changed, local_copy
from ..metafile.header import RAW
from ..metafile.metafile import Metafile
from ..metafile.opening import METAIMAGE_SUFFIXES, read_metafile
from ..metafile.payload import check_payload
from ..metafile.text_values import parse_numbers
from .itk_images import array_of, ijk_to_lps
from .nifti_payload import check_nifti, nifti_forms

logger = logging.getLogger(__name__)

FORMS_APART = 0.5
"""mm between the places of a voxel by qform and sform that are worth a note; both are rounded."""

_IN_SPACE = ("domain", "space")
_METAIMAGE_NUMBERS = {
    **dict.fromkeys(("ElementSpacing", "ElementSize", "Offset", "Position", "Origin"), 3),
    **dict.fromkeys(("TransformMatrix", "Rotation", "Orientation"), 9),
}
"""How many numbers each has; ITK takes what is missing or no number for something."""

_SPACE = re.compile(r"(left|right)-(anterior|posterior)-(superior|inferior)|[LR][AP][SI]", re.IGNORECASE)
"""A frame of the patient, as an NRRD header names it."""


class StoredVolume(NamedTuple):
    """Voxels [k, j, i], or [k, j, i, n] for several values each, their place (not checked yet, mm), and the file's own fields."""

    array: Numbers
    ijk_to_lps: Matrix
    fields: dict[str, str]


def read_nifti(path: Path) -> StoredVolume:
    """The volume in a .nii or .nii.gz file.

    Raises VolumeFormatError when it is damaged, or no 3D volume of real numbers; InsufficientMemoryError.
    """
    header = check_nifti(path, VolumeFormatError)
    image = _read(path, "NiftiImageIO")
    stored = StoredVolume(array_of(image), ijk_to_lps(image), {})
    _note_contradiction(path, nifti_forms(header), LPS_FROM_RAS @ stored.ijk_to_lps, stored.array.shape[::-1])
    return stored


def read_metafile_volume(path: Path) -> StoredVolume:
    """The volume in a MetaImage or NRRD file, by its suffix.

    Raises VolumeFormatError when it is damaged, no 3D volume, or its place in space cannot be understood; InsufficientMemoryError.
    """
    metafile = read_metafile(path, VolumeFormatError)
    is_metaimage = path.suffix.lower() in METAIMAGE_SUFFIXES
    kinds = metafile.kinds or ("domain",) * len(metafile.size)
    if sum(kind in _IN_SPACE for kind in kinds) != 3 or "time" in kinds or len(kinds) > 4:
        raise metafile.failure(
            f"it must be one 3D volume; got axes of the kinds {' '.join(kinds)}. If it is a sequence of frames, give it as a sequence."
        )
    require_bytes(path, metafile.pixel_bytes, available_memory())
    if is_metaimage:
        _check_metaimage(metafile)
    directions = None if is_metaimage else _directions(metafile)
    check_payload(metafile)
    image = _read(path, "MetaImageIO" if is_metaimage else "NrrdImageIO", metafile.data_path if metafile.data_path != path else None)
    array, place = array_of(image), ijk_to_lps(image)
    if array.nbytes != metafile.pixel_bytes:
        raise metafile.failure("SimpleITK takes it for another size. Save the volume from Slicer again.")
    if directions is not None:
        # ITK takes these apart and multiplies them again, which rounds their last digit
        place[:3, :3] = np.copysign(directions.T, place[:3, :3])
    return StoredVolume(array, place, metafile.fields)


def _read(path: Path, reader: str, data: Path | None = None) -> sitk.Image:
    """The image in a file, whose voxels may be in another one beside it."""
    files = [path] if data is None else [path, data]
    seen = [file_stamp(file) for file in files]
    with contextlib.ExitStack() as stack:
        name = path
        if sys.platform == "win32" and not str(path).isascii():
            # There ITK's readers find no names beyond ASCII
            name = stack.enter_context(local_copy(path, VolumeFormatError, seen[0], data))
        stack.enter_context(without_warnings())
        try:
            # Left to look for a reader itself, it asks others too
            image = sitk.ReadImage(itk_path(name, VolumeFormatError), imageIO=reader)
        except RuntimeError as error:
            raise VolumeFormatError(f"{path}: SimpleITK cannot read it: {short_cause(error)}. Export the volume again.") from error
    if [file_stamp(file) for file in files] != seen:
        raise changed(path, VolumeFormatError)
    if image.GetDimension() != 3:
        raise VolumeFormatError(f"{path}: it must be a 3D volume; got {image.GetDimension()} dimensions. Export one 3D volume.")
    if "complex" in image.GetPixelIDTypeAsString():
        raise VolumeFormatError(f"{path}: its voxels must be real numbers; got complex ones. Export the magnitude.")
    return image


def _check_metaimage(metafile: Metafile) -> None:
    """Return if ITK finds all that it needs."""
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


def _directions(metafile: Metafile) -> Floats | None:
    """The vectors of an NRRD header, (3, 3), one a row, as they are written; None where it has none, and no place."""
    text, origin, spacings, space = (metafile.entries.get(key) for key in ("space directions", "space origin", "spacings", "space"))
    if origin is not None:
        _finite(metafile, "space origin", origin, 3)
    if text is None:
        if {"space origin", "axis mins", "axis maxs"} & set(metafile.entries):
            raise metafile.failure(
                "it has a place but no space directions, so which way it lies is not known. Save the volume from Slicer again."
            )
        if spacings is not None:
            _finite(metafile, "spacings", spacings, 3)
    if not _SPACE.fullmatch(space or ""):
        _note_no_frame(metafile.path, f"says {shorten(space)!r}" if space else "does not say which", "LPS, as ITK does")
    if text is None:
        return None
    vectors = re.findall(r"\([^()]*\)", text)
    if len(vectors) != 3:
        raise metafile.failure(
            f"space directions must be a vector for each axis in space, none for others; got {shorten(text)!r}. Save the volume from "
            "Slicer again."
        )
    return np.array([_finite(metafile, "space directions", vector, 3) for vector in vectors])


def _note_no_frame(path: Path, said: str, taken: str) -> None:
    logger.warning(
        "%s: of the frame that its place is in, RAS or LPS, it %s; it is taken to be %s. If it lies wrong, save it from Slicer as .nrrd",
        path,
        said,
        taken,
    )


def _note_contradiction(path: Path, forms: dict[str, Matrix], ijk_to_ras: Matrix, size: tuple[int, ...]) -> None:
    """Note a NIfTI header without a place, or whose two forms do not place the voxels alike, and which of them ITK took, (4, 4)."""
    if not forms:
        _note_no_frame(path, "says nothing (both form codes are 0)", "LPS with voxel (0, 0, 0) at the origin, as ITK does")
    corners = np.array([(*corner, 1.0) for corner in itertools.product(*((0, count - 1) for count in size[-3:]))]).T
    with np.errstate(all="ignore"):
        off = {name: float(np.linalg.norm((form - ijk_to_ras) @ corners, axis=0).max()) for name, form in forms.items()}
    if len(off) == 2 and max(off.values()) > FORMS_APART:
        logger.warning(
            "%s: its qform and sform place voxels up to %.3g mm apart. The %s is taken, as ITK does; if it lies wrong, export it again",
            path,
            max(off.values()),
            min(off, key=lambda name: off[name]),
        )

"""Volumes as SimpleITK reads them, from files that were looked at first: it takes what is missing or not said for something."""

from __future__ import annotations

import contextlib
import gzip
import itertools
import logging
import math
import re
import zlib
from pathlib import Path

import numpy as np
import scipy
import SimpleITK as sitk

from ...arrays import Matrix, Numbers
from ...errors import VolumeFormatError
from ...geometry.transforms import LPS_FROM_RAS
from ...machine.memory import available_memory, require_bytes
from ...message import shorten
from ..disk.itk import itk_reads
from ..metafile.header import RAW
from ..metafile.metafile import Metafile
from ..metafile.opening import METAIMAGE_SUFFIXES, read_metafile
from ..metafile.payload import check_payload
from ..metafile.text_values import NotANumberError, finite_numbers
from .itk_images import array_of, ijk_to_lps

logger = logging.getLogger(__name__)

FORMS_APART = 0.5
"""mm between the places of a voxel by qform and sform that are worth a note; both are rounded."""

_NIFTI_TYPES = {2: "u1", 4: "i2", 8: "i4", 16: "f4", 64: "f8", 256: "i1", 512: "u2", 768: "u4", 1024: "i8", 1280: "u8"}
"""What NIfTI calls the voxels that are single real numbers."""

_UNIT_MM = {1: 1e3, 3: 1e-3}
"""By NIfTI's number of a unit: meters and microns; all others are taken as mm."""

_METAIMAGE_NUMBERS = {
    **dict.fromkeys(("ElementSpacing", "ElementSize", "Offset", "Position", "Origin"), 3),
    **dict.fromkeys(("TransformMatrix", "Rotation", "Orientation"), 9),
}
"""How many numbers each has; ITK takes what is missing or no number for something."""

_SPACE = re.compile(r"(left|right)-(anterior|posterior)-(superior|inferior)|[LR][AP][SI]", re.IGNORECASE)
"""A frame of the patient, as an NRRD header names it."""


StoredVolume = tuple[Numbers, Matrix, dict[str, str]]
"""Voxels [k, j, i], or [k, j, i, n] for several values each, their place in LPS (not checked yet, mm), and the file's own fields."""


def read_nifti(path: Path) -> tuple[Numbers, Matrix]:
    """The voxels in a .nii or .nii.gz file, and their place in LPS.

    Raises VolumeFormatError when it is damaged, or no 3D volume of real numbers; InsufficientMemoryError.
    """
    reader = sitk.ImageFileReader()
    reader.SetImageIO("NiftiImageIO")
    with itk_reads(path, VolumeFormatError, "Export the volume again, as NIfTI-1 or .nrrd.") as name:
        reader.SetFileName(name)
        reader.ReadImageInformation()
        header = {key: reader.GetMetaData(key) for key in reader.GetMetaDataKeys()}
        _require_real(path, reader)
        voxels = _nifti_voxels(path, reader, header)
    _note_contradiction(path, header, LPS_FROM_RAS @ ijk_to_lps(reader), reader.GetSize())
    return voxels, ijk_to_lps(reader)


def _nifti_voxels(path: Path, reader: sitk.ImageFileReader, header: dict[str, str]) -> Numbers:
    """The voxels [k, j, i] of the type and scaled as SimpleITK would: it holds them twice, and takes what is missing for zeros."""
    stored, sizes = _NIFTI_TYPES.get(int(header["datatype"])), reader.GetSize()
    if stored is None or (count := reader.GetNumberOfComponents()) != 1:
        got = "colors" if stored is None else f"{count} each"
        raise VolumeFormatError(f"{path}: its voxels must be single numbers; got {got}. Export a scalar or label volume.")
    of_itk = sitk.GetArrayFromImage(sitk.Image((1, 1, 1), reader.GetPixelID())).dtype
    require_bytes(path, math.prod(sizes) * of_itk.itemsize, available_memory())
    slope, offset = (float(np.float32(header[key])) for key in ("scl_slope", "scl_inter"))
    slope, array = slope or 1.0, np.empty(sizes[::-1], of_itk)
    try:
        with gzip.open(path) if path.suffix.lower() == ".gz" else open(path, "rb") as file:
            little = int.from_bytes(file.read(4), "little") in (348, 540)
            file.seek(int(float(header["vox_offset"])))
            for number, plane in enumerate(array):
                there = file.read(plane.size * int(stored[1]))
                if len(there) < plane.size * int(stored[1]):
                    raise EOFError(f"of {len(array)} slices {number} are whole")
                here = np.frombuffer(there, ("<" if little else ">") + stored).reshape(plane.shape)
                plane[...] = here if (slope, offset) == (1.0, 0.0) else here * slope + offset
            while file.read(2**20):
                pass  # only a file that is decoded to its end is known to be whole
    except (EOFError, gzip.BadGzipFile, zlib.error) as cause:
        raise VolumeFormatError(f"{path}: the voxels are cut short or corrupt ({cause}). Copy or export the file again.") from cause
    return array


def read_metafile_volume(path: Path) -> StoredVolume:
    """The volume in a MetaImage or NRRD file, by its suffix.

    Raises VolumeFormatError when it is damaged, no 3D volume, or its place in space cannot be understood; InsufficientMemoryError.
    """
    metafile = read_metafile(path, VolumeFormatError)
    is_metaimage = path.suffix.lower() in METAIMAGE_SUFFIXES
    kinds = metafile.kinds or ("domain",) * len(metafile.size)
    if sum(kind in ("domain", "space") for kind in kinds) != 3 or "time" in kinds or len(kinds) > 4:
        raise metafile.failure(f"it must be one 3D volume; got axes of the kinds {' '.join(kinds)}. Give a sequence as a sequence.")
    require_bytes(path, metafile.pixel_bytes, available_memory())
    if is_metaimage:
        _check_metaimage(metafile)
    else:
        _check_nrrd(metafile)
    check_payload(metafile)
    with itk_reads(path, VolumeFormatError, "Export the volume again.", *{metafile.data_path} - {path}) as name:
        # Left to look for a reader itself, it asks others too
        image = sitk.ReadImage(name, imageIO="MetaImageIO" if is_metaimage else "NrrdImageIO")
    _require_real(path, image)
    array = array_of(image)
    if array.nbytes != metafile.pixel_bytes:
        raise metafile.failure("SimpleITK takes it for another size. Save the volume from Slicer again.")
    return array, ijk_to_lps(image), metafile.fields


def _require_real(path: Path, image: sitk.Image | sitk.ImageFileReader) -> None:
    if image.GetDimension() != 3:
        raise VolumeFormatError(f"{path}: it must be a 3D volume; got {image.GetDimension()} dimensions. Export one 3D volume.")
    if "complex" in sitk.GetPixelIDValueAsString(image.GetPixelID()):
        raise VolumeFormatError(f"{path}: its voxels must be real numbers; got complex ones. Export the magnitude.")


def _check_metaimage(metafile: Metafile) -> None:
    """Return if ITK finds all that it needs."""
    if metafile.encoding != RAW and not int(metafile.entries.get("CompressedDataSize") or 0):
        raise metafile.failure("CompressedDataSize is missing, without which ITK reads other voxels. Save the volume from Slicer again.")
    for key in _METAIMAGE_NUMBERS.keys() & metafile.entries.keys():
        try:
            numbers = finite_numbers(metafile.entries[key], _METAIMAGE_NUMBERS[key])
        except NotANumberError as error:
            raise metafile.failure(f"{key} must be {_METAIMAGE_NUMBERS[key]} finite numbers; {error}. Correct the header.") from error
        if key in ("ElementSpacing", "ElementSize") and numbers.min() <= 0:
            raise metafile.failure(f"{key} must be positive; got {metafile.entries[key]}. Correct the header.")


def _check_nrrd(metafile: Metafile) -> None:
    """Return if the header says which way the volume lies, where it says a place; a note tells of a frame that is not named."""
    directions, space = metafile.entries.get("space directions"), metafile.entries.get("space")
    if directions is None and {"space origin", "axis mins", "axis maxs"} & metafile.entries.keys():
        raise metafile.failure("it has a place but no space directions, so which way it lies is not known. Save it from Slicer again.")
    if directions is not None and directions.count("(") != 3:
        must = "space directions must be a vector for each axis in space, none for others"
        raise metafile.failure(f"{must}; got {shorten(directions)!r}. Save the volume from Slicer again.")
    if not _SPACE.fullmatch(space or ""):
        _note_no_frame(metafile.path, f"says {shorten(space)!r}" if space else "does not say which", "LPS, as ITK does")


def _note_no_frame(path: Path, stated: str, taken: str) -> None:
    text = "%s: of the frame that its place is in, RAS or LPS, it %s; it is taken to be %s. If it lies wrong, save it from Slicer as .nrrd"
    logger.warning(text, path, stated, taken)


def _note_contradiction(path: Path, header: dict[str, str], ijk_to_ras: Matrix, size: tuple[int, ...]) -> None:
    """Note a NIfTI header without a place, or whose two forms do not place the voxels alike, and which of them ITK took, (4, 4)."""
    forms = _nifti_forms(header)
    if not forms:
        _note_no_frame(path, "says nothing (both form codes are 0)", "LPS with voxel (0, 0, 0) at the origin, as ITK does")
    corners = np.array([(*corner, 1.0) for corner in itertools.product(*((0, count - 1) for count in size))]).T
    with np.errstate(all="ignore"):
        off = {name: float(np.linalg.norm((form - ijk_to_ras[:3]) @ corners, axis=0).max()) for name, form in forms.items()}
    if len(off) == 2 and max(off.values()) > FORMS_APART:
        text = "%s: its qform and sform place voxels up to %.3g mm apart. The %s is taken, as ITK does; if it lies wrong, export it again"
        logger.warning(text, path, max(off.values()), min(off, key=lambda name: off[name]))


def _nifti_forms(header: dict[str, str]) -> dict[str, Matrix]:
    """Voxel (i, j, k) to RAS, (3, 4) in mm, by the forms that a header has: ``qform``, a rotation, and ``sform``, any matrix."""

    def numbers(*keys: str) -> list[float]:
        return [float(word) for key in keys for word in header[key].split()]

    forms: dict[str, Matrix] = {}
    if int(header["qform_code"]) > 0:
        handed, *sizes = numbers(*(f"pixdim[{n}]" for n in range(4)))
        b, c, d = numbers("quatern_b", "quatern_c", "quatern_d")
        sizes[2] *= -1 if handed < 0 else 1
        with contextlib.suppress(ValueError):  # no numbers
            rotation = scipy.spatial.transform.Rotation.from_quat((b, c, d, math.sqrt(max(1 - b * b - c * c - d * d, 0.0))))
            forms["qform"] = np.column_stack([rotation.as_matrix() * sizes, numbers("qoffset_x", "qoffset_y", "qoffset_z")])
    if int(header["sform_code"]) > 0:
        forms["sform"] = np.reshape(numbers("srow_x", "srow_y", "srow_z"), (3, 4))
    scale = _UNIT_MM.get(int(header["xyzt_units"]) & 7, 1.0)
    return {name: scale * form for name, form in forms.items()}

"""Volume files through SimpleITK. The file holds left-posterior-superior coordinates, memory right-anterior-superior ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import SimpleITK as sitk

from ..errors import FileFormatError, GeometryError, OutputError, VolumeFormatError
from ..transforms import LPS_FROM_RAS
from ..volume import Volume
from .atomic import atomic_outputs, check_writable
from .itk_errors import short_cause
from .metafile import METAIMAGE_SUFFIXES, NRRD_SUFFIXES, read_metafile
from .nifti_payload import check_nifti
from .payload import check_payload
from .transform_files import read_transform, write_transform

__all__ = ["check_volume_path", "read_labels", "read_transform", "read_volume", "write_transform", "write_volume"]

NIFTI_SUFFIXES = (".nii", ".nii.gz")
READABLE_SUFFIXES = METAIMAGE_SUFFIXES + NRRD_SUFFIXES + NIFTI_SUFFIXES
WRITABLE_SUFFIXES = (".nrrd", *METAIMAGE_SUFFIXES, *NIFTI_SUFFIXES)


def read_volume(path: str | Path) -> Volume:
    """The volume in a file, placed in RAS.

    Parameters
    ----------
    path : str or Path
        .nrrd, .nhdr, .mha, .mhd, .nii or .nii.gz.

    Raises
    ------
    VolumeFormatError
        When the file is damaged, incomplete, or holds something other than one scalar 3D volume.
    """
    path = Path(path)
    image = _read_image(path)
    if image.GetNumberOfComponentsPerPixel() != 1:
        raise VolumeFormatError(
            f"{path}: its voxels must be single numbers; got {image.GetNumberOfComponentsPerPixel()} each "
            f"({image.GetPixelIDTypeAsString()}). Export a scalar volume."
        )
    return _as_volume(path, image, sitk.GetArrayFromImage(image))


def read_labels(path: str | Path) -> Volume:
    """The labels in a file, as whole numbers: 0 is background.

    Parameters
    ----------
    path : str or Path
        A label volume, or a segmentation as Slicer saves it (.seg.nrrd). Where its segments overlap, it has several layers; the
        result is then 1 wherever any layer has a label.

    Raises
    ------
    VolumeFormatError
        As `read_volume`, and when a voxel is not a whole number or is negative.
    """
    path = Path(path)
    image = _read_image(path)
    array = sitk.GetArrayFromImage(image)
    if image.GetNumberOfComponentsPerPixel() != 1:
        if not any(key.startswith("Segment") for key in image.GetMetaDataKeys()):
            raise VolumeFormatError(
                f"{path}: its voxels must be single labels; got {image.GetPixelIDTypeAsString()}. Export a label volume."
            )
        array = (array > 0).any(axis=-1).astype(np.uint8)
    return _as_volume(path, image, _as_labels(path, array))


def write_volume(volume: Volume, path: str | Path) -> None:
    """Write a volume, completely or not at all.

    Parameters
    ----------
    volume : Volume
        Truth values are written as 0 and 1, 8 bit.
    path : str or Path
        .nrrd, .mha, .mhd (with .zraw beside it), .nii or .nii.gz; compressed, except .nii.

    Raises
    ------
    OutputError
        When it cannot be written.
    """
    path = Path(path)
    suffix = _writable_suffix(path)
    array = volume.array.astype(np.uint8) if volume.array.dtype == bool else volume.array
    image = _as_image(path, array, volume.ijk_to_reference)
    companions = (path.with_suffix(".raw"), path.with_suffix(".zraw")) if suffix == ".mhd" else ()
    with atomic_outputs(*companions, path) as temporaries:
        try:
            sitk.WriteImage(image, str(temporaries[-1]), useCompression=suffix != ".nii")
            # A full disk can pass unnoticed by SimpleITK; a file that is not all there must not get its name.
            _check_complete(temporaries[-1])
        except FileFormatError as error:
            raise OutputError(f"Cannot write {path}: the file came out incomplete. Check that the disk is not full.") from error
        except RuntimeError as error:
            raise OutputError(
                f"Cannot write {path}: {short_cause(error)}. Check that the disk is not full, or choose another path."
            ) from error


def check_volume_path(path: str | Path) -> None:
    """Return if a volume can be written to `path`; to be asked before a long computation. Leaves nothing behind.

    Raises
    ------
    OutputError
        When no volume format has that suffix, or no file can be created there.
    """
    _writable_suffix(Path(path))
    check_writable(path)


def _writable_suffix(path: Path) -> str:
    suffix = _suffix(path)
    if suffix not in WRITABLE_SUFFIXES:
        raise OutputError(f"Cannot write {path}: its suffix must be one of {', '.join(WRITABLE_SUFFIXES)}. Choose another name.")
    return suffix


def _suffix(path: Path) -> str:
    """The suffix that names the format, ``.nii.gz`` being one."""
    name = path.name.lower()
    return ".nii.gz" if name.endswith(".nii.gz") else path.suffix.lower()


def _check_complete(path: Path) -> None:
    """Return if all voxels are there. SimpleITK itself fills up what is missing of compressed data with zeros."""
    if _suffix(path) in NIFTI_SUFFIXES:
        check_nifti(path, VolumeFormatError)
        return
    metafile = read_metafile(path, VolumeFormatError)
    axes = sum(kind in ("domain", "space") for kind in metafile.kinds) or len(metafile.size)
    if axes != 3:
        raise metafile.failure(f"it must be a 3D volume; got {axes} axes in space. If it is a sequence of frames, give it as a sequence.")
    check_payload(metafile)


def _read_image(path: Path) -> sitk.Image:
    if _suffix(path) not in READABLE_SUFFIXES:
        raise VolumeFormatError(
            f"{path}: its suffix must be one of {', '.join(READABLE_SUFFIXES)}. Export the volume in one of these formats."
        )
    _check_complete(path)
    try:
        image = sitk.ReadImage(str(path))
    except RuntimeError as error:
        raise VolumeFormatError(f"{path}: SimpleITK cannot read it: {short_cause(error)}. Export the volume again.") from error
    if image.GetDimension() != 3:
        raise VolumeFormatError(f"{path}: it must be a 3D volume; got {image.GetDimension()} dimensions. Export one 3D volume.")
    if "complex" in image.GetPixelIDTypeAsString():
        raise VolumeFormatError(f"{path}: its voxels must be real numbers; got complex ones. Export the magnitude.")
    return image


def _as_volume(path: Path, image: sitk.Image, array: np.ndarray) -> Volume:
    """Place an array [k, j, i] where the file says: the only way from LPS files into memory."""
    ijk_to_lps = np.eye(4)
    ijk_to_lps[:3, :3] = np.array(image.GetDirection()).reshape(3, 3) * np.array(image.GetSpacing())
    ijk_to_lps[:3, 3] = image.GetOrigin()
    try:
        return Volume(array, LPS_FROM_RAS @ ijk_to_lps)
    except GeometryError as error:
        raise VolumeFormatError(f"{path}: its place in space cannot be used. {error}") from error


def _as_image(path: Path, array: np.ndarray, ijk_to_reference: np.ndarray) -> sitk.Image:
    """The counterpart of `_as_volume`."""
    ijk_to_lps = LPS_FROM_RAS @ ijk_to_reference
    spacing = np.linalg.norm(ijk_to_lps[:3, :3], axis=0)
    try:
        image = sitk.GetImageFromArray(array)
    except (TypeError, KeyError, RuntimeError) as error:
        raise OutputError(f"Cannot write {path}: volume files cannot hold {array.dtype}. Convert the volume to another type.") from error
    image.SetSpacing(spacing.tolist())
    image.SetDirection((ijk_to_lps[:3, :3] / spacing).ravel().tolist())
    image.SetOrigin(ijk_to_lps[:3, 3].tolist())
    return image


def _as_labels(path: Path, array: np.ndarray) -> np.ndarray:
    """Whole numbers; floating-point voxels that are whole become int32."""
    if array.dtype.kind == "f":
        if not np.isfinite(array).all() or (array != np.rint(array)).any() or np.abs(array).max() >= 2**31:
            raise VolumeFormatError(
                f"{path}: labels must be whole numbers; got fractions or NaN. If these are bone probabilities, "
                "give them as --bone-probability."
            )
        array = array.astype(np.int32)
    if array.min() < 0:
        raise VolumeFormatError(f"{path}: labels must not be negative; got {array.min()}. If this is a CT, segment its bone first.")
    return array

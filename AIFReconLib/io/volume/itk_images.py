"""Volumes as images of SimpleITK, and the way back: they hold left-posterior-superior coordinates, as files do."""

from __future__ import annotations

import numpy as np
import SimpleITK as sitk

from ...arrays import Matrix, Numbers
from ...errors import GeometryError
from ...geometry.transforms import LPS_FROM_RAS
from ...geometry.volume import Volume


def to_sitk(volume: Volume) -> sitk.Image:
    """The volume as a `SimpleITK.Image` with a copy of its voxels, placed in LPS. Truth values become 0 and 1, 8 bit.

    Raises GeometryError when SimpleITK has no such voxels: half precision, or numbers of more than 64 bits.
    """
    array = volume.array.astype(np.uint8) if volume.array.dtype == bool else volume.array
    ijk_to_lps = LPS_FROM_RAS @ volume.ijk_to_reference
    spacing = np.linalg.norm(ijk_to_lps[:3, :3], axis=0)
    try:
        image = sitk.GetImageFromArray(array)
    except (TypeError, KeyError, RuntimeError) as error:
        raise GeometryError(f"Input voxels must be of a type that SimpleITK has; got {array.dtype}. Convert the volume.") from error
    image.SetSpacing(spacing.tolist())
    image.SetDirection((ijk_to_lps[:3, :3] / spacing).ravel().tolist())
    image.SetOrigin(ijk_to_lps[:3, 3].tolist())
    return image


def from_sitk(image: object) -> Volume:
    """A `SimpleITK.Image` of one scalar 3D volume as a `Volume`, its voxels copied, placed in RAS.

    Raises GeometryError when it is another thing: a picture, a series, colors, complex numbers.
    """
    if not isinstance(image, sitk.Image) or image.GetDimension() != 3:
        got = f"{image.GetDimension()} dimensions" if isinstance(image, sitk.Image) else type(image).__name__
        raise GeometryError(f"Input image must be a SimpleITK.Image of a 3D volume; got {got}.")
    if image.GetNumberOfComponentsPerPixel() != 1 or "complex" in image.GetPixelIDTypeAsString():
        raise GeometryError(f"Input image must have one real number a voxel; got {image.GetPixelIDTypeAsString()}. Take one component.")
    array: Numbers = sitk.GetArrayFromImage(image)
    return Volume(array, LPS_FROM_RAS @ ijk_to_lps(image))


class _Voxels:
    """The voxels of an image as numpy takes them over. The image lives as long as the array."""

    def __init__(self, image: sitk.Image):
        self._image = image
        view = sitk.GetArrayViewFromImage(image)
        self.__array_interface__ = {**view.__array_interface__, "data": (view.ctypes.data, False)}


def array_of(image: sitk.Image) -> Numbers:
    """The voxels [k, j, i] of an image that nobody else has, or [k, j, i, n] for several values each: not copied."""
    array: Numbers = np.asarray(_Voxels(image))
    return array


def ijk_to_lps(image: sitk.Image | sitk.ImageFileReader) -> Matrix:
    """Where a 3D image places its voxels, (4, 4), mm."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(image.GetDirection()).reshape(3, 3) * np.array(image.GetSpacing())
    matrix[:3, 3] = image.GetOrigin()
    return matrix

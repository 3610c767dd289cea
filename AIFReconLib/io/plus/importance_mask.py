"""The image that says how much each pixel of an ultrasound image counts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import SimpleITK as sitk

from ...arrays import Numbers, Singles
from ...errors import ConfigurationError, FileFormatError
from ...sweep.configuration import PlusConfiguration
from ..disk.itk import itk_reads

_READERS = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".tif": "TIFF", ".tiff": "TIFF"}
"""The kind of picture, by suffix."""


def read_importance_mask(path: str | Path) -> Singles:
    """The weight of each pixel, (rows, columns) float32 array, 0 to 1, in MF orientation.

    Parameters
    ----------
    path : str or Path
        An 8-bit gray image (PNG and the like), as large as the ultrasound images: 0 does not count, 255 counts fully.

    Raises
    ------
    FileFormatError
        When it cannot be read, is no 8-bit gray image, or is 0 everywhere.
    """
    path = Path(path)
    if path.suffix.lower() not in _READERS:
        raise FileFormatError(f"{path}: an importance mask must be one of {', '.join(_READERS)}. Save it as a PNG image.")
    with itk_reads(path, FileFormatError, "Give a PNG image as importance mask.") as name:
        # Other readers of ITK would follow a header to another file
        image = sitk.ReadImage(name, imageIO=f"{_READERS[path.suffix.lower()]}ImageIO")
    array: Numbers = sitk.GetArrayFromImage(image)
    if array.dtype != np.uint8 or image.GetNumberOfComponentsPerPixel() != 1 or array.squeeze().ndim != 2:
        found = f"{' x '.join(map(str, image.GetSize()))} {image.GetPixelIDTypeAsString()}"
        raise FileFormatError(f"{path}: an importance mask must be an 8-bit gray image; got {found}. Convert it.")
    array = array.reshape(array.shape[-2:])
    if not array.any():
        raise FileFormatError(f"{path}: an importance mask must have pixels above 0; got none. Draw what counts in white.")
    return array.astype(np.float32) / np.float32(255)


def configured_importance(configuration: PlusConfiguration) -> Singles | None:
    """The weight of each pixel that a configuration asks for, as `read_importance_mask` returns it; None where it asks for none.

    Raises
    ------
    FileFormatError
        When the mask has no file, or one that cannot be used.
    """
    if not configuration.uses_importance_mask:
        return None
    if configuration.importance_mask is None:
        missing = "VolumeReconstruction@ImportanceMaskFilename is missing, and CompoundingMode=IMPORTANCE_MASK needs it"
        raise ConfigurationError(f"{configuration.path}: {missing}. Add it, or give an importance mask.")
    return read_importance_mask(configuration.importance_mask)

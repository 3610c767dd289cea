"""The image that says how much each pixel of an ultrasound image counts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import SimpleITK as sitk

from ..errors import FileFormatError
from .itk_errors import short_cause


def read_importance_mask(path: str | Path) -> np.ndarray:
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
    if not path.is_file():
        raise FileFormatError(f"{path}: there is no such file. Name an 8-bit gray image as importance mask.")
    try:
        image = sitk.ReadImage(str(path))
    except RuntimeError as error:
        raise FileFormatError(f"{path}: it cannot be read as an importance mask: {short_cause(error)}. Give a PNG image.") from error
    array = sitk.GetArrayFromImage(image)
    if array.dtype != np.uint8 or image.GetNumberOfComponentsPerPixel() != 1 or array.squeeze().ndim != 2:
        found = f"{' x '.join(map(str, image.GetSize()))} {image.GetPixelIDTypeAsString()}"
        raise FileFormatError(f"{path}: an importance mask must be an 8-bit gray image; got {found}. Convert it.")
    array = array.reshape(array.shape[-2:])
    if not array.any():
        raise FileFormatError(f"{path}: an importance mask must have pixels above 0; got none. Draw what counts in white.")
    return array.astype(np.float32) / np.float32(255)

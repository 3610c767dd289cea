"""Where the image lies in the probe, from any file that people have it in: Plus configuration, Slicer transform, or sixteen numbers."""

from __future__ import annotations

import re
from pathlib import Path

from ...arrays import Matrix
from ...errors import FileFormatError, GeometryError
from ...geometry.transform_graph import TransformName
from ...geometry.transforms import as_matrix
from ...message import listed
from ...remedies import NAME_THE_CALIBRATION
from ..disk.small_files import read_bytes
from ..metafile.text_values import NotANumberError, parse_matrix
from ..plus.configuration import read_plus_configuration
from ..sequence.files import IMAGE_FRAME
from ..transform.files import HDF5_SUFFIXES, read_transform

MAXIMUM_BYTES = 2**16
_ITK_MAGIC = "#Insight Transform File"


def read_calibration(path: str | Path, name: TransformName | None = None) -> tuple[TransformName, Matrix]:
    """Name and matrix of a calibration, pixels to mm.

    Raises FileFormatError or ConfigurationError when the file cannot be used.

    Parameters
    ----------
    path : str or Path
        .xml of Plus; .tfm, .txt or .h5 saved by Slicer; or a text file of 16 numbers, row by row.
    name : TransformName or None
        The transform to take from a configuration, by default its only one from Image; for other files, what to call it (ImageToProbe by
        default).
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".xml":
        transforms = read_plus_configuration(path).transforms
        names = [known for known in transforms if known == name or (name is None and known.source == IMAGE_FRAME)]
        if len(names) != 1:
            told = f"it must hold {name or f'one transform from {IMAGE_FRAME}'}; got {listed(transforms) or 'none'}"
            raise FileFormatError(f"{path}: {told}.", NAME_THE_CALIBRATION, example="ImageToProbe")
        return names[0], transforms[names[0]].matrix
    name = name or TransformName(IMAGE_FRAME, "Probe")
    text = read_bytes(path, MAXIMUM_BYTES, FileFormatError).decode("utf-8-sig", errors="replace").strip()
    if suffix in (*HDF5_SUFFIXES, ".tfm") or text.startswith(_ITK_MAGIC):
        return name, read_transform(path)
    try:
        return name, as_matrix(parse_matrix(re.sub(r"[,;\[\]]", " ", text)), "calibration")
    except (NotANumberError, GeometryError) as error:
        why = str(error).rstrip(".")
        forms = "Give those, a Plus configuration (.xml) or a Slicer transform (.tfm)."
        raise FileFormatError(f"{path}: a calibration must be 16 numbers, row by row; {why}. {forms}") from None

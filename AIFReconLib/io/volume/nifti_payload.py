"""Whether a NIfTI file (.nii, .nii.gz) holds all the voxels that its header promises, and where its two forms place them."""

from __future__ import annotations

import contextlib
import gzip
import math
import zlib
from pathlib import Path

import numpy as np
import scipy
import SimpleITK as sitk

from ...arrays import Floats, Matrix
from ...errors import FileFormatError
from ...machine.memory import available_memory, require_bytes
from ..disk.itk import itk_path, short_cause, without_warnings
from ..disk.regular_files import require_regular_file

HEADER = 348
"""Bytes of the header, which begins with their number."""

ITK_COPIES = 2
"""What SimpleITK reads from the file, and the image that it makes of it."""

_PIECE = 2**20
"""Bytes that are decoded at a time."""

_UNIT_MM = {1: 1e3, 3: 1e-3}
"""By NIfTI's number of a unit: meters and microns; all others are taken as mm."""


def check_nifti(path: Path, error: type[FileFormatError]) -> dict[str, str]:
    """What the header says, by SimpleITK's names, if the file is complete: SimpleITK takes what is missing for zeros.

    Raises
    ------
    FileFormatError
        Of the class given.
    """
    require_regular_file(path, error)
    length, zipped = path.stat().st_size, path.suffix.lower() == ".gz"
    try:
        with gzip.open(path) if zipped else open(path, "rb") as file:
            problem = _magic_problem(file.read(HEADER))
            if problem is None:
                header = _header(path, error)
                dimensions = [int(header[f"dim[{n}]"]) for n in range(1, int(header["dim[0]"]) + 1)]
                needed = int(float(header["vox_offset"])) + (math.prod(dimensions) * int(header["bitpix"]) + 7) // 8
                require_bytes(path, ITK_COPIES * needed, available_memory())
                if zipped:
                    length = HEADER + sum(map(len, iter(lambda: file.read(_PIECE), b"")))
                if length < needed:
                    problem = f"are cut short: the header promises {needed} bytes, there are {length}"
    except EOFError:
        problem = "are cut short"
    except (gzip.BadGzipFile, zlib.error) as cause:
        problem = f"are corrupt ({cause})"
    except OSError as cause:
        raise error(f"{path}: the file cannot be read ({cause.strerror}). Check its permissions.") from cause
    if problem is not None:
        raise error(f"{path}: the voxels {problem}. Copy or export the file again.")
    return header


def _magic_problem(head: bytes) -> str | None:
    """What shows in the first bytes that this is no NIfTI file, as the predicate of "the voxels ..."."""
    sizes = {int.from_bytes(head[:4], order) for order in ("little", "big")}
    if 540 in sizes:
        return "are in a NIfTI-2 file, which ITK does not read. Save it as NIfTI-1 or as .nrrd"
    if HEADER not in sizes:
        return "are not those of a NIfTI file: it does not begin with 348"
    if len(head) < HEADER:
        return "are missing, and part of the header too"
    return None if head[344:347] == b"n+1" else "are not in this file: it is the header of a pair, or an old Analyze file"


def _header(path: Path, error: type[FileFormatError]) -> dict[str, str]:
    reader = sitk.ImageFileReader()
    reader.SetImageIO("NiftiImageIO")
    reader.SetFileName(itk_path(path, error))
    try:
        with without_warnings():
            reader.ReadImageInformation()
    except RuntimeError as cause:
        raise error(f"{path}: SimpleITK cannot read it: {short_cause(cause)}. Export the volume again.") from cause
    return {key: reader.GetMetaData(key) for key in reader.GetMetaDataKeys()}


def nifti_forms(header: dict[str, str]) -> dict[str, Matrix]:
    """Voxel (i, j, k) to RAS, (4, 4) in mm, by the forms that a header has: ``qform``, a rotation, and ``sform``, any matrix."""

    def numbers(*keys: str) -> Floats:
        return np.array([float(word) for key in keys for word in header[key].split()])

    forms: dict[str, Matrix] = {}
    if int(header["qform_code"]) > 0:
        handed, *sizes = numbers(*(f"pixdim[{n}]" for n in range(4)))
        b, c, d = numbers("quatern_b", "quatern_c", "quatern_d")
        sizes[2] *= -1 if handed < 0 else 1
        with contextlib.suppress(ValueError):  # no numbers
            rotation = scipy.spatial.transform.Rotation.from_quat((b, c, d, math.sqrt(max(1 - b * b - c * c - d * d, 0.0))))
            forms["qform"] = np.column_stack([rotation.as_matrix() * sizes, numbers("qoffset_x", "qoffset_y", "qoffset_z")])
    if int(header["sform_code"]) > 0:
        forms["sform"] = numbers("srow_x", "srow_y", "srow_z").reshape(3, 4)
    scale = _UNIT_MM.get(int(header["xyzt_units"]) & 7, 1.0)
    return {name: np.vstack([scale * form, (0.0, 0.0, 0.0, 1.0)]) for name, form in forms.items()}

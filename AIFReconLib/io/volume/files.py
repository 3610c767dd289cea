"""Volume files: MetaImage, NRRD, NIfTI and DICOM. Files hold left-posterior-superior coordinates, memory RAS ones."""

from __future__ import annotations

import contextlib
import json
import shutil
from pathlib import Path

import numpy as np
import SimpleITK as sitk

from ...arrays import Matrix, Numbers
from ...errors import FileFormatError, GeometryError, OutputError, VolumeFormatError
from ...geometry.transforms import LPS_FROM_RAS
from ...geometry.volume import Volume
from ...remedies import TAKE_AS_CT, TAKE_AS_PROBABILITY
from ..disk.atomic import atomic_output, atomic_outputs, check_writable
from ..disk.itk import itk_path, short_cause
from ..disk.tables import read_table
from ..metafile.metaimage import LAST_KEY, check_pair_name
from ..metafile.opening import METAIMAGE_SUFFIXES, NRRD_SUFFIXES, read_metafile
from ..metafile.payload import check_payload
from .dicom_writer import SUFFIX as DICOM_SUFFIX
from .dicom_writer import check_dicom, write_dicom
from .itk_images import to_sitk
from .itk_reading import StoredVolume, read_metafile_volume, read_nifti

NIFTI_SUFFIXES = (".nii", ".nii.gz")
READABLE_SUFFIXES = METAIMAGE_SUFFIXES + NRRD_SUFFIXES + NIFTI_SUFFIXES
WRITABLE_SUFFIXES = (".nrrd", *METAIMAGE_SUFFIXES, *NIFTI_SUFFIXES, DICOM_SUFFIX)

ROUNDED = 1e-3
"""How far a label may lie from a whole number: by the scale factor of a file, or by arithmetic."""

OWN_FIELDS = "AIFRecon_"
"""How the fields of a header begin that a volume keeps."""


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
    array, ijk_to_lps, fields = _read_stored(path)
    _require_single(path, array)
    return _as_volume(path, array, ijk_to_lps, fields)


def label_volume(path: Path) -> Volume:
    """The labels in one file, as whole numbers: 0 is background; see `read_labels`.

    Raises VolumeFormatError as `read_volume`, and when a voxel is not a whole number or is negative.
    """
    array, ijk_to_lps, fields = _read_stored(path)
    if array.ndim != 3 and any(key.startswith("Segment") for key in fields):
        array = np.asarray((array > 0).any(axis=-1), dtype=np.uint8)
    _require_single(path, array)
    return _as_volume(path, _as_labels(path, array), ijk_to_lps, fields)


def _require_single(path: Path, array: Numbers) -> None:
    if array.ndim != 3:
        raise VolumeFormatError(f"{path}: its voxels must be single numbers; got {array.shape[3]} each. Export a scalar or label volume.")


def write_volume(volume: Volume, path: str | Path, study: str | Path | None = None) -> None:
    """Write a volume, completely or not at all.

    Parameters
    ----------
    volume : Volume
        Truth values are written as 0 and 1, 8 bit. Its fields go into the header, a line each; of NIfTI into a .json file beside it.
    path : str or Path
        .nrrd, .mha, .mhd (with .zraw beside it), .nii or .nii.gz, compressed, except .nii; or .dcm, one multi-frame DICOM file.
    study : str, Path or None
        Of a .dcm file: a DICOM file of the study that it is added to, or a folder of such.

    Raises
    ------
    OutputError
        When it cannot be written.
    """
    path = Path(path)
    suffix = _writable_suffix(path)
    if suffix == DICOM_SUFFIX:
        with atomic_output(path) as temporary:
            write_dicom(volume, path, temporary, None if study is None else Path(study))
        return
    try:
        image = to_sitk(volume)
    except GeometryError as error:
        raise OutputError(f"Cannot write {path}: volume files cannot hold {volume.array.dtype}. Convert the volume.") from error
    for key, text in volume.fields.items():
        image.SetMetaData(key, text)
    pair = suffix == ".mhd"
    companions = [path.with_suffix(".zraw")] if pair else [sidecar_of(path)] if suffix in NIFTI_SUFFIXES and volume.fields else []
    with atomic_outputs(*companions, path) as (*beside, temporary):
        one_file = temporary.with_suffix(".mha") if pair else temporary
        try:
            sitk.WriteImage(image, itk_path(one_file, OutputError), useCompression=suffix != ".nii")
            if pair:
                _split(one_file, temporary, beside[0])
            elif beside:
                beside[0].write_text(json.dumps(dict(volume.fields), indent=2) + "\n", encoding="utf-8")
            # A full disk can pass unnoticed by SimpleITK; a file that is not all there must not get its name.
            if suffix in NIFTI_SUFFIXES:
                read_nifti(temporary)
            else:
                check_payload(read_metafile(temporary, VolumeFormatError))
        except FileFormatError as error:
            raise OutputError(f"Cannot write {path}: the file came out incomplete. Check that the disk is not full.") from error
        except RuntimeError as error:
            raise OutputError(f"Cannot write {path}: {short_cause(error)}. Check that the disk is not full.") from error


def _split(whole: Path, header: Path, data: Path) -> None:
    """Write the header of a .mha file as `header`, which names `data`, and its pixels as `data`; then remove it.

    SimpleITK would write the pair itself, but takes a percent sign in its path, or in that of a folder, for a pattern of file names, and
    ends the program.
    """
    with open(whole, "rb") as file, open(header, "wb") as lines, open(data, "wb") as pixels:
        while (line := file.readline()) and not line.startswith(LAST_KEY.encode()):
            lines.write(line)
        lines.write(f"{LAST_KEY} = {data.name}\n".encode("utf-8", errors="surrogateescape"))
        shutil.copyfileobj(file, pixels)
    whole.unlink()


def check_volume_path(path: str | Path, dtype: str = "uint8") -> None:
    """Return if a volume with voxels of this type can be written to `path`; to be asked before a long computation. Leaves nothing behind.

    Raises OutputError when no volume format has that suffix, or no file can be created there.
    """
    if _writable_suffix(Path(path)) == DICOM_SUFFIX:
        check_dicom(Path(path), dtype)
    itk_path(Path(path).absolute(), OutputError)
    check_writable(path)


def _writable_suffix(path: Path) -> str:
    suffix = suffix_of(path)
    if suffix not in WRITABLE_SUFFIXES:
        raise OutputError(f"Cannot write {path}: its suffix must be one of {', '.join(WRITABLE_SUFFIXES)}. Choose another name.")
    if suffix == ".mhd":
        check_pair_name(path)
    return suffix


def suffix_of(path: Path) -> str:
    """The suffix that names the format, ``.nii.gz`` being one."""
    name = path.name.lower()
    return ".nii.gz" if name.endswith(".nii.gz") else path.suffix.lower()


def _read_stored(path: Path) -> StoredVolume:
    suffix = suffix_of(path)
    if suffix not in READABLE_SUFFIXES:
        raise VolumeFormatError(f"{path}: its suffix must be one of {', '.join(READABLE_SUFFIXES)}. Export the volume as one.")
    return (*read_nifti(path), _beside(sidecar_of(path))) if suffix in NIFTI_SUFFIXES else read_metafile_volume(path)


def sidecar_of(path: Path) -> Path:
    """The file beside a NIfTI file that holds what its header has no room for: x.json of x.nii.gz."""
    return path.with_name(path.name[: -len(suffix_of(path))] + ".json")


def _beside(path: Path) -> dict[str, str]:
    """The fields in a JSON file, where it is there and is one of ours."""
    with contextlib.suppress(VolumeFormatError):
        found = read_table(path, VolumeFormatError)
        return {key: text for key, text in found.items() if isinstance(text, str)} if isinstance(found, dict) else {}
    return {}


def _as_volume(path: Path, array: Numbers, ijk_to_lps: Matrix, fields: dict[str, str]) -> Volume:
    """Place an array [k, j, i] where the file says: the only way from LPS files into memory."""
    try:
        own = {key: text for key, text in fields.items() if key.startswith(OWN_FIELDS)}
        return Volume(array, LPS_FROM_RAS @ ijk_to_lps, own)
    except GeometryError as error:
        raise VolumeFormatError(f"{path}: its place in space cannot be used. {error}") from error


def _as_labels(path: Path, array: Numbers) -> Numbers:
    """Whole numbers; floating-point voxels that are whole but for their rounding become int32."""
    if array.dtype.kind == "f":
        if not all(((np.abs(plane - np.rint(plane)) <= ROUNDED) & (np.abs(plane) < 2**31)).all() for plane in array):
            advice = "Export them without smoothing, as whole numbers." if np.nanmax(array) > 1 else TAKE_AS_PROBABILITY
            raise VolumeFormatError(f"{path}: labels must be whole numbers; got fractions or NaN.", advice)
        array = np.stack([np.rint(plane).astype(np.int32) for plane in array])
    if array.min() < 0:
        raise VolumeFormatError(f"{path}: labels must not be negative; got {array.min()}.", TAKE_AS_CT)
    return array

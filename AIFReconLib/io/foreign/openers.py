"""Which kind of file holds images of people without Plus, and what opens it."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from ...errors import FileFormatError
from ..disk.regular_files import files_in, require_regular_file
from ..metafile.opening import METAIMAGE_SUFFIXES
from ..sequence.decoded_images import DecodedImages
from ..sequence.files import recording_kind
from ..sequence.metafiles import METAFILES
from ..sequence.others.unread import refuse_unread
from .dicom import open_dicom
from .images import ImportedImages
from .numpy_arrays import open_numpy
from .pictures import open_pictures
from .video import open_video

PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp")
DICOM_SUFFIXES = (".dcm", ".dicom")
VIDEO_SUFFIXES = (".mp4", ".avi", ".mov", ".mkv", ".wmv", ".m4v", ".webm")
NUMPY_SUFFIXES = (".npy",)


def open_images(paths: Sequence[str | Path]) -> ImportedImages:
    """The frames in these files, in natural order of their names (2 before 10).

    Raises FileFormatError, which names the file, and what was expected.

    Parameters
    ----------
    paths : sequence of str or Path
        Pictures, DICOM or MetaImage files, or a folder of them; or one video, multi-frame DICOM file or .npy array (frames, rows, columns).
    """
    files = _listed([Path(path) for path in paths])
    suffixes = {path.suffix.lower() for path in files}
    kind = next((k for k in _KINDS if suffixes <= set(k[0])), None)
    if kind is None:
        refuse_unread(files[0])
        known = ", ".join(suffix for known, _ in _KINDS for suffix in known)
        must = f"images must all be pictures, DICOM or MetaImage files, one video or one .npy array ({known})"
        raise FileFormatError(f"{files[0]}: {must}; got {', '.join(sorted(suffixes)) or 'no suffix'}. Give files of one kind.")
    return kind[1](files)


def natural_order(path: Path) -> list[int | str]:
    """A key that sorts 2 before 10."""
    # Every second piece is a number; isdigit would also take a superscript for one
    return [int(word) if place % 2 else word.lower() for place, word in enumerate(re.split(r"([0-9]+)", path.name))]


def _listed(paths: list[Path]) -> list[Path]:
    """The files, folders replaced by what is in them."""
    known = {suffix for suffixes, _ in _KINDS for suffix in suffixes}
    files: list[Path] = []
    for path in paths:
        kind = recording_kind(path)
        if kind not in (None, METAFILES):
            recording = f"{path}: this is {kind.name}, which holds images and their poses."
            raise FileFormatError(recording, "It is read as it is: give it as the recording.")
        if path.is_dir():
            inside = sorted((file for file in files_in(path) if file.suffix.lower() in known), key=natural_order)
            if not inside:
                raise FileFormatError(f"{path}: there are no images in this folder. Give a folder of pictures or DICOM files.")
            files += inside
        else:
            require_regular_file(path, FileFormatError)
            files.append(path)
    return files


def _open_metaimages(files: list[Path]) -> ImportedImages:
    """One image a file, or the images of one recording, with its times."""
    opened = {path: METAFILES.read(path, None) for path in files}
    frames = [(path, number) for path, recorded in opened.items() for number in range(len(recorded.images))]
    single = len(frames) == len(files)
    if not single and (len(files) > 1 or METAFILES.frame_fields(files[0]) is None):
        path, slices = next((path, len(recorded.images)) for path, recorded in opened.items() if len(recorded.images) > 1)
        raise FileFormatError(f"{path}: this is a 3D volume of {slices} slices; frames must be 2D. Give one image a file, or a .npy array.")
    stack = DecodedImages(
        len(frames), lambda n: opened[frames[n][0]].images[frames[n][1]], lambda n: ", frame ".join(map(str, frames[n][: 2 - single]))
    )
    spacings = {recorded.records[0].stated_spacing for recorded in opened.values()}
    times = [None] if single else [record.timestamp for record in opened[files[0]].records]
    names = tuple(path.name for path in files) if single else None
    seconds = None if None in times else np.array(times, dtype=np.float64)
    several = "the files state several" if len(spacings) > 1 else None
    return ImportedImages(stack, "MetaImage frames", names, seconds, None if several else spacings.pop(), several)


def _only(files: list[Path]) -> Path:
    if len(files) != 1:
        raise FileFormatError(f"{files[1]}: there must be one video or array; got {len(files)} files. Import them one by one.")
    return files[0]


_KINDS: tuple[tuple[tuple[str, ...], Callable[[list[Path]], ImportedImages]], ...] = (
    (PICTURE_SUFFIXES, open_pictures),
    (DICOM_SUFFIXES, open_dicom),
    (METAIMAGE_SUFFIXES, _open_metaimages),
    (VIDEO_SUFFIXES, lambda files: open_video(_only(files))),
    (NUMPY_SUFFIXES, lambda files: open_numpy(_only(files))),
)

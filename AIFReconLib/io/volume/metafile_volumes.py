"""Volumes in MetaImage and NRRD files: their voxels, and the place in space that their headers state.

ITK's own readers of these formats take other values than ours from headers made to mislead, and crash on some; so every value here is
one that `read_metafile` has checked.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...arrays import Floats, Matrix, Numbers
from ...machine.memory import available_memory, require_bytes
from ...message import shorten
from ..metafile.metafile import RAW, Metafile
from ..metafile.opening import METAIMAGE_SUFFIXES
from ..metafile.payload import Inflater, PayloadError
from ..metafile.text_values import parse_numbers

_IN_SPACE = ("domain", "space")
_AXES_TO_LPS = {
    "left-posterior-superior": (1, 1, 1),
    "lps": (1, 1, 1),
    "right-anterior-superior": (-1, -1, 1),
    "ras": (-1, -1, 1),
    "left-anterior-superior": (1, -1, 1),
    "las": (1, -1, 1),
}
"""What each axis of an anatomical space is in left-posterior-superior."""
_OTHER_SPACES = ("scanner-xyz", "3d-right-handed", "3d-left-handed")
"""Taken as left-posterior-superior, as ITK does."""


@dataclass(frozen=True, eq=False)
class StoredVolume:
    """Voxels and their place, as a file gives them.

    Parameters
    ----------
    path : Path
    array : [k, j, i] array, or [k, j, i, n] for several values per voxel
    ijk_to_lps : (4, 4) float64 array, mm
        Not checked yet.
    fields : dict of str to str
        The file's own, by which segmentations are told.
    """

    path: Path
    array: Numbers
    ijk_to_lps: Matrix
    fields: dict[str, str] = field(default_factory=dict)

    @property
    def components(self) -> int:
        """Values per voxel."""
        return self.array.shape[3] if self.array.ndim == 4 else 1


def read_metafile_volume(metafile: Metafile) -> StoredVolume:
    """The voxels of a volume file, and where it says that they lie.

    Parameters
    ----------
    metafile : Metafile
        Three axes in space, and at most one other, of several values per voxel.

    Raises
    ------
    VolumeFormatError
        The metafile's kind: when the data are damaged, or it is no 3D volume, or its place in space cannot be understood.
    InsufficientMemoryError
        When the voxels do not fit into memory.
    """
    space = _space_axes(metafile)
    is_metaimage = metafile.path.suffix.lower() in METAIMAGE_SUFFIXES
    ijk_to_lps = _metaimage_place(metafile) if is_metaimage else _nrrd_place(metafile, space)
    # The file's fastest axis is the last of an array; channels are faster than every other
    stored = _payload(metafile).reshape(*metafile.size[::-1], metafile.channels)
    last = len(metafile.size) - 1
    others = [last - axis for axis in range(len(metafile.size)) if axis not in space]
    array = stored.transpose(*(last - axis for axis in reversed(space)), *others, last + 1)
    array = array.reshape(*array.shape[:3], -1)
    array = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))
    return StoredVolume(metafile.path, array[..., 0] if array.shape[3] == 1 else array, ijk_to_lps, metafile.fields)


def _space_axes(metafile: Metafile) -> list[int]:
    """The axes along i, j and k."""
    kinds = metafile.kinds or ("domain",) * len(metafile.size)
    space = [axis for axis, kind in enumerate(kinds) if kind in _IN_SPACE]
    if len(space) != 3:
        raise metafile.failure(
            f"it must be a 3D volume; got {len(space)} axes in space. If it is a sequence of frames, give it as a sequence."
        )
    if "time" in kinds or len(kinds) > 4:
        raise metafile.failure(
            "it must be one 3D volume; got axes of the kinds {kinds}. Export one 3D volume.".format(kinds=" ".join(kinds))
        )
    return space


def _payload(metafile: Metafile) -> Numbers:
    """All values in the order of the file, 1D, in the file's byte order."""
    require_bytes(metafile.path, metafile.pixel_bytes, available_memory())
    values = np.empty(metafile.pixel_bytes // metafile.dtype.itemsize, metafile.dtype)
    view = values.view(np.uint8).data
    with metafile.open_payload() as file:
        try:
            if metafile.encoding == RAW:
                file.seek(metafile.data_offset)
                if file.readinto(view) != len(view):
                    raise PayloadError("are cut short")
            else:
                stream = Inflater(metafile.data_offset, metafile.data_length)
                stream.read_into(file, view)
                stream.finish(file)
        except PayloadError as error:
            raise metafile.failure(f"the pixel data {error}. Copy or write the file again.") from error
        except OSError as error:
            raise metafile.failure(f"the pixel data cannot be read ({error.strerror}). Copy the file again.") from error
        metafile.require_unchanged(file)
    return values


def _metaimage_place(metafile: Metafile) -> Matrix:
    """ijk_to_lps of a MetaImage header, (4, 4), mm: the rows of TransformMatrix are the directions of the axes."""
    spacing = _numbers(metafile, ("ElementSpacing", "ElementSize"), 3, "1 1 1")
    directions = _numbers(metafile, ("TransformMatrix", "Rotation", "Orientation"), 9, "1 0 0 0 1 0 0 0 1").reshape(3, 3)
    if spacing.min() <= 0:
        raise metafile.failure(f"ElementSpacing must be positive; got {spacing.tolist()}. Correct the header.")
    return _placed(directions.T * spacing, _numbers(metafile, ("Offset", "Position", "Origin"), 3, "0 0 0"))


def _numbers(metafile: Metafile, keys: tuple[str, ...], count: int, otherwise: str) -> Floats:
    """The finite numbers under the first of `keys` that is there."""
    key = next((key for key in keys if key in metafile.entries), keys[0])
    return _parse(metafile, key, metafile.entries.get(key, otherwise), count)


def _nrrd_place(metafile: Metafile, space: list[int]) -> Matrix:
    """ijk_to_lps of an NRRD header, (4, 4), mm."""
    entries = metafile.entries
    name = entries.get("space", "").lower()
    if name not in (*_AXES_TO_LPS, *_OTHER_SPACES, ""):
        raise metafile.failure(
            f"space must be left-posterior-superior, right-anterior-superior or left-anterior-superior; got {shorten(name)!r}. Save "
            "the volume from Slicer again."
        )
    to_lps = np.array(_AXES_TO_LPS.get(name, (1, 1, 1)), dtype=np.float64)
    channel_axes = int(entries.get("dimension", "0")) - len(metafile.size)
    axes = [axis + channel_axes for axis in space]
    directions = entries.get("space directions")
    if directions is None:
        if {"space origin", "axis mins", "axis maxs"} & set(entries):
            raise metafile.failure(
                "it has a place but no space directions, so which way it lies is not known. Save the volume from Slicer again."
            )
        return _placed(np.diag(_spacings(metafile, axes)), np.zeros(3))
    vectors = re.findall(r"none|\([^()]*\)", directions)
    rest = re.sub(r"none|\([^()]*\)", "", directions)
    if rest.strip() or len(vectors) != len(metafile.size) + channel_axes or any(vectors[axis] == "none" for axis in axes):
        raise metafile.failure(
            f"space directions must be a vector for each axis in space, none for others; got {shorten(directions)!r}. Save the volume "
            "from Slicer again."
        )
    columns = [_vector(metafile, "space directions", vectors[axis]) for axis in axes]
    origin = _vector(metafile, "space origin", entries.get("space origin", "(0,0,0)"))
    return _placed(to_lps[:, None] * np.array(columns).T, to_lps * origin)


def _spacings(metafile: Metafile, axes: list[int]) -> Floats:
    """The spacings of these axes; 1 mm where there are none."""
    text = metafile.entries.get("spacings")
    if text is None:
        return np.ones(3)
    words = text.split()
    spacing = _parse(metafile, "spacings", " ".join(words[axis] for axis in axes if axis < len(words)), 3)
    if spacing.min() <= 0:
        raise metafile.failure(f"spacings must be positive; got {shorten(text)!r}. Correct the header.")
    return spacing


def _vector(metafile: Metafile, key: str, text: str) -> Floats:
    """``(1,0,0)``."""
    inside = text.strip()
    if not (inside.startswith("(") and inside.endswith(")")):
        raise metafile.failure(f"{key} must be 3 numbers, as (1,0,0); got {shorten(text)!r}. Correct the header.")
    return _parse(metafile, key, inside[1:-1].replace(",", " "), 3)


def _parse(metafile: Metafile, key: str, text: str, count: int) -> Floats:
    try:
        numbers = np.array(parse_numbers(text))
    except ValueError:
        numbers = np.array([])
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise metafile.failure(f"{key} must be {count} finite numbers; got {shorten(text)!r}. Correct the header.")
    return numbers


def _placed(axes: Floats, origin: Floats) -> Matrix:
    """A (4, 4) matrix of three columns, mm per voxel, and the center of the first voxel."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes, origin
    return matrix

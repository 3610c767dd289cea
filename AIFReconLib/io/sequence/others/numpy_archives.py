"""Archives of NumPy arrays: ``np.savez("sweep.npz", images=..., image_to_reference=..., timestamps=..., spacing=...)``.

The arrays are those of `TrackedSequence.from_arrays`; the last two may be left out. No array of objects is read, for it would be unpickled.
"""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import IO

import numpy as np

from ....arrays import Array, NumberType
from ....errors import GeometryError, SequenceFormatError
from ....message import said
from ....sweep.frames import TrackedSequence
from ...disk.regular_files import require_regular_file
from ..decoded_images import DecodedImages, decoding, frames_in_place
from ..kinds import Recorded, RecordingKind

IMAGES, POSES, TIMES, SPACING = "images", "image_to_reference", "timestamps", "spacing"
MOST_BYTES = 2**30
"""Of an array that is read as a whole, as compressed ones are."""
_LOCAL_HEADER = 30


def _read(path: Path, orientation: str | None) -> Recorded:
    if orientation is not None and not orientation.startswith("MF"):
        raise SequenceFormatError(f"{path}: images of an archive must be MF, the marked side on the right, the transducer at the top.")
    require_regular_file(path, SequenceFormatError)
    with (
        decoding(f"{path}: it cannot be read as an archive of arrays", "Save it again with numpy.savez."),
        zipfile.ZipFile(path) as archive,
    ):
        members = {info.filename.removesuffix(".npy"): info for info in archive.infolist()}
        missing = {IMAGES, POSES} - set(members)
        if missing:
            raise SequenceFormatError(
                f"{path}: it must hold the arrays {IMAGES} and {POSES}; got {', '.join(members) or 'none'}. Save them under these names."
            )
        images = _images(path, archive, members[IMAGES])
        others = {name: _whole(path, archive, members[name]) for name in (POSES, TIMES, SPACING) if name in members}
    spacing = others.get(SPACING)
    try:
        size = None if spacing is None else tuple(np.broadcast_to(spacing.astype(np.float64), 2).tolist())
        made = TrackedSequence.from_arrays(images, others[POSES], others.get(TIMES), spacing=size)
    except (GeometryError, TypeError, ValueError) as error:
        raise SequenceFormatError(f"{path}: {said(error)}") from error
    return Recorded(images, made.records)


def _images(path: Path, archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> DecodedImages:
    """Read one at a time where they are not compressed, else at once."""
    with archive.open(member) as file:
        shape, fortran, dtype, start = _header(path, file, member)
    if len(shape) not in (3, 4) or (len(shape) == 4 and shape[3] not in (1, 3, 4)) or 0 in shape:
        raise SequenceFormatError(f"{path}: images must have shape (frames, rows, columns) or (frames, rows, columns, 3); got {shape}.")
    if member.compress_type == zipfile.ZIP_STORED and not fortran:
        place = _place(path, member) + start
        return DecodedImages(shape[0], frames_in_place(path, shape[1:], dtype, place), lambda n: f"{path}, frame {n}")
    array = _whole(path, archive, member)
    return DecodedImages(shape[0], lambda number: array[number], lambda n: f"{path}, frame {n}")


def _whole(path: Path, archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> Array:
    if member.file_size > MOST_BYTES:
        raise SequenceFormatError(
            f"{path}: {member.filename} is too large ({member.file_size} bytes) to be read at once. Save it with numpy.savez, uncompressed."
        )
    with archive.open(member) as file:
        shape, fortran, dtype, _ = _header(path, file, member)
        data = file.read(int(np.prod(shape, dtype=np.int64)) * dtype.itemsize)
    return np.frombuffer(data, dtype).reshape(shape, order="F" if fortran else "C")


def _header(path: Path, file: IO[bytes], member: zipfile.ZipInfo) -> tuple[tuple[int, ...], bool, NumberType, int]:
    """Shape, order and type of an array, and where its numbers begin; what it promises must be there."""
    version = np.lib.format.read_magic(file)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, fortran, dtype = read(file)
    start = file.tell()
    if dtype.hasobject or dtype.kind not in "biuf":
        raise SequenceFormatError(f"{path}: {member.filename} must hold numbers; got {dtype}. Save it as an array of numbers.")
    promised = int(np.prod(shape, dtype=object)) * dtype.itemsize
    if start + promised != member.file_size:
        raise SequenceFormatError(
            f"{path}: {member.filename} must have {promised} bytes of numbers; got {member.file_size - start}. Save it again."
        )
    return shape, fortran, dtype, start


def _place(path: Path, member: zipfile.ZipInfo) -> int:
    """Where the bytes of a member begin in the file: behind its local header, which has a length of its own."""
    with open(path, "rb") as file:
        file.seek(member.header_offset)
        local = file.read(_LOCAL_HEADER)
    return member.header_offset + _LOCAL_HEADER + int.from_bytes(local[26:28], "little") + int.from_bytes(local[28:30], "little")


NUMPY_ARCHIVES = RecordingKind("an archive of NumPy arrays", (".npz",), _read)

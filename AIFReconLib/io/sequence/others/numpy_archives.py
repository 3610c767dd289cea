"""Archives of NumPy arrays: ``np.savez("sweep.npz", images=..., image_to_reference=..., timestamps=..., spacing=...)``.

The arrays are those of `TrackedSequence.from_arrays`; the last two may be left out. No array of objects is read, for it would be unpickled.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ....arrays import Array
from ....errors import GeometryError, SequenceFormatError
from ....message import said
from ....sweep.frames import TrackedSequence
from ...disk.regular_files import require_regular_file
from ..decoded_images import DecodedImages, decoding, frames_in_place
from ..kinds import Recorded, RecordingKind

IMAGES, POSES, TIMES, SPACING = "images", "image_to_reference", "timestamps", "spacing"
_LOCAL_HEADER = 30


def _read(path: Path, orientation: str | None) -> Recorded:
    if orientation is not None and not orientation.startswith("MF"):
        raise SequenceFormatError(f"{path}: images of an archive must be MF, the marked side on the right, the transducer at the top.")
    require_regular_file(path, SequenceFormatError)
    readable = decoding(f"{path}: it cannot be read as an archive of arrays", "Save it again with numpy.savez.")
    with readable, zipfile.ZipFile(path) as stored, np.load(path, allow_pickle=False) as archive:
        if {IMAGES, POSES} - set(archive.files):
            there = ", ".join(archive.files) or "none"
            raise SequenceFormatError(f"{path}: it must hold the arrays {IMAGES} and {POSES}; got {there}. Save them under these names.")
        images = _images(path, stored, archive)
        others = {name: archive[name] for name in (POSES, TIMES, SPACING) if name in archive.files}
    spacing = others.get(SPACING)
    try:
        size = None if spacing is None else tuple(np.broadcast_to(spacing.astype(np.float64), 2).tolist())
        made = TrackedSequence.from_arrays(images, others[POSES], others.get(TIMES), spacing=size)
    except (GeometryError, TypeError, ValueError) as error:
        raise SequenceFormatError(f"{path}: {said(error)}") from error
    return Recorded(images, made.records)


def _images(path: Path, stored: zipfile.ZipFile, archive: Mapping[str, Array]) -> DecodedImages:
    """Read one at a time where they are not compressed, else at once."""
    member = stored.getinfo(f"{IMAGES}.npy")
    with stored.open(member) as file:
        version = np.lib.format.read_magic(file)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, fortran, dtype = read(file)
        start = file.tell()
    if len(shape) not in (3, 4) or (len(shape) == 4 and shape[3] not in (1, 3, 4)) or 0 in shape:
        raise SequenceFormatError(f"{path}: images must have shape (frames, rows, columns) or (frames, rows, columns, 3); got {shape}.")
    promised = int(np.prod(shape, dtype=object)) * dtype.itemsize
    if start + promised != member.file_size and not dtype.hasobject:
        raise SequenceFormatError(
            f"{path}: {member.filename} must have {promised} bytes of numbers; got {member.file_size - start}. Save it again."
        )
    in_place = member.compress_type == zipfile.ZIP_STORED and not fortran and not dtype.hasobject
    frame = frames_in_place(path, shape[1:], dtype, _place(path, member) + start) if in_place else archive[IMAGES].__getitem__
    return DecodedImages(shape[0], frame, lambda n: f"{path}, frame {n}")


def _place(path: Path, member: zipfile.ZipInfo) -> int:
    """Where the bytes of a member begin in the file: behind its local header, which has a length of its own."""
    with open(path, "rb") as file:
        file.seek(member.header_offset)
        local = file.read(_LOCAL_HEADER)
    return member.header_offset + _LOCAL_HEADER + int.from_bytes(local[26:28], "little") + int.from_bytes(local[28:30], "little")


NUMPY_ARCHIVES = RecordingKind("an archive of NumPy arrays", (".npz",), _read)

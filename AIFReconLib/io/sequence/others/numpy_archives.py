"""Archives of NumPy arrays: ``np.savez("sweep.npz", images=..., image_to_reference=..., timestamps=..., spacing=...)``.

The arrays are those of `TrackedSequence.from_arrays`; the last two may be left out. No array of objects is read, for it would be unpickled.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ....errors import GeometryError, SequenceFormatError
from ....message import message_of
from ....sweep.frames import TrackedSequence
from ...disk.regular_files import require_regular_file
from ..decoded_images import DecodedImages, decoding
from ..kinds import Recorded, RecordingKind

IMAGES, POSES, TIMES, SPACING = "images", "image_to_reference", "timestamps", "spacing"


def _read(path: Path, orientation: str | None) -> Recorded:
    if orientation is not None and not orientation.startswith("MF"):
        raise SequenceFormatError(f"{path}: images of an archive must be MF, the marked side on the right, the transducer at the top.")
    require_regular_file(path, SequenceFormatError)
    readable = decoding(f"{path}: it cannot be read as an archive of arrays", "Save it again with numpy.savez.")
    # numpy leaves a file open that is no archive
    with readable, path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
        arrays = {name: archive[name] for name in archive.files}
    if {IMAGES, POSES} - arrays.keys():
        raise SequenceFormatError(f"{path}: it must hold the arrays {IMAGES} and {POSES}; got {', '.join(arrays) or 'none'}.")
    stored = arrays[IMAGES]
    if stored.ndim not in (3, 4) or stored.shape[3:] not in ((), (1,), (3,), (4,)) or not stored.size:
        raise SequenceFormatError(f"{path}: images must have shape (frames, rows, columns) or (..., 3); got {stored.shape}.")
    images = DecodedImages(len(stored), stored.__getitem__, lambda n: f"{path}, frame {n}")
    spacing = arrays.get(SPACING)
    try:
        size = None if spacing is None else tuple(np.broadcast_to(spacing.astype(np.float64), 2).tolist())
        made = TrackedSequence.from_arrays(images, arrays[POSES], arrays.get(TIMES), spacing=size)
    except (GeometryError, TypeError, ValueError) as error:
        raise SequenceFormatError(f"{path}: {message_of(error)}") from error
    return Recorded(images, made.records)


NUMPY_ARCHIVES = RecordingKind("an archive of NumPy arrays", (".npz",), _read)

"""Recordings, read where nobody waits for windows: what is told of their frames at once, their images some at a time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Numbers, NumberType
from ..io.foreign.options import ImportOptions
from ..io.sequence.files import read_sequence, require_recording_kind
from ..progress import Progress, report
from ..recipe.recipe import LONGEST_GAP
from ..sweep.frames import TrackedSequence
from ..sweep.time_offset import with_time_offset
from .channel import shared_array

if TYPE_CHECKING:
    from ..inspection.imported import Checked, Imported


@dataclass(frozen=True)
class LeftBehind:
    """Images that were not sent: their shape (frames, rows, columns), and the type of their pixels."""

    shape: tuple[int, ...]
    dtype: NumberType

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, index: int, /) -> Numbers:
        raise IndexError(f"Image {index} was left in the process that reads them.")


def read_recording(
    path: str | Path,
    config: str | Path | None = None,
    orientation: str | None = None,
    time_offset: float = 0.0,
    longest_gap: float = LONGEST_GAP,
) -> TrackedSequence:
    """A recording as `read_sequence` and `with_time_offset` make it, whose arguments these are."""
    return with_time_offset(read_sequence(path, config=config, orientation=orientation), time_offset, longest_gap)


def without_images(sequence: TrackedSequence) -> TrackedSequence:
    """The sequence, to be sent: `images_between` gives its images."""
    return replace(sequence, images=LeftBehind(tuple(sequence.images.shape), np.dtype(sequence.images.dtype)))


def images_between(sequence: TrackedSequence, start: int, stop: int) -> Numbers:
    """Images from one number to before another, (frames, rows, columns)."""
    images = shared_array((stop - start, *sequence.images.shape[1:]), sequence.images.dtype)
    for number in range(start, stop):
        images[number - start] = sequence.images[number]
    return images


def frame_fields(path: str | Path) -> frozenset[str] | None:
    """What the header of a file says of each frame, by name; None where it is no recording.

    Raises SequenceFormatError when it cannot be read.
    """
    fields = require_recording_kind(Path(path)).frame_fields(Path(path))
    return None if fields is None else frozenset(fields)


def read_import(images: Sequence[Path], poses: Path, options: ImportOptions, progress: Progress | None = None) -> Imported:
    """As `import_files`; to be kept in the worker."""
    from ..inspection.imported import import_files

    report(progress, 0.0, "Reading images and poses")
    return import_files(images, poses, options)


def seen_of(imported: Imported, name: str, progress: Progress | None = None) -> tuple[tuple[str, ...], Checked]:
    """How images and poses were understood, and what `check_import` tells."""
    from ..inspection.imported import check_import

    report(progress, 0.0, "Looking at the sweep")
    return imported.understood, check_import(imported, name)


def sequence_in(imported: Imported) -> TrackedSequence:
    """The sequence itself."""
    return imported.sequence

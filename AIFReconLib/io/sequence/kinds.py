"""What a kind of recording is: the files that it opens, and the frames that it makes of one."""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set
from dataclasses import dataclass, field
from pathlib import Path

from ...arrays import Matrix
from ...geometry.transform_graph import TransformName, TransformSample
from ...imaging.images import ImageStack
from ...sweep.frames import FrameRecord


@dataclass(frozen=True, eq=False)
class Recorded:
    """What a file holds of a recording.

    Parameters
    ----------
    images : ImageStack
        In MF orientation, gray; read when asked for.
    records : sequence of FrameRecord
        One an image.
    fields, transforms : dict
        Of the whole recording.
    notes : tuple of str
        What a user should know.
    pixel_to_node : (4, 4) array or None, mm
        What the transforms of the image take instead of pixels.
    """

    images: ImageStack
    records: Sequence[FrameRecord]
    fields: dict[str, str] = field(default_factory=dict)
    transforms: dict[TransformName, TransformSample] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    pixel_to_node: Matrix | None = None


@dataclass(frozen=True)
class RecordingKind:
    """A kind of recording. It raises `SequenceFormatError` for a file that it cannot use, before it takes memory for what that promises.

    Parameters
    ----------
    name : str
        In words for people.
    suffixes : tuple of str
        Of the files that it opens, lower case.
    read : callable of (path, orientation)
        Where the caller knows which way the stored pixels run, that is upper case, as MFA; else None.
    frame_fields : callable of path
        The names of fields that frames have; None for a file of these suffixes that is no recording, but a volume.
    is_folder : callable of path
        Whether a folder is one.
    files : callable of path
        What else is opened where a file is: those beside it that belong to it.
    """

    name: str
    suffixes: tuple[str, ...]
    read: Callable[[Path, str | None], Recorded]
    frame_fields: Callable[[Path], Set[str] | None] = lambda _: frozenset()
    is_folder: Callable[[Path], bool] = lambda _: False
    files: Callable[[Path], Sequence[Path]] = lambda _: ()

"""Tracked ultrasound frames: one frame for the reconstructor, and whole recorded sequences.

Pixels are (column, row) with centers at integers. In memory every B-mode image has the marked side of the probe at column 0 and the
transducer at row 0 (Plus calls this orientation MF).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..arrays import Matrix, Numbers
from ..geometry.transform_graph import TransformName, TransformSample, TransformStatus
from ..imaging.images import ImageStack
from ..message import Described
from .configuration import NO_CONFIGURATION, PlusConfiguration


@dataclass(frozen=True, eq=False)
class TrackedFrame:
    """What a reconstructor takes: one image and where it is.

    Parameters
    ----------
    image : (rows, columns) array, or None when the frame has no image
    image_to_reference : (4, 4) float64 array, pixels to mm, or None without a pose
    timestamp : float, s
    status : str
        "OK", or why the frame cannot be used; such a frame is counted by the reconstructor and never inserted.
    number : int
        Its number in the recording or stream, for messages.
    """

    image: Numbers | None
    image_to_reference: Matrix | None
    timestamp: float = 0.0
    status: str = "OK"
    number: int = 0

    def placed(self) -> tuple[Numbers, Matrix]:
        """Image and pose of a frame that is OK.

        Raises
        ------
        ValueError
            When it lacks one of them, which its status should have said.
        """
        if self.image is None or self.image_to_reference is None:
            raise ValueError(f"Input frame {self.number} must have an image and a pose where its status is OK; got {self.status!r}.")
        return self.image, self.image_to_reference


@dataclass(frozen=True, eq=False)
class FrameRecord:
    """What a sequence says of one frame besides its pixels.

    Parameters
    ----------
    timestamp, unfiltered_timestamp : float or None, s
    image_status : TransformStatus
        Not OK: the frame has no image.
    transforms : dict of TransformName to TransformSample
        As recorded. Matrices may hold NaN; `sweep_poses` judges them.
    fields : dict of str to str
        Every other field of the frame, by its name without the ``Seq_Frame0000_`` prefix.
    """

    timestamp: float | None = None
    unfiltered_timestamp: float | None = None
    image_status: TransformStatus = TransformStatus.OK
    transforms: dict[TransformName, TransformSample] = field(default_factory=dict)
    fields: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, repr=False)
class TrackedSequence(Described):
    """A recorded sweep: images, and per frame its transforms, statuses and times.

    Parameters
    ----------
    images : ImageStack, (frames, rows, columns)
    records : list of FrameRecord, one per image
    fields : dict of str to str
        Custom header fields that concern the whole file.
    transforms : dict of TransformName to TransformSample
        Transforms that hold for every frame (from the header, not from a configuration).
    configuration : PlusConfiguration
        What was given with the recording; an empty one where nothing was (None is taken for that).
    path : Path or None
        Where it was read from, for messages.
    notes : tuple of str
        What a user should know about how it was read or changed, one sentence each.
    """

    images: ImageStack
    records: list[FrameRecord]
    fields: dict[str, str] = field(default_factory=dict)
    transforms: dict[TransformName, TransformSample] = field(default_factory=dict)
    configuration: PlusConfiguration = NO_CONFIGURATION
    path: Path | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.configuration is None:
            object.__setattr__(self, "configuration", NO_CONFIGURATION)
        if len(self.images) != len(self.records):
            raise ValueError(f"Input records must be one per image; got {len(self.records)} for {len(self.images)} images.")

    def __len__(self) -> int:
        return len(self.records)

    def _facts(self) -> list[tuple[str, str]]:
        columns, rows = self.frame_size
        names = ", ".join(map(str, self.transform_names())) or "none"
        images = f"{columns} x {rows} pixels, {np.dtype(self.images.dtype).name}"
        return [("name", self.name), ("frames", str(len(self))), ("images", images), ("transforms", names)]

    @property
    def frame_size(self) -> tuple[int, int]:
        """Columns and rows."""
        return int(self.images.shape[2]), int(self.images.shape[1])

    @property
    def name(self) -> str:
        """The file's name, or "sequence" for one made in memory."""
        return self.path.name if self.path else "sequence"

    @property
    def parts(self) -> tuple[TrackedSequence, ...]:
        """The sweeps that it is made of: itself, or those that were joined."""
        return (self,)

    def transform_names(self) -> list[TransformName]:
        """Every transform that occurs in any frame or in the header, in order of appearance."""
        names = dict.fromkeys(self.transforms)
        for record in self.records:
            names.update(dict.fromkeys(record.transforms))
        return list(names)

    def status_counts(self, name: TransformName) -> Counter[TransformStatus]:
        """How many frames have this transform with which status; frames without it count as MISSING, unless the header has it."""
        otherwise = self.transforms.get(name, TransformSample(np.eye(4), TransformStatus.MISSING))
        return Counter(record.transforms.get(name, otherwise).status for record in self.records)

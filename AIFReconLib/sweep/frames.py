"""Tracked ultrasound frames: one frame for the reconstructor, and whole recorded sequences.

Pixels are (column, row) with centers at integers. In memory every B-mode image is MF, as Plus calls it: the marked side of the probe
is at the last column (on the right), the transducer at row 0.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats, Matrix, Numbers
from ..errors import GeometryError
from ..geometry.transform_graph import TransformName, TransformSample, TransformStatus
from ..geometry.transforms import why_not_affine, why_not_rigid
from ..imaging.images import ImageStack
from ..message import Described
from .configuration import NO_CONFIGURATION, PlusConfiguration

CROPPED = TransformName("Image", "CroppedImage")
"""How Plus says that it cropped a recording: pixels of the whole image, which transforms of Image take, to those that it kept."""


@dataclass(frozen=True, eq=False)
class TrackedFrame:
    """What a reconstructor takes: one image and where it is."""

    image: Numbers | None  #: (rows, columns), or None when the frame has no image
    image_to_reference: Matrix | None  #: (4, 4), pixels to mm, or None without a pose
    timestamp: float = 0.0  #: s
    status: str = "OK"
    """OK, or why the frame cannot be used; such a frame is counted by the reconstructor and never inserted."""
    number: int = 0  #: Its number in the recording or stream, for messages

    def __post_init__(self) -> None:
        """Lists become arrays; a GeometryError where the pose is not 4 x 4."""
        if isinstance(self.image, list):
            object.__setattr__(self, "image", np.asarray(self.image))
        if self.image_to_reference is not None:
            object.__setattr__(self, "image_to_reference", np.asarray(self.image_to_reference))
            if self.image_to_reference.shape != (4, 4):
                raise GeometryError(f"Input image_to_reference must have shape (4, 4); got {self.image_to_reference.shape}.")

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
    """What a sequence says of one frame besides its pixels."""

    timestamp: float | None = None
    unfiltered_timestamp: float | None = None  #: Both in s
    image_status: TransformStatus = TransformStatus.OK  #: Not OK: the frame has no image
    transforms: dict[TransformName, TransformSample] = field(default_factory=dict)
    """As recorded. Matrices may hold NaN; `sweep_poses` judges them."""
    fields: dict[str, str] = field(default_factory=dict)
    """Every other field of the frame, by its name without the ``Seq_Frame0000_`` prefix."""
    stated_spacing: tuple[float, float] | None = None
    """(x, y), mm. Size of a pixel, where the file states one. The poses place pixels, as in Plus; this can only contradict them."""


@dataclass(frozen=True, eq=False, repr=False)
class TrackedSequence(Described):
    """A recorded sweep: images, and per frame its transforms, statuses and times."""

    images: ImageStack  #: (frames, rows, columns)
    records: Sequence[FrameRecord]  #: one per image
    fields: dict[str, str] = field(default_factory=dict)  #: Custom header fields that concern the whole file
    transforms: dict[TransformName, TransformSample] = field(default_factory=dict)
    """Transforms that hold for every frame (from the header, not from a configuration)."""
    configuration: PlusConfiguration = NO_CONFIGURATION
    """What was given with the recording; an empty one where nothing was (None is taken for that)."""
    path: Path | None = None  #: Where it was read from, for messages
    notes: tuple[str, ...] = ()  #: What a user should know about how it was read or changed, one sentence each
    reading: Mapping[str, object] = field(default_factory=dict)  #: Settings of `ReadingSettings` that it was read by already

    def __post_init__(self) -> None:
        if self.configuration is None:
            object.__setattr__(self, "configuration", NO_CONFIGURATION)
        if len(self.images) != len(self.records):
            raise ValueError(f"Input records must be one per image; got {len(self.records)} for {len(self.images)} images.")

    @classmethod
    def from_arrays(
        cls,
        images: ImageStack | ArrayLike,
        image_to_reference: ArrayLike,
        timestamps: ArrayLike | None = None,
        *,
        spacing: float | tuple[float, float] | None = None,
    ) -> TrackedSequence:
        """A sweep of images and where each is.

        Parameters
        ----------
        images : (frames, rows, columns) array_like of numbers
            Gray; whole numbers of 0 to 255 are 8-bit images, whatever their type. MF: the marked side of the probe at the last column (on
            the right), the transducer at row 0. Whatever has `shape`, `dtype` and an image for each number is read when an image is needed:
            an array that is mapped from a file, an HDF5 data set.
        image_to_reference : (frames, 4, 4) or (frames, 3, 4) array_like
            Pixel (column, row, 0, 1) to mm in Reference; with `spacing`, mm in the image plane to mm in Reference. A frame whose matrix
            is not finite has no pose: it is skipped and counted.
        timestamps : (frames,) array_like or None, s
            Frames enter in their order; without them in the order given.
        spacing : float or (x, y) or None, mm
            Size of a pixel, where the matrices are rotations and translations.

        Raises
        ------
        GeometryError
            When shapes or numbers do not fit, or nothing tells the size of a pixel.

        Examples
        --------
        >>> image_to_reference = np.tile(np.diag([0.3, 0.3, 0.3, 1.0]), (5, 1, 1))
        >>> image_to_reference[:, 2, 3] = np.arange(5)  # mm; five images behind each other
        >>> TrackedSequence.from_arrays(np.zeros((5, 40, 30), np.uint8), image_to_reference)
        <TrackedSequence: name sequence, frames 5, images 30 x 40 pixels, uint8, transforms ImageToReference>
        """
        stack = _as_images(images)
        count = len(stack)
        matrices = _as_numbers(image_to_reference, "image_to_reference", (count, 4, 4))
        turned = [n for n, one in enumerate(matrices) if why_not_affine(one) is not None and why_not_affine(one.T) is None]
        if turned:
            raise GeometryError(
                f"Input image_to_reference must have 0 0 0 1 as its last rows; those of frame {turned[0]} and {len(turned) - 1} more are "
                "transposed. Give image_to_reference.transpose(0, 2, 1)."
            )
        times = None if timestamps is None else _as_numbers(timestamps, "timestamps", (count,))
        if times is not None and not np.isfinite(times).all():
            raise GeometryError("Input timestamps must be finite seconds; got NaN or infinity. Leave them out for the order given.")
        matrices = _of_pixels(matrices, spacing)
        name = TransformName("Image", "Reference")
        return cls(
            stack,
            [
                FrameRecord(None if times is None else float(times[number]), transforms={name: TransformSample(matrix)})
                for number, matrix in enumerate(matrices)
            ],
        )

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
    def sweeps(self) -> tuple[TrackedSequence, ...]:
        """The sweeps that it is made of: itself, or those that were joined."""
        return (self,)

    def configured(self) -> dict[TransformName, TransformSample]:
        """The configuration's transforms but for those that are recorded, whichever way round.

        A frame that lacks a recorded transform is a frame without a pose: the configuration's must not stand in for it.
        """
        recorded = set(self.transform_names())
        return {name: sample for name, sample in self.configuration.transforms.items() if not recorded & {name, name.inverse}}

    def transform_names(self) -> list[TransformName]:
        """Every transform that occurs in any frame or in the header, in order of appearance."""
        return list(dict.fromkeys([*self.transforms, *self._summary[1]]))

    def status_counts(self, name: TransformName) -> Counter[TransformStatus]:
        """How many frames have this transform with which status; frames without it count as MISSING, unless the header has it."""
        counts = Counter(self._summary[1].get(name))
        otherwise = self.transforms[name].status if name in self.transforms else TransformStatus.MISSING
        return counts + Counter({otherwise: len(self) - counts.total()})

    @property
    def timestamps(self) -> Floats:
        """Time of each frame (frames,), s; NaN for a frame without one."""
        return self._summary[0]

    @cached_property
    def _summary(self) -> tuple[Floats, dict[TransformName, Counter[TransformStatus]]]:
        """Times, and the statuses of every transform in order of appearance: each record is asked for once."""
        timestamps = np.full(len(self), np.nan)
        statuses: dict[TransformName, Counter[TransformStatus]] = defaultdict(Counter)
        for number, record in enumerate(self.records):
            if record.timestamp is not None:
                timestamps[number] = record.timestamp
            for name, sample in record.transforms.items():
                statuses[name][sample.status] += 1
        return timestamps, statuses


def _as_images(images: ImageStack | ArrayLike) -> ImageStack:
    """Images as a stack, or an error that says what a stack is."""
    if isinstance(getattr(images, "dtype", None), np.dtype):
        stack = cast("ImageStack", images)
    else:
        try:
            stack = np.asarray(images)
        except (TypeError, ValueError):
            raise GeometryError("Input images must all have one size; got images of several. Cut or pad them to one.") from None
    if len(stack.shape) != 3 or np.dtype(stack.dtype).kind not in "iuf":
        raise GeometryError(
            f"Input images must be gray, (frames, rows, columns) of numbers; got {tuple(stack.shape)} of {np.dtype(stack.dtype)}. "
            "Masks become images by images.astype(np.uint8) * 255."
        )
    if isinstance(stack, np.ndarray) and stack.dtype.kind in "iu" and stack.dtype != np.uint8 and stack.size:
        # Lists, and what a computation has made of 8-bit images
        return stack.astype(np.uint8) if stack.min() >= 0 and stack.max() <= 255 else stack
    return stack


def _as_numbers(values: ArrayLike, name: str, shape: tuple[int, ...]) -> Floats:
    """A float64 copy of this shape, one row a frame."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise GeometryError(f"Input {name} must be numbers of shape {shape}; got {type(values).__name__}.") from None
    if array.shape == (*shape[:1], 3, 4) and shape[1:] == (4, 4):
        array = np.concatenate([array, np.broadcast_to((0.0, 0.0, 0.0, 1.0), (len(array), 1, 4))], axis=1)
    if array.shape != shape:
        raise GeometryError(f"Input {name} must have shape {shape}, one for each image; got {array.shape}.")
    return array


def _of_pixels(matrices: Matrix, spacing: float | tuple[float, float] | None) -> Matrix:
    """Matrices (frames, 4, 4) that take pixels, of matrices that may take mm."""
    scaled = [number for number, matrix in enumerate(matrices) if why_not_affine(matrix) is None and why_not_rigid(matrix) is not None]
    if spacing is None:
        if len(matrices) and not scaled and any(why_not_affine(matrix) is None for matrix in matrices):
            raise GeometryError(
                "Input image_to_reference must take pixels to mm; got rotations and translations, which hold no size of a pixel. "
                "Give spacing=(x, y) in mm."
            )
        return matrices
    size = np.asarray(spacing, dtype=np.float64)
    if size.shape not in ((), (2,)) or not (np.isfinite(size).all() and (size > 0).all()):
        raise GeometryError(f"Input spacing must be one or two (x, y) positive numbers in mm; got {spacing!r}.")
    if scaled:
        raise GeometryError(
            f"Input image_to_reference must be rotations and translations where spacing is given; the one of frame {scaled[0]} is "
            f"{why_not_rigid(matrices[scaled[0]])}. Leave out spacing if it takes pixels."
        )
    x, y = np.broadcast_to(size, 2)
    return matrices @ np.diag([x, y, (x + y) / 2, 1.0])

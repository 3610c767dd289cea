"""Changes to a recorded sequence that leave images in their place: other frames, a part of each image, other names, another calibration.

Each function returns a new sequence whose images are views of the old one's, read one at a time.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ..arrays import Matrix, Numbers
from ..errors import SettingsError, TransformError
from ..geometry.transform_graph import TransformName, TransformSample, TransformStatus, capital
from ..geometry.transforms import as_matrix, invert, with_unit_depth
from ..imaging.images import ImagesOnDemand, ImageStack
from ..remedies import CALIBRATION_FILE
from .frames import CROPPED, TrackedSequence

_ALL = slice(None)


class _ImageView(ImagesOnDemand):
    """Some frames, and of each some rows and columns, of another `ImageStack`."""

    def __init__(self, images: ImageStack, frames: slice = _ALL, rows: slice = _ALL, columns: slice = _ALL):
        numbers = (range(count)[part] for count, part in zip(images.shape, (frames, rows, columns)))
        self._images, self._part, self._numbers, *sides = images, (rows, columns), *numbers
        self.shape = (len(self._numbers), *map(len, sides))
        self.dtype = np.dtype(images.dtype)

    def _image(self, index: int) -> Numbers:
        return np.asarray(self._images[self._numbers[index]])[self._part]


def select_frames(sequence: TrackedSequence, first: int = 0, last: int | None = None, every: int = 1) -> TrackedSequence:
    """The frames from `first` to `last`, both included, every `every`-th; raises SettingsError when there are no such frames."""
    last = len(sequence) - 1 if last is None else last
    if not 0 <= first <= last < len(sequence):
        raise SettingsError(f"Input frames must be two numbers from 0 to {len(sequence) - 1}, rising; got {first} {last}.")
    if every < 1:
        raise SettingsError(f"Input every must be 1 or more; got {every}.")
    frames = slice(first, last + 1, every)
    return replace(sequence, images=_ImageView(sequence.images, frames), records=sequence.records[frames])


def crop(sequence: TrackedSequence, x: int, y: int, width: int, height: int, image_frame: str = "Image") -> TrackedSequence:
    """The rectangle of `width` x `height` pixels from column `x`, row `y`, in its old place: transforms of the image move along.

    Raises SettingsError when the rectangle is not within the images, or the sequence has no transform of the image to keep it in its
    place.
    """
    columns, rows = sequence.frame_size
    if width < 1 or height < 1 or x < 0 or y < 0 or x + width > columns or y + height > rows:
        raise SettingsError(f"Input crop must lie within the image of {columns} x {rows} pixels; got X {x}, Y {y}, W {width}, H {height}.")
    names = sequence.transform_names()
    was_cropped = bool({CROPPED, CROPPED.inverse} & set(names))
    if not any(image_frame in (name.source, name.target) for name in names):
        raise SettingsError(
            f"{sequence.name}: cropping moves the first pixel, so the calibration must move along, and the recording has none of "
            f"{image_frame}.",
            CALIBRATION_FILE,
        )
    moved = np.eye(4)
    moved[:2, 3] = x, y
    note = (
        f"Columns {x} to {x + width - 1} and rows {y} to {y + height - 1} were cut out. A configuration's clip rectangle, fan and "
        f"transducer center are about the whole image: subtract {x} and {y} from them."
    )
    sequence = _with_image_changed(sequence, CROPPED.target if image_frame == CROPPED.source and was_cropped else image_frame, moved)
    part = _ImageView(sequence.images, rows=slice(y, y + height), columns=slice(x, x + width))
    return replace(sequence, images=part, notes=(*sequence.notes, note))


def rename(sequence: TrackedSequence, names: Mapping[str, str]) -> TrackedSequence:
    """Transforms, or coordinate frames, under other names.

    Raises SettingsError when a name does not occur, is taken, or a transform would become a frame.

    Parameters
    ----------
    names : mapping of str to str
        Old to new: two transforms (``{"ProbeToTracker": "NeedleToTracker"}``) or two frames (``{"Marker": "Probe"}``).
    """
    for old, new in names.items():
        change = _renaming(sequence, old, new)
        before = sequence.transform_names()
        taken = [change(name) for name in before]
        # A pair of inverses that was recorded stays one
        pairs = [name for name, was in zip(taken, before, strict=True) if name.inverse in taken and was.inverse not in before]
        twice = next((name for name in taken if taken.count(name) > 1 or name in pairs), None)
        if twice is not None:
            raise SettingsError(
                f"Input rename {old}={new} must give names that are free; there would be two of {twice}. Choose another name."
            )
        sequence = _renamed(sequence, change)
    return sequence


def _renamed(sequence: TrackedSequence, change: Callable[[TransformName], TransformName]) -> TrackedSequence:
    return _map_transforms(sequence, lambda name, sample: (change(name), sample))


def recalibrate(sequence: TrackedSequence, name: TransformName, matrix: Matrix, wrong: Matrix | None = None) -> TrackedSequence:
    """The recording with another calibration.

    M = X C_wrong becomes X C = M inv(C_wrong) C for every transform M of the image. The calibration itself is written once, into the
    header.

    Raises SettingsError when recorded transforms include a calibration that is not known.

    Parameters
    ----------
    name : TransformName
        What the calibration is called, ImageToProbe.
    matrix : (4, 4) array, pixels to mm
    wrong : (4, 4) array or None
        The calibration that recorded transforms such as ImageToReference include; the recording's own transform of that name by default.
    """
    matrix = as_matrix(matrix, f"calibration {name}")
    apart = (name, name.inverse, CROPPED, CROPPED.inverse)
    others = [other for other in sequence.transform_names() if name.source in (other.source, other.target) and other not in apart]
    if wrong is None and others:
        wrong = _recorded(sequence, name)
        if wrong is None:
            raise SettingsError(
                f"{sequence.name}: its {others[0]} includes the calibration that it was recorded with, which is not in the file.",
                "Give that too, with {wrong_calibration:FILE}.",
            )
    was_recorded = {name, name.inverse} & set(sequence.transform_names())
    sequence = _map_transforms(sequence, lambda other, sample: None if other in (name, name.inverse) else (other, sample))
    if others and wrong is not None:
        sequence = _with_image_changed(sequence, name.source, invert(as_matrix(wrong, "wrong calibration")) @ matrix)
    if others and not was_recorded:
        return sequence  # a second way from the image to the tracker would contradict the first sooner or later
    return replace(sequence, transforms={**sequence.transforms, name: TransformSample(matrix)})


def mirrored(sequence: TrackedSequence) -> TrackedSequence:
    """The recording with its images turned left to right under the same poses: where the marked side was told wrongly."""
    return replace(sequence, images=_ImageView(sequence.images, columns=slice(None, None, -1)))


def inverted(sequence: TrackedSequence, name: TransformName) -> TrackedSequence:
    """The recording with the inverse of one transform under its name: where it was recorded the other way round.

    Raises SettingsError when the recording does not hold it.
    """
    if name not in sequence.transform_names():
        there = ", ".join(map(str, sequence.transform_names())) or "none"
        raise SettingsError(f"Input invert must name a transform of the recording; it has {there}, and no {name}.")
    return _map_transforms(sequence, lambda other, sample: (other, _turned_round(sample) if other == name else sample))


def _turned_round(sample: TransformSample) -> TransformSample:
    return replace(sample, matrix=invert(sample.matrix)) if _is_usable(sample) else sample


def _is_usable(sample: TransformSample) -> bool:
    """What is no pose is judged later, like any other."""
    is_finite = sample.status is TransformStatus.OK and np.isfinite(sample.matrix).all()
    return bool(is_finite and abs(np.linalg.det(sample.matrix)) > 0)


def corrected(sequence: TrackedSequence, correction: Matrix, image_frame: str = "Image") -> TrackedSequence:
    """The recording with a correction of its image plane: M becomes M @ `correction` for every transform M of the image.

    Whatever the third column of M was, it counts as a step of 1 mm out of the image.

    Raises SettingsError when the recording has no transform of the image.

    Parameters
    ----------
    correction : (4, 4) array
        Pixels (and mm out of the image) to the same, as `Calibration.image_correction` has it.
    """
    correction = as_matrix(correction, "correction")
    if not any(image_frame in (name.source, name.target) for name in sequence.transform_names()):
        raise SettingsError(f"{sequence.name}: it has no transform of {image_frame} to correct.", CALIBRATION_FILE)
    return _with_image_changed(sequence, image_frame, correction, of=with_unit_depth)


def with_configured_transforms(sequence: TrackedSequence) -> TrackedSequence:
    """The sequence with the transforms of its configuration in its header, those excepted that it holds already."""
    return replace(sequence, transforms={**sequence.transforms, **sequence.configured()})


def _with_image_changed(
    sequence: TrackedSequence, image_frame: str, new_to_old: Matrix, of: Callable[[Matrix], Matrix] = np.asarray
) -> TrackedSequence:
    """Every transform M of the image as of(M) @ `new_to_old`, which takes pixels of another definition, (4, 4)."""

    def changed(name: TransformName, sample: TransformSample) -> tuple[TransformName, TransformSample]:
        if image_frame == CROPPED.source and name in (CROPPED, CROPPED.inverse):
            return name, sample  # pixels alone
        with np.errstate(all="ignore"):  # a pose that is recorded as infinite is judged later, like any other
            if name.source == image_frame:
                sample = replace(sample, matrix=of(sample.matrix) @ new_to_old)
            elif name.target == image_frame and _is_usable(sample):
                sample = replace(sample, matrix=invert(of(invert(sample.matrix)) @ new_to_old))
        return name, sample

    return _map_transforms(sequence, changed)


def _map_transforms(
    sequence: TrackedSequence, change: Callable[[TransformName, TransformSample], tuple[TransformName, TransformSample] | None]
) -> TrackedSequence:
    """The sequence with `change` done to each transform of the header and of each frame; what becomes None is left out."""

    def changed(transforms: Mapping[TransformName, TransformSample]) -> dict[TransformName, TransformSample]:
        return dict(filter(None, (change(name, sample) for name, sample in transforms.items())))

    records = [replace(record, transforms=changed(record.transforms)) for record in sequence.records]
    return replace(sequence, records=records, transforms=changed(sequence.transforms))


def _renaming(sequence: TrackedSequence, old: str, new: str) -> Callable[[TransformName], TransformName]:
    known = sequence.transform_names()
    one, other = _parsed(old), _parsed(new)
    if one and other:
        if one not in known:
            there = ", ".join(map(str, known)) or "none"
            raise SettingsError(f"Input rename {old}={new} must name a transform of the recording; it has {there}.")
        return lambda name: other if name == one else name
    if one or other or not new:
        raise SettingsError(f"Input rename {old}={new} must be two transforms (AToB=CToD) or two frames (A=B).")
    old, new = capital(old), capital(new)
    frames = {frame for name in known for frame in (name.source, name.target)}
    if old not in frames:
        there = ", ".join(sorted(frames)) or "none"
        raise SettingsError(f"Input rename {old}={new} must name a frame of the recording; it has {there}.")
    return lambda name: TransformName(*(new if frame == old else frame for frame in (name.source, name.target)))


def _parsed(text: str) -> TransformName | None:
    try:
        return TransformName.parse(text)
    except TransformError:
        return None


def _recorded(sequence: TrackedSequence, name: TransformName) -> Matrix | None:
    """The one matrix that the recording holds under `name`; None where it has none, or more than one."""
    samples = [transforms[name] for transforms in (sequence.transforms, *(r.transforms for r in sequence.records)) if name in transforms]
    usable = [sample.matrix for sample in samples if sample.status is TransformStatus.OK]
    same = usable and all(np.array_equal(matrix, usable[0]) for matrix in usable)
    return usable[0] if same else None

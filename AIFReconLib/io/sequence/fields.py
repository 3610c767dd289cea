"""Fields of a sequence header as frame records, and back.

Per frame, ``Seq_Frame0012_`` and a name: Timestamp, UnfilteredTimestamp, ImageStatus (in NRRD: Status), ProbeToTrackerTransform
(16 numbers), ProbeToTrackerTransformStatus, and whatever a recorder adds. The number of digits is not fixed. Names of coordinate frames
begin with a capital: Plus reads ``probeToTracker`` as ``ProbeToTracker``, and so does this library.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import lru_cache
from typing import TypeVar

import numpy as np

from ...errors import SettingsError, TransformError
from ...geometry.transform_graph import TransformName, TransformSample, TransformStatus, capital
from ...message import listed, shorten
from ...sweep.frames import FrameRecord
from ..metafile.header import HeaderLines
from ..metafile.metafile import Metafile
from ..metafile.opening import NRRD_SUFFIXES
from ..metafile.text_values import NotANumberError, finite_numbers, format_number, parse_matrix, parse_numbers

FRAME_KEY = re.compile(r"Seq_Frame([0-9]{1,12})_(.+)", re.DOTALL)
_TIMES = ("Timestamp", "UnfilteredTimestamp")
IMAGE_STATUS, IMAGE_STATUS_IN_NRRD = "ImageStatus", "Status"
"""NRRD files may have either: older ones of this library have the first."""
MATRIX_SUFFIX = "Transform"
STATUS_SUFFIX = "TransformStatus"
_Name = TypeVar("_Name", str, TransformName)


def split_fields(
    metafile: Metafile, frames: int, spacing: tuple[float, float] | None = None
) -> tuple[list[FrameRecord], dict[str, str], dict[TransformName, TransformSample]]:
    """The records of all frames, and the header's own fields and transforms.

    Raises SequenceFormatError, which names the key when a number is none, a matrix has not 16 of them, or a frame does not exist.

    Parameters
    ----------
    metafile : Metafile
    frames : int
    spacing : (x, y) or None, mm
        Size of a pixel that the header states, for frames that state none.
    """
    per_frame, header = by_frame(metafile, metafile.fields.items(), frames)
    transforms, fields = samples_in(metafile, "", header, _transform_name)
    return [_record(metafile, number, per_frame.pop(number, {}), spacing) for number in range(frames)], fields, transforms


def by_frame(
    header_of: Metafile | HeaderLines, fields: Iterable[tuple[str, str]], frames: int
) -> tuple[dict[int, dict[str, str]], dict[str, str]]:
    """Fields of each frame, and the others."""
    per_frame: dict[int, dict[str, str]] = {}
    header: dict[str, str] = {}
    for key, value in fields:
        if (match := FRAME_KEY.fullmatch(key)) is None:
            header[key] = value
            continue
        number, name = frame_number(header_of, key, match[1], frames), match[2]
        if per_frame.setdefault(number, {}).setdefault(name, value) != value:
            raise header_of.failure(f"frame {number} has {name} twice, once as {shorten(key)}. Remove one of them from the header.")
    return per_frame, header


def frame_number(header_of: Metafile | HeaderLines, key: str, digits: str, frames: int) -> int:
    """The number of a frame that a key names, which must be there."""
    if int(digits) >= frames:
        there = f"there are only {frames} frames (0 to {frames - 1})"
        raise header_of.failure(f"{shorten(key)} belongs to frame {int(digits)}, but {there}. Correct the size in the header.")
    return int(digits)


def frame_entries(records: Iterable[FrameRecord], image_status: str = IMAGE_STATUS) -> Iterator[tuple[str, str]]:
    """Header keys and values of all frames, frame by frame; `image_status` is what the format calls the image's status.

    Raises SettingsError when a custom field has the name of another one.
    """
    for number, record in enumerate(records):
        prefix = f"Seq_Frame{number:04d}_"
        for name, value in _transform_entries(record.transforms):
            yield prefix + name, value
        for name, time in zip(_TIMES, (record.timestamp, record.unfiltered_timestamp)):
            if not math.isfinite(time or 0.0):
                raise SettingsError(f"Input {name} of frame {number} must be a finite number; got {time!r}.")
            if time is not None:
                yield prefix + name, format_number(time)
        yield prefix + image_status, record.image_status.value
        for name, value in record.fields.items():
            if name == image_status != IMAGE_STATUS:
                name = name.lower()  # somebody's own, which must not become the image's; Plus tells the two apart as well
            if not name or name in (*_TIMES, IMAGE_STATUS) or _transform_name(name) is not None:
                must = "must have a name, and not that of a time, status or transform"
                raise SettingsError(f"Input field {name!r} of frame {number} {must}. Set those in the record.")
            yield prefix + name, value


def header_entries(fields: Mapping[str, str], transforms: Mapping[TransformName, TransformSample]) -> Iterator[tuple[str, str]]:
    """Header keys and values that hold for the whole sequence.

    Raises SettingsError when a custom field would be read back as something else.
    """
    yield from _transform_entries(transforms)
    for name, value in fields.items():
        if FRAME_KEY.fullmatch(name) or _transform_name(name) is not None:
            raise SettingsError(f"Input header field {name!r} must not have the name of a transform or of a frame's field.")
        yield name, value


def stated_spacing(text: str | None, unit: float = 1.0) -> tuple[float, float] | None:
    """Size of a pixel in mm that a header gives, in `unit` mm; None where it gives none: 1 x 1 is what Plus writes for all."""
    try:
        x, y = (unit * length for length in parse_numbers(text or "")[:2])
    except ValueError:
        return None
    return (x, y) if min(x, y) > 0 and max(x, y) < math.inf and (x, y) != (1, 1) else None


def _record(metafile: Metafile, number: int, fields: dict[str, str], spacing: tuple[float, float] | None) -> FrameRecord:
    """One frame's fields, with those of known meaning parsed."""
    transforms, others = samples_in(metafile, f"frame {number}, ", fields, _transform_name)
    times = [parsed_time(metafile, number, name, others.pop(name, None)) for name in _TIMES]
    statuses = [IMAGE_STATUS, IMAGE_STATUS_IN_NRRD] if metafile.path.suffix.lower() in NRRD_SUFFIXES else [IMAGE_STATUS]
    given = {TransformStatus.parse(others.pop(name)) for name in statuses if name in others} or {TransformStatus.OK}
    if len(given) > 1:
        raise metafile.failure(f"frame {number} has {listed(statuses, ' and ')}, two names of one thing, which differ. Remove one of them.")
    microns = others.get("micronsPerPixel", "")
    spacing = stated_spacing(others.get("ElementSpacing")) or stated_spacing(f"{microns} {microns}", 1e-3) or spacing
    return FrameRecord(times[0], times[1], given.pop(), transforms, others, spacing)


def samples_in(
    header_of: Metafile | HeaderLines, where: str, fields: Mapping[str, str], name_of: Callable[[str], _Name | None]
) -> tuple[dict[_Name, TransformSample], dict[str, str]]:
    """The transforms among fields, by the names in their keys, and the rest. A status alone makes a transform that is NaN.

    Numbers may be NaN: recorders write it for poses that they do not have. `where` is the frame in words.
    """
    given: dict[tuple[_Name, bool], str] = {}
    others: dict[str, str] = {}
    for key, value in fields.items():
        name = name_of(key)
        if name is None:
            others[key] = value
        elif (twin := given.setdefault((name, key.endswith(STATUS_SUFFIX)), key)) is not key:
            raise header_of.failure(f"{where}{name} is given twice, as {twin} and as {key}. Remove one of them from the header.")
    samples = {}
    for name in dict.fromkeys(name for name, _ in given):
        status, matrix_key = given.get((name, True)), given.get((name, False))
        try:
            matrix = np.full((4, 4), np.nan) if matrix_key is None else parse_matrix(fields[matrix_key])
        except NotANumberError as error:
            must = f"{where}{matrix_key} must be 16 numbers; {error}"
            raise header_of.failure(f"{must}. Correct the header, or set its status to INVALID.") from error
        samples[name] = TransformSample(matrix, TransformStatus.OK if status is None else TransformStatus.parse(fields[status]))
    return samples, others


@lru_cache(maxsize=256)  # the same few in every frame
def _transform_name(key: str) -> TransformName | None:
    """The transform whose matrix or status `key` holds; None for any other field."""
    for suffix in (STATUS_SUFFIX, MATRIX_SUFFIX):
        if key.endswith(suffix) and key != suffix:
            try:
                name = TransformName.parse(key.removesuffix(suffix))
            except TransformError:
                return None
            # "TransformToTransform" would lose a word on the way.
            return name if f"{name}{suffix}" == capital(key) else None
    return None


def parsed_time(metafile: Metafile | HeaderLines, number: int, name: str, text: str | None) -> float | None:
    """A finite number of seconds; None where there is none."""
    try:
        return None if text is None else float(finite_numbers(text, 1)[0])
    except NotANumberError as error:
        raise metafile.failure(f"frame {number}, {name} must be a number of seconds; {error}. Correct the header.") from error


def _transform_entries(transforms: Mapping[TransformName, TransformSample]) -> Iterator[tuple[str, str]]:
    """Matrix and status of each transform. Without any number and not OK, the status alone, as it may have been read."""
    for name, sample in transforms.items():
        if _transform_name(f"{name}{MATRIX_SUFFIX}") != name:
            raise SettingsError(f"Input transform {name} must be named FromToTo, with one 'To' before an upper-case letter or a digit.")
        if sample.status is TransformStatus.OK or not np.isnan(sample.matrix).all():
            numbers = np.asarray(sample.matrix, dtype=np.float64)
            if numbers.shape != (4, 4):
                raise SettingsError(f"Input transform {name} must have shape (4, 4); got {numbers.shape}.")
            yield f"{name}{MATRIX_SUFFIX}", " ".join(format_number(number) for number in numbers.ravel())
        yield f"{name}{STATUS_SUFFIX}", sample.status.value

"""What Slicer writes into its own sequence files (.seq.nrrd): times, attributes of frames, and the place of the volume node.

``axis 3 index values`` lists one value per frame (URL-encoded, separated by blanks), which is a time where the axis has the unit of one;
``axis 3 item 0025 NAME`` is an attribute of one frame. Before 2022 the sequence was the first axis, so these keys began with ``axis 0``
and the frames lie interleaved in the file. Frames of a volume sequence share one IJKToRAS, which the header holds in LPS.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from urllib.parse import unquote

import numpy as np

from ...arrays import Matrix
from ...errors import GeometryError
from ...geometry.transform_graph import TransformName, TransformSample
from ...geometry.transforms import LPS_FROM_RAS, as_matrix
from ...message import shorten
from ...sweep.frames import FrameRecord
from ..metafile.metafile import Metafile
from ..metafile.text_values import NotANumberError, finite_numbers, parse_numbers
from .fields import frame_number

_AXIS_KEY = re.compile(r"axis ([03]) index (type|values)")
_ITEM_KEY = re.compile(r"axis [03] item ([0-9]{1,12}) (.+)", re.DOTALL)
_SECONDS = {"s": 1.0, "sec": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6}
_TIME_KINDS = ("list", "time")
_LPS, _RAS = ("left-posterior-superior", "lps"), ("right-anterior-superior", "ras")
_IDENTITY_TOLERANCE = 1e-6

CLOSEST_INDEX = 0.002
"""s. Times closer than this cannot number frames: Slicer's files keep times to 1 ms, and it takes values within 1 ms for equal."""


def is_slicer_sequence(metafile: Metafile) -> bool:
    """Whether Slicer's Sequences module wrote the file."""
    return any(_AXIS_KEY.fullmatch(key) for key in metafile.fields)


def slicer_records(
    metafile: Metafile, records: Sequence[FrameRecord], fields: dict[str, str]
) -> tuple[list[FrameRecord], dict[str, str], tuple[str, ...]]:
    """Records with Slicer's times and attributes of frames, the fields that are left, and what a user should know.

    Raises SequenceFormatError when there is not one index value per frame, or an attribute belongs to a frame that does not exist.

    Parameters
    ----------
    metafile : Metafile
    records : list of FrameRecord
        As `split_fields` returns them, without times.
    fields : dict of str to str
        The header's own fields.
    """
    others: dict[str, str] = {}
    per_frame: list[dict[str, str]] = [{} for _ in records]
    times: list[float] | None = None
    notes: tuple[str, ...] = ()
    for key, value in fields.items():
        axis = _AXIS_KEY.fullmatch(key)
        if item := _ITEM_KEY.fullmatch(key):
            per_frame[frame_number(metafile, key, item[1], len(records))][item[2]] = value
        elif axis is None:
            others[key] = value
        elif axis[2] == "values":
            times, notes = _times(metafile, key, value, len(records))
    moments = [each.timestamp if times is None or each.timestamp is not None else times[n] for n, each in enumerate(records)]
    own = [{**record.fields, **of_frame} for record, of_frame in zip(records, per_frame)]
    return [replace(record, timestamp=moment, fields=each) for record, moment, each in zip(records, moments, own)], others, notes


def node_geometry(metafile: Metafile) -> Matrix | None:
    """IJKToRAS that the volume node of every frame has, (4, 4), pixels to the node's own RAS in mm; None for the identity.

    Raises SequenceFormatError when the header's place in space cannot be understood.
    """
    directions = metafile.entries.get("space directions")
    if directions is None:
        return None
    space = metafile.entries.get("space", "").lower()
    to_ras = LPS_FROM_RAS if space in _LPS else np.eye(4) if space in _RAS else None
    vectors = [word for word in re.findall(r"none|\([^)]*\)", directions) if word != "none"]
    if to_ras is None or len(vectors) != 3:
        must = "space directions must be three vectors in left-posterior-superior"
        raise metafile.failure(f"{must}; got {shorten(directions)!r} in space {space!r}. Save the sequence from Slicer again.")
    matrix = np.eye(4)
    try:
        for column, text in enumerate([*vectors, metafile.entries.get("space origin", "(0,0,0)")]):
            matrix[:3, column] = parse_numbers(text.strip("() ").replace(",", " "))
        matrix = to_ras @ as_matrix(matrix, "space directions")
    except (ValueError, GeometryError) as error:
        raise metafile.failure(f"space directions or space origin cannot be used: {error}. Save the sequence from Slicer again.") from error
    return None if np.abs(matrix - np.eye(4)).max() < _IDENTITY_TOLERANCE else matrix


def place_frames(records: Sequence[FrameRecord], image_frame: str, pixel_to_node: Matrix) -> list[FrameRecord]:
    """Records whose transforms from the image frame take pixels, where they took the RAS coordinates of Slicer's volume node.

    `pixel_to_node` is its `node_geometry`.
    """

    def placed(name: TransformName, sample: TransformSample) -> TransformSample:
        before = np.linalg.inv(pixel_to_node) if name.target == image_frame else np.eye(4)
        behind = pixel_to_node if name.source == image_frame else np.eye(4)
        with np.errstate(all="ignore"):  # a pose that is recorded as infinite is judged later, like any other
            return replace(sample, matrix=before @ sample.matrix @ behind) if image_frame in (name.source, name.target) else sample

    return [replace(record, transforms={name: placed(name, sample) for name, sample in record.transforms.items()}) for record in records]


def is_interleaved(metafile: Metafile) -> bool:
    """Whether the frames are the fastest axis of the file, as Slicer wrote it before 2022."""
    in_time = [kind in _TIME_KINDS for kind in metafile.kinds]
    return is_slicer_sequence(metafile) and in_time[:1] == [True] and not any(in_time[1:])


def index_seconds(unit: str, label: str) -> float | None:
    """How many seconds 1 is in an index of this unit and name, in lower case; None where it is no time."""
    return _SECONDS.get(unit, 1.0 if not unit and label == "time" else None)


def index_values(records: Sequence[FrameRecord]) -> tuple[list[str], str]:
    """What numbers the items of a sequence, and its unit: times in s where they can tell frames apart, else frame numbers."""
    times = [record.timestamp for record in records]
    rounded = [f"{time:.3f}" for time in times if time is not None and math.isfinite(time)]
    gaps = np.diff([float(text) for text in rounded])
    if len(rounded) == len(times) and (not gaps.size or gaps.min() > CLOSEST_INDEX - 1e-9):
        return rounded, "s"
    return [str(number) for number in range(len(records))], ""


def _times(metafile: Metafile, key: str, text: str, frames: int) -> tuple[list[float] | None, tuple[str, ...]]:
    """Times in s of all frames, where the axis is one of time."""
    words = [unquote(word) for word in text.split()]
    if len(words) != frames:
        raise metafile.failure(f"{key} must have one value per frame ({frames}); got {len(words)}. Save the sequence from Slicer again.")
    axis = int(key.split()[1])
    unit, label = (_axis_word(metafile, entry, axis).lower() for entry in ("units", "labels"))
    seconds = index_seconds(unit, label)
    if seconds is None:
        named = unit or label or "no unit"
        note = f"Slicer's index of the frames is not a time ({named}); frames are taken in the order of the file."
        return None, (note,)
    try:
        return [seconds * time for time in finite_numbers(" ".join(words), frames).tolist()], ()
    except NotANumberError as error:
        raise metafile.failure(f"{key} must be times; {error}. Save the sequence from Slicer again.") from error


def _axis_word(metafile: Metafile, entry: str, axis: int) -> str:
    """Label or unit of the sequence's axis; the header has one quoted word per axis, channels included."""
    words = re.findall(r'"((?:[^"\\]|\\.)*)"', metafile.entries.get(entry, ""))
    return words[-1 if axis == 3 else -len(metafile.size)] if len(words) >= len(metafile.size) else ""

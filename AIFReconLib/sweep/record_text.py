"""A sweep's record as one text: what a program keeps of a sweep beside images and poses, where its own files would round or drop it.

Slicer writes transform sequences with 6 digits and without the attributes of their items, so that the poses would move by some
micrometers and frames without tracking would look like good ones once the scene is saved and loaded. It has no place for the Plus
configuration either. The text is JSON; a class of the library is an object whose "@" names it.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Matrix
from ..errors import GeometryError
from ..geometry.transform_graph import TransformName, TransformSample, TransformStatus
from ..geometry.transforms import as_matrix
from ..holes.filling import HoleFilling
from ..imaging.beams import ProbeGeometry
from ..imaging.region import ClipRectangle, Fan, FanDetection, ImageRegion
from ..progress import Progress, report
from .configuration import NO_CONFIGURATION, PlusConfiguration
from .frames import TrackedSequence
from .poses import SweepPoses, status_of_problem

_HELD = (ClipRectangle, Fan, FanDetection, HoleFilling, ImageRegion, PlusConfiguration, ProbeGeometry, TransformName, TransformSample)
_CLASSES: dict[str, Any] = {made.__name__: made for made in _HELD}
"""What a record may hold, by name."""

REPORTED_EVERY = 50
"""Frames between two reports of progress."""


def record_of(
    sequence: TrackedSequence, poses: SweepPoses | None, pose_name: TransformName, index: Sequence[str], progress: Progress | None = None
) -> dict[str, object]:
    """What is to be kept of a sweep whose poses, None where no chain tells them, are called `pose_name`: frames by their `index`."""
    names = [name for name in sequence.transform_names() if name not in sequence.transforms]
    missing = TransformSample(np.full((4, 4), np.nan), TransformStatus.MISSING)
    frames: dict[str, object] = {}
    for number, record in enumerate(sequence.records):
        if number % REPORTED_EVERY == 0:
            report(progress, number / len(sequence), "Adding transforms")
        frame: dict[str, object] = {"time": record.timestamp}
        if record.unfiltered_timestamp is not None:
            frame["unfiltered"] = record.unfiltered_timestamp
        if record.image_status is not TransformStatus.OK:
            frame["image"] = record.image_status.value
        if record.fields:
            frame["fields"] = dict(record.fields)
        statuses = {str(name): usable_sample(record.transforms.get(name, missing))[1].value for name in names}
        statuses = {name: status for name, status in statuses.items() if status != TransformStatus.OK.value}
        if poses is not None:
            if poses.problems[number] is None:
                frame["pose"] = poses.image_to_reference[number]
            else:
                frame["problem"] = poses.problems[number]
                statuses[str(pose_name)] = status_of_problem(poses.problems[number]).value
        if statuses:
            frame["statuses"] = statuses
        frames[index[number]] = frame
    return {
        "version": 1,
        "name": sequence.name,
        "poseName": str(pose_name) if poses is not None else None,
        "fields": dict(sequence.fields),
        "notes": tuple(sequence.notes if poses is None else poses.notes),
        "transforms": dict(sequence.transforms),
        "configuration": None if sequence.configuration is NO_CONFIGURATION else sequence.configuration,
        "frames": frames,
    }


def usable_sample(sample: TransformSample) -> tuple[Matrix, TransformStatus]:
    """Matrix and status as a program can hold them: INVALID and the identity for what is no invertible affine matrix."""
    try:
        return as_matrix(sample.matrix), sample.status
    except GeometryError:
        status = TransformStatus.INVALID if sample.status is TransformStatus.OK else sample.status
        return np.eye(4), status


def record_text(record: Mapping[Any, Any]) -> str:
    """What is kept of a record, of the types that `record_from` gives; TypeError for another."""
    return json.dumps(_encoded(record), separators=(",", ":"))


def record_from(text: str | None) -> dict[Any, Any]:
    """The record that is kept in a text; an empty dict where there is none, or it is damaged. Lists come back as tuples."""
    try:
        record = _decoded(json.loads(text)) if text else {}
    except (ValueError, TypeError, KeyError):
        return {}
    return record if isinstance(record, dict) else {}


def _encoded(value: Any) -> Any:
    """A value of the library as what JSON can hold; all numbers to the last digit, NaN included."""
    if isinstance(value, Mapping):
        return {"@": "dict", "items": [[_encoded(key), _encoded(item)] for key, item in value.items()]}
    if isinstance(value, np.ndarray):
        return {"@": "array", "shape": list(value.shape), "values": [float(number) for number in value.ravel()]}
    if isinstance(value, TransformStatus):
        return {"@": "TransformStatus", "word": value.value}
    if isinstance(value, Path):
        # The folder is nobody's business in a scene that is handed on
        return {"@": "Path", "name": value.name}
    if isinstance(value, list | tuple):
        return [_encoded(item) for item in value]
    if isinstance(value, np.generic):
        return value.item()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        if type(value) not in _HELD:
            raise TypeError(f"a record of a sweep cannot hold {type(value).__name__}: reading it would lose all of the record")
        # Not `fields` of the class: a field that is not known here is simply kept by its name
        items = {field.name: _encoded(getattr(value, field.name)) for field in dataclasses.fields(value)}
        return {"@": type(value).__name__, **items}
    return value


def _decoded(value: Any) -> Any:
    """The value that was encoded; fields that a class does not have any more are left out."""
    if isinstance(value, list):
        return tuple(_decoded(item) for item in value)
    if not isinstance(value, dict):
        return value
    kind = value["@"]
    if kind == "dict":
        return {_decoded(key): _decoded(item) for key, item in value["items"]}
    if kind == "array":
        return np.array(value["values"], dtype=np.float64).reshape(value["shape"])
    if kind == "TransformStatus":
        return TransformStatus.parse(value["word"])
    if kind == "Path":
        return Path(value["name"])
    made = _CLASSES[kind]
    names = {field.name for field in dataclasses.fields(made)}
    return made(**{name: _decoded(item) for name, item in value.items() if name in names})

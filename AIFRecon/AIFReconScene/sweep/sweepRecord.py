"""What MRML files would round or drop of a sweep, as one text that is kept as an attribute of the sequence browser.

Slicer writes transform sequences with 6 digits and without the attributes of their items, so that the poses would move by some
micrometers and frames without tracking would look like good ones once the scene is saved and loaded. It has no place for the Plus
configuration either. The text is JSON; a class of the library is an object whose "@" names it.
"""

import dataclasses
import json
import re
from pathlib import Path

import numpy as np

from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.holes.filling import HoleFilling
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, Fan, FanDetection, ImageRegion
from AIFReconLib.sweep.configuration import PlusConfiguration

ATTRIBUTE = "AIFRecon.Sweep"
"""Of the sequence browser node."""

_HELD = (ClipRectangle, Fan, FanDetection, HoleFilling, ImageRegion, PlusConfiguration, ProbeGeometry, TransformName, TransformSample)
CLASSES = {made.__name__: made for made in _HELD}
"""What a record may hold, by name."""


def recordText(record: dict) -> str:
    """What is kept of `record`, of the types that `decode` gives, in the attribute of a browser node."""
    return json.dumps(encode(record), separators=(",", ":"))


def readRecord(browserNode) -> dict:
    """The record that is kept; an empty dict for a browser node that somebody else made, or whose record is damaged."""
    text = browserNode.GetAttribute(ATTRIBUTE)
    try:
        record = decode(json.loads(text)) if text else {}
    except (ValueError, TypeError, KeyError):
        return {}
    return record if isinstance(record, dict) else {}


def encode(value):
    """A value of the library as what JSON can hold; all numbers to the last digit, NaN included."""
    if isinstance(value, dict):
        return {"@": "dict", "items": [[encode(key), encode(item)] for key, item in value.items()]}
    if isinstance(value, np.ndarray):
        return {"@": "array", "shape": list(value.shape), "values": [float(number) for number in value.ravel()]}
    if isinstance(value, TransformName):
        return {"@": "TransformName", "source": value.source, "target": value.target}
    if isinstance(value, TransformStatus):
        return {"@": "TransformStatus", "word": value.value}
    if isinstance(value, Path):
        # The folder is nobody's business in a scene that is handed on
        return {"@": "Path", "name": value.name}
    if isinstance(value, list | tuple):
        return [encode(item) for item in value]
    if isinstance(value, np.generic):
        return value.item()
    if dataclasses.is_dataclass(value):
        if type(value) not in _HELD:
            raise TypeError(f"a record of a sweep cannot hold {type(value).__name__}: reading it would lose all of the record")
        # Not `fields` of the class: a field that is not known here is simply kept by its name
        items = {field.name: encode(getattr(value, field.name)) for field in dataclasses.fields(value)}
        return {"@": type(value).__name__, **items}
    return value


def decode(value):
    """The value that `encode` was given; lists come back as tuples, and fields that a class does not have any more are left out."""
    if isinstance(value, list):
        return tuple(decode(item) for item in value)
    if not isinstance(value, dict):
        return value
    kind = value["@"]
    if kind == "dict":
        return {decode(key): decode(item) for key, item in value["items"]}
    if kind == "array":
        return np.array(value["values"], dtype=np.float64).reshape(value["shape"])
    if kind == "TransformStatus":
        return TransformStatus.parse(value["word"])
    if kind == "Path":
        return Path(value["name"])
    if kind == "Message":
        # As sentences were kept before they were plain text
        return re.sub(r"\{(\w+)[^}]*\}", lambda found: str(decode(value["values"].get(found[1], found[0]))), value["template"])
    made = CLASSES[kind]
    names = {field.name for field in dataclasses.fields(made)}
    return made(**{name: decode(item) for name, item in value.items() if name in names})

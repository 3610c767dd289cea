"""Poses in JSON as a table: a list of matrices, or of objects whose keys are the headings."""

from __future__ import annotations

import json
from collections.abc import Iterator

from ....errors import FileFormatError
from ....message import listed, one_line, shorten
from .headings import IMAGE, MATRIX, STATUS, TOOL, TURN, column_of
from .sheet import Sheet

_BETWEEN = "\x1f"
"""The unit separator of ASCII, which no text holds."""

_LISTS = ("frames", "poses", "transforms", "data")
_PARTS = {
    "matrix": "matrix transform pose",
    "translation": "translation position origin",
    "quaternion": "quaternion orientation rotation q quat",
    "euler": "euler angles eulerangles",
}
_PART_OF = {spelling: name for name, spellings in _PARTS.items() for spelling in spellings.split()}
_FIELDS: dict[str, dict[int, tuple[str, ...]]] = {
    "matrix": {16: MATRIX, 12: MATRIX[:12]},
    "translation": {3: ("x", "y", "z")},
    "quaternion": {4: ("q0", "q1", "q2", "q3"), 9: TURN},
    "euler": {3: ("e0", "e1", "e2")},
}


def sheet_of_json(text: str) -> Sheet:
    """The table that a JSON file holds."""
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise FileFormatError(f"this is not JSON ({one_line(str(error))}). Export it again.") from None
    if isinstance(document, dict):
        key = next((key for key in _LISTS if isinstance(document.get(key), list)), None)
        if key is None:
            raise FileFormatError(f"it must hold a list of poses, or an object with one under {', '.join(_LISTS)}.")
        document = document[key]
    if not isinstance(document, list):
        raise FileFormatError(f"it must hold a list of poses; got {type(document).__name__}. Export it again.")
    places = [f"pose {number}" for number in range(len(document))]
    rows = [dict(_cells(place, item if isinstance(item, dict) else {"matrix": item})) for place, item in zip(places, document)]
    headings = list(rows[0]) if rows else []
    for place, row in zip(places, rows):
        if set(row) != set(headings):
            raise FileFormatError(f"{place} must hold {', '.join(headings)} as the first; got {', '.join(row)}. Export it again.")
    lines = [_BETWEEN.join(row[name].replace(_BETWEEN, " ").replace("\n", " ") for name in headings) for row in rows]
    return Sheet(lines, list(range(len(rows))), _BETWEEN, headings, item="pose")


def _cells(place: str, item: dict[str, object], above: str = "") -> Iterator[tuple[str, str]]:
    """Headings and cells of an object, those of the objects in it below its key."""
    for key, value in item.items():
        heading, at = f"{above} {key}".strip(), listed([place, key])
        part = _PART_OF.get("".join(filter(str.isalnum, key.lower())))
        role = column_of(heading).role
        if isinstance(value, dict):
            yield from _cells(at, value, heading)
        elif part is not None and not isinstance(value, str):
            yield from _numbers(at, part, value, above)
        elif role in (IMAGE, STATUS, TOOL) or isinstance(value, str) or (role is None and isinstance(value, bool)):
            yield heading, str(value)
        elif role is not None or value is None or isinstance(value, int | float):
            yield heading, _number(at, value)
        else:
            yield heading, ""


def _numbers(place: str, part: str, value: object, above: str) -> Iterator[tuple[str, str]]:
    """The fields of a list of numbers, or of lists of them."""
    numbers = [number for line in value for number in (line if isinstance(line, list) else [line])] if isinstance(value, list) else [value]
    fields = _FIELDS[part].get(len(numbers))
    if fields is None:
        raise FileFormatError(f"{place} must be {listed(_FIELDS[part], ' or ')} numbers; got {len(numbers)}. Export it again.")
    for name, number in zip(fields, numbers):
        yield f"{above} {name}".strip(), _number(place, number)


def _number(place: str, value: object) -> str:
    if value is None:
        return "nan"
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise FileFormatError(f"{place} must be a number; got {shorten(repr(value))}. Export it again.")
    try:
        return repr(float(value))
    except OverflowError:  # JSON's whole numbers have no limit
        return "inf" if value > 0 else "-inf"

"""Poses in JSON as a table: a list of matrices, or of objects whose keys are the headings."""

from __future__ import annotations

import json
from typing import Any

from ....errors import FileFormatError
from ....message import one_line
from .sheet import Sheet

_LISTS = ("frames", "poses", "transforms", "data")


def sheet_of_json(text: str) -> Sheet:
    """The table that a JSON file holds; numbers of a list are counted, and those of lists in a list by row and column."""
    try:
        document = json.loads(text)
        if isinstance(document, dict):
            document = next((document[key] for key in _LISTS if isinstance(document.get(key), list)), document)
        items = document if isinstance(document, list) else []
        rows = [_flat("", item if isinstance(item, dict) else {"matrix": item}) for item in items]
    except (ValueError, RecursionError) as error:
        raise FileFormatError(f"this is not JSON ({one_line(str(error))}). Export it again.") from None
    if not isinstance(document, list):
        kinds = f"a list of poses, or an object with one under {', '.join(_LISTS)}"
        raise FileFormatError(f"it must hold {kinds}; got {type(document).__name__}. Export it again.")
    headings = list(dict.fromkeys(heading for row in rows for heading in row))
    lines = ["\t".join(row.get(heading, "") for heading in headings) for row in rows]
    return Sheet(lines, range(len(rows)), "\t", headings, item="pose")


def _flat(heading: str, value: Any) -> dict[str, str]:
    """The cells below a key, by their headings."""
    if isinstance(value, dict):
        return {name: cell for key, each in value.items() for name, cell in _flat(f"{heading} {key}".strip(), each).items()}
    if isinstance(value, list):
        mark = "" if heading[-1:].isdecimal() else " "
        return {name: cell for number, each in enumerate(value) for name, cell in _flat(f"{heading}{mark}{number}", each).items()}
    return {one_line(heading): "" if value is None else one_line(str(value))}

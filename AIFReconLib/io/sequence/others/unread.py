"""Recordings and images of other programs that are known by their names and not read: what each is, and the way that there is."""

from __future__ import annotations

import json
from pathlib import Path

from ....errors import SequenceFormatError

UNREAD: list[tuple[list[str], str, str]] = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))
"""Suffixes, what they are, and what to do."""


def refuse_unread(path: Path) -> None:
    """Return if a file has none of these names.

    Raises SequenceFormatError otherwise.
    """
    for suffixes, what, way in UNREAD:
        if path.suffix.lower() in suffixes:
            raise SequenceFormatError(f"{path}: this is {what}, which is not read as it is. {way}.")

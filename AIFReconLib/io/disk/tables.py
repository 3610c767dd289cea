"""Names and values in JSON or TOML, each name once."""

from __future__ import annotations

import json
from collections import Counter
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from ...errors import FileFormatError
from ...message import shorten
from .small_files import read_bytes

JSON, TOML = ".json", ".toml"


def read_table(path: Path, error: type[FileFormatError], advice: str = "Give another file.") -> object:
    """What a file of JSON holds, or by its suffix one of TOML.

    Raises FileFormatError, the given one, when it cannot be read, is damaged or nested too deeply, or gives a name twice.
    """
    suffix = TOML if path.suffix.lower() == TOML else JSON
    try:
        text = read_bytes(path, None, error).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise error(f"{path}: it is not text in UTF-8. {advice}") from None
    return parse_table(path, text, suffix, error, advice)


def parse_table(path: Path, text: str, suffix: str, error: type[FileFormatError], advice: str) -> object:
    """The same of a text that stands in the file at `path`."""
    if suffix == TOML and find_spec("tomllib") is None:
        raise error(f"{path}: this Python reads no TOML; that of 3.11 or later does. Give it as .json.")
    try:
        table: object = import_module("tomllib").loads(text) if suffix == TOML else json.loads(text, object_pairs_hook=_without_twins)
    except (ValueError, RecursionError) as cause:
        reason = "it is nested too deeply" if isinstance(cause, RecursionError) else shorten(str(cause), 200)
        raise error(f"{path}: it cannot be read as {suffix[1:].upper()} ({reason}). {advice}") from None
    return table


def _without_twins(pairs: list[tuple[str, object]]) -> dict[str, object]:
    table = dict(pairs)
    if len(table) < len(pairs):
        counts = Counter(name for name, _ in pairs)
        raise ValueError(f"{counts.most_common(1)[0][0]!r} is there twice")
    return table

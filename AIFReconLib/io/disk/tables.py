"""Names and values in text, JSON or TOML, each name once."""

from __future__ import annotations

import json
from collections import Counter
from importlib import import_module
from importlib.util import find_spec

JSON, TOML = ".json", ".toml"

MOST_TOML_BYTES = 2**14
"""Python's reader takes time that grows with the square of a name's parts."""


def reads_toml() -> bool:
    """Whether this Python does: 3.10 does not."""
    return find_spec("tomllib") is not None


def parse_table(text: str, suffix: str) -> object:
    """What a text holds that is JSON or TOML, by its suffix.

    Raises ValueError or RecursionError when it is damaged, nested too deeply, or gives a name twice.
    """
    if suffix == TOML:
        table: object = import_module("tomllib").loads(text)
        return table
    return json.loads(text, object_pairs_hook=_without_twins)


def _without_twins(pairs: list[tuple[str, object]]) -> dict[str, object]:
    table = dict(pairs)
    if len(table) < len(pairs):
        counts = Counter(name for name, _ in pairs)
        raise ValueError(f"{counts.most_common(1)[0][0]!r} is there twice")
    return table

"""What a setting may be, and what every door says of it: the metadata of its field."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Mapping
from dataclasses import field
from numbers import Integral, Real
from pathlib import Path
from typing import Any, NamedTuple, TypedDict, cast

import numpy as np

from ..compounding.methods.method import CompoundingMethod
from ..compounding.methods.table import OWN_METHOD, is_own_method
from ..errors import SettingsError
from ..message import shorten

LARGEST = 1e300
"""Of a number; larger ones are not finite, or will not be."""

NUMBER, WHOLE, NUMBERS, MATRIX, FLAG = "number", "whole", "numbers", "matrix", "flag"
WORD, WORDS, TEXT, FILE = "word", "words", "text", "file"
"""Kinds of settings. A file is never kept, for it is given as an input each time."""


class Rule(TypedDict):
    """What a setting may be, and what doors say of it.

    `word` may be given instead of a number; `own`: the name of a method of the user's own is a choice too; `counts`: how many `NUMBERS`;
    `metavar`: their names on the command line, which has no option where there are none; `kept`: whether volumes and settings files have
    it; `label`, `decimals`: of its field in the panel; `preset`: whether a preset of the panel resets it.
    """

    help: str
    kind: str
    default: Any
    unit: str
    minimum: float | None
    maximum: float | None
    choices: tuple[str, ...] | None
    word: str | None
    own: bool
    counts: tuple[int, ...]
    metavar: str
    kept: bool
    label: str
    decimals: int
    preset: bool


_PLAIN: dict[str, Any] = {
    "unit": "",
    "minimum": None,
    "maximum": None,
    "choices": None,
    "word": None,
    "own": False,
    "counts": (),
    "metavar": "N",
    "label": "",
    "decimals": 1,
    "preset": False,
}


def setting(default: Any, help: str = "", kind: str = NUMBER, **more: Any) -> Any:
    """A dataclass field that carries its `Rule`, of which `more` are the keys that are not plain. One whose default is None may be None.
    Without a help the docstring of its class explains it.
    """
    if unknown := set(more) - {*_PLAIN, "kept"}:
        raise TypeError(f"A setting has no {', '.join(unknown)}.")
    kind = WORD if more.get("choices") else kind
    rule = {**_PLAIN, "kept": kind != FILE, **more, "help": help, "kind": kind, "default": default}
    # Arrays, which may stand for a file, have no order and no hash
    return field(default=default, metadata=rule, compare=kind != FILE)


class Explained(NamedTuple):
    """What the docstring of a class says: its summary, of each parameter what it takes and what it means, and examples."""

    summary: str
    parameters: dict[str, tuple[str, str]]
    examples: str


def explained(group: type) -> Explained:
    """What a class says of itself."""
    summary, _, rest = inspect.cleandoc(group.__dict__.get("__doc__") or "").partition("\n\n")
    parameters = rest.partition("Parameters\n----------\n")[2].partition("\n\n")[0]
    entries = re.findall(r"^(\w+)(?: : (.*))?\n((?: {4}.*(?:\n|$))+)", parameters, re.MULTILINE)
    meanings = {name: (takes, " ".join(meaning.split())) for name, takes, meaning in entries}
    return Explained(" ".join(summary.split()), meanings, rest.partition("Examples\n--------\n")[2])


def rule_of(metadata: Mapping[str, object]) -> Rule:
    """The metadata of a setting's field as what it is."""
    return cast("Rule", metadata)


def expected(rule: Rule) -> str:
    """What a setting takes, in words."""
    if rule["kind"] == WORD:
        return "one of " + ", ".join([*(rule["choices"] or ()), *([OWN_METHOD] if rule["own"] else [])])
    if rule["kind"] == NUMBERS:
        return "one number or three (x y z)" if 1 in rule["counts"] else f"{rule['counts'][0]} numbers"
    return {
        NUMBER: "a finite number" + (f" or {rule['word']}" if rule["word"] else ""),
        WHOLE: "a whole number",
        MATRIX: "4 rows of 4 numbers",
        FLAG: "True or False",
        TEXT: "a text",
        WORDS: "texts",
        FILE: "a file",
    }[rule["kind"]]


def checked(name: str, value: Any, rule: Rule) -> Any:
    """A value as it is kept, lists as tuples.

    Raises SettingsError when it does not obey the rule.
    """
    if value is None and rule["default"] is None:
        return None
    if rule["own"] and isinstance(value, CompoundingMethod):
        value = value.name
    if rule["own"] and callable(value):
        raise SettingsError(f"Input {name} must be the name of a method, or a method. Write @register_method above it.")
    several = not isinstance(value, str) and isinstance(value, Iterable)
    if rule["kind"] == NUMBERS and several:
        value = tuple(value)
        _check(len(value) != 1 and len(value) in rule["counts"] and all(map(_is_number, value)), name, value, rule)
        for number in value:
            _check_range(name, number, rule)
        return tuple(int(number) if isinstance(number, Integral) else float(number) for number in value)
    if rule["kind"] == MATRIX:
        rows = [tuple(row) for row in value] if several and all(isinstance(row, Iterable) for row in value) else []
        _check(len(rows) == 4 and all(len(row) == 4 and all(map(_is_number, row)) for row in rows), name, value, rule)
        return tuple(tuple(map(float, row)) for row in rows)
    if rule["kind"] == WORDS:
        words = tuple(value) if several else ()
        _check(bool(words) and all(isinstance(word, str) for word in words), name, value, rule)
        return words
    _check(_is_one(value, rule), name, value, rule)
    if rule["kind"] in (NUMBER, WHOLE, NUMBERS) and not isinstance(value, str):
        _check_range(name, value, rule)
    return value


def _is_one(value: Any, rule: Rule) -> bool:
    """Whether it is a value of the kind."""
    kind = rule["kind"]
    if kind == WORD:
        own = rule["own"] and isinstance(value, str) and is_own_method(value)
        return isinstance(value, str) and (value in (rule["choices"] or ()) or own)
    if isinstance(value, str) and value == rule["word"]:
        return True
    if kind == WHOLE:
        return _is_number(value) and isinstance(value, Integral)
    if kind == NUMBER or (kind == NUMBERS and 1 in rule["counts"]):
        return _is_number(value)
    return kind != NUMBERS and isinstance(value, {FLAG: bool, TEXT: str, FILE: str | Path | np.ndarray}[kind])


def _is_number(value: Any) -> bool:
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    # Compared, because a whole number in a file may be too large for a float
    return -LARGEST < (value if isinstance(value, int) else float(value)) < LARGEST


def _check(right: bool, name: str, value: Any, rule: Rule) -> None:
    if not right:
        raise SettingsError(f"Input {name} must be {expected(rule)}; got {shorten(repr(value))}.")


def _check_range(name: str, number: Any, rule: Rule) -> None:
    unit = f" {rule['unit']}" if rule["unit"] else ""
    if rule["minimum"] is not None and number < rule["minimum"]:
        raise SettingsError(f"Input {name} must be at least {rule['minimum']:g}{unit}; got {number!r}.")
    if rule["maximum"] is not None and number > rule["maximum"]:
        raise SettingsError(f"Input {name} must be at most {rule['maximum']:g}{unit}; got {number!r}.")

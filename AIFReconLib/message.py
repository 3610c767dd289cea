"""Sentences for people: what is wrong and where, in English, and which settings would mend it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from html import escape
from string import Formatter

LONGEST_QUOTE = 500
"""Characters of a text that a sentence repeats at most."""
LONGEST_SENTENCE = 2000
"""Characters that an error has at most, whatever a file holds that it quotes."""


Spelling = Callable[[str, str], str]
"""How a door (terminal, Python, panel) writes a setting, of its name and its value, which may be empty: ``--probe linear``."""

ARGUMENTS = {
    "accept": "found.transform",
    "mirror": "edits.mirrored",
    "bone_labels": "bone=BoneMap.from_labels(...)",
    "bone_from_sweep": "Recipe(bone_from_sweep=True)",
    "bone_probability": "bone=BoneMap.from_probability(...)",
    "ct": "labels_from_ct(...)",
    "bone_transform": "start",
    "bone_unit": "unit",
    "grid_like": "grid",
    "transform_sequence": "transform_sequences",
    "wrong_calibration": "wrong",
    "image_origin_px": "origin_px",
    "units": "length_unit",
}
"""Inputs that have another name in Python than on the command line."""


COMMANDS = ("calibrate", "convert", "import", "register")
"""Names in an advice that are no settings: what else of this program helps. A panel has buttons for some."""


class Sentence(str):
    """What the library says, and the advice that goes with it, in which every door writes settings in its own way.

    It is a `str`, the sentence alone, wherever a string is wanted; `advised` adds the advice.

    Parameters
    ----------
    text : str
        What is wrong, and where. Names from a file may be in it: it is shown on one line, and cut to `LONGEST_SENTENCE` characters.
    advice : str, Sentence or Exception
        What to do, in words that hold for all doors, with names of settings in braces, and values where there are any:
        ``"Give {probe:linear}, or choose another {method}."``; `COMMANDS` likewise. Of a sentence or an error, its advice.
    **details
        What else stands in braces there.
    """

    advice: str
    details: dict[str, object]

    def __new__(cls, text: str, /, advice: str | BaseException = "", **details: object) -> Sentence:
        sentence = super().__new__(cls, one_line(shorten(text.strip(), LONGEST_SENTENCE)))
        other = message_of(advice) if isinstance(advice, BaseException) else advice
        sentence.advice, sentence.details = (other.advice, other.details) if isinstance(other, Sentence) else (other, details)
        return sentence

    @property
    def settings(self) -> tuple[str, ...]:
        """The settings that would mend it, in the order of the advice."""
        return tuple(name for _, name, *_ in Formatter().parse(self.advice) if name and name not in self.details)


class _Setting:
    """A setting in an advice, whose format is its value."""

    def __init__(self, name: str, spelling: Spelling):
        self._name, self._spelling = name, spelling

    def __format__(self, value: str) -> str:
        return self._spelling(self._name, value)


def as_argument(name: str, value: str = "") -> str:
    """A setting as Python writes it: ``probe=``, ``apex_px=(column, row)``; a value in capitals stands for another."""
    name = ARGUMENTS.get(name, name)
    if name in COMMANDS:
        return name
    if not value:
        return name if {".", "("} & {*name} else f"{name}="
    if value.startswith('"'):
        return f"{name}={value}"
    words = [word.lower() if word.isupper() or word.strip("-.0123456789") == "" else f'"{word}"' for word in value.split()]
    return f"{name}={words[0] if len(words) == 1 else '(' + listed(words) + ')'}"


def as_label(labels: Mapping[str, str], name: str, value: str = "") -> str:
    """A setting as a panel shows it, by the labels of its controls; without one, its name in words."""
    label = labels.get(name)
    bare = f"aifrecon {name}" if name in COMMANDS else name.replace("_", " ")
    control = f"“{label}”" if label else bare
    return control if value.isupper() or not value else f"{control} ({value})"


def advised(sentence: object, spelling: Spelling = as_argument) -> str:
    """A sentence with its advice, settings as a door writes them; any other text, and an error that has none, as it is."""
    if isinstance(sentence, BaseException):
        sentence = message_of(sentence)
    if not isinstance(sentence, Sentence):
        return str(sentence)
    settings = {name: _Setting(name, spelling) for name in sentence.settings}
    return f"{sentence} {sentence.advice.format(**sentence.details, **settings)}".strip()


def message_of(error: object) -> Sentence:
    """What an error says, or a sentence or text that may have an advice."""
    if isinstance(error, BaseException):
        error = error.args[0] if error.args and isinstance(error.args[0], Sentence) else str(error)
    return error if isinstance(error, Sentence) else Sentence(str(error))


def listed(items: Iterable[object], separator: str = ", ") -> str:
    """Several things, one after the other."""
    return separator.join(map(str, items))


def one_line(text: str) -> str:
    """`text` with everything that a terminal cannot show on one line replaced by a question mark."""
    return text if text.isprintable() else "".join(character if character.isprintable() else "?" for character in text)


def shorten(text: str, length: int = 60) -> str:
    """`text` cut to `length` characters, for quoting it in a message."""
    return text if len(text) <= length else text[: length - 3] + "..."


def html_table(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """Names and values as a small table for a notebook."""
    body = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td style='text-align:left'>{escape(str(value))}</td></tr>"
        for name, value in rows
    )
    return f"<table><caption style='text-align:left'><b>{escape(title)}</b></caption>{body}</table>"


class Described:
    """Shows itself in a line, and in a notebook as a table, by what `_facts` tells."""

    def _facts(self) -> list[tuple[str, str]]:
        raise NotImplementedError

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {', '.join(f'{name} {value}' for name, value in self._facts())}>"

    def _repr_html_(self) -> str:
        return html_table(type(self).__name__, self._facts())


class Judged(Described):
    """An answer that is to be used only where nothing speaks against it."""

    reason: str | None

    @property
    def accepted(self) -> bool:
        """Whether it may be used unseen."""
        return self.reason is None

    @property
    def refusal(self) -> str | None:
        """Why it must not be used unseen, and what to do about it in Python."""
        return None if self.reason is None else advised(self.reason)


def columns(rows: Iterable[Iterable[str]], indent: str = "  ") -> str:
    """Rows of words as aligned columns, one line each."""
    table = [[str(cell) for cell in row] for row in rows]
    widths = [max((len(row[c]) for row in table if c < len(row)), default=0) for c in range(max(map(len, table), default=0))]
    return "\n".join((indent + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))).rstrip() for row in table)

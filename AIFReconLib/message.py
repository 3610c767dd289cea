"""Sentences for people: what is wrong and where, in English, and the name of what can be done about it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape

from .remedies import IN_PYTHON, Remedy

LONGEST_QUOTE = 500
"""Characters of a text that a sentence repeats at most."""
LONGEST_SENTENCE = 2000
"""Characters that an error has at most, whatever a file holds that it quotes."""


class Sentence(str):
    """What the library says, and the remedy for it, which every door (terminal, Python, panel) puts in its own words.

    It is a `str`, the sentence alone, wherever a string is wanted; `advised` adds the remedy.

    Parameters
    ----------
    text : str
        What is wrong, and where. Names from a file may be in it: it is shown on one line, and cut to `LONGEST_SENTENCE` characters.
    remedy : Remedy, str, Exception or None
        What to do; of a sentence or an error, the remedy that it names.
    **details
        What the words of the remedy name in braces.
    """

    remedy: Remedy | None
    details: dict[str, object]

    def __new__(cls, text: str, /, remedy: Remedy | str | BaseException | None = None, **details: object) -> Sentence:
        sentence = super().__new__(cls, one_line(shorten(text.strip(), LONGEST_SENTENCE)))
        if remedy is not None and not isinstance(remedy, Remedy):
            other = said(remedy) if isinstance(remedy, BaseException) else remedy
            remedy, details = (other.remedy, other.details) if isinstance(other, Sentence) else (None, {})
        sentence.remedy, sentence.details = remedy, details
        return sentence


def advised(sentence: object, words: Mapping[Remedy, str] = IN_PYTHON) -> str:
    """A sentence with its remedy in a door's words; any other text, and an error that names no remedy, as it is."""
    if isinstance(sentence, BaseException):
        sentence = said(sentence)
    if not isinstance(sentence, Sentence) or sentence.remedy is None:
        return str(sentence)
    return f"{sentence} {words[sentence.remedy].format(**sentence.details)}".strip()


def said(error: BaseException) -> Sentence:
    """What an error says, without what to do about it."""
    return error.args[0] if error.args and isinstance(error.args[0], Sentence) else Sentence(str(error))


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

    said: str | None

    @property
    def accepted(self) -> bool:
        """Whether it may be used unseen."""
        return self.said is None

    @property
    def refusal(self) -> str | None:
        """Why it must not be used unseen, in Python's words."""
        return None if self.said is None else advised(self.said)


def columns(rows: Iterable[Iterable[str]], indent: str = "  ") -> str:
    """Rows of words as aligned columns, one line each."""
    table = [[str(cell) for cell in row] for row in rows]
    widths = [max((len(row[c]) for row in table if c < len(row)), default=0) for c in range(max(map(len, table), default=0))]
    return "\n".join((indent + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))).rstrip() for row in table)

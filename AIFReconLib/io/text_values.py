"""Values in text as headers and configurations write them, and quoting that text in messages."""

from __future__ import annotations

import math
import re

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_NOT_A_NUMBER = re.compile(r"[+-]?(nan(\(\w*\))?|1\.#(ind|qnan|snan)\d*)", re.IGNORECASE | re.ASCII)
_INFINITY = re.compile(r"[+-]?(inf(inity)?|1\.#inf\d*)", re.IGNORECASE | re.ASCII)


def parse_number(text: str) -> float:
    """The number that `text` spells; NaN and infinity as C libraries print them, Microsoft's ``-1.#IND00`` too.

    Raises
    ------
    ValueError
        When it is not one number. (`float` alone would also take ``1_000``.)
    """
    word = text.strip()
    if _NUMBER.fullmatch(word):
        return float(word)
    if _NOT_A_NUMBER.fullmatch(word):
        return math.nan
    if _INFINITY.fullmatch(word):
        return -math.inf if word.startswith("-") else math.inf
    raise ValueError(f"{shorten(word)!r} is not a number")


def parse_numbers(text: str) -> list[float]:
    """The numbers in `text`, separated by white space.

    Raises
    ------
    ValueError
        When a word is not a number; the message quotes it.
    """
    return [parse_number(word) for word in text.split()]


def format_number(value: float) -> str:
    """The shortest text that reads back as exactly `value`."""
    text = repr(float(value))
    return text[:-2] if text.endswith(".0") else text


def capital(text: str) -> str:
    """`text` with a capital first letter, as Plus spells the names of coordinate frames."""
    return text[:1].upper() + text[1:]


def one_line(text: str) -> str:
    """`text` with everything that a terminal cannot show on one line replaced by a question mark."""
    return "".join(character if character.isprintable() else "?" for character in text)


def shorten(text: str, length: int = 60) -> str:
    """`text` cut to `length` characters, for quoting it in a message."""
    return text if len(text) <= length else text[: length - 3] + "..."

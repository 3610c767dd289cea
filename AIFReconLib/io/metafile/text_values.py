"""Values in text as headers and configurations write them, and quoting that text in messages."""

from __future__ import annotations

import contextlib
import math
import re

import numpy as np

from ...arrays import Matrix
from ...errors import AIFReconError
from ...message import shorten

# Written so that there is one way to match a run of digits: with two, a long run takes the square of its length
_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_PLAIN_NUMBERS = re.compile(r"[-+.eE0-9 ]*")
_NOT_A_NUMBER = re.compile(r"[+-]?(nan(\(\w*\))?|1\.#(ind|qnan|snan)\d*)", re.IGNORECASE | re.ASCII)
_INFINITY = re.compile(r"[+-]?(inf(inity)?|1\.#inf\d*)", re.IGNORECASE | re.ASCII)


class NotANumberError(AIFReconError, ValueError):
    """A word is not a number, as half a sentence for the message that says where it stands."""


def parse_number(text: str) -> float:
    """The number that `text` spells; NaN and infinity as C libraries print them, Microsoft's ``-1.#IND00`` too.

    Raises NotANumberError when it is not one number. (`float` alone would also take ``1_000``.)
    """
    word = text.strip()
    if _NUMBER.fullmatch(word):
        return float(word)
    if _NOT_A_NUMBER.fullmatch(word):
        return math.nan
    if _INFINITY.fullmatch(word):
        return -math.inf if word.startswith("-") else math.inf
    raise NotANumberError(f"{shorten(word)!r} is not a number")


def parse_numbers(text: str) -> list[float]:
    """The numbers in `text`, separated by white space.

    Raises NotANumberError when a word is not a number; the message quotes it.
    """
    if _PLAIN_NUMBERS.fullmatch(text):  # of these letters Python makes the same numbers, ten times as fast
        with contextlib.suppress(ValueError):
            return [float(word) for word in text.split()]
    return [parse_number(word) for word in text.split()]


def parse_matrix(text: str) -> Matrix:
    """The (4, 4) matrix in `text`, row by row; NaN is allowed.

    Raises NotANumberError when it is not 16 numbers.
    """
    numbers = parse_numbers(text)
    if len(numbers) != 16:
        raise NotANumberError(f"got {len(numbers)}")
    return np.array(numbers).reshape(4, 4)


def format_number(value: float) -> str:
    """The shortest text that reads back as exactly `value`."""
    text = repr(float(value))
    return text[:-2] if text.endswith(".0") else text

"""Values in text as headers and configurations write them, and quoting that text in messages."""

from __future__ import annotations

import math
import re

import numpy as np

from ...arrays import Floats, Matrix
from ...errors import AIFReconError
from ...message import shorten

_OF_MICROSOFT = re.compile(r"([+-]?)(?:nan\(\w*\)|1\.#(ind|qnan|snan|inf)\d*)", re.IGNORECASE | re.ASCII)
"""NaN and infinity, which Python spells otherwise."""


class NotANumberError(AIFReconError, ValueError):
    """A word is not a number, as half a sentence for the message that says where it stands."""


def parse_number(text: str) -> float:
    """The number that `text` spells; NaN and infinity as C libraries print them, Microsoft's ``-1.#IND00`` too.

    Raises NotANumberError when it is not one number.
    """
    try:
        return float(text)
    except ValueError:
        found = _OF_MICROSOFT.fullmatch(text.strip())
    if found is None:
        raise NotANumberError(f"{shorten(text.strip())!r} is not a number")
    return float(f"{found[1]}inf") if (found[2] or "").lower() == "inf" else math.nan


def parse_numbers(text: str) -> list[float]:
    """The numbers in `text`, separated by white space.

    Raises NotANumberError when a word is not a number; the message quotes it.
    """
    return list(map(parse_number, text.split()))


def finite_numbers(text: str, count: int | None = None) -> Floats:
    """The finite numbers in `text`, so many.

    Raises NotANumberError when one is none, or there are more or fewer.
    """
    numbers = np.array(parse_numbers(text), np.float64)
    if len(numbers) != (count or len(numbers)) or not np.isfinite(numbers).all():
        raise NotANumberError(f"got {shorten(text)!r}")
    return numbers


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

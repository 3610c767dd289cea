"""Typed attributes of one XML element, with errors that name file, element and attribute."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar
from xml.etree.ElementTree import Element

from ...errors import ConfigurationError
from ...message import shorten
from ..metafile.text_values import NotANumberError, parse_numbers

LARGEST_INTEGER = 2**31 - 1
"""As in Plus."""


Value = TypeVar("Value")
Given = TypeVar("Given", tuple[float, ...], tuple[int, ...], tuple[float, float, float] | None, tuple[float, ...] | None)


class Attributes:
    """Reads the attributes of an element, and keeps account of its place for messages.

    Parameters
    ----------
    path : Path
    element : xml.etree.ElementTree.Element
    place : str
        The element in words, e.g. ``VolumeReconstruction``.
    """

    def __init__(self, path: Path, element: Element, place: str):
        self._path = path
        self.element = element
        self.place = place

    def failure(self, attribute: str, problem: str) -> ConfigurationError:
        """The error to raise for an attribute of this element."""
        return ConfigurationError(f"{self._path}: {self.place}@{attribute} {problem}")

    def text(self, *names: str) -> str | None:
        """The first of `names` that is there (newer names first), without white space around it; None without any."""
        for name in names:
            if (value := self.element.get(name)) is not None and value.strip():
                return value.strip()
        return None

    def required_text(self, name: str) -> str:
        """An attribute that must be there."""
        return self._required(self.text(name), name)

    def numbers(self, count: int, *names: str) -> tuple[float, ...] | None:
        """`count` finite numbers; None when the attribute is not there."""
        text = self.text(*names)
        if text is None:
            return None
        name = self._present(names)
        try:
            numbers = parse_numbers(text)
        except NotANumberError as error:
            raise self.failure(name, f"must be {_spell(count)}; {error}. Correct it.") from error
        if len(numbers) != count or not all(math.isfinite(number) for number in numbers):
            raise self.failure(name, f"must be {_spell(count)}; got {shorten(text)!r}. Correct it.")
        return tuple(numbers)

    def required_numbers(self, count: int, name: str) -> tuple[float, ...]:
        """`count` finite numbers that must be there."""
        return self._required(self.numbers(count, name), name)

    def pair(self, *names: str) -> tuple[float, float] | None:
        """Two finite numbers; None when the attribute is not there."""
        numbers = self.numbers(2, *names)
        return None if numbers is None else (numbers[0], numbers[1])

    def required_number(self, name: str) -> float:
        """One finite number that must be there."""
        return self.required_numbers(1, name)[0]

    def required_integer(self, name: str) -> int:
        """One whole number that must be there."""
        return self._required(self.integers(1, name), name)[0]

    def number(self, default: float, *names: str) -> float:
        """One finite number; `default` when the attribute is not there."""
        numbers = self.numbers(1, *names)
        return default if numbers is None else numbers[0]

    def integers(self, count: int, *names: str) -> tuple[int, ...] | None:
        """`count` whole numbers; None when the attribute is not there."""
        numbers = self.numbers(count, *names)
        if numbers is None:
            return None
        if any(number != int(number) for number in numbers):
            raise self.failure(self._present(names), f"must be whole; got {shorten(self.text(*names) or '')!r}. Correct it.")
        if max(map(abs, numbers)) > LARGEST_INTEGER:
            raise self.failure(self._present(names), f"must be of 32 bits; got {shorten(self.text(*names) or '')!r}. Correct it.")
        return tuple(int(number) for number in numbers)

    def positive(self, numbers: Given, name: str) -> Given:
        """The same numbers, each of which must be above 0; None stays None."""
        if numbers is not None and min(numbers) <= 0:
            raise self.failure(
                name, "must be positive; got {numbers}. Correct it.".format(numbers=" ".join(f"{number:g}" for number in numbers))
            )
        return numbers

    def word(self, name: str, choices: Sequence[str]) -> str | None:
        """One of `choices`, in any case; None when the attribute is not there."""
        text = self.text(name)
        if text is None:
            return None
        if text.upper() not in choices:
            raise self.failure(name, f"must be {' or '.join(choices)}; got {shorten(text)!r}. Correct it.")
        return text.upper()

    def required_word(self, name: str, choices: Sequence[str]) -> str:
        """One of `choices`, in any case, that must be there."""
        return self._required(self.word(name, choices), name)

    def switch(self, name: str) -> bool:
        """ON or TRUE; False when the attribute is not there."""
        return self.word(name, ("ON", "OFF", "TRUE", "FALSE")) in ("ON", "TRUE")

    def _required(self, value: Value | None, name: str) -> Value:
        if value is None:
            raise self.failure(name, "is missing. Add it to the element.")
        return value

    def _present(self, names: Sequence[str]) -> str:
        return next(name for name in names if self.element.get(name, "").strip())


def _spell(count: int) -> str:
    return "a finite number" if count == 1 else f"{count} finite numbers"

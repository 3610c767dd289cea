"""Typed attributes of one XML element, with errors that name file, element and attribute."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, TypeVar
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import AIFReconError, ConfigurationError
from ...message import shorten
from ..metafile.text_values import NotANumberError, finite_numbers

LARGEST_INTEGER = 2**31 - 1
"""As in Plus."""

Thing = TypeVar("Thing")


class Attributes:
    """Reads the attributes of an element, and keeps account of its place for messages, and of the names that were asked for.

    Parameters
    ----------
    path : Path
    element : xml.etree.ElementTree.Element
    place : str
        The element in words, e.g. ``VolumeReconstruction``.

    Notes
    -----
    Of several names of one attribute the first that is there holds: newer names come first. What is `required` is an error when it is
    not there.
    """

    def __init__(self, path: Path, element: Element, place: str):
        self._path, self.element, self.place = path, element, place
        self.asked: set[str] = set()

    def failure(self, attribute: str, problem: str) -> ConfigurationError:
        """The error to raise for an attribute of this element."""
        return ConfigurationError(f"{self._path}: {self.place}@{attribute} {problem}")

    def build(self, attribute: str, make: Callable[[], Thing]) -> Thing:
        """What `make` makes of values in the file; its complaint becomes the file's."""
        try:
            return make()
        except AIFReconError as error:
            raise self.failure(attribute, f"cannot be used. {error}") from error

    def text(self, *names: str, required: bool = False) -> str:
        """An attribute without white space around it; empty when it is not there."""
        self.asked.update(names)
        text = next((text for name in names if (text := self.element.get(name, "").strip())), "")
        if required and not text:
            raise self.failure(names[0], "is missing. Add it to the element.")
        return text

    def numbers(self, count: int, *names: str, whole: bool = False, positive: bool = False, required: bool = False) -> Any:
        """A tuple of `count` finite numbers, on demand `whole` ones of 32 bits, or all above 0; None when the attribute is not there."""
        text = self.text(*names, required=required)
        if not text:
            return None
        name = next(name for name in names if self.element.get(name, "").strip())
        finite = "a finite number" if count == 1 else f"{count} finite numbers"
        try:
            numbers = finite_numbers(text, count)
        except NotANumberError as error:
            raise self.failure(name, f"must be {finite}; {error}. Correct it.") from error
        if (positive and numbers.min() <= 0) or (whole and (numbers % 1).any()) or (whole and np.abs(numbers).max() > LARGEST_INTEGER):
            rule = " and ".join(["positive"] * positive + ["whole and of 32 bits"] * whole)
            raise self.failure(name, f"must be {rule}; got {shorten(text)!r}. Correct it.")
        return tuple(map(int, numbers) if whole else numbers.tolist())

    def number(self, *names: str, default: float | None = None, **rules: bool) -> Any:
        """One number by the rules of `numbers`; `default` when the attribute is not there."""
        numbers = self.numbers(1, *names, **rules)
        return default if numbers is None else numbers[0]

    def word(self, name: str, choices: Collection[str], required: bool = False) -> str:
        """One of `choices`, in any case; empty when the attribute is not there."""
        text = self.text(name, required=required)
        if text and text.upper() not in choices:
            raise self.failure(name, f"must be {' or '.join(choices)}; got {shorten(text)!r}. Correct it.")
        return text.upper()

    def switch(self, name: str) -> bool:
        """ON or TRUE; False when the attribute is not there."""
        return self.word(name, ("ON", "OFF", "TRUE", "FALSE")) in ("ON", "TRUE")

"""Labels: whole numbers on voxels, what each is called, and what a user should know of how they came to be."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import cast

import numpy as np

from ..arrays import Floats, Integers, Matrix
from ..errors import GeometryError
from ..message import listed, shorten
from .box import Box, box_around
from .transforms import LPS_FROM_RAS, transform_points
from .volume import Volume, VoxelGrid

MOST_LISTED = 12
"""Names of labels that a sentence lists at most."""


SPACE_UNKNOWN = "The model does not say whether it is in RAS or LPS; it is taken to be in "

MOST_NUMBER = 1 << 16
"""Of a label up to which all boxes are found at once."""

MOST_ASKED = 20_000
"""Voxels of bone that are asked where they lie."""


@dataclass(frozen=True, eq=False, repr=False)
class Labels(Volume):
    """A segmentation: 0 is nothing, every other number a bone.

    Examples
    --------
    >>> labels = Labels(np.arange(24, dtype=np.uint8).reshape(2, 3, 4) // 12, np.eye(4), names={1: "L3"})
    >>> labels.called(1), labels.called(2), labels.numbers().tolist()
    ('L3', 'label 2', [1])
    """

    names: Mapping[int, str] = field(default_factory=dict)  #: What labels are called, by their numbers, where that is known.
    notes: tuple[str, ...] = ()  #: What a user should know of them, one sentence each.
    space_is_guessed: bool = False
    """Whether they come of a surface model that does not say if it is in RAS or LPS; then they are placed as if in LPS."""

    def taken_as(self, space: str, why: str) -> Labels:
        """Those of models that do not say it, in that space, RAS or LPS, for a reason that a note tells."""
        matrix = LPS_FROM_RAS @ self.ijk_to_reference if space == "RAS" else self.ijk_to_reference
        others = (note for note in self.notes if not note.startswith(SPACE_UNKNOWN))
        return replace(self, ijk_to_reference=matrix, notes=(*others, f"{SPACE_UNKNOWN}{space}, {why}."), space_is_guessed=False)

    def share_within(self, grid: VoxelGrid, labels_to_reference: Matrix | None = None) -> float:
        """The share of these bones that lies in the box of a grid in Reference, 0 to 1."""
        kji = np.argwhere(self.array > 0)
        kji = kji[:: max(len(kji) // MOST_ASKED, 1)]
        to_grid = grid.reference_to_ijk @ (np.eye(4) if labels_to_reference is None else labels_to_reference) @ self.ijk_to_reference
        ijk = transform_points(to_grid, kji[:, ::-1].astype(np.float64))
        return float(((ijk >= -0.5) & (ijk <= np.array(grid.size) - 0.5)).all(axis=1).mean()) if len(ijk) else 0.0

    def told_by(self, grid: VoxelGrid, labels_to_reference: Matrix | None = None) -> Labels:
        """Models that do not say their space, in that of which more lies in a volume that shows them."""
        if not self.space_is_guessed:
            return self
        as_lps, as_ras = self.taken_as("LPS", "where it lies in the volume"), self.taken_as("RAS", "where it lies in the volume")
        low, high = (each.share_within(grid, labels_to_reference) for each in (as_lps, as_ras))
        return self if low == high else as_ras if high > low else as_lps

    def numbers(self) -> Integers:
        """The labels that there are, above 0, in their order."""
        return np.array([*self.boxes], dtype=np.int64)

    @cached_property
    def boxes(self) -> dict[int, Box]:
        """The smallest part of the array [k, j, i] that holds each of the labels that there are, above 0, in their order."""
        import scipy

        array = cast(Integers, self.array.view(np.uint8) if self.array.dtype.kind == "b" else self.array)
        if array.dtype.kind == "f" or array.max(initial=0) > MOST_NUMBER:
            return {int(number): box_around(array == number) for number in np.unique(array) if number > 0}
        return {number: (box[0], box[1], box[2]) for number, box in enumerate(scipy.ndimage.find_objects(array), 1) if box is not None}

    def called(self, number: int) -> str:
        """The name of a label, or its number in words."""
        return self.names.get(number) or f"label {number}"

    def only(self, numbers: Iterable[int], *notes: str) -> Labels:
        """These labels, the others taken for nothing; `notes` are added."""
        kept = sorted(set(numbers))
        array = np.where(np.isin(self.array, kept), self.array, 0).astype(self.array.dtype)
        return replace(self, array=array, names={n: name for n, name in self.names.items() if n in kept}, notes=(*self.notes, *notes))

    def chosen(self, choice: str) -> Labels:
        """The labels that a text names.

        Parameters
        ----------
        choice : str
            Numbers, ranges and names with commas between them: ``27-31``, ``L3, L4``, ``20-24, sacrum``.

        Raises
        ------
        GeometryError
            When it names none of those that there are.
        """
        there = self.numbers().tolist()
        kept: set[int] = set()
        for word in filter(None, (each.strip() for each in choice.split(","))):
            span = re.fullmatch(r"(\d{1,9})(?:\s*-\s*(\d{1,9}))?", word)
            if span:
                first, last = int(span[1]), int(span[2] or span[1])
                found = {number for number in there if min(first, last) <= number <= max(first, last)}
            else:
                found = {number for number in there if self.names.get(number, "").lower() == word.lower()}
            if not found:
                raise GeometryError(f"No label is called {shorten(word)!r}. There are {self.in_words()}.")
            kept |= found
        if not kept:
            raise GeometryError(f"Input labels must name labels, as 27-31 or L3, L4; got {choice!r}. There are {self.in_words()}.")
        return self.only(kept)

    def in_words(self) -> str:
        """The labels that there are, the first of them by name."""
        numbers = self.numbers().tolist()
        words = [f"{number} ({self.names[number]})" if number in self.names else str(number) for number in numbers]
        return listed([*words[:MOST_LISTED], *(["..."] if len(words) > MOST_LISTED else [])]) or "none"


def centers_of_mass(labels: Volume) -> dict[int, Floats]:
    """The center of mass of each label above 0, (3,) float64 in Reference, mm."""
    import scipy

    numbers = [int(label) for label in np.unique(labels.array) if label > 0]
    centers_kji = scipy.ndimage.center_of_mass(labels.array > 0, cast("Integers", labels.array), numbers)
    return {label: transform_points(labels.ijk_to_reference, np.array(kji)[::-1]) for label, kji in zip(numbers, centers_kji)}

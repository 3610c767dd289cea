"""What labels are called, and which are bone: by their names, else by the numbers that a program always gives.

The programs' own class maps, the codes of Slicer's terminology and the words of anatomy are data: label_names.json, with its sources.
"""

from __future__ import annotations

import contextlib
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy

from ...arrays import Floats
from ...errors import GeometryError
from ...geometry.labels import Labels
from ...geometry.transforms import transform_points
from ...message import listed
from ...remedies import CHOOSE_LABELS

BONE, SOFT = "bone", "soft"

LEAST_STEP, LARGEST_STEP = 8.0, 70.0
"""mm from one vertebra to the next, along the labels' axis toward the head and in all."""

TYPICAL_STEPS = ((0, 7, 18, 25), (17.0, 19.0, 29.0, 36.0))
"""mm from C1, T1, T12 and L5 to the next; they decide where two programs' numbers fit as well."""

CLEARLY = 0.08
"""How much nearer (natural logarithm) steps must be to the typical ones of one program than to those of another."""

OWN_NUMBERS = 8
"""Fewer labels than these, counted from 1, are a user's own."""

_LEVELS = [f"{letter}{n}" for letter, last in (("C", 7), ("T", 13), ("L", 6), ("S", 5)) for n in range(1, last + 1)]
"""From the head."""

_LEVEL = re.compile(r"(?<![A-Za-z0-9])(C|Th?|L|S)(\d{1,2})(?![A-Za-z0-9])", re.IGNORECASE)


_TABLES: dict[str, Any] = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))


class _Program(NamedTuple):
    """The numbers that a program gives, and what each is called."""

    name: str
    labels: dict[int, str]
    files: list[str]  #: What is in the names of its files
    marks: list[int]  #: Numbers that are in all of its files


_PROGRAMS = [_Program(**{**each, "labels": {int(n): name for n, name in each["labels"].items()}}) for each in _TABLES["programs"]]


def _levels(names: Mapping[int, str]) -> dict[int, int]:
    """Places of vertebrae in the order from the head."""
    return {number: _LEVELS.index(short) for number, name in names.items() if (short := bone_name(name)) in _LEVELS}


def _fit(names: Mapping[int, str], centers: Mapping[int, Floats], up: int) -> tuple[int, float]:
    """How many neighbors lie to each other as their names say, others counted twice against them; and how far (natural logarithm)
    their steps are from the typical ones. `up` is 1, or -1 for a body that lies upside down."""
    known = sorted((place, number) for number, place in _levels(names).items() if number in centers)
    links, off = 0, [0.0] if len(known) < 2 else []
    for (upper, first), (lower, second) in pairwise(known):
        step, apart = centers[first] - centers[second], lower - upper
        length = float(np.linalg.norm(step))
        links += 1 if step[2] * up > LEAST_STEP * apart and length < LARGEST_STEP * apart else -2
        off.append(abs(math.log(max(length, 1e-3) / float(np.interp(np.arange(upper, lower), *TYPICAL_STEPS).sum()))))
    return links, float(np.mean(off))


def bone_name(name: str) -> str:
    """The name of a bone in short: L3 for ``vertebrae_L3``; other names as they are."""
    found = _LEVEL.search(name.replace("_", " "))
    if found and re.fullmatch(r"[\W_]*(vertebrae?|level)?[\W_]*", name.replace(found[0], "", 1), re.IGNORECASE):
        return f"{found[1][0].upper()}{found[2]}"
    return name


def kind_of(name: str) -> str | None:
    """BONE or SOFT by the whole words of a name; None where it tells neither."""
    words = {word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name)}
    if words & set(_TABLES[SOFT]):
        return SOFT
    return BONE if words & set(_TABLES[BONE]) or _LEVEL.search(name.replace("_", " ")) else None


def name_by_code(name: str, tags: str) -> str:
    """The name of a segment of Slicer: its own where that tells what it is, else that of its terminology."""
    found = re.search(r"TerminologyEntry:[^~|]*~[^~|]*~[^~^|]*\^([^~^|]*)\^([^~^|]*)", tags)
    if found is None or kind_of(name) is not None:
        return name
    meaning: str = _TABLES["codes"].get(found[1], found[2])
    return meaning if kind_of(meaning) is not None else name


def with_known_names(labels: Labels, choice: str | None = None, file: str = "") -> Labels:
    """The labels with the names of their bones, without what is none, which a note tells; or those that a choice names.

    Labels that have names are told apart by these; others by the numbers of the programs, where they fit. `file` is its name, which may
    tell the program.

    Raises GeometryError, which asks which labels are bone where that cannot be told, or when the choice names none of them.
    """
    there = labels.numbers().tolist()
    programs = [] if labels.names else _programs_of(labels, there, file, must=choice is None)
    readings = [program.labels for program in programs] or [dict(labels.names)]
    if choice is not None:
        return _chosen(labels, readings, ",".join(map(bone_name, choice.split(","))))
    kinds = {n: {kind_of(names.get(n, "")) for names in readings} for n in there}
    bones = [n for n in there if kinds[n] == {BONE}]
    soft = [n for n in there if SOFT in kinds[n] and BONE not in kinds[n]]
    unknown = [n for n in there if n not in (*bones, *soft)] if bones or programs else []
    if unknown:
        raise GeometryError(f"Labels {_told(labels, unknown)} may be bone or not: neither names nor numbers tell.", CHOOSE_LABELS)
    called = {n: {bone_name(names.get(n, "")) for names in readings} for n in there if n not in soft}
    named = replace(labels, names={n: next(iter(names)) for n, names in called.items() if len(names) == 1 and "" not in names})
    if not soft:
        return named
    by = f"the numbers of {programs[0].name}" if programs else "their names"
    if len(soft) == len(there):
        raise GeometryError(f"None of its labels is bone by {by}: {_told(labels, soft)}.", CHOOSE_LABELS)
    some = f"{len(soft)} labels are" if len(soft) > 1 else "1 label is"
    return named.only(called.keys(), f"{some} no bone by {by} and left out: {_told(labels, soft)}.")


def _told(labels: Labels, numbers: Sequence[int]) -> str:
    """Some labels in words."""
    return some([labels.names.get(n, n) for n in numbers])


def some(names: Sequence[object]) -> str:
    """The first of several things, in words."""
    return listed([*names[:6], *["..."] * (len(names) > 6)])


def _chosen(labels: Labels, readings: Sequence[Mapping[int, str]], choice: str) -> Labels:
    """The labels that a choice names, by the names of any reading in which all its words are found."""
    named = [replace(labels, names={n: bone_name(name) for n, name in names.items()}) for names in [*readings, {}]]
    found = []
    for each in named:
        with contextlib.suppress(GeometryError):
            found.append(each.chosen(choice))
    if not found:
        return named[0].chosen(choice)  # which says why not
    if any(set(each.boxes) != set(found[0].boxes) for each in found):
        told = f"The labels called {choice} differ between the programs whose numbers these can be. Give numbers."
        raise GeometryError(told, CHOOSE_LABELS)
    return found[0]


def _programs_of(labels: Labels, there: Sequence[int], file: str, must: bool) -> list[_Program]:
    """The programs whose numbers these can be, as well as another's; none where they are a user's own.

    Raises GeometryError where they `must` be known, are of no known program, and no user counts so.
    """
    known = [program for program in _PROGRAMS if set(program.marks) <= set(there) <= program.labels.keys()]
    by_file = [program for program in known if any(word in file.lower() for word in program.files)]
    own = [*there] == [*range(1, len(there) + 1)] and len(there) < OWN_NUMBERS
    if not by_file and (own or not there):
        return []
    centers = _centers(labels)
    for up in (1, -1):
        fits = [(program, *_fit(program.labels, centers, up)) for program in by_file or known]
        most = max((links for _, links, _ in fits), default=0)
        if most > 0:
            nearest = min(off for _, links, off in fits if links == most)
            return [program for program, links, off in fits if links == most and off <= nearest + CLEARLY]
    marked = [program for program in known if program.marks and not _levels(program.labels)]
    alone = [program for program in known if len(_levels(program.labels).keys() & set(there)) == 1]
    if must and not (marked or by_file or alone) and len(there) > 1:
        told = f"What its labels {_told(labels, there)} are is not said, and they are not numbered as a known program does."
        raise GeometryError(told, CHOOSE_LABELS)
    return marked or by_file or alone


def _centers(labels: Labels) -> dict[int, Floats]:
    """Where the middle of each label is, mm, seen coarsely."""
    steps = [max(n // 160, 1) for n in labels.shape]
    coarse = labels.array[tuple(slice(None, None, step) for step in steps)].astype(np.int64)
    numbers = np.unique(coarse[coarse > 0])
    middle = np.reshape(scipy.ndimage.center_of_mass(coarse > 0, coarse, numbers), (-1, 3)) * steps
    return dict(zip(numbers.tolist(), transform_points(labels.ijk_to_reference, middle[:, ::-1]), strict=True))


def out_of_order(labels: Labels) -> list[str]:
    """A doubt where vertebrae do not lie in the order of their names, along the labels' axis toward the head."""
    centers = _centers(labels)
    known = sorted((place, n) for n, place in _levels(labels.names).items() if n in centers)
    wrong = ((lower, upper) for (_, upper), (_, lower) in pairwise(known) if centers[lower][2] > centers[upper][2] + LEAST_STEP)
    told = "the names, or the axes of the labels, may be wrong."
    return [f"{labels.called(lower)} lies above {labels.called(upper)}: {told}" for lower, upper in wrong][:1]


def mixed(names: Iterable[str]) -> list[str]:
    """Names that tell neither bone nor soft tissue, where others tell bone."""
    kinds = {name: kind_of(name) for name in names}
    return [name for name, kind in kinds.items() if kind is None and BONE in kinds.values()]

"""What labels are called: by their numbers, where a program always gives the same, and by the names of files and segments.

References
----------
Wasserthal J et al. (2023), TotalSegmentator, Radiology: Artificial Intelligence 5(5), doi:10.1148/ryai.230024; the numbers of task
``total`` of versions 1 and 2 as its documentation lists them. Sekuboyina A et al. (2021), VerSe, Medical Image Analysis 73:102166,
doi:10.1016/j.media.2021.102166; the numbers as its page lists them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ...arrays import Floats
from ...geometry.labels import Labels
from ...geometry.transforms import transform_points
from ...message import listed


def _vertebrae(letter: str, first: int, last: int) -> list[str]:
    step = 1 if last >= first else -1
    return [f"{letter}{n}" for n in range(first, last + step, step)]


def _ribs(side: str, *numbers: int) -> list[str]:
    return [f"rib {side} {n}" for n in numbers]


_LIMBS = [f"{bone} {side}" for bone in ("humerus", "scapula", "clavicula", "femur", "hip") for side in ("left", "right")]
_UPWARD = [*_vertebrae("L", 5, 1), *_vertebrae("T", 12, 1), *_vertebrae("C", 7, 1)]
_ALL_RIBS = range(1, 13)


def _numbered(first: int, names: list[str]) -> dict[int, str]:
    return dict(enumerate(names, first))


@dataclass(frozen=True)
class _Program:
    """The numbers that a program gives."""

    name: str
    bones: dict[int, str]
    last: int  #: The largest number; those that are no bone are organs
    column: range  #: Numbers of the vertebrae
    upward: bool  #: Whether their numbers rise toward the head

    def links(self, centers: dict[int, Floats]) -> tuple[int, int, int]:
        """How many neighboring vertebrae lie to each other as their numbers say, the other way round, and not like neighbors."""
        counts = [0, 0, 0]
        for number in self.column:
            if number in centers and number + 1 in centers and number + 1 in self.column:
                step = centers[number + 1] - centers[number]
                near = abs(step[2]) > LEAST_STEP and np.linalg.norm(step) < LARGEST_STEP
                counts[2 if not near else 0 if (step[2] > 0) == self.upward else 1] += 1
        return counts[0], counts[1], counts[2]


LEAST_STEP, LARGEST_STEP = 8.0, 70.0
"""mm from one vertebra to the next, along the labels' axis toward the head and in all."""

PROGRAMS = (
    _Program(
        "TotalSegmentator",
        {
            **_numbered(25, ["sacrum", "S1", *_UPWARD]),
            **_numbered(69, _LIMBS),
            **_numbered(91, ["skull", "rib right 4", "rib right 3", *_ribs("left", *_ALL_RIBS), *_ribs("right", 1, 2, *range(5, 13))]),
            116: "sternum",
        },
        117,
        range(26, 51),
        True,
    ),
    _Program(
        "TotalSegmentator 1",
        {
            **_numbered(18, _UPWARD),
            **_numbered(58, [*_ribs("left", *_ALL_RIBS), *_ribs("right", *_ALL_RIBS), *_LIMBS, "sacrum"]),
        },
        104,
        range(18, 42),
        True,
    ),
    _Program(
        "VerSe",
        {
            **_numbered(1, [*_vertebrae("C", 1, 7), *_vertebrae("T", 1, 12), *_vertebrae("L", 1, 6), "sacrum", "coccyx", "T13"]),
        },
        28,
        range(1, 26),
        False,
    ),
)

OWN_NUMBERS = 8
"""Labels below are as likely a user's own, counted from 1, unless there are as many."""

_NO_BONE = re.compile(
    r"spleen|kidney|gallbladder|liver|stomach|pancreas|adrenal|lung|esophagus|trachea|thyroid|bowel|duodenum|colon|bladder|prostate|heart|"
    r"atri(al|um)|ventricle|aorta|arter(y|ies)|vein|vena|vessel|trunk|trunc|spinal.?(cord|canal)|gluteus|autochthon|iliopsoas|psoas|muscle|"
    r"brain|cartilage|(^|[^a-z])fat([^a-z]|$)|skin|(^|[^a-z])body|extremities|dis[ck]s?([^a-z]|$)|(^|[^a-z])face([^a-z]|$)|tumou?r|effusion|"
    r"implant|screw|background"
)
_VERTEBRA = re.compile(r"(?<![A-Za-z0-9])([CTLS]\d{1,2})(?![A-Za-z0-9])", re.IGNORECASE)


def bone_name(name: str) -> str:
    """The name of a bone in short: L3 for ``vertebrae_L3``; other names as they are."""
    found = _VERTEBRA.search(name.replace("_", " "))
    if found and re.fullmatch(r"[\W_]*(vertebrae?|level)?[\W_]*", name.replace(found[1], "", 1), re.IGNORECASE):
        return found[1].upper()
    return name


def is_no_bone(name: str) -> bool:
    """Whether a name is that of another organ; names that are not known may be of bone."""
    plain = name.lower()
    return "vertebra" not in plain and bool(_NO_BONE.search(plain))


def with_known_names(labels: Labels) -> Labels:
    """The labels with the names of their bones, without those of other organs, which a note tells.

    Labels that have names are told apart by these; others by the numbers of TotalSegmentator or VerSe, where they fit.
    """
    there = labels.numbers().tolist()
    if labels.names:
        bones = {n: bone_name(labels.names[n]) if n in labels.names else "" for n in there if not is_no_bone(labels.names.get(n, ""))}
        source = "their names"
    else:
        program = _program_of(labels, there)
        if program is None:
            return labels
        bones = {n: program.bones[n] for n in there if n in program.bones}
        source = f"the numbers of {program.name}"
    if not bones:
        return labels
    named = replace(labels, names={n: name for n, name in bones.items() if name})
    others = [n for n in there if n not in bones]
    if not others:
        return named
    told = listed(labels.names.get(n, str(n)) for n in others[:6]) + (", ..." if len(others) > 6 else "")
    some = f"{len(others)} labels are" if len(others) > 1 else "1 label is"
    return named.only(bones, f"{some} no bone by {source} and left out: {told}.")


def _program_of(labels: Labels, there: list[int]) -> _Program | None:
    """The program whose numbers these are."""
    if not there:
        return None
    centers = _centers(labels)
    best, most = None, 0
    for program in PROGRAMS:
        if there[-1] > program.last or not any(n in program.column for n in there):
            continue
        if there[0] < OWN_NUMBERS and not program.upward and len(there) < OWN_NUMBERS:
            continue
        right, turned, apart = program.links(centers)
        links = right - 2 * (turned + apart)
        if links > most:
            best, most = program, links
    if best is not None:
        return best
    # One vertebra, or a body that lies the other way: only TotalSegmentator has such numbers
    first = PROGRAMS[0]
    right, turned, apart = first.links(centers)
    fits = PROGRAMS[-1].last < there[-1] <= first.last and any(n in first.column for n in there)
    return first if fits and turned >= 2 * (right + apart) else None


def _centers(labels: Labels) -> dict[int, Floats]:
    """Where the middle of each label is, mm, seen coarsely."""
    steps = [max(n // 160, 1) for n in labels.shape]
    coarse = labels.array[tuple(slice(None, None, step) for step in steps)]
    kji = np.nonzero(coarse > 0)
    numbers, which, counts = np.unique(coarse[kji].astype(np.int64), return_inverse=True, return_counts=True)
    middle = np.stack([np.bincount(which, along) / counts * step for along, step in zip(kji, steps, strict=True)], axis=-1)
    places = transform_points(labels.ijk_to_reference, middle[:, ::-1])
    return dict(zip(numbers.tolist(), places, strict=True))


def out_of_order(labels: Labels) -> str | None:
    """A doubt where vertebrae do not lie in the order of their names, along the labels' axis toward the head."""
    order = {name: place for place, name in enumerate(reversed(_UPWARD))}
    centers = _centers(labels)
    known = sorted((order[labels.names[n]], n) for n in centers if labels.names.get(n) in order)
    for (_, upper), (_, lower) in pairwise(known):
        if centers[lower][2] > centers[upper][2] + LEAST_STEP:
            return f"{labels.called(lower)} lies above {labels.called(upper)}: the names, or the axes of the labels, may be wrong."
    return None

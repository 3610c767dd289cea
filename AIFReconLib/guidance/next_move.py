"""Where to move the probe next, from where it is and from what was met until now."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Matrix
from ..message import listed
from ..progress import Progress, Steps, carry_out
from .bone import GuidedBone
from .bone_coverage import CoverageAccumulator
from .candidates import Candidates
from .passes import HAND, Hand, Pass, freehand_passes, name_of_place
from .probe import ProbeOnBack, ProbePlacement
from .snapshot import Direction

STABLE = 0.25
"""Part by which another move must be better than the one that was advised before it is advised instead."""

FAR_MM, FAR_DEG = 60.0, 60.0
"""A slide of so many mm is as laborious as a tilt of so many degrees."""

LABOR = 0.5
"""What a move adds is divided by 1 and this times its labor, in units of those."""

ROUNDS = 3
"""Times as many frames as a pass needs at least, in which a pass is thought to be made: 18 for a slide of 18 mm, a second or two."""

SMALLEST_MM, SMALLEST_DEG = 4.0, 4.0
"""What a hand does not notice is not said."""


TURN, UP, DOWN, TO_LEFT, TO_RIGHT, HERE = "\u21bb", "\u2191", "\u2193", "\u2190", "\u2192", "\u25cf"
"""As on a prone patient's back, with the head up; where nobody knows the head, as on the screen, and up is into the image."""

PATIENT = (
    (TO_RIGHT, "toward the patient's right"),
    (TO_LEFT, "toward the patient's left"),
    (UP, "toward the head"),
    (DOWN, "toward the feet"),
)
IMAGE = (
    (TO_RIGHT, "to the right of the image"),
    (TO_LEFT, "to the left of the image"),
    (UP, "away from you, as you see the image"),
    (DOWN, "toward you, as you see the image"),
)
"""The ways of x and z up and down, of the patient and of an image that is looked at on a screen: an arrow, and words."""

TURNED_DEG = 45.0
"""Between a transverse and a sagittal image."""


@dataclass(frozen=True, eq=False)
class Move:
    """An advice."""

    words: str  #: In a sonographer's words, with what it adds
    adds_cm2: float
    """Area of the target, and `OFF_TARGET` of the area off it, that it is expected to show beyond what is shown already."""
    image_to_reference: Matrix  #: (4, 4). Where the probe is in the middle of that pass: for a ghost.
    planned: Pass  #: The pass
    frames: int  #: In which that pass is thought to be made


class NextMove:
    """Advises moves for a target.

    Candidates are the passes of a plan by hand: each is a move from where the probe is (turn, slide, tilt), and then a slide of
    some 18 mm across the image, or 36 mm along the spine. The one that adds most for its labor is advised, and stays advised until
    another is better by `STABLE` or it has nothing more to add.

    `target` as in `GuidedBone.target`; without a `hand` moves are expected to be made exactly.
    """

    def __init__(
        self,
        bone: GuidedBone,
        probe: ProbeOnBack,
        target: str = "interspinous",
        hand: Hand | None = HAND,
    ):
        self._bone, self._probe = bone, probe
        self.candidates = Candidates(freehand_passes(bone), bone, probe, target, hand)
        self._passes = self.candidates.passes
        self._advised: Pass | None = None

    def gains(self, met: CoverageAccumulator) -> Steps[Floats]:
        """What each candidate pass would add to what was met."""
        return self.candidates.gains(self.candidates.looked(met.support), ROUNDS)

    def advise(
        self, met: CoverageAccumulator, image_to_reference: Matrix, gains: Floats | None = None, progress: Progress | None = None
    ) -> Move | None:
        """What to do next from a pose, with the `gains` where they are known; None when nothing is worth its labor any more.

        Where gains are not known, candidate passes are looked at first, which takes some seconds.
        """
        if gains is None:
            self.candidates.look(progress)
            gains = carry_out(self.gains(met))
        now = self._probe.placement(image_to_reference)
        values = gains / np.array([one.least * (1.0 + LABOR * _labor(now, _middle(one))) for one in self._passes])
        worth = gains >= self.candidates.worth
        if not worth.any():
            self._advised = None
            return None
        best = int(np.argmax(np.where(worth, values, -1.0)))
        held = next((n for n, one in enumerate(self._passes) if one is self._advised), None)
        if held is not None and worth[held] and values[best] <= (1.0 + STABLE) * values[held]:
            best = held
        planned = self._passes[best]
        self._advised = planned
        there, adds = _middle(planned), float(gains[best]) / 100.0
        return Move(self._words(now, there, adds), adds, self._probe.pose(there), planned, ROUNDS * planned.least)

    def _words(self, now: ProbePlacement, there: ProbePlacement, adds: float) -> str:
        steps = listed(step.words for step in directions(now, there, self._bone.is_of_ct))
        return f"{steps} over {name_of_place(self._bone, there.z)}, adds {adds:.1f} cm2"


def directions(now: ProbePlacement, there: ProbePlacement, knows_head: bool = True) -> tuple[Direction, ...]:
    """Turn, slide, then tilt, told by where the beam then goes, not by the handle; where nothing of it is left, to sweep on.

    Where nobody knows the head, ways are those of the image that is there after the turn.
    """
    steps, ways = [], PATIENT
    turn = (there.turn_deg - now.turn_deg + 90.0) % 180.0 - 90.0
    is_other_way_round = np.cos(np.radians(there.turn_deg - now.turn_deg - turn)) < 0
    is_sagittal = abs(there.turn_deg) > TURNED_DEG
    if not knows_head:
        right, left, into, out = IMAGE if not is_other_way_round else (IMAGE[1], IMAGE[0], IMAGE[3], IMAGE[2])
        ways = (out, into, right, left) if is_sagittal else (right, left, into, out)
    if is_other_way_round:
        now = ProbePlacement(now.x, now.z, now.turn_deg + 180.0, -now.in_plane_deg, -now.across_deg)
    if abs(turn) > TURNED_DEG:
        plane, sense = "sagittal" if is_sagittal else "transverse", "counterclockwise" if turn > 0 else "clockwise"
        to = f"to {plane}" if knows_head else f"{abs(turn):.0f}° {sense}, seen from above"
        steps.append(Direction(TURN, f"turn the probe {to}"))
        now = ProbePlacement(now.x, now.z, there.turn_deg)
    for way, mm in zip(ways, (there.x - now.x, now.x - there.x, there.z - now.z, now.z - there.z), strict=True):
        if mm >= SMALLEST_MM:
            steps.append(Direction(way[0], f"slide {mm:.0f} mm {way[1]}"))
    right, left, up, down = ways
    # The normal of a sagittal image points to the left
    in_plane, across = ((up, down), (left, right)) if is_sagittal else ((right, left), (up, down))
    for sides, degrees in ((in_plane, there.in_plane_deg - now.in_plane_deg), (across, there.across_deg - now.across_deg)):
        if abs(degrees) >= SMALLEST_DEG:
            arrow, words = sides[int(degrees < 0)]
            steps.append(Direction(arrow, f"aim the beam {abs(degrees):.0f}° more {words}"))
    return tuple(steps) or (Direction(HERE, "keep sweeping here"),)


def _middle(planned: Pass) -> ProbePlacement:
    return planned.placements(1)[0]


def _labor(now: ProbePlacement, there: ProbePlacement) -> float:
    """How laborious it is to get there: slides, tilts and turns in units of `FAR_MM` and `FAR_DEG`."""
    turn = abs((there.turn_deg - now.turn_deg + 90.0) % 180.0 - 90.0)
    tilt = abs(there.in_plane_deg - now.in_plane_deg) + abs(there.across_deg - now.across_deg)
    return float(np.hypot(there.x - now.x, there.z - now.z) / FAR_MM + (turn + tilt) / FAR_DEG)

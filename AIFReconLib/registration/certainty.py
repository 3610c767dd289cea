"""What the echoes do not hold fast: motions of the CT that hardly change how well it agrees, in mm and degrees."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats
from ..bone.echoes.found import SweepEchoes
from ..bone.field import BoneField
from ..geometry.transforms import invert, transform_points
from .refine import MOST_ECHOES, SCALES, _Cost, refine, robust_cost, vector_motion
from .search import motion_between

LOSS = 0.02
"""A motion is held once it costs this much more: two echoes in a hundred."""

HELD_MM, HELD_DEG = 1.0, 3.0
"""Motions that are held within these are not named."""

FARTHEST_MM, FARTHEST_DEG = 20.0, 45.0
"""Nothing is followed farther."""

RESTARTS, RESTART_MM, RESTART_DEG = 4, 3.0, 3.0
"""Starts about the place that was found, from which it must be found again."""

ALONG = 0.94
"""Cosine to an axis of the CT, 20 degrees, from which on a motion is said to be along it."""


@dataclass(frozen=True, eq=False)
class UnconstrainedMotion:
    """A motion that the sweep does not hold."""

    kind: str  #: "slide" or "turn"
    axis: Floats  #: (3,), unit vector, Reference. Along which it slides, or about which it turns.
    amount: float  #: mm or degrees, either way, until `LOSS` is reached
    ct_axis: Floats  #: (3,). The same axis in the CT's own axes: right, front, head.
    reach: Floats  #: (6,). The motion by that amount as `vector_motion` has it, turns in mm of the lever

    @property
    def sentence(self) -> str:
        """In words."""
        axis = _words(self.ct_axis)
        if self.kind == "slide":
            return f"the CT may be {self.amount:.1f} mm off either way along {axis}"
        return f"the CT may be turned {self.amount:.0f} degrees either way about {axis}"


def _words(axis: Floats) -> str:
    """An axis of the CT as a clinician calls it; in numbers (right, front, head) where it is near none."""
    nearest = int(np.abs(axis).argmax())
    if abs(axis[nearest]) >= ALONG:
        return ("the left-right axis", "the front-back axis", "the head-feet axis")[nearest]
    return "the axis ({:.2f}, {:.2f}, {:.2f}) of the CT".format(*(axis + 0.0))


def not_held(echoes: SweepEchoes, bone: BoneField, labels_to_reference: Floats) -> list[UnconstrainedMotion]:
    """Motions that hardly matter to the agreement, the loosest first.

    The eigenvectors of Gauss-Newton's matrix at the optimum, `labels_to_reference`, are motions that do not depend on each other; the
    cost along each of small eigenvalue is followed until it has risen by `LOSS`. One that is mostly a shift is told as a slide, else as a
    turn.
    """
    chosen = echoes.thinned(MOST_ECHOES)
    least = robust_cost(chosen, bone, labels_to_reference)
    cost = _Cost(chosen, bone, labels_to_reference)
    distances, slopes = cost(np.zeros(6))
    # The mean over the echoes of w g g^T in 1 / mm^2, for motions about their center, turns in mm
    weights = np.exp(-0.5 * np.minimum((distances / SCALES[-1]) ** 2, 1e3))
    found = []
    for vector in np.linalg.eigh((slopes * weights[:, None]).T @ slopes / len(slopes))[1].T:
        slides = np.linalg.norm(vector[:3]) >= np.linalg.norm(vector[3:])
        axis = vector[:3] if slides else vector[3:]
        length = np.linalg.norm(axis)
        # Steps in units of the named motion: mm of the slide, radians of the turn
        unit = vector / length * (1.0 if slides else cost.lever)
        step, farthest = (0.25, FARTHEST_MM) if slides else (math.radians(0.5), math.radians(FARTHEST_DEG))

        def is_held(size: float, unit: Floats = unit) -> bool:
            steps = (vector_motion(sign * size * unit, cost.center, cost.lever) for sign in (-1, 1))
            return min(robust_cost(chosen, bone, by @ labels_to_reference) for by in steps) > least + LOSS

        amount = next(filter(is_held, np.arange(step, farthest + step, step).tolist()), farthest)
        reach = amount * unit
        amount = amount if slides else math.degrees(amount)
        if amount > (HELD_MM if slides else HELD_DEG):
            axis = axis / length
            axis = axis * np.sign(axis[np.abs(axis).argmax()])
            found.append(UnconstrainedMotion("slide" if slides else "turn", axis, float(amount), axis @ labels_to_reference[:3, :3], reach))
    return sorted(found, key=lambda one: -one.amount / (HELD_MM if one.kind == "slide" else HELD_DEG))


def as_given(echoes: SweepEchoes, bone: BoneField, place: Floats, start: Floats, loose: list[UnconstrainedMotion]) -> Floats:
    """The place without what it differs from the start by motions that the sweep does not hold, as far as it does not hold them.

    It is `place` itself where the echoes do not bear that out.
    """
    chosen = echoes.thinned(MOST_ECHOES)
    cost = _Cost(chosen, bone, place)
    motion = place @ invert(start)
    turn = scipy.spatial.transform.Rotation.from_matrix(motion[:3, :3]).as_rotvec()
    vector = np.concatenate([transform_points(motion, cost.center) - cost.center, cost.lever * turn])
    for one in loose:
        limit = np.linalg.norm(one.reach)
        along = one.reach / limit
        vector = vector - np.clip(vector @ along, -limit, limit) * along
    held = scipy.linalg.null_space(np.array([one.reach for one in loose]))
    kept = refine(echoes, bone, vector_motion(vector, cost.center, cost.lever) @ start, SCALES[-1:], free=held)
    allowed = robust_cost(chosen, bone, place) + len(loose) * LOSS
    return kept if robust_cost(chosen, bone, kept) <= allowed else place


def restart_spread(echoes: SweepEchoes, bone: BoneField, labels_to_reference: Floats) -> float:
    """How far apart places end, as the largest mean motion of the echoes in mm, that are refined anew from starts some mm and degrees
    away.
    """
    rng = np.random.default_rng(0)
    chosen, center = echoes.thinned(MOST_ECHOES // 2), echoes.thinned(MOST_ECHOES).points.mean(axis=0)
    spread = 0.0
    for _ in range(RESTARTS):
        move, axis = (vector / np.linalg.norm(vector) for vector in rng.standard_normal((2, 3)))
        vector = np.concatenate([RESTART_MM * move, math.radians(RESTART_DEG) * axis])
        again = refine(chosen, bone, vector_motion(vector, center) @ labels_to_reference, (4.0, 2.0, 1.0))
        spread = max(spread, motion_between(labels_to_reference, again, chosen.points))
    return spread

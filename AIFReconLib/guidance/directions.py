"""The way from where the probe is to where it should be, step by step, for someone who looks at the patient and not at the screen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.transforms import invert, transform_points
from ..message import Message
from .bone import GuidedBone
from .next_move import FEET, HEAD, LEFT, RIGHT, SMALLEST_DEG, SMALLEST_MM
from .probe import Placement

TURN, UP, DOWN, TO_LEFT, TO_RIGHT, HERE = "\u21bb", "\u2191", "\u2193", "\u2190", "\u2192", "\u25cf"
"""As on a prone patient's back, with the head up."""

TURNED_DEG = 45.0
"""Between a transverse and a sagittal image."""


@dataclass(frozen=True)
class Direction:
    """One step: an arrow for the eye, and words."""

    arrow: str
    words: Message


def directions(now: Placement, there: Placement) -> tuple[Direction, ...]:
    """Turn, slide, then tilt; where nothing of it is left, to sweep on."""
    steps = []
    if np.cos(np.radians(there.turn_deg - now.turn_deg)) < 0:
        # The same plane, held the other way round
        now = Placement(now.x, now.z, now.turn_deg + 180.0, -now.in_plane_deg, -now.across_deg)
    if abs((there.turn_deg - now.turn_deg + 90.0) % 180.0 - 90.0) > TURNED_DEG:
        plane = Message("sagittal") if abs(there.turn_deg) > TURNED_DEG else Message("transverse")
        steps.append(Direction(TURN, Message("turn to {plane}", plane=plane)))
        now = Placement(now.x, now.z, there.turn_deg)
    for (arrow, way), mm in (
        ((UP, HEAD), there.z - now.z),
        ((DOWN, FEET), now.z - there.z),
        ((TO_RIGHT, RIGHT), there.x - now.x),
        ((TO_LEFT, LEFT), now.x - there.x),
    ):
        if mm >= SMALLEST_MM:
            steps.append(Direction(arrow, Message("slide {mm:.0f} mm toward the {way}", mm=mm, way=way)))
    along, sideways = ((UP, HEAD), (DOWN, FEET)), ((TO_RIGHT, RIGHT), (TO_LEFT, LEFT))
    # The normal of a sagittal image points to the left
    in_plane, across = (along, sideways[::-1]) if abs(there.turn_deg) > TURNED_DEG else (sideways, along)
    for ways, degrees in ((in_plane, there.in_plane_deg - now.in_plane_deg), (across, there.across_deg - now.across_deg)):
        if abs(degrees) >= SMALLEST_DEG:
            arrow, way = ways[degrees < 0]
            steps.append(Direction(arrow, Message("tilt {degrees:.0f} degrees toward the {way}", degrees=abs(degrees), way=way)))
    return tuple(steps) or (Direction(HERE, Message("sweep on here")),)


def labels_under(bone: GuidedBone, placement: Placement) -> tuple[int, ...]:
    """The label, or the two labels, that a probe stands over, from head to feet."""
    to_patient = invert(bone.patient_to_reference)
    levels = {label: float(transform_points(to_patient, center[None])[0, 2]) for label, center in bone.centers.items()}
    nearest, *others = sorted(levels, key=lambda label: abs(levels[label] - placement.z))
    if others:
        # Within a quarter of the way to the next one, or beyond the last, it is over one alone
        way, off = levels[others[0]] - levels[nearest], placement.z - levels[nearest]
        if off * way > 0 and abs(off) >= 0.25 * abs(way):
            return tuple(sorted((nearest, others[0]), key=lambda label: -levels[label]))
    return (nearest,)

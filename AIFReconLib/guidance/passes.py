"""Passes that a probe can make over a back: straight slides at one tilt, and what a wearable device can do without sliding."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np

from ..arrays import Floats, Matrix
from ..geometry.transforms import invert, transform_points
from .bone import GuidedBone
from .probe import ProbeOnBack, ProbePlacement

STEP = 3.0
"""mm between the frames of a pass: the thickness of the beam."""

SAGITTAL_TILTS_DEG = (-38.0, -19.0, 0.0, 19.0, 38.0)
SAGITTAL_ACROSS_DEG = (-40.0, -25.0, 0.0, 25.0, 40.0)
TRANSVERSE_TILTS_DEG = (-35.0, -18.0, 0.0, 18.0, 35.0)
"""Within what the skin allows: beyond some 40 degrees a face loses contact."""

STEEPEST_DEG = 45.0
"""From straight ahead to the middle beam, of both tilts together."""

NARROW, WIDE = 9.0, 27.0
"""mm to either side of the midline: spinous processes and their gaps; laminae, facets and what can be seen of transverse processes."""

BETWEEN_PLACES = 15.0
"""mm along the spine between the places of sagittal passes."""

ALONG = 36.0
"""mm along the spine of one transverse pass: about a level."""

WEARABLE_TILT_DEG = 35.0
"""How far a wearable device tilts to either side, about two axes."""

WEARABLE_STEP_DEG = 5.0


@dataclass(frozen=True)
class Pass:
    """The probe goes from one placement to another, evenly."""

    name: str  #: In a sonographer's words
    start: ProbePlacement
    stop: ProbePlacement
    least: int  #: Frames below which gaps would open between their beams

    def placements(self, frames: int) -> list[ProbePlacement]:
        """Where each of so many frames is taken: in the middles of as many parts of the way."""
        start, stop = (np.array(astuple(end)) for end in (self.start, self.stop))
        return [ProbePlacement(*(start + part * (stop - start)).tolist()) for part in (np.arange(frames) + 0.5) / frames]

    def poses(self, probe: ProbeOnBack, frames: int | None = None) -> Matrix:
        """image_to_reference of its frames, (frames, 4, 4); `least` of them by default."""
        return probe.poses(self.placements(frames or self.least))


@dataclass(frozen=True)
class Hand:
    """Standard deviations of normal errors."""

    off_mm: float = 5.0
    off_deg: float = 5.0
    """Of a whole pass: of its place along each axis of the skin, and of each of the three angles."""
    wander_mm: float = 1.0
    wander_deg: float = 1.0
    """The same of each frame within the pass, on top of that."""

    def follow(self, placements: Sequence[ProbePlacement], rng: np.random.Generator) -> list[ProbePlacement]:
        """A pass as this hand makes it; another one with every call."""
        off = rng.standard_normal(5) * ([self.off_mm] * 2 + [self.off_deg] * 3)
        wander = rng.standard_normal((len(placements), 5)) * ([self.wander_mm] * 2 + [self.wander_deg] * 3)
        return [ProbePlacement(*(astuple(one) + by).tolist()) for one, by in zip(placements, off + wander, strict=True)]


HAND = Hand()
"""What plans and advice count on."""


def freehand_passes(bone: GuidedBone) -> list[Pass]:
    """Passes that a hand can make: sagittal ones across the spine, transverse ones along it."""
    points = _patient(bone, bone.surface.points_reference)
    low, high = np.quantile(points[:, 2], (0.02, 0.98))
    passes = []
    for z in _spread(low + 6.0, high - 6.0, BETWEEN_PLACES):
        where = name_of_place(bone, z)
        for tilt in SAGITTAL_TILTS_DEG:
            for across in SAGITTAL_ACROSS_DEG:
                # The normal of a sagittal image points to the left
                words = [_looking(tilt, "head", "feet")] if tilt or not across else []
                words += [_looking(across, "left", "right")] if across else []
                passes.append(_sagittal(", ".join([f"sagittal over {where}", *words]), z, tilt, across, -NARROW, NARROW))
                for side in (-1.0, 1.0):
                    if across * side >= 0:  # beside the midline, beams away from it meet nothing that others do not
                        place = f"sagittal {'right' if side > 0 else 'left'} of {where}"
                        passes.append(_sagittal(", ".join([place, *words]), z, tilt, across, side * NARROW, side * WIDE))
    for z in _spread(low, high, ALONG):
        where = name_of_place(bone, z)
        for across in TRANSVERSE_TILTS_DEG:
            for in_plane in TRANSVERSE_TILTS_DEG:
                start = ProbePlacement(0.0, z - ALONG / 2, 0.0, in_plane, across)
                words = [f"transverse along {where}"]
                words += [_looking(across, "head", "feet")] if across else []
                words += [f"{abs(in_plane):g} degrees toward the {'right' if in_plane > 0 else 'left'}"] if in_plane else []
                passes.append(Pass(", ".join(words), start, replace(start, z=z + ALONG / 2), round(ALONG / STEP)))
    return [one for one in passes if one.start.tilt_deg <= STEEPEST_DEG]


def _sagittal(name: str, z: float, tilt: float, across: float, first: float, last: float) -> Pass:
    start = ProbePlacement(first, z, 90.0, tilt, across)
    return Pass(name, start, replace(start, x=last), round(abs(last - first) / STEP))


def wearable_passes(place: tuple[float, float], turn_deg: float) -> list[Pass]:
    """Passes of a device that is strapped on at one place and tilts about two axes, by 35 degrees to either side, without sliding."""
    tilts = np.arange(-WEARABLE_TILT_DEG, WEARABLE_TILT_DEG + 1.0, WEARABLE_STEP_DEG)
    passes = []
    for tilt in tilts:
        start = ProbePlacement(*place, turn_deg, float(tilt), -WEARABLE_TILT_DEG)
        name = f"{'transverse' if turn_deg == 0 else 'sagittal'}, tilted {tilt:+g} degrees in the plane, swept across it"
        passes.append(Pass(name, start, replace(start, across_deg=WEARABLE_TILT_DEG), round(2 * WEARABLE_TILT_DEG / 3.0)))
    return passes


def wearable_places(bone: GuidedBone, target: Floats) -> list[tuple[float, float]]:
    """Where on the midline a device may be strapped on for a target, (n, 3) points in Reference: over its middle, and a step beside."""
    z = float(np.median(_patient(bone, target)[:, 2]))
    return [(0.0, z + shift) for shift in (-BETWEEN_PLACES, 0.0, BETWEEN_PLACES)]


def labels_under(bone: GuidedBone, z: float) -> tuple[int, ...]:
    """The label, or the two from head to feet, that a place along the spine (mm to the head) lies over; none where there is no CT."""
    if not bone.is_of_ct:
        return ()
    levels = {label: float(_patient(bone, center[None])[0][2]) for label, center in bone.centers.items()}
    nearest, *others = sorted(levels, key=lambda label: abs(levels[label] - z))
    if others:
        # Within a quarter of the way to the next one, or beyond the last, it is over one alone
        way, off = levels[others[0]] - levels[nearest], z - levels[nearest]
        if off * way > 0 and abs(off) >= 0.25 * abs(way):
            return tuple(sorted((nearest, others[0]), key=lambda label: -levels[label]))
    return (nearest,)


def name_of_place(bone: GuidedBone, z: float) -> str:
    """What it lies over, in words: ``L3``, ``L3 and L4``, ``labels 2 and 3``; ``the bone`` where there is no CT."""
    if not bone.is_of_ct:
        return "the bone"
    upper, lower = (*(under := labels_under(bone, z)), under[-1])[:2]
    if upper == lower:
        return f"{bone.name_of(upper)}" if bone.names.get(upper) else f"label {upper}"
    if bone.names.get(upper) and bone.names.get(lower):
        return f"{bone.name_of(upper)} and {bone.name_of(lower)}"
    return f"labels {upper} and {lower}"


def _looking(tilt: float, positive: str, negative: str) -> str:
    return "straight" if tilt == 0 else f"{abs(tilt):g} degrees toward the {positive if tilt > 0 else negative}"


def _spread(low: float, high: float, step: float) -> Iterable[float]:
    """Places from low to high about `step` apart, in the middles of equal parts."""
    count = max(round((high - low) / step), 1)
    return [float(low + (high - low) * (n + 0.5) / count) for n in range(count)]


def _patient(bone: GuidedBone, points_reference: Floats) -> Floats:
    return transform_points(invert(bone.patient_to_reference), points_reference)

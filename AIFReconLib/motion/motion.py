"""What is found of a patient's motion in a scan, in words and numbers, and the recording with it taken out.

References
----------
Kuklisova-Murgasova M, Quaghebeur G, Rutherford MA, Hajnal JV, Schnabel JA (2012), Reconstruction of fetal brain MRI with intensity matching
and complete outlier removal, Medical Image Analysis 16:1550-1564: slices laid on what all slices show, in turns, outliers left out. Chen Y,
Medioni G (1992), Object modelling by registration of multiple range images, Image and Vision Computing 10:145-155: views laid on each
other's planes. Geman S, McClure DE (1987), Statistical methods for tomographic image reconstruction: the loss.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ..arrays import Floats, Integers, Mask, Matrix
from ..bone.echoes.found import SweepEchoes
from ..bone.echoes.search import sweep_echoes
from ..errors import AIFReconError, OperationCanceled
from ..geometry.transform_graph import TransformStatus
from ..geometry.transforms import invert
from ..message import listed
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..sweep.frames import FrameRecord, TrackedSequence
from ..sweep.multi_sweep import joined, sweeps_of
from ..sweep.poses import chain_ends, poses_of_each
from .passes import Passes, passes_of
from .solve import BOTH, CALIBRATION_ALONE, FINE, MOST_ECHOES, BoneInPlace, MotionCurve, onto_bone, planes_of, solved

MOST_FRAMES = 600
"""Frames of all sweeps together whose echoes are looked at."""

STILL, STILL_ON_BONE = 0.48, 0.35
"""mm that a pass lies off the others, and off a CT's bone, in the median, up to which nobody looks for motion. At rest
they are 0.37 to 0.39 with half of the frames, and 0.2 to 0.25."""

FAR, SEEN_TWICE, SHARE = 6.0, 0.2, 0.03
"""mm to the farthest neighbor, the share of echoes that two passes must show, and that of a pass to count."""

GAIN, LEAST = 0.85, 0.5
"""Part of their distance that echoes may keep which had no say, and mm (root mean square) that a motion must have, to be applied."""

SIMPLER = 1.25
"""Times farther off each other that a calibration may lay the passes than a motion does, and explain them all the same: it has six
numbers for all frames. Where the calibration is wrong that is 0.9 to 1.15, where the patient breathes 2 mm from 2.1 on."""

CLOSE, CLOSE_TO_BONE, LAID_ON_BONE = 1.1, 0.5, 0.7
"""mm that the worst pass may lie off the others afterwards, and off the CT's bone: 0.4 to 0.6 and 0.2 to 0.3 where a motion is right, and
up to 0.5 where passes were laid on each other first; one that was laid beside its CT is 2.6 mm off. Where passes have few frames nothing
comes so close, and without a CT nothing is done."""

COMMON = 5.0
"""mm that all frames together may be moved onto a CT. Beyond, it is the CT that is off."""

TOLD, PLAINLY = 1.0, 1.0
"""mm from which a pass is named, and between echoes that no motion explains from which there is a warning."""

UNEXPLAINED = (
    "The reference may have slipped, the depth may have changed, a calibration may be wrong, or the recordings may be of two patients."
)
"""What contradicts itself without a motion."""

CANNOT_TELL = "this sweep cannot tell whether the patient moved: that takes passes over the same bone"

PERIODS, BREATHES = np.arange(2.0, 8.01, 0.1), 0.6
"""s that a breath may last, and the share of the motion that breathing must explain to be named."""

LOOSE, HALF, HINDERS = 0.7, 0.5, 1.1
"""mm to which the echoes of a pass must hold it along a direction, else it stays there; the share of an axis that is named for it; and by
how much farther off each other passes that stay there may lie without a CT, by frames that had no say: farther, and they moved."""

AXES = ("x", "y", "z")
"""Of Reference: how the patient lies to a tracker nobody knows."""


@dataclass(frozen=True, eq=False)
class PatientMotion:
    """How a patient moved against the reference during a scan, as its bone echoes tell."""

    curve: MotionCurve
    before: float  #: mm. How far the worst pass lies off the others, see `apart`; by frames that had no say where it is applied.
    after: float  #: mm. The same with the motion taken out.
    applied: bool  #: Whether it is to be taken out
    loose: tuple[str, ...] = ()  #: Directions that the echoes do not hold, left at rest
    echoes: SweepEchoes | None = field(default=None, repr=False)  #: That showed it, where they lie now

    @cached_property
    def shifts(self) -> Floats:
        """(frames, 3), mm. How far the patient was from the middle of the scan at each frame; NaN for frames without a pass."""
        curve, frames = self.curve, np.flatnonzero(self.curve.passes.numbers >= 0)
        shifts = np.full((len(curve.knots), 3), np.nan)
        matrices = curve.motions[frames]
        # A turn of a pass and shifts along it may stand for each other: what they do to the bone in the image tells
        places = curve.places[frames]
        at = np.einsum("nij,nj->ni", matrices[:, :3, :3], places) + matrices[:, :3, 3] - places
        shifts[frames] = at.mean(axis=0) - at
        return shifts

    @property
    def size(self) -> float:
        """mm, root mean square over the frames; or how far the calibration is off, if that is more."""
        return max(float(np.sqrt(np.nanmean((self.shifts**2).sum(axis=1)))), self.curve.calibration_off)

    @property
    def alone(self) -> PatientMotion:
        """What of it is the patient's; what is wrong with the calibration stays in the sweep."""
        return replace(self, curve=replace(self.curve, calibration=np.eye(4)))

    @property
    def is_calibration(self) -> bool:
        """Whether a calibration that is off explains all of it."""
        return bool(self.applied and not np.ptp(self.curve.shifts, axis=0).any())

    @cached_property
    def breath(self) -> tuple[float, float] | None:
        """mm to either side, and s from breath to breath; None where the patient is not seen to breathe."""
        known = np.isfinite(self.shifts[:, 0])
        shifts, times = self.shifts[known], self.curve.passes.times[known]
        best = (BREATHES, 0.0, 0.0)
        if np.ptp(times) > 2 * PERIODS[0] and len(self.curve.turns) < len(self.curve.shifts):
            for period in PERIODS[np.ptp(times) / 2 > PERIODS]:
                angle = 2 * np.pi * times / period
                waves = np.stack([np.cos(angle), np.sin(angle), np.ones_like(angle)], axis=1)
                found = np.linalg.lstsq(waves, shifts, rcond=None)[0]
                share = 1 - ((shifts - waves @ found) ** 2).sum() / max((shifts**2).sum(), 1e-9)
                if share > best[0]:
                    best = (float(share), float(np.linalg.svd(found[:2])[1][0]), float(period))
        return best[1:] if best[2] else None

    @property
    def off(self) -> Floats:
        """(passes,), mm. How far each pass lies off the middle of all."""
        numbers = self.curve.passes.numbers
        means = np.array([np.nanmean(self.shifts[numbers == n], axis=0) for n in range(len(self.curve.turns))])
        off: Floats = np.linalg.norm(means - np.median(means, axis=0), axis=1)
        return off

    @property
    def lines(self) -> tuple[str, ...]:
        """All of it, in sentences."""
        if not self.applied:
            if not self.unexplained:
                return (f"{self.still[:1].upper()}{self.still[1:]}.",)
            apart = f"Passes show the bone {self.before:.1f} mm apart"
            return (f"WARNING: {apart}, and no motion of the patient explains it. {self.unexplained}",)
        lines = [self.moved]
        if self.is_calibration:
            lines = [f"WARNING: {self.moved} Calibrate anew."]
        if self.loose:
            lines.append(f"Along {listed(self.loose)} of Reference the echoes do not hold it; there nothing is moved.")
        return (*lines, f"Mended: echoes lie {self.after:.1f} mm apart, before {self.before:.1f}.")

    @property
    def still(self) -> str:
        """That there was none, as part of a sentence."""
        return f"the patient lay still: no pass shows the bone more than {self.before:.1f} mm off"

    @property
    def unexplained(self) -> str:
        """What it may be where frames contradict each other, and no motion explains it; else empty."""
        return UNEXPLAINED if not self.applied and self.before > PLAINLY else ""

    @property
    def moved(self) -> str:
        """How, in a sentence."""
        if self.is_calibration:
            return f"The patient lay still, but the calibration is {self.curve.calibration_off:.1f} mm off."
        if self.breath is not None:
            return f"The patient breathed: {self.breath[0]:.1f} mm, every {self.breath[1]:.1f} s."
        off = self.off
        named = np.flatnonzero(off > TOLD)
        if len(named) == 1:
            return f"Pass {named[0] + 1} lies {off[named[0]]:.1f} mm off the others."
        if 1 < len(named) <= len(off) / 2:
            which = listed(str(n + 1) for n in named)
            return f"Passes {which} lie {off[named].min():.1f} to {off[named].max():.1f} mm off the others."
        return f"The patient moved by up to {np.nanmax(np.linalg.norm(self.shifts, axis=1)):.1f} mm."


def motion_of(echoes: SweepEchoes, passes: Passes, bone: BoneInPlace | None = None, progress: Progress | None = None) -> PatientMotion:
    """The motion that echoes show, judged on every other frame."""
    report(progress, 0.0, "Looking for motion of the patient")
    tried: Mask = np.isin(echoes.frames, np.unique(echoes.frames)[::2])
    rest, asked = MotionCurve.none(passes, echoes), echoes[~tried]
    before = apart(asked, rest, bone)
    # Half of the frames of a sparse sweep lie farther off each other than they do with the frames between
    contradiction = apart(echoes, rest, bone)
    still = PatientMotion(rest, contradiction, contradiction, False, echoes=echoes)
    if not moves(asked, passes, bone):
        return still
    alone, _ = solved(echoes[tried], rest, bone, free=CALIBRATION_ALONE, progress=part(progress, 0.0, 0.2))
    half, information = solved(echoes[tried], rest, bone, progress=part(progress, 0.2, 0.5))
    if (loose := _loose(half, information)).any():
        held, _ = solved(echoes[tried], rest, bone, loose, progress=part(progress, 0.5, 0.7))
        if bone is None and apart(asked, held) > HINDERS * apart(asked, half):
            loose[:] = 0.0
        else:
            half = held
    is_simple = apart(asked, alone, bone) <= SIMPLER * apart(asked, half, bone)
    half = _in_the_middle(alone if is_simple else half, echoes, bone)
    after = apart(asked, half, bone)
    borne_out = after <= min(GAIN * before, CLOSE if bone is None else np.inf) and (
        bone is None or off_the_bone(asked, half, bone) <= min(GAIN * off_the_bone(asked, rest, bone), CLOSE_TO_BONE)
    )
    if not borne_out or PatientMotion(half, before, after, False).size < LEAST:
        return still if bone is None else _by_echoes_first(echoes, passes, bone, part(progress, 0.6, 1.0))
    free = CALIBRATION_ALONE if is_simple else BOTH
    curve = _in_the_middle(solved(echoes, half, bone, loose, FINE, free, part(progress, 0.7, 1.0))[0], echoes, bone)
    stays = np.median(loose, axis=0).diagonal() * (not is_simple)
    names = tuple(name for name, share in zip(AXES, stays, strict=True) if share > HALF)
    return PatientMotion(curve, before, after, True, names, curve.moved(echoes))


def _by_echoes_first(echoes: SweepEchoes, passes: Passes, bone: BoneInPlace, progress: Progress | None) -> PatientMotion:
    """Passes laid on each other alone, and then, where that bears it out, all of them on the CT's bone."""
    found = motion_of(echoes, passes, None, progress)
    if found.echoes is None or not found.applied:
        return found
    laid = found.curve.then(onto_bone(found.echoes, passes, bone))
    curve = _in_the_middle(solved(echoes, laid, bone, stages=FINE)[0], echoes, bone)
    if off_the_bone(echoes, curve, bone) > LAID_ON_BONE or apart(echoes, curve) > max(CLOSE, found.after):
        return found
    return replace(found, curve=curve, echoes=curve.moved(echoes))


def apart(echoes: SweepEchoes, curve: MotionCurve, bone: BoneInPlace | None = None) -> float:
    """mm. Median distance of a pass's echoes to the surface that the others show, of the pass where it is largest.

    Where no two passes show the same bone it is the distance to the CT's bone; NaN without one.
    """
    points, owners = curve.moved(echoes).points, curve.passes.numbers[echoes.frames]
    chosen = np.unique(np.linspace(0, len(points) - 1, MOST_ECHOES).astype(np.int64))
    planes = planes_of(points, owners, chosen, FAR)
    if len(planes.rows) > SEEN_TWICE * len(chosen):
        return _worst(np.abs(planes.off(points)), owners[planes.rows])
    return np.nan if bone is None else off_the_bone(echoes, curve, bone)


def off_the_bone(echoes: SweepEchoes, curve: MotionCurve, bone: BoneInPlace) -> float:
    """mm. Median distance of a pass's echoes to the CT's bone, of the pass where it is largest."""
    off = np.abs(bone.sample(curve.moved(echoes).points)[0])
    near = off < FAR
    return _worst(off[near], curve.passes.numbers[echoes.frames[near]])


def _worst(off: Floats, owners: Integers) -> float:
    """The largest median over the owners, but for those who own next to nothing."""
    counts = np.bincount(owners)
    return max((float(np.median(off[owners == n])) for n in np.flatnonzero(counts > SHARE * len(off))), default=np.nan)


def _in_the_middle(curve: MotionCurve, echoes: SweepEchoes, bone: BoneInPlace | None) -> MotionCurve:
    """The motion without what all frames have in common, but for the little that lays them on a CT.

    Echoes tell how passes lie to each other, not where all of them lie: that holds for a calibration that is off as well.
    """
    by = (curve.moved(echoes).points - echoes.points).mean(axis=0)
    if bone is not None and np.linalg.norm(by) <= COMMON:
        return curve
    return replace(curve, shifts=curve.shifts - by)


def _loose(curve: MotionCurve, information: Matrix) -> Matrix:
    """Onto the directions along which the echoes of each pass do not hold it, (passes, 3, 3)."""
    count, begin = len(curve.shifts), 3 * len(curve.turns)
    blocks = information[begin:-6, begin:-6].reshape(count, 3, count, 3).transpose(0, 2, 1, 3)
    loose = np.zeros((len(curve.turns), 3, 3))
    for number in range(len(curve.turns)):
        mine = curve.owners == number
        held, axes = np.linalg.eigh(blocks[np.ix_(mine, mine)].sum(axis=(0, 1)))
        free = axes[:, held < 1 / LOOSE**2]
        loose[number] = free @ free.T
    return loose


def find_motion(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    bone: BoneInPlace | None = None,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
    known: SweepEchoes | None = None,
) -> PatientMotion | None:
    """The motion of the patient in sweeps of one Reference; None where the sweep cannot tell it.

    Parameters
    ----------
    bone : BoneInPlace or None
        A CT's bone where it lies.
    known : SweepEchoes or None
        Echoes of some frames, by which it is told that nothing moved.
    """
    recipe = recipe or Recipe()
    sweeps = sweeps_of(sequences, recipe)
    try:
        passes = passes_in(sweeps, recipe)
        if known is not None and not moves(known, passes, bone):
            rest, off = MotionCurve.none(passes, known), off_at_rest(known, passes, bone)
            return PatientMotion(rest, off, off, False)
        echoes = sweep_echoes(sweeps, recipe, most_frames=MOST_FRAMES, progress=part(progress, 0.0, 0.4))
    except OperationCanceled:
        raise
    except AIFReconError:
        return None
    return motion_of(echoes, passes, bone, part(progress, 0.4, 1.0))


def passes_in(sweeps: list[TrackedSequence], recipe: Recipe | None = None) -> Passes:
    """The passes of sweeps in one Reference."""
    recipe = recipe or Recipe()
    return passes_of(sweeps, poses_of_each(sweeps, recipe.image_to_reference, recipe.reference))


def off_at_rest(echoes: SweepEchoes, passes: Passes, bone: BoneInPlace | None = None) -> float:
    """mm that the worst pass lies off the others or, where there is one, off the CT's bone, as it was recorded."""
    rest = MotionCurve.none(passes, echoes)
    return apart(echoes, rest) if bone is None else off_the_bone(echoes, rest, bone)


def moves(echoes: SweepEchoes, passes: Passes, bone: BoneInPlace | None = None) -> bool:
    """Whether it is worth looking for motion."""
    return off_at_rest(echoes, passes, bone) > (STILL if bone is None else STILL_ON_BONE)


def taken_out(sequence: TrackedSequence, motion: PatientMotion, recipe: Recipe | None = None) -> TrackedSequence:
    """The recording with the motion taken out of its poses, and with notes that say so."""
    recipe, first, mended = recipe or Recipe(), 0, []
    for sweep in sequence.sweeps:
        mended.append(_moved(sweep, motion.curve.matrices[first : first + len(sweep)], recipe))
        first += len(sweep)
    return with_notes(joined(mended), motion.lines)


def with_notes(sequence: TrackedSequence, notes: Iterable[str]) -> TrackedSequence:
    """The recording with more to be said of it."""
    return replace(sequence, notes=(*sequence.notes, *notes))


def _moved(sweep: TrackedSequence, motions: Matrix, recipe: Recipe) -> TrackedSequence:
    """The sweep with Reference moved in each frame: what ends there goes through the motion."""
    frame = chain_ends(sweep.configuration, recipe.image_to_reference, recipe.reference)[0].target
    static = {name: sample for name, sample in {**sweep.configured(), **sweep.transforms}.items() if frame in (name.source, name.target)}

    def changed(record: FrameRecord, motion: Matrix) -> FrameRecord:
        transforms = {**static, **record.transforms}
        for name, sample in transforms.items():
            if sample.status is TransformStatus.OK and name.target == frame:
                transforms[name] = replace(sample, matrix=motion @ sample.matrix)
            elif sample.status is TransformStatus.OK and name.source == frame:
                transforms[name] = replace(sample, matrix=sample.matrix @ invert(motion))
        return replace(record, transforms=transforms)

    kept = {name: sample for name, sample in sweep.transforms.items() if name not in static}
    return replace(sweep, records=list(map(changed, sweep.records, motions)), transforms=kept)

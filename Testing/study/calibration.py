"""Is a wrong calibration found from the scan itself, does the check tell what is wrong, and do both say so where a sweep cannot tell?

    python Testing/study calibration --output study-output/calibration

writes calibration.md and three more tables. About ten minutes per patient and core; an interrupted study goes on where it stopped.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from measured import shown, table
from scipy.spatial.transform import Rotation

from AIFReconLib.calibration.calibration import Calibration, calibrate
from AIFReconLib.calibration.check import checked
from AIFReconLib.calibration.crossing import calibrate_by_crossing
from AIFReconLib.calibration.echoes import Correction, ImagedEchoes
from AIFReconLib.calibration.solve import Solved
from AIFReconLib.errors import AIFReconError
from AIFReconLib.geometry.transform_graph import TransformName
from AIFReconLib.geometry.transforms import affine, invert, transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import (
    PROBE_TO_TRACKER,
    REFERENCE_TO_TRACKER,
    ProbePath,
    TrackingErrors,
    multi_angle_sweep,
    random_rigid,
    recorded_poses,
    simulate_sweep,
)
from AIFReconLib.sweep.edits import inverted
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

from .calibration_halves import halves_on_bone
from .command import Study
from .lumbar_shapes import lumbar_shapes
from .method_cases import EFFECTS, configured, turned_marker
from .real_bone_cases import RealBone

FRAMES, PASSES = 270, 9
CHOSEN_PASSES = {"three angles": (3, 4, 7), "five angles": (1, 3, 4, 5, 7), "nine angles": tuple(range(PASSES))}
"""Of three tilts in the image and three across it; neighbors run to and fro."""

CALIBRATE, WITHOUT_CT, CHECKS = "calibrate", "calibrate without a CT", ("check", "check without")

ONE_WAY, ONE_ANGLE, RIGHT = "nine angles, one direction", "one angle", "a right calibration"
DRAWN = 3
"""Wrong calibrations for each number of angles."""

SHIFT_MM, TURN_DEG, SCALE, DELAY = 5.0, 3.0, 0.03, 0.06
"""The largest errors; the smallest are a third of them, those of size and delay 0."""

DEPTHS_MM = (10.0, 70.0)
"""Where points of the image are asked for, under the face."""

WITHIN_MM = 0.4, 0.8
"""What image points placed rightly lie within: in the median, and 95 of 100."""

FAST_TISSUE = 1.03
"""Times the speed that the scanner takes."""


@dataclass(frozen=True)
class Row:
    """One calibration or check, and what came of it."""

    patient: int
    kind: str  #: `CALIBRATE`, `WITHOUT_CT`, or one of `CHECKS`: with the CT, and without
    case: str
    accepted: bool  #: A calibration is given; of a check: it told something wrong
    right: bool  #: Within `WITHIN_MM`; of a check: it told what is wrong, or, of a right one, nothing
    said: str
    before: float = math.nan  #: mm. Median error of image points by the calibration as given, the CT's place refined
    median: float = math.nan
    worst: float = math.nan  #: 95 of 100
    echoes: float = math.nan  #: mm. Median error of the bone echoes
    stated: float = math.nan  #: mm. What it says that is within, 9 times in 10
    delay_ms: float = math.nan  #: Error of the delay, where it is held


@dataclass(frozen=True, eq=False)
class Case:
    """A sweep that was recorded with a mistake, and where its pixels truly are."""

    sequence: TrackedSequence
    true: TrackedSequence
    delay: float = 0.0  #: s by which poses are late


@dataclass(frozen=True, eq=False)
class Patient:
    """A back with one simulated sweep, of which poses and calibration are recorded anew for every case."""

    seed: int
    probe: PhasedArray
    path: ProbePath
    images: np.ndarray
    labels: Volume
    ct_to_reference: np.ndarray

    @classmethod
    def scanned(cls, seed: int, speed: float = 1.0) -> Patient:
        """Scan the back of a seed; its CT lies in a frame of its own."""
        back, probe = lumbar_shapes(seed + 1), PhasedArray()
        path = multi_angle_sweep(back, FRAMES)
        effects = replace(EFFECTS, speed_of_sound=EFFECTS.speed_of_sound * speed)
        place = random_rigid(25.0, 8.0, np.random.default_rng([seed, 7]), (0.0, 40.0, 0.0))
        images = np.asarray(simulate_sweep(back, probe, path, effects=effects, seed=seed).images)
        return cls(seed, probe, path, images, back.labels.placed_by(invert(place)), place)

    def case(
        self, passes: tuple[int, ...], errors: TrackingErrors | None = None, image_to_probe: np.ndarray | None = None, mirror: bool = False
    ) -> Case:
        """Some passes, with such poses and such a calibration."""
        chosen = np.isin(np.arange(FRAMES) * PASSES // FRAMES, passes)
        images = self.images[chosen][:, :, ::-1] if mirror else self.images[chosen]
        errors = errors or TrackingErrors()
        sweeps = []
        for wrong, matrix in ((errors, image_to_probe), (TrackingErrors(), None)):
            records = [one for one, kept in zip(recorded_poses(self.probe, self.path, wrong, self.seed), chosen, strict=True) if kept]
            sweeps.append(configured(TrackedSequence(images, records), self.probe, matrix))
        return Case(sweeps[0], sweeps[1], errors.time_offset)

    def wrong_calibration(self, rng: np.random.Generator, scale: tuple[float, float] = (1.0, 1.0)) -> np.ndarray:
        """Shifted and turned at the middle of the image, its pixels of another size."""
        middle = np.array([(self.probe.columns - 1) / 2, self.probe.rows / 2, 0.0])
        sized = affine(np.diag([*scale, 1.0]), middle * (1.0 - np.array([*scale, 1.0])))
        about = transform_points(self.probe.image_to_transducer, middle[None])[0]
        moved = random_rigid(SHIFT_MM * rng.uniform(1 / 3, 1), TURN_DEG * rng.uniform(1 / 3, 1), rng, about)
        return self.probe.transducer_to_probe @ moved @ self.probe.image_to_transducer @ sized


def patient_rows(seed: int) -> list[Row]:
    """All calibrations and checks of one patient."""
    patient, rng = Patient.scanned(seed), np.random.default_rng([seed, 80])
    rows = []
    for name, passes in CHOSEN_PASSES.items():
        for _ in range(DRAWN):
            scale = tuple(1.0 + SCALE * rng.uniform(-1, 1, 2))
            late = TrackingErrors(time_offset=DELAY * rng.uniform(-1, 1))
            case = patient.case(passes, late, patient.wrong_calibration(rng, scale))
            rows += [asked(patient, name, case) for asked in (_calibrated, _crossed)]
        rows += [asked(patient, f"{RIGHT}, {name}", patient.case(passes)) for asked in (_calibrated, _crossed)]
    every = CHOSEN_PASSES["nine angles"]
    wrong = patient.wrong_calibration(rng)
    others = {
        ONE_WAY: patient.case(every[::2], TrackingErrors(time_offset=0.04), wrong),
        ONE_ANGLE: patient.case(every[4:5], None, wrong),
        "the tracker drifts by 2 mm": patient.case(every, TrackingErrors(drift=2.0)),
    }
    rows += [_calibrated(patient, name, case) for name, case in others.items()]
    fast = Patient.scanned(seed, FAST_TISSUE)
    tissue = fast.case(every)
    image_to_probe = patient.probe.image_to_probe @ _about_face(FAST_TISSUE, FAST_TISSUE, patient.probe)
    true = configured(tissue.true, patient.probe, image_to_probe)
    rows.append(_calibrated(fast, f"tissue {FAST_TISSUE - 1:.0%} faster", replace(tissue, true=true)))
    for name, (case, told) in mistakes(patient, rng).items():
        rows += [_checked(patient, kind, name, case, told) for kind in CHECKS]
    return rows


def mistakes(patient: Patient, rng: np.random.Generator) -> dict[str, tuple[Case, str]]:
    """Cases of the check by their names, with what of its sentence tells the mistake; nothing of a right calibration."""
    probe, every = patient.probe, CHOSEN_PASSES["nine angles"]
    right, calibration = patient.case(every), patient.probe.image_to_probe

    def turned(axis: int) -> Case:
        turn = np.diag([1.0 if k == axis else -1.0 for k in range(3)] + [1.0])
        return replace(right, sequence=turned_marker(right.sequence, [turn] * len(right.sequence)))

    def sized(across: float, along: float) -> Case:
        return patient.case(every, image_to_probe=calibration @ _about_face(across, along, probe))

    def inverse(name: TransformName) -> Case:
        return replace(right, sequence=inverted(right.sequence, name))

    return {
        "right": (right, ""),
        "images mirrored": (patient.case(every, mirror=True), "mirrored"),
        "images mirrored, calibration off": (patient.case(every, None, patient.wrong_calibration(rng), mirror=True), "mirrored"),
        **{f"marker turned about {'xyz'[axis]}": (turned(axis), f"180 degrees about its {'xyz'[axis]} axis") for axis in range(3)},
        "ProbeToTracker inverse": (inverse(PROBE_TO_TRACKER), "ProbeToTracker looks recorded as its inverse"),
        "ReferenceToTracker inverse": (inverse(REFERENCE_TO_TRACKER), "ReferenceToTracker looks recorded as its inverse"),
        "pixels 20% too wide": (sized(1.2, 1.0), "as wide"),
        "pixels 20% too high": (sized(1.0, 1.2), "as high"),
        "pixels 20% too large": (sized(1.2, 1.2), "as wide"),
        "speed of sound 5% off": (sized(1.0, 1.05), "size along"),
        "60 ms late": (patient.case(every, TrackingErrors(time_offset=0.06)), "out of step"),
        "shifted and turned": (patient.case(every, None, patient.wrong_calibration(rng)), "image points lie"),
    }


def _about_face(across: float, along: float, probe: PhasedArray) -> np.ndarray:
    """Pixels of other sizes, (4, 4): the middle of the probe's face stays."""
    face = invert(probe.image_to_transducer)[:3, 3]
    sized = np.array([across, along, 1.0])
    return affine(np.diag(sized), face - sized * face)


def _calibrated(patient: Patient, name: str, case: Case) -> Row:
    try:
        found = calibrate(case.sequence, patient.labels)
    except AIFReconError as error:
        return Row(patient.seed, CALIBRATE, name, False, False, str(error))
    pixels, solved = _image_points(patient.probe), Solved(found.labels_to_reference, found.correction, 0.0)
    off = [_misplaced(patient, case, found, *how) for how in ((found.given, pixels), (solved, pixels), (solved, None))]
    delay = found.correction.delay if found.held[-1] else math.nan
    row = _judged(patient, CALIBRATE, name, case, found.accepted, found.refusal or found.advice or "", off, delay)
    return replace(row, stated=found.uncertainty)


def _crossed(patient: Patient, name: str, case: Case) -> Row:
    """The same without a CT: where all of it lies is not asked."""
    try:
        found = calibrate_by_crossing(case.sequence)
    except AIFReconError as error:
        return Row(patient.seed, WITHOUT_CT, name, False, False, str(error))
    none, pixels = Correction.none(found.echoes.center), _image_points(patient.probe)
    ways = (none, pixels), (found.correction, pixels), (found.correction, None)
    off = [_shapes_apart(*_placed(case, found.echoes, *how)) for how in ways]
    return _judged(patient, WITHOUT_CT, name, case, found.accepted, found.refusal or "", off, found.correction.delay)


def _judged(patient: Patient, kind: str, name: str, case: Case, accepted: bool, said: str, off: Sequence[np.ndarray], delay: float) -> Row:
    """The row of a calibration: mm by which image points are off before, after, and echoes after."""
    before, median, echoes = (float(np.median(each)) for each in off)
    worst = float(np.quantile(off[1], 0.95))
    right = median <= WITHIN_MM[0] and worst <= WITHIN_MM[1]
    late = float(1e3 * abs(delay - case.delay))
    return Row(patient.seed, kind, name, accepted, bool(right), said, before, median, worst, echoes, delay_ms=late)


def _image_points(probe: PhasedArray) -> np.ndarray:
    """Pixels of the sector, evenly, (n, 2)."""
    depths, angles = np.linspace(*DEPTHS_MM, 7) + probe.apex_offset, np.linspace(-0.9, 0.9, 7) * probe.half_angle
    points = np.stack([np.outer(depths, np.sin(angles)), np.outer(depths, np.cos(angles))], axis=-1).reshape(-1, 2)
    return np.asarray(probe.apex_px) + points / probe.pixel_spacing


def _misplaced(patient: Patient, case: Case, found: Calibration, solved: Solved, pixels: np.ndarray | None) -> np.ndarray:
    """mm by which pixels of every frame with echoes, (n, 2), or its echoes are placed beside where they are in the CT."""
    here, there = _placed(case, found.echoes, solved.correction, pixels)
    in_ct = transform_points(invert(solved.labels_to_reference), here)
    return np.linalg.norm(in_ct - transform_points(invert(patient.ct_to_reference), there), axis=1)


def _placed(case: Case, echoes: ImagedEchoes, correction: Correction, pixels: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Where pixels of every frame with echoes, (n, 2), or its echoes are placed in Reference, and where they truly are; mm."""
    if pixels is None:
        frames, at = echoes.frames, echoes.points[:, :2] / echoes.spacing
    else:
        frames = np.repeat(np.arange(len(echoes.planes)), len(pixels))
        at = np.tile(pixels, (len(echoes.planes), 1))
    planes = echoes.planes_at(correction.delay)[frames] @ correction.plane
    flat = np.concatenate([at, np.zeros((len(at), 1)), np.ones((len(at), 1))], axis=1)
    here = np.einsum("nij,nj->ni", planes, flat * [*echoes.spacing, 1.0, 1.0])[:, :3]
    there = np.einsum("nij,nj->ni", sweep_poses(case.true).image_to_reference[echoes.numbers][frames], flat)[:, :3]
    return here, there


def _shapes_apart(here: np.ndarray, there: np.ndarray) -> np.ndarray:
    """mm between points, the ones laid on the others as a whole."""
    here, there = here - here.mean(axis=0), there - there.mean(axis=0)
    return np.linalg.norm(Rotation.align_vectors(there, here)[0].apply(here) - there, axis=1)


def _checked(patient: Patient, kind: str, name: str, case: Case, told: str) -> Row:
    try:
        found = checked(case.sequence, patient.labels if kind == CHECKS[0] else None)
    except AIFReconError as error:
        return Row(patient.seed, kind, name, False, False, str(error))
    said = " ".join(found.lines)
    wrong = found.agrees is False
    return Row(patient.seed, kind, name, wrong, told in said and wrong if told else not wrong, said)


HEAD = (
    "",
    "n",
    "given",
    "right",
    "image points off: before",
    "after",
    "worst",
    "95 of 100",
    "worst",
    "error within the stated",
    "delay off, ms",
)


def calibrations(rows: list[Row], kind: str = CALIBRATE) -> str:
    """A line for each sort of case."""
    lines = []
    for case, of in pd.DataFrame([row for row in rows if row.kind == kind]).groupby("case", sort=False):
        given = of[of.accepted]
        cells = [case, f"{len(of)}", f"{len(given)}", f"{given.right.sum()}"]
        if len(given):
            median, worst = given["median"], given.worst
            cells += [f"{mm:.2f}" for mm in (given.before.median(), median.median(), median.max(), worst.median(), worst.max())]
            cells.append("" if math.isnan(given.stated.iloc[0]) else f"{(given.echoes <= given.stated).mean():.0%}")
            cells.append(shown(given.delay_ms.max(), ".1f", "not told"))
        lines.append([*cells, *[""] * (len(HEAD) - len(cells))])
    return table(HEAD, lines) + "\n"


def checks(rows: list[Row]) -> str:
    """A line for each mistake."""
    lines = []
    for case, of in pd.DataFrame([row for row in rows if row.kind in CHECKS]).groupby("case", sort=False):
        each = [of[of.kind == kind] for kind in CHECKS]
        told = (str(count) for these in each for count in (these.right.sum(), (these.accepted & ~these.right).sum()))
        lines.append([case, f"{len(each[0])}", *told])
    return table(("", "n", "told, with a CT", "something else told", "told, without", "something else told"), lines) + "\n"


def texts(rows: list[Row]) -> dict[str, str]:
    """All tables by their names."""
    return {
        "calibration": calibrations(rows),
        "calibration-bone": halves_on_bone(RealBone.found()),
        "calibration-no-ct": calibrations(rows, WITHOUT_CT),
        "calibration-check": checks(rows),
    }


STUDY = Study(patient_rows, Row, "calibrations and checks", texts)

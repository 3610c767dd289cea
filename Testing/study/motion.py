"""Is a patient's motion found and taken out, with a CT and without one, and is nothing done to a scan at rest?

    python Testing/study motion --output study-output/motion

writes motion.md. Patients of real shape, nine passes of 33 frames, whose poses are recorded anew for each motion: images stay the same. The
truth is where bone is at rest. Without a CT nothing tells where all of a scan lies, so that it is laid on the truth as one before it is
measured. Six minutes a patient.
"""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from measured import table
from scipy.spatial.transform import Rotation

from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.geometry.transforms import affine, transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.motion.motion import find_motion, taken_out
from AIFReconLib.motion.solve import BoneInPlace
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import TrackingErrors, multi_angle_sweep, recorded_poses, simulate_sweep
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

from .command import Study
from .lumbar_shapes import lumbar_shapes
from .method_cases import EFFECTS, HOLE_LIMIT, OURS, SPACING, Scan, configured, placed_labels, scan_of

FRAMES = 297
REST = "at rest"
MOTIONS = {
    REST: TrackingErrors(),
    "passes moved by 1.5 mm": TrackingErrors(shifting=1.5),
    "passes moved by 3 mm": TrackingErrors(shifting=3.0),
    "breathing, 2 mm": TrackingErrors(breathing=2.0),
    "breathing, 4 mm": TrackingErrors(breathing=4.0),
    "a step of 6 mm in a pass": TrackingErrors(step=6.0),
    "the tracker drifts by 2 mm": TrackingErrors(drift=2.0),
    "all at once": TrackingErrors(shifting=1.5, breathing=2.0, step=6.0, drift=2.0),
}
WITH_CT, WITHOUT_CT = "CT", "no CT"


@dataclass(frozen=True)
class Row:
    """One patient who moves so, with or without a CT, and what `weighted` shows of it."""

    patient: int
    motion: str
    by: str  #: `WITH_CT` or `WITHOUT_CT`
    mended: bool  #: Whether motion was taken out
    asked: bool  #: Whether it was to be
    cnr: float
    coverage: float
    left: float  #: mm. Root mean square of how far frames lie beside where they were, at bone.
    seconds: float  #: To find it and take it out, the search for echoes included


def patient_rows(seed: int) -> list[Row]:
    """All motions of one patient."""
    back, probe = lumbar_shapes(seed + 1), PhasedArray()
    path = multi_angle_sweep(back, FRAMES)
    images = np.asarray(simulate_sweep(back, probe, path, effects=EFFECTS, seed=seed).images)
    rows = []
    true = configured(TrackedSequence(images, recorded_poses(probe, path, seed=seed)), probe)
    scan, labels = scan_of(true, back, probe), placed_labels(back)
    for name, errors in MOTIONS.items():
        sequence = configured(TrackedSequence(images, recorded_poses(probe, path, errors, seed)), probe)
        rows += [_row(seed, name, by, asked, sequence, scan, labels) for by in (WITH_CT, WITHOUT_CT) for asked in (False, True)]
    return rows


def _row(seed: int, name: str, by: str, asked: bool, sequence: TrackedSequence, scan: Scan, labels: Volume) -> Row:
    bone, seconds, applied = LabeledBone(labels), 0.0, False
    if asked:
        started = time.perf_counter()
        motion = find_motion(sequence, BoneInPlace(bone.field, bone.place) if by == WITH_CT else None)
        if motion is not None and motion.applied:
            sequence, applied = taken_out(sequence, motion), True
        seconds = time.perf_counter() - started
    if by == WITHOUT_CT:
        sequence = laid_on(sequence, scan.sequence)
    settings = ReconstructionSettings(method=OURS, spacing=SPACING, hole_limit=HOLE_LIMIT, motion="off")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # it moved, as it should
        settings = settings if by == WITH_CT else replace(settings, bone_from_sweep=True)
        result = reconstruct(sequence, settings, bone if by == WITH_CT else None)
    shown = evaluate(result.intensity, scan.truth, result.mask).bone
    here, there = _places(sequence), _places(scan.sequence)
    left = float(np.sqrt(((here - there) ** 2).sum(axis=1).mean()))
    return Row(seed, name, by, applied, asked, float(shown.cnr), float(shown.coverage), left, seconds)


def _places(sequence: TrackedSequence) -> np.ndarray:
    """Where some pixels at bone of every frame lie, (n, 3) mm."""
    columns, rows = sequence.frame_size
    pixels = np.array([[x * columns, y * rows, 0.0] for x in (0.35, 0.5, 0.65) for y in (0.3, 0.5)])
    return np.concatenate([transform_points(one, pixels) for one in sweep_poses(sequence).image_to_reference])


def laid_on(sequence: TrackedSequence, true: TrackedSequence) -> TrackedSequence:
    """A sweep moved as one to where another has its frames."""
    here, there = _places(sequence), _places(true)
    turn = Rotation.align_vectors(there - there.mean(axis=0), here - here.mean(axis=0))[0].as_matrix()
    poses = affine(turn, there.mean(axis=0) - turn @ here.mean(axis=0)) @ sweep_poses(sequence).image_to_reference
    moved = TrackedSequence.from_arrays(sequence.images, poses, sequence.timestamps)
    return replace(moved, configuration=replace(sequence.configuration, transforms={}))


MENDED = ("mended", "least", "coverage")
HEAD = ("", "CNR, CT: moved", *MENDED, "no CT: moved", *MENDED, "left, mm: CT", "no CT", "taken out", "s")


def page_of(rows: list[Row]) -> str:
    """A line per motion: as it is and mended, in times of the patient at rest."""
    every = pd.DataFrame(rows)
    rest = every[(every.motion == REST) & ~every.asked].set_index(["patient", "by"])
    every = every.join(rest[["cnr", "coverage"]], on=["patient", "by"], rsuffix="_rest")
    every = every.assign(kept=every.cnr / every.cnr_rest, points=100 * (every.coverage - every.coverage_rest))
    lines = []
    for name in MOTIONS:
        cells = [name]
        moved, mended = ([of for _, of in every[(every.motion == name) & (every.asked == asked)].groupby("by")] for asked in (False, True))
        for here, there in zip(moved, mended, strict=True):
            cells += [
                f"{here.kept.mean():.2f}",
                f"{there.kept.mean():.2f}",
                f"{there.kept.min():.2f}",
                f"{there.points.mean():+.1f} points",
            ]
        cells += [f"{of.left.mean():.2f}" for of in mended]
        cells += [", ".join(f"{of.mended.sum()}/{len(of)}" for of in mended), f"{pd.concat(mended).seconds.mean():.0f}"]
        lines.append(cells)
    return table(HEAD, lines) + "\n"


STUDY = Study(patient_rows, Row, "reconstructions", lambda rows: {"motion": page_of(rows)})

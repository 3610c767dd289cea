"""One simulated patient of the study of guidance: scans by plan, by `next` and by a wearable device, and what `weighted` shows of each."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.geometry.transforms import invert, transform_points
from AIFReconLib.guidance.bone import GuidedBone, guided_bone
from AIFReconLib.guidance.bone_coverage import CoverageAccumulator
from AIFReconLib.guidance.candidates import geometry_of
from AIFReconLib.guidance.coverage import covered
from AIFReconLib.guidance.guidance import guidance_of_sweep
from AIFReconLib.guidance.next_move import NextMove
from AIFReconLib.guidance.passes import HAND, Pass, freehand_passes
from AIFReconLib.guidance.plan import WEARABLE, ScanPlan, plan_scan
from AIFReconLib.guidance.probe import ProbeImages, ProbeOnBack, Skin
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.simulation.anatomy import LumbarAnatomy, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import ProbePath, single_angle_sweep
from AIFReconLib.sweep.edits import select_frames

from .method_cases import HOLE_LIMIT, SPACING, Back, Scan, map_in_place, scan_of, simulated_scan

FEW, MANY = 120, 360

SCOUTED = 15
"""Frames that a scan without a CT begins with."""

EXHAUSTIVE = 2
"""Patients that are scanned by all candidate passes too, for what the best plan could show."""


@dataclass(frozen=True)
class Row:
    """One scan of one patient, and what `weighted` shows of it.

    `interspinous` and `coverage` are shares of what the scan reached, `of_reachable` is the share of all borders that any probe on the
    back could reach; `predicted` and `predicted_of_reachable` are the plan's, before the scan; `expected` is what `coverage` tells of the
    frames as they were taken, as a share of what they met.
    """

    patient: int
    scan: str
    frames: int
    passes: int
    interspinous: float
    of_reachable: float
    coverage: float
    reached_cm2: float
    cnr: float
    expected: float
    predicted: float = float("nan")
    predicted_of_reachable: float = float("nan")


def patient_rows(seed: int) -> list[Row]:
    """Every scan of one patient. Some three minutes on one core."""
    case = ScannedCase(seed)
    rows = []
    for frames in (FEW, MANY):
        plan = plan_scan(case.bone, case.probe, "interspinous", frames)
        rows.append(case.planned("plan, with errors", plan, case.missed(plan)))
    rows += case.followed("next, with errors", case.follow(MANY), FEW)
    rows += case.followed("next, no CT, with errors", case.follow_echoes(MANY), FEW)
    worn = plan_scan(case.bone, case.probe, "interspinous", MANY, WEARABLE)
    rows.append(case.planned("wearable, exact", worn, np.concatenate([one.image_to_reference for one in worn.passes])))
    if seed < EXHAUSTIVE:
        passes = freehand_passes(case.bone)
        rows.append(case.row("all candidate passes, exact", np.concatenate([one.poses(case.probe) for one in passes]), len(passes)))
    return rows


class ScannedCase:
    """A patient, a probe on its back, and an operator."""

    def __init__(self, seed: int, phantom: Back | None = None):
        self.seed = seed
        self.phantom: Back = phantom or make_lumbar_phantom(LumbarAnatomy.from_seed(seed))
        self.bone: GuidedBone = guided_bone(self.phantom.labels, self.phantom.ct_to_reference)
        images, self._array = ProbeImages.simulated(), PhasedArray()
        self._to_transducer = invert(self._array.image_to_transducer)
        scout = single_angle_sweep(self.phantom, 30).transducer_to_reference @ self._array.image_to_transducer
        skin = Skin.through(transform_points(invert(self.bone.patient_to_reference), images.faces(scout)))
        self.probe = ProbeOnBack(images, skin, self.bone.patient_to_reference)
        self._scout, self._start = scout, scout[len(scout) // 2]

    @cached_property
    def _map(self) -> BoneMap:
        return map_in_place(self.phantom.labels)

    def _made(self, planned: Pass, frames: int, number: int) -> np.ndarray:
        """A pass as an operator makes it who misses, image_to_reference of its frames."""
        rng = np.random.default_rng([self.seed, 70, number])
        return self.probe.poses(HAND.follow(planned.placements(frames), rng))

    def missed(self, plan: ScanPlan) -> np.ndarray:
        """The frames of an operator who makes a plan's passes, and misses."""
        return np.concatenate([self._made(one.planned, len(one.image_to_reference), n) for n, one in enumerate(plan.passes)])

    def planned(self, scan: str, plan: ScanPlan, poses: np.ndarray) -> Row:
        """A scan by plan."""
        row = self.row(scan, poses, len(plan.passes))
        return replace(row, predicted=plan.predicted_visibility, predicted_of_reachable=plan.predicted_of_reachable)

    def followed(self, name: str, done: tuple[np.ndarray, list[int]], few: int) -> list[Row]:
        """A scan by `next`: of its first frames, and whole."""
        poses, begins = done
        scan = self._scan(poses)
        first = scan_of(select_frames(scan.sequence, 0, few - 1), self.phantom, self._array)
        begun = sum(begin < few for begin in begins)
        return [self._measured(name, first, poses[:few], begun), self._measured(name, scan, poses, len(begins))]

    def follow(self, frames: int) -> tuple[np.ndarray, list[int]]:
        """The frames of an operator who does, again and again, what `next` says, and misses; and where each move begins."""
        met = CoverageAccumulator(geometry_of(self.bone, self.probe))
        advisor = NextMove(self.bone, self.probe)
        taken: list[np.ndarray] = []
        begins: list[int] = []
        last: tuple[Pass, int] | None = None
        while len(taken) < frames:
            move = advisor.advise(met, taken[-1] if taken else self._start)
            last = (move.planned, move.frames) if move else last
            if last is None:
                break
            begins.append(len(taken))
            for pose in self._made(*last, 1000 + len(taken))[: frames - len(taken)]:
                met.insert(pose)
                taken.append(pose)
        return np.array(taken), begins

    def follow_echoes(self, frames: int) -> tuple[np.ndarray, list[int]]:
        """The same of an operator without a CT, who begins with a pass along the midline."""
        taken, begins, sweeps = self._scout[:: len(self._scout) // SCOUTED], [0], []
        new = taken
        while len(taken) < frames:
            sweeps.append(self._scan(new).sequence)
            found = guidance_of_sweep(sweeps)
            if found.coverage is None or found.advice is None or found.advice.move is None:
                break
            move, there = found.advice.move, found.coverage.met.bone.patient_to_reference
            skin = Skin.through(transform_points(invert(there), self.probe.images.faces(taken)))
            rng = np.random.default_rng([self.seed, 70, 1000 + len(taken)])
            made = HAND.follow(move.planned.placements(move.frames), rng)
            begins.append(len(taken))
            new = ProbeOnBack(self.probe.images, skin, there).poses(made)[: frames - len(taken)]
            taken = np.concatenate([taken, new])
        return taken, begins

    def path(self, poses: np.ndarray) -> ProbePath:
        """The way of the probe of frames whose image_to_reference is given."""
        return ProbePath(poses @ self._to_transducer, np.arange(len(poses)) / 20.0)

    def _scan(self, poses: np.ndarray) -> Scan:
        found: Scan = simulated_scan(self.phantom, self._array, self.path(poses), self.seed)
        return found

    def row(self, name: str, poses: np.ndarray, passes: int) -> Row:
        """Scan, reconstruct and measure."""
        return self._measured(name, self._scan(poses), poses, passes)

    def _measured(self, name: str, scan: Scan, poses: np.ndarray, passes: int) -> Row:
        settings = ReconstructionSettings(spacing=SPACING, hole_limit=HOLE_LIMIT)
        result = reconstruct(scan.sequence, settings, self._map)
        metrics = evaluate(result.intensity, scan.truth, result.mask)
        met = CoverageAccumulator(geometry_of(self.bone, self.probe))
        for pose in poses:
            met.insert(pose)
        border = covered(met).interspinous
        gaps, bone = metrics.interspinous, metrics.bone
        of_reachable = gaps.coverage * gaps.area / 100.0 / border.reachable_cm2
        shown = gaps.coverage, of_reachable, bone.coverage, bone.area / 100.0, bone.cnr
        return Row(self.seed, name, len(poses), passes, *shown, expected=border.expected_visibility / border.met)

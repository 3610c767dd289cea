"""One simulated patient of the study of guidance: scans by plan, by `next` and by a wearable device, and what `weighted` shows of each."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.visibility import BoneTruth
from AIFReconLib.geometry.transforms import invert, transform_points
from AIFReconLib.guidance.bone import GuidedBone, guided_bone
from AIFReconLib.guidance.candidates import candidates_of, geometry_of
from AIFReconLib.guidance.coverage import covered
from AIFReconLib.guidance.expectation import expected_visibility
from AIFReconLib.guidance.met import BoneMet
from AIFReconLib.guidance.next_move import NextMove
from AIFReconLib.guidance.passes import Pass, freehand_passes
from AIFReconLib.guidance.plan import WEARABLE, plan_scan
from AIFReconLib.guidance.probe import Placement, ProbeImages, ProbeOnBack, Skin
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.settings import ReconstructionSettings
from AIFReconLib.simulation.anatomy import LumbarAnatomy, LumbarPhantom, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import ProbePath, multi_angle_sweep, single_angle_sweep

from .method_cases import HOLE_LIMIT, MULTI_FRAMES, SIGMA, SPACING, Scan, simulated_scan

FEW = 120
ERROR_MM, ERROR_DEG = 5.0, 5.0
"""Standard deviations of what the operator misses by, in every pass anew: of the place along each axis of the skin, and of each angle."""

WANDER_MM, WANDER_DEG = 1.0, 1.0
"""The same from frame to frame."""


@dataclass(frozen=True)
class Row:
    """One scan of one patient, and what `weighted` shows of it.

    `best` is the share of the borders that all candidate passes together are expected to show; `predicted` the plan's; `expected` what the
    frames as they were taken are expected to show of all reachable borders; `below_45` the share of these that was met below 45 degrees.
    """

    patient: int
    scan: str
    frames: int
    interspinous: float
    coverage: float
    reached_cm2: float
    cnr: float
    expected: float
    below_45: float
    predicted: float = float("nan")
    best: float = float("nan")


def patient_rows(seed: int) -> list[Row]:
    """Every scan of one patient. Some five minutes on one core."""
    case = _Case(seed)
    rows = [case.row("fixed scan", case.fixed)]
    few, many = (plan_scan(case.bone, case.probe, "interspinous", frames) for frames in (FEW, MULTI_FRAMES))
    for plan in (few, many):
        exact = np.concatenate([one.image_to_reference for one in plan.passes])
        missed = np.concatenate([case.missed(exact_pass, n) for n, exact_pass in enumerate(one.image_to_reference for one in plan.passes)])
        predicted = plan.predicted_visibility
        rows.append(replace(case.row("plan, with errors", missed), predicted=predicted, best=case.best))
        if plan is many:
            rows.append(replace(case.row("plan, exact", exact), predicted=predicted, best=case.best))
    followed = case.followed(MULTI_FRAMES)
    rows += [case.row("next, with errors", followed[:FEW]), case.row("next, with errors", followed)]
    worn = plan_scan(case.bone, case.probe, "interspinous", MULTI_FRAMES, WEARABLE)
    poses = np.concatenate([one.image_to_reference for one in worn.passes])
    return [*rows, replace(case.row("wearable, exact", poses), predicted=worn.predicted_visibility)]


class _Case:
    """A patient, a probe on its back, and an operator."""

    def __init__(self, seed: int):
        self.seed = seed
        self.phantom: LumbarPhantom = make_lumbar_phantom(LumbarAnatomy.from_seed(seed))
        self.bone: GuidedBone = guided_bone(self.phantom.labels, self.phantom.ct_to_reference)
        images, array = ProbeImages.simulated(), PhasedArray()
        self._to_transducer = invert(array.image_to_transducer)
        scout = single_angle_sweep(self.phantom, 30).transducer_to_reference @ array.image_to_transducer
        skin = Skin.through(transform_points(invert(self.bone.patient_to_reference), images.faces(scout)))
        self.probe = ProbeOnBack(images, skin, self.bone.patient_to_reference)
        self.fixed = multi_angle_sweep(self.phantom, MULTI_FRAMES).transducer_to_reference @ array.image_to_transducer
        self._start = scout[len(scout) // 2]
        self._map = BoneMap.from_labels(self.phantom.labels, sigma_mm=SIGMA)

    @property
    def best(self) -> float:
        """Share of the borders that all candidate passes together are expected to show."""
        shown = np.zeros(len(self.bone))
        for one in candidates_of(freehand_passes(self.bone), self.probe, geometry_of(self.bone, self.probe)):
            shown[one.points] = np.maximum(shown[one.points], one.shown)
        areas = self.bone.surface.areas[self.bone.border]
        return float(areas @ shown[self.bone.border] / areas.sum())

    def missed(self, poses: np.ndarray, number: int) -> np.ndarray:
        """A pass as an operator makes it who misses."""
        rng = np.random.default_rng([self.seed, 70, number])
        off = rng.standard_normal(5) * ([ERROR_MM] * 2 + [ERROR_DEG] * 3)
        found = []
        for pose in poses:
            here = self.probe.placement(pose)
            x, z, a, b, c = off + rng.standard_normal(5) * ([WANDER_MM] * 2 + [WANDER_DEG] * 3)
            there = Placement(here.x + x, here.z + z, here.turn_deg + a, here.in_plane_deg + b, here.across_deg + c)
            found.append(self.probe.pose(there))
        return np.array(found)

    def followed(self, frames: int) -> np.ndarray:
        """The frames of an operator who does, again and again, what `next` says, and misses."""
        met = BoneMet(geometry_of(self.bone, self.probe))
        advisor = NextMove(self.bone, self.probe)
        taken: list[np.ndarray] = []
        here: np.ndarray = self._start
        last: Pass | None = None
        while len(taken) < frames:
            move = advisor.advise(met, here)
            planned: Pass | None = move.planned if move else last
            if planned is None:
                break
            poses = self.missed(planned.poses(self.probe), 1000 + len(taken))[: frames - len(taken)]
            for pose in poses:
                met.insert(pose)
            taken += list(poses)
            here, last = taken[-1], planned
        return np.array(taken)

    def row(self, scan: str, poses: np.ndarray) -> Row:
        """Scan, reconstruct and measure."""
        path = ProbePath(poses @ self._to_transducer, np.arange(len(poses)) / 20.0)
        found: Scan = simulated_scan(self.phantom, PhasedArray(), path, self.seed)
        settings = ReconstructionSettings(method="weighted", spacing=SPACING, hole_limit=HOLE_LIMIT)
        result = reconstruct(found.sequence, settings, self._map)
        truth: BoneTruth = found.truth
        metrics = evaluate(result.intensity, truth, result.mask)
        met = BoneMet(geometry_of(self.bone, self.probe))
        for pose in poses:
            met.insert(pose)
        border = covered(met).interspinous
        areas, chances = self.bone.surface.areas[self.bone.border], expected_visibility(met.best_cosine)[self.bone.border]
        return Row(
            self.seed,
            scan,
            len(poses),
            metrics.interspinous.coverage,
            metrics.bone.coverage,
            metrics.bone.area / 100.0,
            metrics.bone.cnr,
            float(areas @ chances / areas.sum()),
            border.below_45_deg,
        )

"""How well bone that is found in a CT alone stands for bone that was segmented, in simulated patients.

Each patient's CT has noise, blur, a table, a calcified aorta and contrast medium in the bowel (`ct_disturbances.py`). Its bone is found by
`labels_from_ct` and compared with the true labels: the surface that a probe on the back can meet, and what `weighted` shows with either.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from AIFReconLib.bone.ct.from_ct import labels_from_ct
from AIFReconLib.bone.field import BoneField
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.quantities import BoneMetrics
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.guidance.bone import guided_bone
from AIFReconLib.message import columns
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.simulation.anatomy import LumbarAnatomy, LumbarPhantom, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep, random_rigid

from .command import Study
from .ct_disturbances import SPACINGS, disturbed_ct
from .method_cases import HOLE_LIMIT, SPACING, simulated_scan

FRAMES = 72

MOST_MEDIAN, MOST_OFF, LEAST_KEPT = 0.5, 1.5, 0.97
"""mm, mm and the share of CNR and coverage that must hold."""


@dataclass(frozen=True)
class Row:
    """One patient; distances in mm, of true surface to found bone and of found surface to true bone."""

    patient: int
    spacing: float
    median: float
    off_95: float
    back_median: float
    back_off_95: float
    vertebrae: int
    overlap: float
    """Least Dice of a vertebra's label and the true one's, 0 where they were not told apart."""
    cnr_kept: float
    coverage_kept: float


def phantom_of(seed: int) -> LumbarPhantom:
    """A patient whose CT is still without noise, somewhere in its own frame."""
    place = random_rigid(25.0, 6.0, np.random.default_rng([seed, 7]))
    return make_lumbar_phantom(LumbarAnatomy.from_seed(seed), spacing=SPACINGS[seed % len(SPACINGS)], ct_to_reference=place, ct_noise=0.0)


def surface_off(of: Volume, to: Volume) -> tuple[float, float]:
    """Median and 95th percentile of how far the surface of labels that a probe on the back can meet is from the bone of others, mm."""
    off = np.abs(BoneField.from_labels(to).distances(guided_bone(of).surface.points_reference))
    return float(np.median(off)), float(np.percentile(off, 95))


def patient_rows(seed: int) -> list[Row]:
    """The row of one patient."""
    phantom = phantom_of(seed)
    found, true = labels_from_ct(disturbed_ct(phantom, seed)), phantom.labels
    count = sum(name.startswith("vertebra") for name in found.names.values())
    scan = simulated_scan(phantom, PhasedArray(), multi_angle_sweep(phantom, FRAMES), seed)

    def shown(labels: Volume) -> BoneMetrics:
        bone = LabeledBone(labels, phantom.ct_to_reference, scan.sequence)
        result = reconstruct(scan.sequence, ReconstructionSettings(spacing=SPACING, hole_limit=HOLE_LIMIT), bone)
        return evaluate(result.intensity, scan.truth, result.mask)

    exact, own = shown(true), shown(found)
    overlaps = [_dice(found.array == n, true.array == n) for n in range(1, int(true.array.max()) + 1)]
    kept = own.bone.cnr / exact.bone.cnr, own.bone.coverage / exact.bone.coverage
    off = *surface_off(true, found), *surface_off(found, true)
    return [Row(seed, float(phantom.ct.spacing[0]), *off, count, min(overlaps) if count else 0.0, *kept)]


def _dice(a: np.ndarray, b: np.ndarray) -> float:
    return float(2 * (a & b).sum() / max(a.sum() + b.sum(), 1))


def page(rows: list[Row]) -> str:
    """The table, and what holds."""
    head = ("patient", "voxel mm", "off mm", "95%", "back mm", "95%", "vertebrae", "overlap", "CNR kept", "coverage kept")
    table = [head, *((str(r.patient), f"{r.spacing:g}", *_numbers(r)) for r in rows)]
    of = pd.DataFrame(rows)
    near = (of[["median", "back_median"]].max(axis=1) <= MOST_MEDIAN) & (of[["off_95", "back_off_95"]].max(axis=1) <= MOST_OFF)
    holds = near & (of[["cnr_kept", "coverage_kept"]].min(axis=1) >= LEAST_KEPT)
    return f"# Bone from the CT alone\n\n{columns(table)}\n\nAll limits hold in {holds.sum()} of {len(rows)} patients.\n"


def _numbers(r: Row) -> tuple[str, ...]:
    distances = (f"{mm:.2f}" for mm in (r.median, r.off_95, r.back_median, r.back_off_95))
    return (*distances, str(r.vertebrae), f"{r.overlap:.2f}", f"{r.cnr_kept:.1%}", f"{r.coverage_kept:.1%}")


STUDY = Study(patient_rows, Row, "CTs", lambda rows: {"ct-bone": page(rows)})

"""The cases of the study: patients of two kinds, scans, wrong CTs and wrong poses, and what every method makes of them."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from AIFReconLib.bone.echoes.surface import bone_from_sweep
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.compounding.methods.average import AVERAGE
from AIFReconLib.compounding.methods.table import COMPARED_METHODS, METHODS, method_named
from AIFReconLib.compounding.methods.weighted import WEIGHTED
from AIFReconLib.compounding.own.method import load_method
from AIFReconLib.errors import DisagreementWarning, GeometryError
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.visibility import BoneTruth, SweepBeams, bone_truth
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample
from AIFReconLib.geometry.transforms import affine
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.recipe.recipe import Recipe, ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.simulation.anatomy import LumbarAnatomy, LumbarPhantom, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import (
    PROBE_TO_TRACKER,
    ProbePath,
    multi_angle_sweep,
    random_rigid,
    simulate_sweep,
    single_angle_sweep,
)
from AIFReconLib.simulation.ultrasound import UltrasoundEffects
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

from .free_paths import lines_to_canal
from .lumbar_shapes import LumbarShapes, lumbar_shapes
from .real_bone_measures import precision

SPACING, HOLE_LIMIT = 1.0, 2.0
BEAM_THICKNESS = 3.0
MULTI_FRAMES, SINGLE_FRAMES, TISSUE_FRAMES = 270, 90, 90
PLAIN, OURS, PAPER = AVERAGE.name, WEIGHTED.name, "aif-compensated"
WITHOUT_CT = "weighted, no CT"
"""`weighted` with the surface that the sweep's own echoes show."""

PHANTOM, SHAPES = "own phantom", "real shapes"
KINDS = (PHANTOM, SHAPES)

SHIFTS = {"CT 3 mm off": 3.0, "CT 5 mm off": 5.0}
"""mm, in a random direction."""

LEVEL, OTHER, NOISE, ONE_ANGLE, NO_BONE = "CT one level off", "CT of another patient", "tracker noise", "one angle only", "no bone at all"
NOISE_MM, NOISE_DEG = 0.5, 1.0
IMAGE_TO_PROBE = TransformName("Image", "Probe")
EFFECTS = UltrasoundEffects(clutter=True)
"""Shadows are gray, as real ones are."""


@dataclass(frozen=True)
class Row:
    """One reconstruction of the study and its numbers."""

    seed: int
    kind: str
    condition: str
    method: str
    metrics: dict[str, float]


@dataclass(frozen=True, eq=False)
class Scan:
    """A sweep with its configuration, and the truth it is measured against."""

    sequence: TrackedSequence
    truth: BoneTruth


Back = LumbarPhantom | LumbarShapes


@dataclass(frozen=True, eq=False)
class _Patient:
    seed: int
    kind: str
    back: Back
    scan: Scan

    def rows(self, condition: str, methods: Iterable[str], labels: Volume, scan: Scan | None = None) -> list[Row]:
        """Reconstruct with each method, and measure."""
        scan = scan or self.scan
        bone = LabeledBone(labels, None, scan.sequence)
        return [self._row(condition, method, bone, scan) for method in methods]

    def _row(self, condition: str, method: str, bone: LabeledBone, scan: Scan) -> Row:
        settings = ReconstructionSettings(method=OURS if method == WITHOUT_CT else method, spacing=SPACING, hole_limit=HOLE_LIMIT)
        with warnings.catch_warnings():
            # Told of wrong CTs, as it should be
            warnings.simplefilter("ignore", DisagreementWarning)
            result = reconstruct(scan.sequence, settings, bone_for(method, bone, scan.sequence))
        metrics = evaluate(result.intensity, scan.truth, result.mask).to_dict()
        metrics["precision"] = precision(result.intensity, scan.truth)["precision_180"]
        return Row(self.seed, self.kind, condition, method, metrics)


def patient_of(kind: str, seed: int) -> Back:
    """The patient of a kind and a seed."""
    return make_lumbar_phantom(LumbarAnatomy.from_seed(seed)) if kind == PHANTOM else lumbar_shapes(seed + 1)


def patient_rows(given: tuple[str, int], own: tuple[str, ...] = ()) -> list[Row]:
    """All reconstructions of one patient, (kind, seed), with methods of one's own by their names. Some three minutes on one core."""
    kind, seed = given
    for method in own:
        load_method(method)
    back, probe = patient_of(kind, seed), PhasedArray()
    labels = placed_labels(back)
    scan = simulated_scan(back, probe, multi_angle_sweep(back, MULTI_FRAMES), seed, EFFECTS)
    scan = replace(scan, truth=replace(scan.truth, lines=lines_to_canal(back, labels, back.bone_distance, seed)))
    patient = _Patient(seed, kind, back, scan)
    rows = patient.rows("right CT", (*METHODS, WITHOUT_CT, *own), labels)
    for condition, wrong in wrong_cts(back, kind, seed).items():
        rows += patient.rows(condition, (PAPER, OURS), wrong)
    shaken = Scan(_shaken(scan.sequence, seed), scan.truth)
    rows += patient.rows(NOISE, (PLAIN, OURS), labels, shaken)
    single = simulated_scan(back, probe, single_angle_sweep(back, SINGLE_FRAMES), seed, EFFECTS)
    against_all = Scan(single.sequence, scan.truth)
    rows += patient.rows(ONE_ANGLE, (PLAIN, OURS), labels, against_all)
    return rows + _without_bone(patient, labels, probe)


def wrong_cts(back: Back, kind: str, seed: int) -> dict[str, Volume]:
    """Labels where they are not, or of somebody else, in Reference."""
    labels, tips = placed_labels(back), back.spinous_tips()
    rng = np.random.default_rng([seed, 20])
    middle = tips[len(tips) // 2] + (0.0, 30.0, 0.0)
    wrong = {name: labels.placed_by(random_rigid(mm, 0.0, rng, middle)) for name, mm in SHIFTS.items()}
    wrong[LEVEL] = labels.placed_by(affine(np.eye(3), tips[0] - tips[1]))
    other = patient_of(kind, seed + 500)
    there = middle - (other.spinous_tips()[len(tips) // 2] + (0.0, 30.0, 0.0))
    return {**wrong, OTHER: placed_labels(other).placed_by(affine(np.eye(3), there))}


def _without_bone(patient: _Patient, labels: Volume, probe: PhasedArray) -> list[Row]:
    """Does a method only draw the CT? Tissue without any bone, and the CT of this patient."""
    distance = patient.back.bone_distance
    boneless = replace(patient.back, bone_distance=Volume(np.full_like(distance.array, 6.0), distance.ijk_to_reference))
    path = multi_angle_sweep(patient.back, TISSUE_FRAMES)
    scan = scan_of(configured(simulate_sweep(boneless, probe, path, effects=EFFECTS, seed=patient.seed), probe), patient.back, probe)
    rows = patient.rows(NO_BONE, (PLAIN, PAPER, OURS), labels, scan)
    with contextlib.suppress(GeometryError):  # told that there is none: as it should be
        rows += patient.rows(NO_BONE, [WITHOUT_CT], labels, scan)
    return rows


def bone_for(method: str, bone: LabeledBone, sequence: TrackedSequence, recipe: Recipe | None = None) -> BoneMap | LabeledBone | None:
    """What a method is told of bone: that of the CT, what the sweep's own echoes show, or nothing."""
    if method == WITHOUT_CT:
        return bone_from_sweep(sequence, recipe)
    return bone if method_named(method).needs_bone else None


def map_in_place(labels: Volume) -> BoneMap:
    """The map of `weighted` for labels that lie exactly where bone is."""
    return LabeledBone(labels, recipe=Recipe(bone_sigma_mm=1.0)).map(OURS)


def placed_labels(back: Back) -> Volume:
    """The labels in Reference."""
    return back.labels.placed_by(back.ct_to_reference)


def simulated_scan(back: Back, probe: PhasedArray, path: ProbePath, seed: int, effects: UltrasoundEffects | None = None) -> Scan:
    """A simulated sweep along a path, with a configuration as a recording has one, and the bone that its beams could show."""
    return scan_of(configured(simulate_sweep(back, probe, path, effects=effects, seed=seed), probe), back, probe)


def scan_of(sequence: TrackedSequence, back: Back, probe: PhasedArray) -> Scan:
    """A simulated sweep with the bone that its beams could show."""
    poses = sweep_poses(sequence)
    beams = SweepBeams(poses.image_to_reference[poses.usable], sequence.frame_size, probe.geometry, probe.region, BEAM_THICKNESS)
    return Scan(sequence, bone_truth(placed_labels(back), beams, distance=back.bone_distance))


def configured(sequence: TrackedSequence, probe: PhasedArray, image_to_probe: np.ndarray | None = None) -> TrackedSequence:
    """A simulated sweep with a configuration as a recording has one; its calibration is the probe's where no other is given."""
    calibration = {IMAGE_TO_PROBE: TransformSample(probe.image_to_probe if image_to_probe is None else image_to_probe)}
    return replace(sequence, configuration=PlusConfiguration(Path("simulated"), calibration, region=probe.region, probe=probe.geometry))


def _shaken(sequence: TrackedSequence, seed: int) -> TrackedSequence:
    """The same images with a tracker that is off in every frame."""
    rng, shakes = np.random.default_rng([seed, 30]), []
    for _ in sequence.records:
        shakes.append(random_rigid(0.0, NOISE_DEG * abs(rng.standard_normal()) * np.sqrt(3), rng))
        shakes[-1][:3, 3] += NOISE_MM * rng.standard_normal(3)
    return turned_marker(sequence, shakes)


def turned_marker(sequence: TrackedSequence, turns: Iterable[np.ndarray]) -> TrackedSequence:
    """The same images with a marker that sits on the probe otherwise, in each frame."""

    def turned(record: FrameRecord, turn: np.ndarray) -> FrameRecord:
        sample = record.transforms[PROBE_TO_TRACKER]
        return replace(record, transforms={**record.transforms, PROBE_TO_TRACKER: replace(sample, matrix=sample.matrix @ turn)})

    return replace(sequence, records=list(map(turned, sequence.records, turns)))


WITHOUT_BONE = tuple(method for method in METHODS if not method_named(method).needs_bone)
COMPARED = (*COMPARED_METHODS, WITHOUT_CT)

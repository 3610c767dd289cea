"""One simulated patient of the study of registration: every condition, and how far each answer is from the truth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from AIFReconLib.bone.echoes.found import SweepEchoes
from AIFReconLib.bone.echoes.search import sweep_echoes
from AIFReconLib.bone.field import BoneField
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.quantities import BoneMetrics
from AIFReconLib.evaluation.surface import bone_surface, distance_from_labels
from AIFReconLib.geometry.labels import Labels, centers_of_mass
from AIFReconLib.geometry.transforms import invert, transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.registration.registration import Registration, register_echoes
from AIFReconLib.simulation.anatomy import LumbarAnatomy, LumbarPhantom, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import freehand_sweep, multi_angle_sweep, random_rigid, simulate_sweep, single_angle_sweep

from .method_cases import HOLE_LIMIT, SPACING, configured, simulated_scan

FRAMES = 144

STARTS = (("10 mm, 10 degrees", 10.0, 10.0, 10), ("25 mm, 20 degrees", 25.0, 20.0, 4))
"""Name, mm and degrees of every start, and how many."""

POSTURES_DEG = (3.0, 6.0)

NOISES = ((0.3, 0.3), (1.0, 0.5))
"""mm and degrees per axis and frame."""


@dataclass(frozen=True)
class Row:
    """One registration: how far the bone in the sweep's box is from its place in mm on the mean (NaN where there is no truth)."""

    patient: int
    condition: str
    error: float
    accepted: bool
    agreement: float
    median_distance: float
    cnr_kept: float = float("nan")
    """Of what `weighted` shows with the exact registration, the share that it shows with this one; likewise `coverage_kept`."""
    coverage_kept: float = float("nan")


def patient_rows(seed: int) -> list[Row]:
    """Every condition of one patient. Truth is where the simulator had the bone; the CT lies turned and shifted in its own frame."""
    case = _Case(seed)
    parts = (_starts, _volumes, _wrong_cts, _single_and_mirrored, _postures, _noises, _sparse)
    return [row for part in parts for row in part(case)]


class _Case:
    """A patient, its sweep's echoes, and the truth."""

    def __init__(self, seed: int):
        self.seed = seed
        self.phantom = _phantom(seed)
        self.truth = self.phantom.ct_to_reference
        self.bone = BoneField.from_labels(self.phantom.labels)
        self.echoes = _echoes(self.phantom, multi_angle_sweep(self.phantom, FRAMES), seed)
        self.center = self.echoes.points.mean(axis=0)
        surface = bone_surface(distance_from_labels(self.phantom.labels), pitch=3.0).points_reference
        placed = transform_points(self.truth, surface)
        low, high = self.echoes.points.min(axis=0), self.echoes.points.max(axis=0)
        self.targets = surface[((placed >= low) & (placed <= high)).all(axis=1)]

    def start(self, *drawn: int, move: float = 10.0, turn: float = 10.0) -> np.ndarray:
        """So many mm and degrees off the truth."""
        return random_rigid(move, turn, np.random.default_rng([self.seed, *drawn]), about=self.center) @ self.truth

    def row(self, condition: str, found: Registration, error: float | None = None) -> Row:
        """The row of an answer; its error is that of the whole bone unless given."""
        if error is None:
            off = transform_points(found.transform, self.targets) - transform_points(self.truth, self.targets)
            error = float(np.linalg.norm(off, axis=1).mean())
        agreement = found.agreement
        return Row(self.seed, condition, error, found.accepted, agreement.share, float(np.nan_to_num(agreement.median_distance, nan=99.0)))


def _phantom(seed: int, **options) -> LumbarPhantom:
    place = random_rigid(25.0, 8.0, np.random.default_rng([seed, 7]))
    return make_lumbar_phantom(LumbarAnatomy.from_seed(seed), ct_to_reference=place, **options)


def _echoes(phantom: LumbarPhantom, path, seed: int, **options) -> SweepEchoes:
    probe = PhasedArray()
    return sweep_echoes(configured(simulate_sweep(phantom, probe, path, seed=seed, **options), probe))


def _starts(case: _Case) -> Iterator[Row]:
    """The right CT from places far and near."""
    yield case.row("exact start", register_echoes(case.echoes, case.bone, case.truth))
    for name, move, turn, count in STARTS:
        for trial in range(count):
            yield case.row(f"start {name}", register_echoes(case.echoes, case.bone, case.start(50, trial, move=move, turn=turn)))
    yield case.row("no start", register_echoes(case.echoes, case.bone))


def _volumes(case: _Case) -> Iterator[Row]:
    """What `weighted` shows where the CT found its own place, against what it shows with the exact registration."""
    scan = simulated_scan(case.phantom, PhasedArray(), multi_angle_sweep(case.phantom, FRAMES), case.seed)

    def shown(labels_to_reference: np.ndarray) -> BoneMetrics:
        bone = LabeledBone(case.phantom.labels, labels_to_reference, scan.sequence)
        result = reconstruct(scan.sequence, ReconstructionSettings(spacing=SPACING, hole_limit=HOLE_LIMIT), bone)
        return evaluate(result.intensity, scan.truth, result.mask)

    exact = shown(case.truth)
    for name, start in (("start 10 mm, 10 degrees", case.start(55)), ("no start", None)):
        found = register_echoes(case.echoes, case.bone, start)
        metrics = shown(found.transform)
        row = case.row(f"`weighted` after {name}", found)
        cnr, coverage = metrics.bone.cnr / exact.bone.cnr, metrics.bone.coverage / exact.bone.coverage
        yield replace(row, cnr_kept=cnr, coverage_kept=coverage)


def _wrong_cts(case: _Case) -> Iterator[Row]:
    """Another patient's CT, laid level upon level; the right CT a level off; and one that lacks a vertebra the sweep shows."""
    own = {label: transform_points(case.truth, center) for label, center in centers_of_mass(case.phantom.labels).items()}
    stranger = _phantom((case.seed + 1) % 10)
    bone = BoneField.from_labels(stranger.labels)
    start = stranger.ct_to_reference.copy()
    start[:3, 3] += own[2] - transform_points(start, centers_of_mass(stranger.labels)[2])
    yield case.row("another patient's CT, start on the right level", register_echoes(case.echoes, bone, start), np.nan)
    yield case.row("another patient's CT, no start", register_echoes(case.echoes, bone), np.nan)
    for levels in (1, -1):
        start = case.truth.copy()
        start[:3, 3] += own[2 + levels] - own[2]
        yield case.row("start one level off", register_echoes(case.echoes, case.bone, start))
    for kept, name in (((1, 2), "CT without the lowest vertebra"), ((2, 3), "CT without the highest vertebra")):
        bone = BoneField.from_labels(_only(case.phantom.labels, kept))
        yield case.row(f"{name}, right start", register_echoes(case.echoes, bone, case.truth))
        yield case.row(f"{name}, no start", register_echoes(case.echoes, bone))
        off = case.truth.copy()
        off[:3, 3] += own[3 if kept[0] == 1 else 2] - own[2 if kept[0] == 1 else 3]
        yield case.row(f"{name}, start one level off", register_echoes(case.echoes, bone, off))


def _single_and_mirrored(case: _Case) -> Iterator[Row]:
    """CTs of one vertebra, of one that the sweep does not show, and mirrored ones: what repeats itself along a spine, or across it."""
    labels = case.phantom.labels
    numbers = [int(label) for label in np.unique(labels.array) if label]
    for label in numbers:
        alone, others = (BoneField.from_labels(_only(labels, kept)) for kept in ([label], [n for n in numbers if n != label]))
        yield case.row("CT of one vertebra, no start", register_echoes(case.echoes, alone))
        at = transform_points(invert(case.truth), case.echoes.points)
        unseen = case.echoes[alone.distances(at) > others.distances(at)]
        yield case.row("CT of one vertebra that the sweep does not show", register_echoes(unseen, alone), np.nan)
    for kept in (numbers, numbers[:2], numbers[-2:]):
        mirrored = np.ascontiguousarray(_only(labels, kept).array[:, :, ::-1])
        bone = BoneField.from_labels(Volume(mirrored, labels.ijk_to_reference))
        yield case.row("mirrored CT, no start", register_echoes(case.echoes, bone), np.nan)


def _postures(case: _Case) -> Iterator[Row]:
    """The spine bent between CT and scan: the error of each vertebra, with one rigid motion and with one motion each."""
    for angle in POSTURES_DEG:
        bent = _phantom(case.seed, ct_flexion_deg=angle)
        bone, motions = BoneField.from_labels(bent.labels), bent.motions_since_ct()
        start = random_rigid(5.0, 5.0, np.random.default_rng([case.seed, 51]), about=case.center) @ motions[2] @ bent.ct_to_reference
        for per_segment, name in ((False, "rigid"), (True, "per vertebra")):
            found = register_echoes(case.echoes, bone, start, per_segment=per_segment)
            for label, motion in motions.items():
                points = bone_surface(distance_from_labels(_only(bent.labels, [label])), pitch=4.0).points_reference
                place = found.segments.transforms[label] if found.segments else found.transform
                off = transform_points(place, points) - transform_points(motion @ bent.ct_to_reference, points)
                yield case.row(f"bent by {angle:g} degrees per level, {name}", found, float(np.linalg.norm(off, axis=1).mean()))


def _only(labels: Volume, kept: Sequence[int]) -> Volume:
    """These vertebrae alone."""
    return Labels(labels.array, labels.ijk_to_reference).only(kept)


def _noises(case: _Case) -> Iterator[Row]:
    """Tracker noise, drawn anew for every frame: it moves each frame's echoes together, about the probe some 40 mm above them."""
    for mm, degrees in NOISES:
        rng = np.random.default_rng([case.seed, 52])
        points, beams = case.echoes.points.copy(), case.echoes.beams.copy()
        for frame in np.unique(case.echoes.frames):
            mine = case.echoes.frames == frame
            turn = Rotation.from_rotvec(np.deg2rad(degrees) * rng.standard_normal(3)).as_matrix()
            probe = points[mine].mean(axis=0) - 40.0 * beams[mine].mean(axis=0)
            points[mine] = (points[mine] - probe) @ turn.T + probe + mm * rng.standard_normal(3)
            beams[mine] = beams[mine] @ turn.T
        noisy = SweepEchoes(points, beams, case.echoes.scores, case.echoes.frames)
        found = register_echoes(noisy, case.bone, case.start(53, 0))
        yield case.row(f"tracker noise {mm:g} mm, {degrees:g} degrees; start 10 mm, 10 degrees", found)


def _sparse(case: _Case) -> Iterator[Row]:
    """Few frames, and other ways of scanning."""
    sweeps = [(f"{FRAMES // every} frames of nine angles", case.echoes[case.echoes.frames % every == 0]) for every in (6, 12)]
    paths = {"60 frames of one angle": single_angle_sweep(case.phantom, 60), "60 frames freehand": freehand_sweep(case.phantom, 60)}
    sweeps += [(name, _echoes(case.phantom, path, case.seed)) for name, path in paths.items()]
    for name, echoes in sweeps:
        yield case.row(f"{name}; start 10 mm, 10 degrees", register_echoes(echoes, case.bone, case.start(54, 0)))
        yield case.row(f"{name}; no start", register_echoes(echoes, case.bone))

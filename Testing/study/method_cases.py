"""The cases of the study: simulated patients, scans, wrong CTs and wrong poses, and what every method makes of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.compounding.methods.aif import AIF_COMPENSATED
from AIFReconLib.compounding.methods.average import AVERAGE
from AIFReconLib.compounding.methods.table import BONE_METHODS, COMPARED_METHODS, METHODS, method_named
from AIFReconLib.compounding.methods.weighted import WEIGHTED
from AIFReconLib.compounding.own.method import load_method
from AIFReconLib.compounding.state import Reconstruction
from AIFReconLib.evaluation.metrics import evaluate, shown_points
from AIFReconLib.evaluation.surface import BoneSurface
from AIFReconLib.evaluation.visibility import BoneTruth, SweepBeams, bone_truth
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.simulation.anatomy import LumbarAnatomy, LumbarPhantom, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import ProbePath, TrackingErrors, multi_angle_sweep, random_rigid, simulate_sweep, single_angle_sweep
from AIFReconLib.simulation.ultrasound import UltrasoundEffects
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

from .reference_methods import confidence_weighted_sector, incidence_weighted

SPACING = 1.0
HOLE_LIMIT = 2.0
SIGMA = 4.0
"""mm; width of the bone map, for every method alike."""

BEAM_THICKNESS = 3.0
MULTI_FRAMES, SINGLE_FRAMES = 360, 120
PLAIN, OURS = AVERAGE.name, WEIGHTED.name
CONTROLLED = (AIF_COMPENSATED.name, OURS)
"""Methods that are tried with CTs that show what is not there, or lack what is."""

WITHOUT_BONE = tuple(method for method in METHODS if method not in BONE_METHODS)
REFERENCES = {"confidence-weighted": confidence_weighted_sector.name, "incidence-weighted": incidence_weighted.name}
"""Methods of others, by what they are called here, tried with exact poses and CT."""

MISREGISTRATIONS = {
    "CT 1 mm off": (1.0, 0.0),
    "CT 2 mm off": (2.0, 0.0),
    "CT 4 mm off": (4.0, 0.0),
    "CT 2 deg off": (0.0, 2.0),
    "CT 5 deg off": (0.0, 5.0),
}
"""Length of the shift in a random direction, mm, and angle about a random axis through the middle vertebra, degrees."""

GRAY_SHADOWS = "gray shadows"
"""The condition in which reverberation and clutter lie behind bone, as in real images; otherwise shadows are black."""

BOTH = "bone that average and weighted show"
"""The condition in which widths and distances of the lines are compared on the same bone."""

OF_MULTI = "single-angle, of what multi-angle reaches"
TRACKER_NOISE = TrackingErrors(noise=0.5, noise_deg=1.0)


@dataclass(frozen=True)
class Row:
    """One reconstruction of the study and its numbers."""

    seed: int
    scan: str
    condition: str
    method: str
    direction: str
    metrics: dict[str, float]


@dataclass(frozen=True, eq=False)
class Scan:
    """A sweep with its configuration, and the truth it is measured against."""

    sequence: TrackedSequence
    truth: BoneTruth


def patient_rows(seed: int, own: tuple[str, ...] = ()) -> list[Row]:
    """All reconstructions of one simulated patient, with methods of one's own by their names. About ten minutes on one core."""
    for method in own:
        load_method(method)
    bone_methods = (*BONE_METHODS, *(name for name in own if method_named(name).needs_bone))
    phantom = make_lumbar_phantom(LumbarAnatomy.from_seed(seed))
    probe = PhasedArray()
    multi = simulated_scan(phantom, probe, multi_angle_sweep(phantom, MULTI_FRAMES), seed)
    rows = _exact(seed, "multi-angle", multi, phantom.labels, own)
    single = simulated_scan(phantom, probe, single_angle_sweep(phantom, SINGLE_FRAMES), seed)
    rows += _exact(seed, "single-angle", single, phantom.labels, own)
    against_multi = Scan(single.sequence, multi.truth)
    rows += [_row(seed, OF_MULTI, "exact", method, against_multi, phantom.labels) for method in (PLAIN, OURS)]
    about = _middle(phantom)
    for condition, (translation, rotation_deg) in MISREGISTRATIONS.items():
        wrong = phantom.labels.placed_by(random_rigid(translation, rotation_deg, np.random.default_rng([seed, 20]), about))
        rows += [_row(seed, "multi-angle", condition, method, multi, wrong) for method in bone_methods]
    noisy = simulate_sweep(phantom, probe, multi_angle_sweep(phantom, MULTI_FRAMES), seed=seed, errors=TRACKER_NOISE)
    noisy_scan = Scan(_configured(noisy, probe), multi.truth)
    rows += [_row(seed, "multi-angle", "tracker noise", method, noisy_scan, phantom.labels) for method in (*COMPARED_METHODS, *own)]
    gray = simulated_scan(phantom, probe, multi_angle_sweep(phantom, MULTI_FRAMES), seed, UltrasoundEffects(clutter=True))
    rows += [_row(seed, "multi-angle", GRAY_SHADOWS, method, gray, phantom.labels) for method in (*COMPARED_METHODS, *REFERENCES.values())]
    return rows + _controls(seed, phantom, probe, multi)


def _exact(seed: int, name: str, scan: Scan, labels: Volume, own: tuple[str, ...] = ()) -> list[Row]:
    methods = (*WITHOUT_BONE, *BONE_METHODS, *REFERENCES.values(), *own)
    rows = [_row(seed, name, "exact", method, scan, labels) for method in methods]
    rows += [_row(seed, name, "exact", method, scan, labels, "surface") for method in BONE_METHODS]
    return rows + _where_both_show(seed, name, scan, labels)


def _where_both_show(seed: int, name: str, scan: Scan, labels: Volume) -> list[Row]:
    """Average and `weighted` on the bone that both show: how wide and how far off their lines are is told of what each shows."""
    made = {method: _result(method, scan, labels) for method in (PLAIN, OURS)}
    both = np.logical_and.reduce([shown_points(result.intensity, scan.truth, result.mask) for result in made.values()])
    truth = restricted(scan.truth, both)
    return [Row(seed, name, BOTH, method, "", evaluate(result.intensity, truth, result.mask).to_dict()) for method, result in made.items()]


def _controls(seed: int, phantom: LumbarPhantom, probe: PhasedArray, multi: Scan) -> list[Row]:
    """A prior can flatter itself: CTs that show what is not there, or lack what is."""
    rows = []
    other = make_lumbar_phantom(LumbarAnatomy.from_seed(seed + 1000)).labels
    level = np.eye(4)
    level[2, 3] = phantom.anatomy.body_height + phantom.anatomy.disc_height
    without = without_middle_process(phantom)
    process = removed_surface(multi.truth.surface, without.bone_distance)
    for condition, labels in (
        ("CT of another patient", other),
        ("CT one level off", phantom.labels.placed_by(level)),
        ("CT lacks a process", without.labels),
    ):
        rows += [_row(seed, "multi-angle", condition, method, multi, labels) for method in CONTROLLED]
    of_process = Scan(multi.sequence, restricted(multi.truth, process))
    for condition, labels in (("right CT, that process", phantom.labels), ("CT lacks it, that process", without.labels)):
        rows += [_row(seed, "multi-angle", condition, method, of_process, labels) for method in (PLAIN, *CONTROLLED)]
    lacking = simulated_scan(without, probe, multi_angle_sweep(phantom, MULTI_FRAMES), seed)
    no_process = Scan(lacking.sequence, restricted(multi.truth, process, lacking.truth.shadows))
    for condition, labels in (("no process, right CT", without.labels), ("no process, CT shows one", phantom.labels)):
        rows += [_row(seed, "multi-angle", condition, method, no_process, labels) for method in (PLAIN, *CONTROLLED)]
    return rows


def _row(seed: int, scan_name: str, condition: str, method: str, scan: Scan, labels: Volume, direction: str = "gradient") -> Row:
    """Reconstruct and measure."""
    result = _result(method, scan, labels, direction)
    metrics = evaluate(result.intensity, scan.truth, result.mask).to_dict()
    return Row(seed, scan_name, condition, method, direction if method_named(method).needs_bone else "", metrics)


def _result(method: str, scan: Scan, labels: Volume, direction: str = "gradient") -> Reconstruction:
    bone = BoneMap.from_labels(labels, sigma_mm=SIGMA) if method_named(method).needs_bone else None
    settings = ReconstructionSettings(method=method, spacing=SPACING, hole_limit=HOLE_LIMIT, bone_direction=direction)
    return reconstruct(scan.sequence, settings, bone)


def simulated_scan(
    phantom: LumbarPhantom, probe: PhasedArray, path: ProbePath, seed: int, effects: UltrasoundEffects | None = None
) -> Scan:
    """A simulated sweep along a path, with a configuration as a recording has one, and the bone that its beams could show."""
    return scan_of(_configured(simulate_sweep(phantom, probe, path, effects=effects, seed=seed), probe), phantom, probe)


def scan_of(sequence: TrackedSequence, phantom: LumbarPhantom, probe: PhasedArray) -> Scan:
    """A simulated sweep with the bone that its beams could show."""
    poses = sweep_poses(sequence)
    beams = SweepBeams(poses.image_to_reference[poses.usable], sequence.frame_size, probe.geometry, probe.region, BEAM_THICKNESS)
    return Scan(sequence, bone_truth(phantom.labels.placed_by(phantom.ct_to_reference), beams, distance=phantom.bone_distance))


def _configured(sequence: TrackedSequence, probe: PhasedArray) -> TrackedSequence:
    calibration = {TransformName("Image", "Probe"): TransformSample(probe.image_to_probe)}
    return replace(sequence, configuration=PlusConfiguration(Path("simulated"), calibration, region=probe.region, probe=probe.geometry))


def _middle(phantom: LumbarPhantom) -> np.ndarray:
    junctions = phantom.spinolaminar_junctions()
    return junctions[len(junctions) // 2]


def without_middle_process(phantom: LumbarPhantom) -> LumbarPhantom:
    """The phantom after its middle spinous process was taken away: all bone more than 2 mm posterior of its lamina, at that level.

    Notes
    -----
    With r the signed distance to the box taken away, bone is where max(d, -r) <= 0.
    """
    _, y, z = _middle(phantom)
    half_level = (phantom.anatomy.body_height + phantom.anatomy.disc_height) / 2
    distance = phantom.bone_distance

    def taken_away(volume: Volume) -> np.ndarray:
        i_size, j_size, k_size = volume.grid.size
        k, j = np.meshgrid(np.arange(k_size), np.arange(j_size), indexing="ij")
        zeros = np.zeros_like(k)
        points = np.stack([zeros, j, k], axis=-1) @ volume.ijk_to_reference[:3, :3].T + volume.ijk_to_reference[:3, 3]
        box = np.maximum(points[..., 1] - (y - 2.0), np.abs(points[..., 2] - z) - half_level)
        return np.broadcast_to(box[:, :, None], (k_size, j_size, i_size)).astype(np.float32)

    cut = Volume(np.maximum(distance.array, -taken_away(distance)), distance.ijk_to_reference)
    labels = Volume(np.where(taken_away(phantom.labels) < 0, 0, phantom.labels.array).astype(np.uint8), phantom.labels.ijk_to_reference)
    return replace(phantom, bone_distance=cut, labels=labels)


def removed_surface(surface: BoneSurface, distance_without: Volume) -> np.ndarray:
    """Which points of a surface are bone no more once something was taken away, (n,) bool."""
    grid = distance_without.grid
    ijk = surface.points_reference @ grid.reference_to_ijk[:3, :3].T + grid.reference_to_ijk[:3, 3]
    i, j, k = np.clip(np.rint(ijk).astype(int), 0, np.array(grid.size) - 1).T
    return distance_without.array[k, j, i] > 1.0


def restricted(truth: BoneTruth, points: np.ndarray, shadows: Volume | None = None) -> BoneTruth:
    """A truth of some of its surface points only, (n,) bool; `shadows` where another scan is measured at them."""
    surface = truth.surface
    part = BoneSurface(surface.points_reference[points], surface.normals_reference[points], surface.areas[points], surface.labels[points])
    best = None if truth.best_cosine is None else truth.best_cosine[points]
    return BoneTruth(part, truth.distance, truth.border[points], best, shadows or truth.shadows)

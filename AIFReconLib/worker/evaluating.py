"""What else a program with windows has done for it: measuring, guidance in a sweep, calibrating, simulating.

What computes is imported where it is used: who asks does not load it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats, Matrix
from ..evaluation.quantities import BoneMetrics
from ..geometry.labels import Labels
from ..geometry.volume import Volume, VoxelGrid
from ..guidance.snapshot import GuidanceSnapshot, Share
from ..inspection.verdicts import Verdict, calibration_verdict, motion_verdict
from ..io.disk.workspace import workspace
from ..message import Sentence, message_of
from ..progress import Progress, part, report
from ..recipe.recipe import AUTOMATIC, Recipe
from ..remedies import PLACE_THE_CT
from ..sweep.frames import TrackedSequence

if TYPE_CHECKING:
    from ..calibration.calibration import Calibration
    from ..motion.motion import PatientMotion
    from ..workflows.job import ReconstructionJob

FAR = 0.5
"""mm that the CT may lie from where it belongs by the new calibration until that is told."""


def bone_of_ct(ct: Volume, progress: Progress | None = None) -> Labels:
    """The bone of a CT; see `labels_from_ct`."""
    from ..bone.ct.from_ct import labels_from_ct

    return labels_from_ct(ct, progress=progress)


def measured_volumes(
    volumes: Mapping[str, Volume],
    labels: Volume,
    sequence: TrackedSequence | None = None,
    mask: Volume | None = None,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
) -> dict[str, BoneMetrics]:
    """Bone metrics of several volumes of one sweep, by name; arguments as for `bone_truth` and `evaluate`."""
    from ..evaluation.metrics import evaluate
    from ..evaluation.visibility import SweepBeams, bone_truth

    beams = SweepBeams.of_sequence(sequence, recipe) if sequence is not None else None
    truth = bone_truth(labels, beams, progress=part(progress, 0.0, 0.6))
    results = {}
    for number, (name, volume) in enumerate(volumes.items()):
        report(progress, 0.6 + 0.4 * number / len(volumes), f"Measuring {name}")
        results[name] = evaluate(volume, truth, mask)
    report(progress, 1.0, "Measured")
    return results


def met_of_sweep(
    sequence: TrackedSequence,
    labels: Volume,
    labels_to_reference: Matrix,
    recipe: Recipe,
    motion: PatientMotion | None,
    progress: Progress | None = None,
) -> dict[str, Share]:
    """How much of what faces the back of each bone was met, by the label's number; see `coverage`. `motion` was taken out of the sweep."""
    from ..guidance.coverage import back_of_labels, coverage

    return back_of_labels(coverage(_as_seen(sequence, motion, recipe), labels, labels_to_reference, recipe, progress=progress).met)


def calibration_of_sweep(
    sequence: TrackedSequence,
    labels: Volume,
    labels_to_reference: Matrix,
    recipe: Recipe,
    motion: PatientMotion | None,
    progress: Progress | None = None,
) -> Verdict:
    """Whether the calibration agrees with the bone of a CT that lies on the sweep, from which `motion` was taken out."""
    from ..workflows.register import calibration_by

    return calibration_verdict(calibration_by(list(sequence.sweeps), labels, labels_to_reference, recipe, progress, motion=motion))


def motion_of_sweep(job: ReconstructionJob, motion: PatientMotion | None, progress: Progress | None = None) -> Verdict:
    """Whether the patient moved in the sweep of a job, by its CT where it has one."""
    from ..effective_settings import takes_out_motion
    from ..workflows.reconstruct import without_motion

    if motion is not None:
        return motion_verdict(motion, taken_out=True)
    looking = replace(job, recipe=replace(job.recipe, motion=AUTOMATIC))
    return motion_verdict(without_motion(looking, progress)[1], takes_out_motion(job.recipe))


def _as_seen(sequence: TrackedSequence, motion: PatientMotion | None, recipe: Recipe) -> TrackedSequence:
    """The sweep as it went into the volume."""
    from ..motion.motion import taken_out

    return sequence if motion is None else taken_out(sequence, motion, recipe)


@dataclass(frozen=True, eq=False)
class _Calibrated:
    """What a sweep says of its calibration."""

    lines: tuple[str, ...]  #: For the user, a sentence or two each
    image_correction: Matrix | None  #: (4, 4), pixels: with_unit_depth(pose) @ this = mended pose; None where nothing is to be changed


def calibrated_by(
    sequence: TrackedSequence, labels: Volume, labels_to_reference: Matrix, recipe: Recipe, progress: Progress | None = None
) -> _Calibrated:
    """What a sweep, or several as one, says of its calibration; the arguments are those of `calibrate`, the CT lies on the sweep."""
    from ..calibration.calibration import calibrate, findings

    found = calibrate(sequence, labels, labels_to_reference, recipe=recipe, progress=progress)
    if found.reason is not None:
        return _Calibrated((Sentence(f"The calibration was not changed. {found.reason}", message_of(found.reason)),), None)
    if not found.needed:
        return _Calibrated(tuple(findings(found)), None)
    return _Calibrated((*findings(found), *_belongs(found, labels_to_reference)), found.image_correction)


def _belongs(found: Calibration, labels_to_reference: Matrix) -> list[str]:
    """Where the CT belongs by the new calibration, if that is elsewhere."""
    points = np.column_stack([found.echoes_on_bone[1], np.ones(len(found.echoes))])
    apart = float(np.median(np.linalg.norm((points @ (found.labels_to_reference - labels_to_reference).T)[:, :3], axis=1)))
    return [Sentence(f"With it the CT belongs {apart:.1f} mm from where it lies.", PLACE_THE_CT)] if apart > FAR else []


def guidance_in_sweep(
    sequence: TrackedSequence,
    labels: Volume | None,
    labels_to_reference: Matrix | None,
    recipe: Recipe,
    grid: VoxelGrid | None = None,
    unseen: Floats | None = None,
    progress: Progress | None = None,
) -> GuidanceSnapshot:
    """What is shown of what `guidance_of_sweep` tells."""
    from ..effective_settings import takes_out_motion
    from ..guidance.guidance import guidance_of_sweep
    from ..registration.labeled_bone import LabeledBone
    from ..workflows.reconstruct import mended

    if takes_out_motion(recipe):
        bone = None if labels is None else LabeledBone(labels, labels_to_reference, sequence, recipe)
        sequence = mended(sequence, bone, recipe, part(progress, 0.0, 0.3))
        progress = part(progress, 0.3, 1.0)
    return guidance_of_sweep(sequence, labels, labels_to_reference, recipe, grid=grid, unseen=unseen, progress=progress).seen()


@dataclass(frozen=True, eq=False)
class _SimulatedPatient:
    """The CT of a lumbar spine, its labels 1, 2, ..., where they lie, and a sweep of it."""

    ct: Volume
    labels: Volume
    ct_to_reference: Matrix
    sweep: TrackedSequence


def simulated_patient(
    seed: int = 0, vertebrae: int = 3, frames: int = 21, spacing: float = 1.25, above: float = 0.0, progress: Progress | None = None
) -> _SimulatedPatient:
    """A patient, by `seed`: the CT has voxels of `spacing` mm, 0.2 to 3, the sweep so many frames, 9 or more, from `above` mm higher."""
    from ..io.plus.configuration import read_plus_configuration
    from ..simulation.anatomy import LumbarAnatomy
    from ..simulation.phased_array import PhasedArray
    from ..simulation.scan import multi_angle_sweep, plus_configuration_xml
    from ..workflows.simulate import simulated

    anatomy = LumbarAnatomy.from_seed(seed, vertebrae=vertebrae)
    way = partial(multi_angle_sweep, above=above)
    phantom, sweep = simulated(seed, way, frames, anatomy=anatomy, spacing=spacing, progress=progress)
    with workspace(Path(tempfile.gettempdir())) as folder:
        path = folder / "PlusDeviceSet.xml"
        path.write_text(plus_configuration_xml(PhasedArray()), encoding="utf-8")
        configuration = read_plus_configuration(path)
    sweep = replace(sweep, configuration=configuration, path=Path("lumbar phantom"))
    return _SimulatedPatient(phantom.ct, phantom.labels, phantom.ct_to_reference, sweep)


def write_settings(settings: Mapping[str, object], path: str | Path) -> None:
    """Write the settings of a volume, as `provenance.settings_files.write_settings` does."""
    from ..provenance import settings_files

    settings_files.write_settings(settings, path)

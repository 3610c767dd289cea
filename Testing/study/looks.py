"""Does the same scan show the same bone whatever gain, gray curve and depth gain the scanner was set to?

    python Testing/study looks --output study-output/looks

Ten patients of real shape and the fibula, each under the looks of `scanner_looks.py`, by every method. A volume of another look has other
gray levels: before it is measured, these are taken to those of the volume as recorded, by the percentiles of both. What a look does to the
picture and what it does to judging it are told apart: `weighted` is also measured where a look is judged and the frames as recorded are
put into the voxels. Three minutes a source.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from unittest import mock

import numpy as np
import pandas as pd
from measured import table

from AIFReconLib.compounding.layout import PixelLayout
from AIFReconLib.compounding.state import Reconstruction
from AIFReconLib.effective_settings import resolve_imaging
from AIFReconLib.errors import AIFReconError
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.visibility import BoneTruth
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.imaging.beams import LINEAR
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep
from AIFReconLib.sweep.edits import select_frames
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

from .command import Study
from .method_cases import (
    EFFECTS,
    HOLE_LIMIT,
    MULTI_FRAMES,
    OURS,
    PAPER,
    PLAIN,
    SHAPES,
    SPACING,
    WITHOUT_CT,
    bone_for,
    patient_of,
    placed_labels,
    simulated_scan,
)
from .real_bone_cases import HOLE_LIMIT as FIBULA_HOLE_LIMIT
from .real_bone_cases import SPACING as FIBULA_SPACING
from .real_bone_cases import RealBone
from .real_bone_measures import precision
from .scanner_looks import LOOKS

Look = Callable[[np.ndarray], np.ndarray]

COMPARED = (PLAIN, PAPER, OURS, WITHOUT_CT)
JUDGED = {OURS: f"{OURS}, judged", WITHOUT_CT: f"{WITHOUT_CT}, judged"}
"""Methods under a look that is judged, where the frames as recorded are put into the voxels."""

FIBULA = 0
"""Number of the source that is no patient; the others are the patients of seeds 0, 1, ..."""

PERCENTILES = np.linspace(0.0, 100.0, 257)


@dataclass(frozen=True)
class Row:
    """One reconstruction, of the source of this number; refused ones have no metrics."""

    seed: int
    look: str
    method: str
    metrics: dict[str, float]


def source_of(seed: int) -> tuple[TrackedSequence, Volume, BoneTruth, ReconstructionSettings]:
    """The sweep of a patient or of the fibula (every second frame), its labels, its truth, and how it is reconstructed."""
    if seed == FIBULA:
        bone = RealBone.found()
        sweep = select_frames(bone.sequence, 0, len(bone.sequence) - 1, 2)
        return sweep, bone.labels, bone.truth, ReconstructionSettings(probe=LINEAR, spacing=FIBULA_SPACING, hole_limit=FIBULA_HOLE_LIMIT)
    back = patient_of(SHAPES, seed - 1)
    scan = simulated_scan(back, PhasedArray(), multi_angle_sweep(back, MULTI_FRAMES), seed - 1, EFFECTS)
    return scan.sequence, placed_labels(back), scan.truth, ReconstructionSettings(spacing=SPACING, hole_limit=HOLE_LIMIT)


def rows_of(seed: int) -> list[Row]:
    """All looks and methods of one source."""
    sweep, labels, truth, settings = source_of(seed)
    recorded, rows = np.asarray(sweep.images), []
    for method in COMPARED:
        plain: Reconstruction | None = None
        for name, look in LOOKS.items():
            seen = replace(sweep, images=look(recorded))
            try:
                result = _reconstructed(seen, labels, settings, method)
            except AIFReconError:
                rows.append(Row(seed, name, method, {}))
                continue
            plain = plain or result
            metrics = evaluate(matched(result, plain), truth, result.mask).to_dict()
            metrics["precision"] = precision(matched(result, plain), truth)["precision_180"]
            rows.append(Row(seed, name, method, metrics))
            if method in JUDGED:
                judged = _reconstructed(seen, labels, settings, method, sweep, look)
                rows.append(Row(seed, name, JUDGED[method], evaluate(judged.intensity, truth, judged.mask).to_dict()))
    return rows


def _reconstructed(
    seen: TrackedSequence,
    labels: Volume,
    settings: ReconstructionSettings,
    method: str,
    recorded: TrackedSequence | None = None,
    look: Look | None = None,
) -> Reconstruction:
    """What a sweep shows as it is `seen`; where it is `recorded` otherwise, that is put into the voxels."""
    settings = replace(settings, method=OURS if method == WITHOUT_CT else method)
    bone = bone_for(method, LabeledBone(labels, None, seen, settings), seen, settings)
    if recorded is None or look is None:
        return reconstruct(seen, settings, bone)
    levels = resolve_imaging(seen, sweep_poses(seen), True, settings).gray_levels
    pixels = PixelLayout.pixels
    # What an image tells of bone and shadow is judged as the look shows it
    with mock.patch.object(PixelLayout, "pixels", lambda self, image: pixels(self, look(image[None])[0])):
        return reconstruct(recorded, replace(settings, gray_levels=levels.landmarks), bone)


def matched(result: Reconstruction, to: Reconstruction) -> Volume:
    """The intensity of a result, its gray levels taken to those of another by the percentiles of what was measured."""
    own, other = (np.percentile(each.intensity.array[each.mask.array > 0], PERCENTILES) for each in (result, to))
    rising = own + 1e-6 * np.arange(len(own))
    values = np.interp(result.intensity.array.astype(np.float64), rising, other).astype(np.float32)
    return replace(result.intensity, array=np.where(result.mask.array > 0, values, 0))


def in_the_pages(rows: list[Row]) -> dict[str, str]:
    """What docs/study.md and docs/real-bone.md show, by the names of the files in docs/measured."""
    return {"study-looks": _worst_and_best(rows, False), "real-bone-looks": _worst_and_best(rows, True)}


def _worst_and_best(rows: list[Row], of_fibula: bool) -> str:
    of = [row for row in rows if (row.seed == FIBULA) is of_fibula]
    lines = []
    for method in (*COMPARED, *JUDGED.values()):
        cells = [method]
        for metric, form in (("bone_cnr", ".2f"), ("bone_coverage", ".0%")):
            numbers = {look: [row.metrics.get(metric, np.nan) for row in of if (row.method, row.look) == (method, look)] for look in LOOKS}
            means = pd.DataFrame(numbers).mean(skipna=False)
            cells += [f"{means.min():{form}} ({means.idxmin()})", f"{means.max():{form}}"]
        lines.append(cells)
    return table(("", "CNR, worst look", "best", "coverage, worst look", "best"), lines)


# Ten patients and the fibula
STUDY = Study(rows_of, Row, "reconstructions", in_the_pages, patients=11)

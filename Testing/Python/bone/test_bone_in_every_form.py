"""Real shapes of vertebrae as models and as labels: the same volume of a sweep over them."""

from __future__ import annotations

import numpy as np
from study.lumbar_shapes import LEVELS, lumbar_shapes
from study.method_cases import HOLE_LIMIT, simulated_scan
from sweeps import rigid

from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.io.volume.label_files import read_labels
from AIFReconLib.io.volume.models import read_model
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep


def test_a_sweep_gives_the_same_volume_with_models_and_with_labels(data_dir):
    files = [data_dir / "lumbar-shape" / f"{level}.stl" for level in LEVELS]
    models, back = read_labels(files), lumbar_shapes(0, warp=0.0, spacing=1.0)
    assert list(models.names.values()) == [*LEVELS]
    hindmost = min(read_model(files[0]).points, key=lambda point: point[1])
    scan = simulated_scan(back, PhasedArray(), multi_angle_sweep(back, 36), 0)

    def shown(bone, method="weighted"):
        result = reconstruct(scan.sequence, ReconstructionSettings(method=method, spacing=1.0, hole_limit=HOLE_LIMIT), bone)
        return result, evaluate(result.intensity, scan.truth, result.mask).bone

    exact, best = shown(LabeledBone(back.labels, None, scan.sequence))
    plain = shown(None, "average")[1]
    result, bone = shown(LabeledBone(models, rigid(translation=back.tips[0] - hindmost), scan.sequence))
    assert np.corrcoef(exact.intensity.array.ravel(), result.intensity.array.ravel())[0, 1] > 0.97
    assert bone.cnr > 0.94 * best.cnr > plain.cnr
    assert bone.coverage > 0.97 * best.coverage > plain.coverage
    # Half a voxel
    assert abs(bone.localization_bias - best.localization_bias) < 0.5

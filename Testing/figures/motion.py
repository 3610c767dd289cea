"""The picture of docs/motion.md: how a simulated patient breathed and shifted, and what was found of it, over time.

``python Testing/figures/motion.py``, or ``make figures``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib import pyplot

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from study.lumbar_shapes import lumbar_shapes
from study.method_cases import EFFECTS, configured, placed_labels

from AIFReconLib.bone.field import BoneField
from AIFReconLib.motion.motion import find_motion
from AIFReconLib.motion.solve import BoneInPlace
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import TrackingErrors, multi_angle_sweep, patient_motion, simulate_sweep

PICTURE = Path(__file__).resolve().parents[2] / "docs" / "images" / "motion.png"
SEED, FRAMES = 0, 297
ERRORS = TrackingErrors(breathing=2.0, shifting=1.0)


def main() -> None:
    """Simulate, find, draw."""
    back, probe = lumbar_shapes(SEED + 1), PhasedArray()
    path = multi_angle_sweep(back, FRAMES)
    sweep = configured(simulate_sweep(back, probe, path, errors=ERRORS, effects=EFFECTS, seed=SEED), probe)
    found = find_motion(sweep, BoneInPlace(BoneField.from_labels(placed_labels(back)), np.eye(4)))
    if found is None:
        raise SystemExit("no motion was found")
    places = np.append(found.curve.places, np.ones((FRAMES, 1)), axis=1)[:, :, None]
    true = (patient_motion(path.timestamps, ERRORS, SEED) @ places - places)[:, :3, 0]
    figure, axes = pyplot.subplots(figsize=(8, 3), layout="constrained")
    gaps = np.flatnonzero(np.diff(path.timestamps) > 1.0) + 1
    times = np.insert(path.timestamps, gaps, np.nan)
    for axis, name, color in ((1, "front-back", "#1f6f8b"), (2, "head-feet", "#c0562f")):
        shown, truth = (np.insert(each[:, axis] - each[:, axis].mean(), gaps, np.nan) for each in (found.shifts, true))
        axes.plot(times, truth, color=color, linewidth=4, alpha=0.3)
        axes.plot(times, shown, color=color, linewidth=1.2, label=name)
    axes.set_xlabel("time, s")
    axes.set_ylabel("mm")
    axes.legend(frameon=False, ncols=2, loc="upper right")
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(PICTURE, dpi=100)
    print(*found.lines, PICTURE, sep="\n")


if __name__ == "__main__":
    main()

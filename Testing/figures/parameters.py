"""Pictures of docs/parameters.md: what each parameter does to the same cut through the same simulated patient.

Run from anywhere: ``make figures``, or ``python Testing/figures/parameters.py``; the pictures go to docs/images. Takes a few minutes.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.evaluation.figures import Panel, cut_panel, draw_panels, own_looks, save_figure
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.slices import AXIAL, CORONAL, Plane
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.recipe.recipe import DEFAULT_SPACING, ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.simulation.anatomy import LumbarAnatomy, LumbarPhantom, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep, random_rigid
from AIFReconLib.terminal.console import ProgressBar

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from study.method_cases import Scan, simulated_scan

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
SEED, FRAMES = 0, 270
BASE = ReconstructionSettings(spacing=0.7, hole_limit=2.0)
SIGMA = 4.0
"""mm; the paper's 10 voxels on a CT of 0.4 mm."""

SIZE = 64.0, 46.0
"""mm of a panel."""

INCHES = 2.15
"""Width of a panel."""

BELIEVED_COLOR = "#45c8e8"


@dataclass(frozen=True, eq=False)
class Value:
    """One value of a parameter, and the bone that goes with it; without settings the bone map itself is drawn."""

    name: str
    settings: ReconstructionSettings | None
    bone: BoneMap
    believed: Volume | None = None  #: Labels of a wrong CT, drawn beside the true ones
    plane: Plane = AXIAL


Row = tuple[str, list[Value]]
"""What a parameter is called, and its values."""


def values(name: str, method: str, field: str, numbers: Sequence[Any], bone: BoneMap, **beside) -> Row:
    """A row of one field of the settings, its default marked."""
    default = ReconstructionSettings.__dataclass_fields__[field].metadata["default"]
    default = DEFAULT_SPACING if field == "spacing" else default
    plane = beside.pop("plane", AXIAL)
    made = replace(BASE, method=method, **beside)
    marked = [(f"{number:g}{', default' if number == default else ''}", number) for number in numbers]
    return f"{name}\n{method}", [Value(words, replace(made, **{field: number}), bone, plane=plane) for words, number in marked]


def rows(phantom: LumbarPhantom) -> dict[str, list[Row]]:
    """Every picture by the name of its file."""
    labels, methods = phantom.labels, ("weighted", "aif-compensated")
    bone = BoneMap.from_labels(labels, sigma_mm=SIGMA)
    maps = {f"{sigma:g} mm": BoneMap.from_labels(labels, sigma_mm=sigma) for sigma in (1.0, 2.0, 4.0, 8.0)}
    errors = {"exact": (0.0, 0.0), "2 mm off": (2.0, 0.0), "5 mm off": (5.0, 0.0), "5 degrees off": (0.0, 5.0)}
    about = phantom.spinolaminar_junctions()[2]
    placed = {name: labels.placed_by(random_rigid(*error, np.random.default_rng([SEED, 20]), about)) for name, error in errors.items()}

    def registered(method: str) -> list[Value]:
        made = replace(BASE, method=method)
        maps = {name: BoneMap.from_labels(wrong, sigma_mm=SIGMA) for name, wrong in placed.items()}
        return [Value(name, made, found, None if name == "exact" else placed[name]) for name, found in maps.items()]

    def of_sigma(method: str) -> list[Value]:
        return [Value(name, replace(BASE, method=method), found) for name, found in maps.items()]

    return {
        "parameters-bone-map": [
            ("--bone-sigma-mm\nthe map itself", [Value(name, None, found) for name, found in maps.items()]),
            *((f"--bone-sigma-mm\n{method}", of_sigma(method)) for method in methods),
        ],
        "parameters-registration": [(f"registration\n{method}", registered(method)) for method in methods],
        "parameters-aif": [
            values("--alpha", "aif", "alpha", (0.0, 0.1, 1.0, 5.0), bone),
            values("--alpha", "aif-compensated", "alpha", (0.0, 0.1, 1.0, 5.0), bone),
            values("--beta", "aif-compensated", "beta", (0.02, 0.1, 0.5, 1.0), bone),
        ],
        "parameters-weighted": [
            values("--bone-gain", "weighted", "bone_gain", (0.0, 1.0, 4.0, 10.0), bone),
            values("--weight-floor", "weighted", "weight_floor", (0.0003, 0.003, 0.03, 1.0), bone),
        ],
        "parameters-volume": [
            values("--spacing, mm", "weighted", "spacing", (0.3, 0.5, 1.0, 2.0), bone),
            values("--hole-limit, mm", "weighted", "hole_limit", (0.0, 1.0, 2.0, 5.0), bone, plane=CORONAL, skip=3),
        ],
    }


def panel_of(value: Value, scan: Scan, center_ras: np.ndarray, labels: Volume) -> Panel:
    """Reconstruct and measure; the panel says what came of it."""
    place = center_ras, SIZE
    if value.settings is None:
        shown = cut_panel(value.name, value.bone.probability, value.plane, place, (0.0, 1.0), None, labels)
        return replace(shown, picture=np.nan_to_num(shown.picture))
    result = reconstruct(scan.sequence, value.settings, value.bone)
    found = evaluate(result.intensity, scan.truth, result.mask).bone
    name = f"{value.name}: CNR {found.cnr:.1f}, {found.coverage:.0%}"
    return cut_panel(name, result.intensity, value.plane, place, (0.0, 255.0), result.mask, labels)


@own_looks()
def main() -> None:
    """Draw every picture."""
    with ProgressBar() as progress:
        phantom = make_lumbar_phantom(LumbarAnatomy.from_seed(SEED))
        scan = simulated_scan(phantom, PhasedArray(), multi_angle_sweep(phantom, FRAMES), SEED)
        center_ras = phantom.spinous_tips()[1] + (0.0, 15.0, 0.0)
        pictures = rows(phantom)
        for number, (name, pictured) in enumerate(pictures.items()):
            progress(number / len(pictures), f"Drawing {name}")
            drawn = [[panel_of(value, scan, center_ras, phantom.labels) for value in row] for _, row in pictured]
            panels = [[replace(first, side=title), *others] for (title, _), (first, *others) in zip(pictured, drawn, strict=True)]
            figure = draw_panels(panels, INCHES / SIZE[0], "CNR and coverage of each", "blue: not scanned")
            for axes, value in zip(figure.axes, (value for _, row in pictured for value in row), strict=True):
                if value.believed is not None:
                    outline = cut_panel("", value.believed, value.plane, (center_ras, SIZE), (0, 1), None, value.believed).outline
                    axes.contour(
                        outline, [0.5], colors=[BELIEVED_COLOR], linewidths=0.6, extent=(0.0, SIZE[0], SIZE[1], 0.0), origin="upper"
                    )
            save_figure(IMAGES / f"{name}.png", figure)


if __name__ == "__main__":
    main()

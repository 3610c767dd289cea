"""Pictures of docs/parameters.md: what each parameter does to the same cut through the same simulated patient.

Run from anywhere: ``make figures``, or ``python Testing/figures/parameters.py``; the pictures go to docs/images. Takes a few minutes.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.evaluation.figures import BACKGROUND, BONE_COLOR, INK, NOT_SCANNED
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.slices import AXIAL, CORONAL, Plane, cut
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.progress import part
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

WIDTH, HEIGHT, PITCH = 64.0, 46.0, 0.2
"""mm of a panel and of its pixels."""

PANEL, GAP, TITLE, CAPTION = 2.15, 0.06, 0.24, 0.34
"""Inches: width of a panel, between panels, above a row for its parameter and above each panel for its value and numbers."""

DPI = 105
DEFAULT = ", default"
BELIEVED_COLOR = "#45c8e8"


@dataclass(frozen=True, eq=False)
class Panel:
    """One value of a parameter: what is written over it, and what is reconstructed with it.

    `map_only` draws the bone map instead; `believed` are labels of a wrong CT, drawn beside the true ones.
    """

    name: str
    settings: ReconstructionSettings
    bone: BoneMap
    map_only: bool = False
    believed: Volume | None = None


@dataclass(frozen=True, eq=False)
class Row:
    """A parameter: what it is called, its panels, and the plane that shows it."""

    title: str
    panels: tuple[Panel, ...]
    plane: Plane = AXIAL


def values(
    title: str, method: str, field: str, numbers, bone: BoneMap, unit: str = "", plane: Plane = AXIAL, base: ReconstructionSettings = BASE
) -> Row:
    """A row of one field of the settings, its default marked."""
    default = ReconstructionSettings.__dataclass_fields__[field].metadata["default"]
    default = DEFAULT_SPACING if field == "spacing" else default
    panels = (
        Panel(f"{number:g}{unit}{DEFAULT if number == default else ''}", replace(base, method=method, **{field: number}), bone)
        for number in numbers
    )
    return Row(f"{title} ({method})", tuple(panels), plane)


def rows(phantom: LumbarPhantom) -> dict[str, tuple[Row, ...]]:
    """Every picture by the name of its file."""
    labels = phantom.labels
    bone = BoneMap.from_labels(labels, sigma_mm=SIGMA)
    about = phantom.spinolaminar_junctions()[2]

    def sigma_panels(method: str | None) -> tuple[Panel, ...]:
        maps = {sigma: BoneMap.from_labels(labels, sigma_mm=sigma) for sigma in (1.0, 2.0, 4.0, 8.0)}
        return tuple(
            Panel(f"{sigma:g} mm", replace(BASE, method=method or "average"), found, map_only=method is None)
            for sigma, found in maps.items()
        )

    def registration_panels(method: str) -> tuple[Panel, ...]:
        errors = {"exact": (0.0, 0.0), "2 mm off": (2.0, 0.0), "5 mm off": (5.0, 0.0), "5 degrees off": (0.0, 5.0)}
        placed = {name: labels.placed_by(random_rigid(*error, np.random.default_rng([SEED, 20]), about)) for name, error in errors.items()}
        return tuple(
            Panel(
                name, replace(BASE, method=method), BoneMap.from_labels(wrong, sigma_mm=SIGMA), believed=None if name == "exact" else wrong
            )
            for name, wrong in placed.items()
        )

    return {
        "parameters-bone-map": (
            Row("the bone map itself: --bone-sigma-mm", sigma_panels(None)),
            Row("--bone-sigma-mm (weighted)", sigma_panels("weighted")),
            Row("--bone-sigma-mm (aif-compensated)", sigma_panels("aif-compensated")),
        ),
        "parameters-registration": (
            Row("registration of the CT (weighted)", registration_panels("weighted")),
            Row("registration of the CT (aif-compensated)", registration_panels("aif-compensated")),
        ),
        "parameters-aif": (
            values("--alpha", "aif", "alpha", (0.0, 0.1, 1.0, 5.0), bone),
            values("--alpha", "aif-compensated", "alpha", (0.0, 0.1, 1.0, 5.0), bone),
            values("--beta", "aif-compensated", "beta", (0.02, 0.1, 0.5, 1.0), bone),
        ),
        "parameters-weighted": (
            values("--bone-gain", "weighted", "bone_gain", (0.0, 1.0, 4.0, 10.0), bone),
            values("--weight-floor", "weighted", "weight_floor", (0.0003, 0.003, 0.03, 1.0), bone),
        ),
        "parameters-volume": (
            values("--spacing", "weighted", "spacing", (0.3, 0.5, 1.0, 2.0), bone, " mm"),
            values(
                "every 3rd frame, --hole-limit", "weighted", "hole_limit", (0.0, 1.0, 2.0, 5.0), bone, " mm", CORONAL, replace(BASE, skip=3)
            ),
        ),
    }


def draw(name: str, pictured: tuple[Row, ...], scan: Scan, center_ras: np.ndarray, labels: Volume, progress) -> None:
    """Reconstruct, measure and draw one picture."""
    panel_height = PANEL * HEIGHT / WIDTH
    columns = max(len(row.panels) for row in pictured)
    width = columns * PANEL + (columns + 1) * GAP
    row_height = panel_height + TITLE + CAPTION + GAP
    height = len(pictured) * row_height
    figure = Figure(figsize=(width, height), facecolor=BACKGROUND)
    FigureCanvasAgg(figure)
    count = sum(len(row.panels) for row in pictured)
    done = 0
    for number, row in enumerate(pictured):
        top = height - number * row_height
        figure.text(GAP / width, (top - 0.6 * TITLE) / height, row.title, color=INK, fontsize=10, weight="bold", va="center")
        for column, panel in enumerate(row.panels):
            left = GAP + column * (PANEL + GAP)
            bottom = top - TITLE - CAPTION - panel_height
            axes = figure.add_axes((left / width, bottom / height, PANEL / width, panel_height / height))
            axes.set_title(_panel(axes, panel, row.plane, scan, center_ras, labels), color=INK, fontsize=8, pad=2.5, linespacing=1.2)
            done += 1
            progress(done / count, f"Drawing {name}")
    _scale_bar(axes)
    figure.savefig(IMAGES / f"{name}.png", dpi=DPI, facecolor=BACKGROUND)


def _panel(axes, panel: Panel, plane: Plane, scan: Scan, center_ras: np.ndarray, labels: Volume) -> str:
    """Draw one panel; what is to be written over it."""
    extent = (0.0, WIDTH, HEIGHT, 0.0)
    axes.set_facecolor(NOT_SCANNED)
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)
    if panel.map_only:
        picture = np.nan_to_num(cut(panel.bone.probability, plane, center_ras, WIDTH, HEIGHT, PITCH))
        axes.imshow(picture, cmap="inferno", vmin=0, vmax=1, extent=extent)
        caption = panel.name
    else:
        result = reconstruct(scan.sequence, panel.settings, panel.bone)
        picture = np.nan_to_num(cut(result.intensity, plane, center_ras, WIDTH, HEIGHT, PITCH))
        empty = np.nan_to_num(cut(result.mask, plane, center_ras, WIDTH, HEIGHT, PITCH, order=0)) == 0
        axes.imshow(np.ma.masked_array(picture, mask=empty), cmap="gray", vmin=0, vmax=255, extent=extent)
        metrics = evaluate(result.intensity, scan.truth, result.mask)
        caption = f"{panel.name}\nCNR {metrics.bone.cnr:.1f}, coverage {metrics.bone.coverage:.0%}"
    outlines = [(labels, BONE_COLOR)] if panel.believed is None else [(panel.believed, BELIEVED_COLOR), (labels, BONE_COLOR)]
    for shown, color in outlines:
        bony = replace(shown, array=(shown.array > 0).astype(np.float32))
        outline = np.nan_to_num(cut(bony, plane, center_ras, WIDTH, HEIGHT, PITCH))
        axes.contour(outline, levels=[0.5], colors=[color], linewidths=0.5, alpha=0.8, extent=extent, origin="upper")
    for letter, x, y in zip(plane.edges, (0.03, 0.97, 0.5, 0.5), (0.5, 0.5, 0.95, 0.05), strict=True):
        axes.text(x, y, letter, color=INK, alpha=0.7, fontsize=6, ha="center", va="center", transform=axes.transAxes)
    return caption


def _scale_bar(axes, length: float = 10.0) -> None:
    x, y = WIDTH - length - 3.0, HEIGHT - 3.0
    axes.plot([x, x + length], [y, y], color=INK, linewidth=1.5, solid_capstyle="butt")
    axes.text(x + length / 2, y - 1.0, f"{length:g} mm", color=INK, fontsize=6.5, ha="center", va="bottom")


def main() -> None:
    """Draw every picture."""
    with ProgressBar() as progress:
        phantom = make_lumbar_phantom(LumbarAnatomy.from_seed(SEED))
        scan = simulated_scan(phantom, PhasedArray(), multi_angle_sweep(phantom, FRAMES), SEED)
        center_ras = phantom.spinous_tips()[1] + (0.0, 15.0, 0.0)
        pictures = rows(phantom)
        for number, (name, pictured) in enumerate(pictures.items()):
            share = part(progress, 0.3 + 0.7 * number / len(pictures), 0.3 + 0.7 * (number + 1) / len(pictures))
            draw(name, pictured, scan, center_ras, phantom.labels, share)


if __name__ == "__main__":
    main()

"""The study on real bone in pictures: cuts across it, curves, and its echoes by the angle."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from AIFReconLib.compounding.methods.average import AVERAGE
from AIFReconLib.compounding.methods.table import BONE_METHODS
from AIFReconLib.evaluation.lines import values_at
from AIFReconLib.geometry.volume import Volume

from .method_figure import COLORS, new_figure, saved
from .real_bone_cases import CONTRAST, IN_PLACE, Case, RealBone, Row
from .real_bone_measures import INCIDENCES, THRESHOLDS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SOURCE = "Ultrasound and CT: UltraBones100k (Wu, Cavalcanti, Seibold et al.), CC BY 4.0; reconstructed by AIFRecon."
SHOWN = (AVERAGE.name, CONTRAST, *BONE_METHODS)
CURVES = {**COLORS, "confidence-weighted": "#5b8f4e", CONTRAST: "#a05fa8"}
PLACES = (0.15, 0.4, 0.65, 0.9)
"""Of the cuts along the bone: parts of its points that lie before."""

CUT, PITCH = 30.0, 0.25
"""mm. Side of a cut and of its pixels."""


def real_bone_figures(folder: Path, bone: RealBone, rows: list[Row]) -> list[Path]:
    """Draw what volumes show; the answer names the files.

    Raises
    ------
    OutputError
        When a file cannot be written.
    """
    volumes = {method: bone.reconstructed(Case(IN_PLACE, SHOWN), method).intensity for method in SHOWN}
    curves = _curves([row for row in rows if row.condition == IN_PLACE])
    return [saved(_cuts(bone, volumes), folder / "real-bone-cuts.png"), saved(curves, folder / "real-bone-curves.png")]


def angle_figure(folder: Path, angles: list[dict[str, float]], shadows: list[dict[str, float]]) -> Path:
    """How bright real bone is by the angle, and what is left behind it, as `angle_rows` and `shadow_rows` have it."""
    figure = new_figure(12.0, 3.8)
    levels, shares, shadow = figure.subplots(1, 3)
    middles = [row["middle"] for row in angles]

    behind = [(row["near"] + row["far"]) / 2 for row in shadows]
    levels.fill_between(middles, *([row[f"peak_{part}"] for row in angles] for part in (25, 75)), color="#e07b00", alpha=0.2, linewidth=0)
    of_levels = ("peak", "echo of bone", "#e07b00"), ("elsewhere", "traced 6 mm before", "#8a8a8a"), ("tissue", "tissue", "#7fb2e5")
    of_shares = ("share", "real", "#e07b00"), ("simulated", "simulated", "#2f6db3"), ("cosine", "cosine", "#8a8a8a")
    of_shadow = ("gray", "real", "#e07b00"), ("black", "simulated, black", "#8a8a8a"), ("clutter", "simulated, clutter", "#2f6db3")
    incidence = "angle of incidence, degrees"
    for ax, x, rows, curves, title, below in (
        (levels, middles, angles, of_levels, "gray level; band: quartiles of the echo", incidence),
        (shares, middles, angles, of_shares, "echo over tissue, of that met squarely", incidence),
        (shadow, behind, shadows, of_shadow, "gray level in the shadow", "mm behind the echo"),
    ):
        for name, label, color in curves:
            style = "--" if name == "cosine" else "-"
            ax.plot(x, [row[name] for row in rows], style, color=color, label=label, marker="o", markersize=3.5)
        _bare(ax, title, below)
        ax.set_ylim(bottom=0)
        ax.legend(frameon=False, fontsize=8)
    figure.supxlabel(SOURCE.replace("; reconstructed by AIFRecon", ""), fontsize=8)
    return saved(figure, folder / "real-bone-angles.png")


def _bare(ax: Axes, title: str, label: str) -> None:
    """The title and the label below; no frame above and beside."""
    ax.set_title(title, fontsize=10, loc="left")
    ax.set_xlabel(label, fontsize=9)
    ax.grid(linewidth=0.3)
    ax.spines[["top", "right"]].set_visible(False)


def _cuts(bone: RealBone, volumes: dict[str, Volume]) -> Figure:
    """Cuts across the bone, the probe above, the CT's outline over them."""
    down, across, _ = bone.axes
    points = bone.reached[0]
    figure = new_figure(2.6 * len(volumes), 2.7 * len(PLACES))
    axes = figure.subplots(len(PLACES), len(volumes))
    pixels = (np.arange(-CUT / 2, CUT / 2, PITCH) + PITCH / 2)[:, None]
    plane = pixels[None] * across + pixels[:, None] * down
    along = points @ bone.axes[2]
    for ax, method in zip(axes[0], volumes, strict=True):
        ax.set_title(method, fontsize=11)
    for line, place in zip(axes, PLACES, strict=True):
        near = np.abs(along - np.quantile(along, place)) < 2.0
        middle = points[near].mean(axis=0) + 3.0 * down
        outline = values_at(bone.truth.distance, middle + plane, outside=1.0)
        for ax, volume in zip(line, volumes.values(), strict=True):
            ax.imshow(values_at(volume, middle + plane), cmap="gray", vmin=0, vmax=255, extent=(0, CUT, CUT, 0))
            ax.contour(outline, [0.0], colors="#ff9a1f", linewidths=0.7, extent=(0, CUT, 0, CUT))
            ax.set_axis_off()
    axes[0, 0].plot([2, 12], [28, 28], color="white", linewidth=2)
    axes[0, 0].text(7, 27, "10 mm", color="white", fontsize=8, ha="center", va="bottom")
    figure.supxlabel(f"{SOURCE} Orange: the bone from CT.", fontsize=8)
    return figure


def _curves(rows: list[Row]) -> Figure:
    """Coverage and CNR against incidence, and precision against what is shown."""
    figure = new_figure(12.0, 3.8)
    covered, contrast, precise = figure.subplots(1, 3)
    middles = [(low + high) / 2 for low, high in pairwise(INCIDENCES)]
    for row in rows:
        if row.method in CURVES:
            look = {"color": CURVES[row.method], "label": row.method, "marker": "o", "markersize": 3.5}
            covered.plot(middles, [100 * row.metrics[f"bone_coverage_{low}"] for low in INCIDENCES[:-1]], **look)
            contrast.plot(middles, [row.metrics[f"bone_cnr_{low}"] for low in INCIDENCES[:-1]], **look)
            curve = [(100 * row.metrics[f"shown_{level}"], 100 * row.metrics[f"precision_{level}"]) for level in THRESHOLDS]
            precise.plot(*np.array(curve).T, **look)
    for ax, title, label in (
        (covered, "coverage, %", "best angle of incidence, degrees"),
        (contrast, "CNR", "best angle of incidence, degrees"),
        (precise, "of bright voxels near bone, % within 1.5 mm of it", "of bone that beams reached, % shown so bright"),
    ):
        _bare(ax, title, label)
    handles, labels = covered.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(handles), frameon=False, fontsize=10)
    return figure

"""The study in one picture: what every method makes of right and wrong CTs and poses."""

from __future__ import annotations

from pathlib import Path

from AIFReconLib.compounding.methods.table import COMPARED_METHODS, method_named
from AIFReconLib.io.disk.atomic import atomic_output

from .method_cases import Row
from .patients import spread_of

CONDITIONS = ("exact", "CT 2 mm off", "CT 4 mm off", "CT 5 deg off", "tracker noise", "CT of another patient", "CT one level off")
PANELS = (
    ("bone_cnr", "CNR, reachable bone", 1.0),
    ("oblique_cnr", "CNR, bone beyond 45 degrees", 1.0),
    ("bone_coverage", "coverage, %", 100.0),
    ("interspinous_coverage", "interspinous visibility, %", 100.0),
    ("bone_thickness", "thickness, mm (less is better)", 1.0),
    ("speckle_snr", "speckle SNR of soft tissue", 1.0),
)
COLORS = dict(zip(COMPARED_METHODS, ("#8a8a8a", "#7fb2e5", "#2f6db3", "#e07b00", "#5b8f4e", "#a05fa8"), strict=False))


def study_figure(path: str | Path, rows: list[Row]) -> None:
    """Draw medians with quartiles of the multi-angle scans, by condition and method.

    Raises
    ------
    OutputError
        When the file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12, 7.2), layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    for ax, (name, title, scale) in zip(figure.subplots(2, 3).flat, PANELS, strict=True):
        for number, (method, color) in enumerate(COLORS.items()):
            for place, condition in enumerate(CONDITIONS):
                spread = _spread(rows, name, condition, method)
                if spread is None:
                    continue
                x = place + 0.8 / len(COLORS) * (number - (len(COLORS) - 1) / 2)
                low, median, high = (scale * value for value in (spread.low, spread.median, spread.high))
                ax.bar(x, median, width=0.72 / len(COLORS), color=color, label=method if place == 0 else None)
                ax.plot([x, x], [low, high], color="black", linewidth=0.8)
        ax.set_title(title, fontsize=10, loc="left")
        ax.set_xticks(range(len(CONDITIONS)), CONDITIONS, fontsize=7, rotation=30, ha="right", rotation_mode="anchor")
        ax.tick_params(axis="y", labelsize=8)
        ax.axhline(0, color="black", linewidth=0.6)
        for side in ("top", "right"):
            ax.spines[side].set_visible(False)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(COLORS), frameon=False, fontsize=10)
    with atomic_output(path) as temporary:
        figure.savefig(temporary, dpi=100)


def _spread(rows: list[Row], name: str, condition: str, method: str):
    """The spread of a number, None where nothing is known; that of a method without bone stands for every wrong CT."""
    wanted = {"scan": "multi-angle", "condition": condition, "method": method, "direction": "gradient"}
    if not method_named(method).needs_bone:
        wanted = {**wanted, "direction": "", "condition": "tracker noise" if condition == "tracker noise" else "exact"}
    spread = spread_of(rows, name, **wanted)
    return spread if spread.median == spread.median else None

"""The study in one picture: what every method makes of right and wrong CTs and poses."""

from __future__ import annotations

from pathlib import Path

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
COLORS = {"average": "#8a8a8a", "aif": "#7fb2e5", "aif-compensated": "#2f6db3", "weighted": "#e07b00"}


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
                x = place + 0.2 * (number - 1.5)
                low, median, high = (scale * value for value in (spread.low, spread.median, spread.high))
                ax.bar(x, median, width=0.18, color=color, label=method if place == 0 else None)
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
    """The spread of a number; the average's does not depend on the CT, so it stands for every wrong one. None where nothing is known."""
    wanted = {"scan": "multi-angle", "condition": condition, "method": method, "direction": "gradient"}
    if method == "average":
        wanted = {**wanted, "direction": "", "condition": "tracker noise" if condition == "tracker noise" else "exact"}
    spread = spread_of(rows, name, **wanted)
    return spread if spread.median == spread.median else None

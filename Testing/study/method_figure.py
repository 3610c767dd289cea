"""The study in one picture: what every method makes of right and wrong CTs, on both kinds of patients."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

from AIFReconLib.compounding.methods.table import COMPARED_METHODS
from AIFReconLib.io.disk.atomic import atomic_output

from .method_cases import COMPARED, KINDS, LEVEL, OTHER, PLAIN, SHIFTS, WITHOUT_CT, Row
from .method_page import RIGHT
from .patients import quartiles

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CONDITIONS = (RIGHT, *SHIFTS, LEVEL, OTHER)
PANELS = (
    ("bone_coverage", "bone that is shown, %"),
    ("oblique_coverage", "oblique bone that is shown, %"),
    ("lines_called_free", "blocked paths that look free, %"),
)
COLORS = {**dict(zip(COMPARED_METHODS, ("#8a8a8a", "#7fb2e5", "#2f6db3", "#e07b00"), strict=True)), WITHOUT_CT: "#5b8f4e"}


def study_figure(path: Path, rows: list[Row]) -> None:
    """Draw medians with quartiles, by condition and method.

    Raises
    ------
    OutputError
        When the file cannot be written.
    """
    figure = new_figure(12, 6.4)
    for line, kind in zip(figure.subplots(len(KINDS), len(PANELS)), KINDS, strict=True):
        for ax, (name, title) in zip(line, PANELS, strict=True):
            for number, method in enumerate(COMPARED):
                for place, condition in enumerate(CONDITIONS):
                    # A method that asks no CT is the same with every one
                    asked = RIGHT if method in (PLAIN, WITHOUT_CT) else condition
                    low, median, high = (100 * value for value in quartiles(rows, name, kind=kind, condition=asked, method=method))
                    x = place + 0.8 / len(COMPARED) * (number - (len(COMPARED) - 1) / 2)
                    ax.bar(x, median, width=0.72 / len(COMPARED), color=COLORS[method], label=method if place == 0 else None)
                    ax.plot([x, x], [low, high], color="black", linewidth=0.8)
            ax.set_title(f"{kind}: {title}", fontsize=9, loc="left")
            ax.set_xticks(range(len(CONDITIONS)), [textwrap.fill(name, 10) for name in CONDITIONS], fontsize=7)
            ax.set_ylim(0, 100)
            ax.tick_params(axis="y", labelsize=8)
            ax.spines[["top", "right"]].set_visible(False)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(COLORS), frameon=False, fontsize=10)
    saved(figure, path, 100)


def new_figure(width: float, height: float) -> Figure:
    """An empty one, inches; no window is opened."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained", facecolor="white")


def saved(figure: Figure, path: Path, dpi: int = 110) -> Path:
    """The figure as a PNG file, whose path comes back."""
    with atomic_output(path) as temporary:
        figure.savefig(temporary, dpi=dpi, format="png")
    return path

"""The study of free paths in one picture: of the lines that bone blocks, how many are called free while more of the free ones are found."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from AIFReconLib.evaluation.lines import FOUND

from .method_cases import OURS, PLAIN
from .method_figure import new_figure, saved
from .paths_cases import FIXED, NONE, PLANNED, RIGHT, WRONG, Row
from .paths_page import judged_of

CURVES = (
    ("average", NONE, PLAIN, False, "#7a7a7a", "-"),
    ("CT alone, 3 mm off", WRONG, "", False, "#b0307a", "--"),
    ("weighted, no CT", NONE, OURS, False, "#2f8f4e", "-"),
    ("weighted, CT 3 mm off", WRONG, OURS, True, "#2f6db3", "-"),
    ("weighted, right CT", RIGHT, OURS, False, "#e07b00", "-"),
)
"""Name, CT, method, whether the CT's bone counts too, color and style."""

LOWEST = 0.1
"""Percent below which the picture does not go."""

APART = 1.35
"""Times that two labels beside the curves stand apart, at least."""


def paths_figure(path: Path, rows: list[Row]) -> None:
    """Draw a panel for each scan.

    Raises OutputError when the file cannot be written.
    """
    figure = new_figure(13, 5.6)
    for ax, scan in zip(figure.subplots(1, 2, sharey=True), (FIXED, PLANNED), strict=True):
        some = [row for row in rows if row.scan == scan]
        labels = []
        for name, ct, method, with_ct, color, style in CURVES:
            judged = judged_of(some, ct, method, with_ct)
            free, blocked = judged.clearance[judged.free], np.sort(judged.clearance[judged.blocked])
            found = np.linspace(0.0, 1.0, 201)
            called = 1.0 - np.searchsorted(blocked, np.quantile(free, 1.0 - found), "left") / len(blocked)
            ax.plot(100 * found, np.maximum(100 * called, LOWEST), color=color, linestyle=style, linewidth=2.2)
            at_found = 100 * float(np.interp(FOUND, found, called))
            ax.plot(100 * FOUND, max(at_found, LOWEST), "o", color=color, markersize=6)
            labels.append((max(at_found, LOWEST), f"{name}: {at_found:.1f}%", color))
        place = 0.0
        for at_found, words, color in sorted(labels):
            place = max(at_found, place * APART)
            ax.text(102.0, place, words, color=color, fontsize=11, va="center")
        ax.axvline(100 * FOUND, color="#333333", linewidth=0.8, linestyle=":")
        ax.text(100 * FOUND - 1, 130, "nine in ten found", fontsize=9, color="#333333", ha="right", va="bottom")
        ax.set_yscale("log")
        ax.minorticks_off()
        ax.set_ylim(LOWEST, 120)
        ax.set_yticks([0.1, 1, 10, 100], ["0.1% or less", "1%", "10%", "100%"])
        ax.set_xlim(40, 100)
        ax.set_xticks(range(40, 101, 10), [f"{tick}%" for tick in range(40, 101, 10)])
        ax.set_title(scan.capitalize(), fontsize=13, loc="left", pad=18)
        ax.set_xlabel("free lines found", fontsize=11)
        ax.grid(axis="y", color="#dddddd", linewidth=0.8)
        ax.spines[["top", "right"]].set_visible(False)
    figure.axes[0].set_ylabel("blocked lines called free (less is better)", fontsize=11)
    saved(figure, path, 100)

"""The picture that compares reconstructions of one sweep beside the CT."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..volume import Volume
from .slices import AXIAL, CORONAL, SAGITTAL, Plane, cut, extent_along

CT_WINDOW = (-200.0, 700.0)
"""Hounsfield units shown from black to white: soft tissue and bone."""

BACKGROUND = "#111111"
INK = "#e8e8e8"
NOT_SCANNED = "#1b2740"
BONE_COLOR = "#ffb000"


def compare_figure(
    path: str | Path,
    ct: Volume,
    reconstructions: dict[str, Volume],
    center_ras,
    bone: Volume | None = None,
    mask: Volume | None = None,
    title: str = "",
) -> None:
    """Draw sagittal, axial and coronal cuts of a CT and of reconstructions side by side.

    Parameters
    ----------
    path : str or Path
        PNG, PDF or SVG file to write.
    ct : Volume of HU, placed in Reference
    reconstructions : dict of str to Volume
        All on one grid; intensities 0 to 255.
    center_ras : (3,), mm
        Where the three planes meet.
    bone : Volume of labels or None
        Its outline is drawn over the CT.
    mask : Volume or None
        As reconstructions give it: where it is 0 nothing was scanned, and the picture is tinted instead of black.
    title : str

    Raises
    ------
    OutputError
        When the file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from ..io.atomic import atomic_output

    planes = (SAGITTAL, AXIAL, CORONAL)
    grid = next(iter(reconstructions.values())).grid
    sizes = [_size(grid, plane) for plane in planes]
    columns = 1 + len(reconstructions)
    widest = max(width for width, _ in sizes)
    panel = 2.4
    heights = [panel * height / widest for _, height in sizes]
    figure = Figure(figsize=(columns * panel + 0.5, sum(heights) + 0.35 * len(planes) + 0.6), facecolor=BACKGROUND)
    FigureCanvasAgg(figure)
    axes = figure.subplots(
        len(planes),
        columns,
        squeeze=False,
        gridspec_kw={"height_ratios": heights, "left": 0.04, "right": 0.995, "bottom": 0.01, "top": 0.91, "wspace": 0.04, "hspace": 0.06},
    )
    for row, (plane, (width, height)) in enumerate(zip(planes, sizes, strict=True)):
        middle = _middle(grid, plane, center_ras)
        picture = cut(ct, plane, middle, width, height)
        axes[row, 0].imshow(picture, cmap="gray", vmin=CT_WINDOW[0], vmax=CT_WINDOW[1], extent=_extent(width, height))
        if bone is not None:
            outline = np.nan_to_num(cut(bone, plane, middle, width, height, order=0)) > 0
            if outline.any() and not outline.all():
                axes[row, 0].contour(
                    outline, levels=[0.5], colors=[BONE_COLOR], linewidths=0.5, extent=_extent(width, height), origin="upper"
                )
        for column, volume in enumerate(reconstructions.values(), start=1):
            picture = np.nan_to_num(cut(volume, plane, middle, width, height))
            if mask is not None:
                scanned = np.nan_to_num(cut(mask, plane, middle, width, height, order=0)) > 0
                picture = np.ma.masked_array(picture, mask=~scanned)
            axes[row, column].imshow(picture, cmap="gray", vmin=0, vmax=255, extent=_extent(width, height))
        for ax in axes[row]:
            _bare(ax, plane)
        axes[row, 0].set_ylabel(plane.name, color=INK, fontsize=9)
    for ax, name in zip(axes[0], ["CT and its bone", *reconstructions], strict=True):
        ax.set_title(name, color=INK, fontsize=10)
    _scale_bar(axes[-1, -1], sizes[-1])
    if mask is not None:
        figure.text(0.995, 0.985, "blue: not scanned", color="#7f9ad0", fontsize=9, ha="right", va="top")
    figure.suptitle(title, color=INK, fontsize=11, x=0.04, ha="left", y=0.985)
    with atomic_output(path) as temporary:
        figure.savefig(temporary, dpi=130, facecolor=BACKGROUND)


def _size(grid, plane: Plane) -> tuple[float, float]:
    spans = (np.subtract(*extent_along(grid, direction)[::-1]) for direction in (plane.right_ras, plane.down_ras))
    width, height = spans
    return float(width), float(height)


def _middle(grid, plane: Plane, center_ras) -> np.ndarray:
    """The middle of the grid within the plane, at the depth of `center_ras` across it."""
    right, down = np.asarray(plane.right_ras, float), np.asarray(plane.down_ras, float)
    across = np.cross(right, down)
    along = [sum(extent_along(grid, d)) / 2 * d for d in (right, down)]
    return along[0] + along[1] + across * (np.asarray(center_ras, float) @ across)


def _extent(width: float, height: float) -> tuple[float, float, float, float]:
    return 0.0, width, height, 0.0


def _bare(ax, plane: Plane) -> None:
    ax.set_xticks([])
    ax.set_yticks([])
    ax.set_facecolor(NOT_SCANNED)
    for spine in ax.spines.values():
        spine.set_visible(False)
    places = ((0.02, 0.5, "left", "center"), (0.98, 0.5, "right", "center"), (0.5, 0.98, "center", "top"), (0.5, 0.02, "center", "bottom"))
    for letter, (x, y, horizontal, vertical) in zip(plane.edges, places, strict=True):
        ax.text(x, y, letter, color=INK, alpha=0.7, fontsize=7, ha=horizontal, va=vertical, transform=ax.transAxes)


def _scale_bar(ax, size: tuple[float, float], length: float = 20.0) -> None:
    width, height = size
    x, y = width - length - 0.04 * width, 0.93 * height
    ax.plot([x, x + length], [y, y], color=INK, linewidth=1.5, solid_capstyle="butt")
    ax.text(x + length / 2, y - 0.02 * height, f"{length:g} mm", color=INK, fontsize=7, ha="center", va="bottom")

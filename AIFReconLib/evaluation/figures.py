"""The picture that compares reconstructions of one sweep beside the CT."""

from __future__ import annotations

import contextlib
import importlib.util
import io
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats
from ..errors import OutputError
from ..geometry.volume import Volume, VoxelGrid
from ..io.disk.atomic import atomic_output
from ..message import shorten
from .slices import AXIAL, CORONAL, SAGITTAL, cut, whole_cut
from .surface import BoneSurface

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

CT_WINDOW = (-200.0, 700.0)
"""Hounsfield units shown from black to white: soft tissue and bone."""

BACKGROUND = "#111111"
INK = "#e8e8e8"
NOT_SCANNED = "#1b2740"
BONE_COLOR = "#ffb000"

PANEL, GAP, LEFT, TOP, TOP_UNTITLED = 2.4, 0.08, 0.35, 0.72, 0.35
"""Inches: width of a panel, between panels, and what the names of planes and volumes and the title take."""

DPI = 130
LONGEST_NAME = 30

SPINOUS_LENGTH = 30.0
"""mm from the laminae to the tip, at L2 to L5."""


def require_matplotlib() -> None:
    """Return if figures can be drawn; to be asked before a long computation; an OutputError when matplotlib is not installed."""
    if importlib.util.find_spec("matplotlib") is None:
        raise OutputError("Cannot draw a figure: matplotlib is not installed. Install it with: pip install matplotlib")


@contextlib.contextmanager
def own_looks() -> Iterator[None]:
    """Within the block, or the function that it decorates, figures are drawn as matplotlib does by itself.

    Raises OutputError when matplotlib is not installed, or cannot be loaded.

    Notes
    -----
    It reads a file matplotlibrc of the working folder, which may have come with a recording, and may ask for LaTeX, which runs programs.
    """
    require_matplotlib()
    try:
        matplotlib = importlib.import_module("matplotlib")
    except Exception as error:
        raise OutputError(
            f"Cannot draw a figure: matplotlib cannot be loaded ({shorten(str(error), 200)}). If there is a file matplotlibrc in this "
            "folder, move it."
        ) from error
    with matplotlib.rc_context({name: value for name, value in matplotlib.rcParamsDefault.items() if not name.startswith("backend")}):
        yield


def new_figure(width: float, height: float, **looks: str) -> Figure:
    """A dark figure of this size in inches that no window shows."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), facecolor=BACKGROUND, **looks)
    FigureCanvasAgg(figure)
    return figure


def save_figure(path: str | Path, figure: Figure) -> None:
    """Write a figure to a PNG, PDF or SVG file; an OutputError where it cannot be written."""
    with atomic_output(path) as temporary:
        figure.savefig(temporary, dpi=DPI, facecolor=BACKGROUND)


def png_of(figure: Figure) -> bytes:
    """A figure as a PNG file."""
    png = io.BytesIO()
    figure.savefig(png, format="png", dpi=DPI, facecolor=BACKGROUND)
    return png.getvalue()


@own_looks()
def compare_figure(
    path: str | Path,
    ct: Volume,
    reconstructions: dict[str, Volume],
    center_ras: ArrayLike,
    bone: Volume | None = None,
    mask: Volume | None = None,
    title: str = "",
) -> None:
    """Draw sagittal, axial and coronal cuts of a CT and of reconstructions side by side, into a PNG, PDF or SVG file.

    Raises OutputError when the file cannot be written.

    Parameters
    ----------
    ct : Volume of HU, placed in Reference
    reconstructions : dict of str to Volume
        The first one's grid says what is shown. 8-bit volumes are shown from 0 to 255, others to the brightest voxel of all.
    center_ras : (3,), mm
        Where the three planes meet.
    bone : Volume of labels or None
        Its outline is drawn over the CT.
    mask : Volume or None
        As reconstructions give it: where it is 0 nothing was scanned, and the picture is tinted instead of black.
    """
    save_figure(path, _draw(ct, reconstructions, center_ras, bone, mask, title))


@own_looks()
def comparison_png(
    ct: Volume, reconstructions: dict[str, Volume], center_ras: ArrayLike, bone: Volume | None = None, mask: Volume | None = None
) -> bytes:
    """The picture of `compare_figure` as a PNG file."""
    return png_of(_draw(ct, reconstructions, center_ras, bone, mask, ""))


def within_spinous_process(surface: BoneSurface, grid: VoxelGrid) -> Floats:
    """A place worth looking at: in the middle of the spinous process that is nearest to the middle of a volume, (3,) mm in RAS.

    Notes
    -----
    Half the length of a process before the hind edge of the vertebra, which is the 1% of its surface that lies farthest posterior
    in RAS. With one label for all bone it is the hindmost process.
    """
    corners = grid.corners()
    inside = ((surface.points_reference >= corners.min(axis=0)) & (surface.points_reference <= corners.max(axis=0))).all(axis=1)
    if not inside.any():
        inside[:] = True
    edges = []
    for label in np.unique(surface.labels[inside]):
        points = surface.points_reference[inside & (surface.labels == label)]
        edges.append(points[points[:, 1] <= np.quantile(points[:, 1], 0.01)].mean(axis=0))
    away = [abs(edge[2] - corners[:, 2].mean()) for edge in edges]
    place: Floats = edges[int(np.argmin(away))] + (0.0, SPINOUS_LENGTH / 2, 0.0)
    return place


def _draw(
    ct: Volume, reconstructions: dict[str, Volume], center_ras: ArrayLike, bone: Volume | None, mask: Volume | None, title: str
) -> Figure:
    planes = (AXIAL, SAGITTAL, CORONAL)
    grid = next(iter(reconstructions.values())).grid
    columns = 1 + len(reconstructions)
    # All panels have one width and one scale, so that one scale bar holds for all
    wholes = [whole_cut(grid, plane, center_ras) for plane in planes]
    width = max(size[0] for _, size in wholes)
    sizes = [(width, size[1]) for _, size in wholes]
    heights = [PANEL * height / width for _, height in sizes]
    figure_width = LEFT + columns * (PANEL + GAP)
    above = TOP if title or mask is not None else TOP_UNTITLED
    figure_height = above + sum(heights) + len(planes) * GAP
    figure = new_figure(figure_width, figure_height)
    brightest = _brightest(reconstructions.values())
    top = figure_height - above
    for plane, (middle, (_, height)), panel_height in zip(planes, wholes, heights, strict=True):
        extent = (0.0, width, height, 0.0)
        axes = [
            figure.add_axes(
                (
                    (LEFT + column * (PANEL + GAP)) / figure_width,
                    (top - panel_height) / figure_height,
                    PANEL / figure_width,
                    panel_height / figure_height,
                )
            )
            for column in range(columns)
        ]
        picture = cut(ct, plane, middle, width, height)
        axes[0].imshow(picture, cmap="gray", vmin=CT_WINDOW[0], vmax=CT_WINDOW[1], extent=extent)
        if bone is not None:
            outline = np.nan_to_num(cut(bone, plane, middle, width, height, order=0)) > 0
            if outline.any() and not outline.all():
                axes[0].contour(outline, levels=[0.5], colors=[BONE_COLOR], linewidths=0.5, extent=extent, origin="upper")
        for ax, volume in zip(axes[1:], reconstructions.values(), strict=True):
            picture = np.nan_to_num(cut(volume, plane, middle, width, height))
            if mask is not None:
                scanned = np.nan_to_num(cut(mask, plane, middle, width, height, order=0)) > 0
                # Not typed in every numpy
                picture = cast("Any", np.ma).masked_array(picture, mask=~scanned)
            ax.imshow(picture, cmap="gray", vmin=0, vmax=brightest, extent=extent)
        for ax in axes:
            edge_letters(ax, plane.edges, 0.02, 7, alpha=0.7)
        axes[0].set_ylabel(plane.name, color=INK, fontsize=9)
        if plane is planes[0]:
            for ax, name in zip(axes, ["CT and its bone" if bone is not None else "CT", *reconstructions], strict=True):
                ax.set_title(_shortened(name), color=INK, fontsize=10, parse_math=False)
        top -= panel_height + GAP
    _scale_bar(axes[-1], sizes[-1])
    title_y = 1 - 0.12 / figure_height
    if mask is not None:
        figure.text(1 - GAP / figure_width, title_y, "blue: not scanned", color="#7f9ad0", fontsize=9, ha="right", va="top")
    figure.suptitle(title, color=INK, fontsize=11, x=LEFT / figure_width, ha="left", y=title_y, parse_math=False)
    return figure


def _brightest(volumes: Collection[Volume]) -> float:
    if all(volume.array.dtype == np.uint8 for volume in volumes):
        return 255.0
    return max(float(np.nanmax(volume.array)) for volume in volumes) or 1.0


def _shortened(name: str) -> str:
    """The end of a name, for that is where methods tend to stand, as far as it fits over a panel."""
    return name if len(name) <= LONGEST_NAME else "\N{HORIZONTAL ELLIPSIS}" + name[1 - LONGEST_NAME :]


def edge_letters(ax: Axes, plane_edges: tuple[str, str, str, str], inset: float, size: float, **looks: float) -> list[Text]:
    """Write which way is which at the left, right, top and bottom edge of a picture without ticks and frame."""
    ax.set(xticks=[], yticks=[], facecolor=NOT_SCANNED)
    for spine in ax.spines.values():
        spine.set_visible(False)
    far = 1 - inset
    places = ((inset, 0.5, "left", "center"), (far, 0.5, "right", "center"), (0.5, far, "center", "top"), (0.5, inset, "center", "bottom"))
    return [
        ax.text(x, y, letter, color=INK, fontsize=size, ha=across, va=up, transform=ax.transAxes, **looks)
        for letter, (x, y, across, up) in zip(plane_edges, places, strict=True)
    ]


def _scale_bar(ax: Axes, size: tuple[float, float], length: float = 20.0) -> None:
    width, height = size
    x, y = width - length - 0.04 * width, 0.93 * height
    ax.plot([x, x + length], [y, y], color=INK, linewidth=1.5, solid_capstyle="butt")
    ax.text(x + length / 2, y - 0.02 * height, f"{length:g} mm", color=INK, fontsize=7, ha="center", va="bottom")

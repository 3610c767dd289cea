"""The picture that compares reconstructions of one sweep beside the CT."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import textwrap
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats
from ..errors import OutputError, require_kind
from ..geometry.volume import Volume, VoxelGrid
from ..io.disk.atomic import atomic_output
from ..message import shorten
from .slices import cut, planes, whole_cut
from .surface import BoneSurface

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

CT_WINDOW = (-200.0, 700.0)
"""Hounsfield units shown from black to white: soft tissue and bone."""

BACKGROUND = "#111111"
INK = "#e8e8e8"
PAPER, INK_ON_PAPER = "#ffffff", "#111111"
NOT_SCANNED = "#1b2740"
BONE_COLOR = "#ffb000"

PANEL, GAP, LEFT, TOP, TOP_UNTITLED = 2.4, 0.08, 0.35, 0.72, 0.35
"""Inches: width of a panel, between panels, and what the names of planes and volumes and the title take."""

DPI, PRINT_DPI = 130, 300
PITCH = 0.25
"""mm of a pixel."""

LONGEST_NAME, LETTERS_PER_INCH = 30, 10

LOOKS = {
    "figure.facecolor": BACKGROUND,
    "axes.facecolor": BACKGROUND,
    "savefig.dpi": DPI,
    # Text that journals and their authors can change
    "pdf.fonttype": 42,
    "svg.fonttype": "none",
    "text.parse_math": False,
    **dict.fromkeys(("text.color", "axes.labelcolor", "xtick.color", "ytick.color"), INK),
    "legend.frameon": False,
}
"""Of every figure that we draw: on black, for a screen."""

SPINOUS_LENGTH = 30.0
"""mm from the laminae to the tip, at L2 to L5."""


def require_matplotlib() -> None:
    """Return if figures can be drawn; to be asked before a long computation; an OutputError when matplotlib is not installed."""
    if importlib.util.find_spec("matplotlib") is None:
        raise OutputError("Cannot draw a figure: matplotlib is not installed. Install it with: pip install matplotlib")


@contextlib.contextmanager
def own_looks() -> Iterator[None]:
    """Within the block, or the function that it decorates, figures have `LOOKS`, and else those that matplotlib has by itself.

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
    plain = {name: value for name, value in matplotlib.rcParamsDefault.items() if not name.startswith("backend")}
    with matplotlib.rc_context({**plain, **LOOKS}):
        yield


def new_figure(width: float, height: float, **looks: str) -> Figure:
    """A figure of this size in inches that no window shows."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), **looks)
    FigureCanvasAgg(figure)
    return figure


def save_figure(path: str | Path, figure: Figure, dpi: int = DPI) -> None:
    """Write a figure to a PNG, PDF or SVG file; an OutputError where it cannot be written."""
    with atomic_output(path) as temporary:
        figure.savefig(temporary, dpi=dpi)


def png_of(figure: Figure) -> bytes:
    """A figure as a PNG file."""
    png = io.BytesIO()
    figure.savefig(png, format="png")
    return png.getvalue()


@dataclass(frozen=True)
class ComparisonFigure:
    """Sagittal, axial and coronal cuts of reconstructions side by side, beside the CT where there is one.

    Parameters
    ----------
    volumes : dict of str to Volume
        In Reference, by the names that are written above them. The first one's grid says what is shown.
    center_ras : (3,), mm
        Where the three planes meet.
    ct : Volume of HU or None
        Placed in Reference. Where neither it nor bone is given, nothing tells how the patient lies: planes have the names of the axes.
    bone : Volume of labels or None
        Its outline is drawn over the CT; without one over all volumes.
    mask : Volume or None
        As reconstructions give it: where it is 0 nothing was scanned, and the picture is tinted instead of black.
    window : (2,) or None
        Gray levels shown black and white, the same for all. By default 0 to 255 for 8-bit volumes, others to the brightest voxel of all.
    white : bool
        On white, for a paper; else on black, for a screen.
    """

    volumes: dict[str, Volume]
    center_ras: ArrayLike
    ct: Volume | None = None
    bone: Volume | None = None
    mask: Volume | None = None
    title: str = ""
    window: tuple[float, float] | None = None
    white: bool = False

    def __post_init__(self) -> None:
        for name, volume in {**self.volumes, "ct": self.ct, "bone": self.bone, "mask": self.mask}.items():
            require_kind(name, volume, (Volume, type(None)), "Of an array make one: Volume(array, ijk_to_reference).")

    @property
    def gray_window(self) -> tuple[float, float]:
        """Gray levels shown black and white."""
        return self.window or (0.0, _brightest(self.volumes.values()))

    @own_looks()
    def write(self, path: str | Path) -> None:
        """Draw into a PNG, PDF or SVG file; an OutputError when it cannot be written."""
        save_figure(path, _draw(self), PRINT_DPI if self.white else DPI)

    @own_looks()
    def png(self) -> bytes:
        """The picture as a PNG file; an OutputError when matplotlib is not installed."""
        return png_of(_draw(self))


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


def _draw(shown: ComparisonFigure) -> Figure:
    ways = planes(shown.ct is not None or shown.bone is not None)
    mask, window = shown.mask, shown.gray_window
    background, ink = (PAPER, INK_ON_PAPER) if shown.white else (BACKGROUND, INK)
    grid = next(iter(shown.volumes.values())).grid
    names = list(shown.volumes) if shown.ct is None else ["CT and its bone" if shown.bone is not None else "CT", *shown.volumes]
    # All panels have one width and one scale, so that one scale bar holds for all
    wholes = [whole_cut(grid, plane, shown.center_ras) for plane in ways]
    width = max(size[0] for _, size in wholes)
    sizes = [(width, size[1]) for _, size in wholes]
    heights = [PANEL * height / width for _, height in sizes]
    figure_width = LEFT + len(names) * (PANEL + GAP)
    above = TOP if shown.title or mask is not None else TOP_UNTITLED
    figure_height = above + sum(heights) + len(ways) * GAP
    figure = new_figure(figure_width, figure_height, facecolor=background)
    top = figure_height - above
    for plane, (middle, (_, height)), panel_height in zip(ways, wholes, heights, strict=True):
        extent = (0.0, width, height, 0.0)
        places = [(LEFT + column * (PANEL + GAP), top - panel_height, PANEL, panel_height) for column in range(len(names))]
        axes = [figure.add_axes((x / figure_width, y / figure_height, w / figure_width, h / figure_height)) for x, y, w, h in places]
        pictures = [np.nan_to_num(cut(volume, plane, middle, width, height, PITCH)) for volume in shown.volumes.values()]
        if mask is not None:
            scanned = np.nan_to_num(cut(mask, plane, middle, width, height, PITCH, order=0)) > 0
            # Not typed in every numpy
            pictures = [cast("Any", np.ma).masked_array(picture, mask=~scanned) for picture in pictures]
        windows = [window] * len(pictures)
        if shown.ct is not None:
            pictures, windows = [cut(shown.ct, plane, middle, width, height, PITCH), *pictures], [CT_WINDOW, *windows]
        outline = None if shown.bone is None else np.nan_to_num(cut(shown.bone, plane, middle, width, height, PITCH, order=0)) > 0
        for column, (ax, picture, (black, white)) in enumerate(zip(axes, pictures, windows, strict=True)):
            ax.imshow(picture, cmap="gray", vmin=black, vmax=white, extent=extent)
            if outline is not None and (column == 0 or shown.ct is None) and outline.any() and not outline.all():
                ax.contour(outline, levels=[0.5], colors=[BONE_COLOR], linewidths=0.5, extent=extent, origin="upper")
            edge_letters(ax, plane.edges, 0.02, 7, alpha=0.7)
            if plane is ways[0]:
                ax.set_title(_shortened(names[column]), color=ink, fontsize=10)
        axes[0].set_ylabel(plane.name, color=ink, fontsize=9)
        top -= panel_height + GAP
    _scale_bar(axes[-1], sizes[-1])
    title_y = 1 - 0.12 / figure_height
    if mask is not None:
        words = figure.text(1 - GAP / figure_width, title_y, "blue: not scanned", fontsize=9, ha="right", va="top")
        words.set_color(NOT_SCANNED if shown.white else "#7f9ad0")
    title = "\n".join(textwrap.wrap(shown.title, int(LETTERS_PER_INCH * figure_width)))
    figure.suptitle(title, color=ink, fontsize=11, x=LEFT / figure_width, ha="left", y=title_y)
    return figure


def _brightest(volumes: Collection[Volume]) -> float:
    if all(volume.array.dtype == np.uint8 for volume in volumes):
        return 255.0
    return max(float(np.nanmax(volume.array)) for volume in volumes) or 1.0


def _shortened(name: str) -> str:
    """The end of a name, for that is where methods tend to stand, as far as it fits over a panel."""
    return name if len(name) <= LONGEST_NAME else "\N{HORIZONTAL ELLIPSIS}" + name[1 - LONGEST_NAME :]


def edge_letters(ax: Axes, plane_edges: tuple[str, str, str, str], inset: float, size: float, **looks: Any) -> list[Text]:
    """Write which way is which at the left, right, top and bottom edge of a picture without ticks and frame."""
    ax.set(xticks=[], yticks=[], facecolor=NOT_SCANNED)
    for spine in ax.spines.values():
        spine.set_visible(False)
    from matplotlib.patheffects import withStroke

    far = 1 - inset
    looks = {"path_effects": [withStroke(linewidth=1.5, foreground=BACKGROUND)], **looks}
    places = ((inset, 0.5, "left", "center"), (far, 0.5, "right", "center"), (0.5, far, "center", "top"), (0.5, inset, "center", "bottom"))
    return [
        ax.text(x, y, letter, fontsize=size, ha=across, va=up, transform=ax.transAxes, **looks)
        for letter, (x, y, across, up) in zip(plane_edges, places, strict=True)
    ]


def _scale_bar(ax: Axes, size: tuple[float, float], length: float = 20.0) -> None:
    width, height = size
    x, y = width - length - 0.04 * width, 0.93 * height
    ax.plot([x, x + length], [y, y], color=INK, linewidth=1.5, solid_capstyle="butt")
    ax.text(x + length / 2, y - 0.02 * height, f"{length:g} mm", fontsize=7, ha="center", va="bottom")

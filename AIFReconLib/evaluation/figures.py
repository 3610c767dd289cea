"""The picture that compares reconstructions of one sweep beside the CT."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats, Mask
from ..errors import OutputError, require_kind
from ..geometry.volume import Volume
from ..io.disk.atomic import atomic_output
from ..message import shorten
from .slices import Plane, cut, planes, whole_cut

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CT_WINDOW = (-200.0, 700.0)
"""Hounsfield units shown from black to white: soft tissue and bone."""

BACKGROUND = "#111111"
INK = "#e8e8e8"
PAPER, INK_ON_PAPER = "#ffffff", "#111111"
NOT_SCANNED = "#1b2740"
BONE_COLOR = "#ffb000"

PANEL, GAP, LEFT, TOP, ABOVE = 2.4, 0.08, 0.35, 0.55, 0.2
"""Inches: width of a panel that is compared, between panels, and what is left for names of planes, for title and note, and for a name."""

DPI, PRINT_DPI = 130, 300
PIXELS = 600
"""Along the longest side of a cut."""

LONGEST_NAME, LETTERS_PER_INCH, NARROWEST = 30, 10, 6.0
"""Letters of a name, letters of a title to the inch, and inches of a figure at least."""

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
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), **looks)


def save_figure(path: str | Path, figure: Figure, dpi: int = DPI) -> None:
    """Write a figure to a PNG, PDF or SVG file; an OutputError where it cannot be written."""
    with atomic_output(path) as temporary:
        figure.savefig(temporary, dpi=dpi)


def png_of(figure: Figure) -> bytes:
    """A figure as a PNG file."""
    png = io.BytesIO()
    figure.savefig(png, format="png")
    return png.getvalue()


@dataclass(frozen=True, eq=False)
class Panel:
    """One picture of a figure: gray levels (NaN where there are none), its size in mm, and what is drawn in it and written beside it."""

    name: str
    picture: Floats
    size: tuple[float, float]
    edges: tuple[str, str, str, str]
    window: tuple[float, float]
    outline: Mask | None = None
    side: str = ""


def cut_panel(
    name: str,
    volume: Volume,
    plane: Plane,
    place: tuple[Floats, tuple[float, float]],
    window: tuple[float, float],
    seen: Volume | None = None,
    labels: Volume | None = None,
) -> Panel:
    """A volume cut at a place, as `whole_cut` tells it; nothing where `seen` is 0, and the outline of what is labeled."""
    middle, size = place
    pitch = max(size) / PIXELS
    picture = cut(volume, plane, middle, *size, pitch)
    if seen is not None:
        picture[~(cut(seen, plane, middle, *size, pitch, order=0) > 0)] = np.nan
    outline = None if labels is None else cut(labels, plane, middle, *size, pitch, order=0) > 0
    return Panel(name, picture, size, plane.edges, window, outline)


def draw_panels(rows: Sequence[Sequence[Panel]], scale: float, title: str, note: str, white: bool = False) -> Figure:
    """Rows of panels under a title and a note; all have one scale, in inches per mm, and so one scale bar."""
    background, ink, tint = (PAPER, INK_ON_PAPER, NOT_SCANNED) if white else (BACKGROUND, INK, "#9fb3dd")
    widths = [scale * max(row[n].size[0] for row in rows if n < len(row)) for n in range(len(rows[0]))]
    heights = [scale * max(panel.size[1] for panel in row) for row in rows]
    above = [ABOVE if any(panel.name for panel in row) else 0.0 for row in rows]
    width = max(LEFT + sum(widths) + len(widths) * GAP, NARROWEST)
    height = TOP + sum(heights) + len(rows) * GAP + sum(above)
    figure = new_figure(width, height, facecolor=background)
    bottom = height - TOP
    for row, tall, titles in zip(rows, heights, above, strict=True):
        bottom -= titles + tall
        left = LEFT
        for panel, wide in zip(row, widths, strict=False):
            w, h = (scale * side for side in panel.size)
            x, y = left + (wide - w) / 2, bottom + (tall - h) / 2
            ax = figure.add_axes((x / width, y / height, w / width, h / height))
            _show(ax, panel, ink)
            left += wide + GAP
        bottom -= GAP
    _scale_bar(ax, row[-1].size)
    title = "\n".join(textwrap.wrap(title, int(LETTERS_PER_INCH * width)))
    figure.text(LEFT / width, 1 - 0.1 / height, title, color=ink, fontsize=11, ha="left", va="top")
    figure.text(1 - GAP / width, 1 - 0.35 / height, note, color=tint, fontsize=9, ha="right", va="top")
    return figure


def _show(ax: Axes, panel: Panel, ink: str) -> None:
    from matplotlib.patheffects import withStroke

    extent = (0.0, panel.size[0], panel.size[1], 0.0)
    ax.imshow(panel.picture, cmap="gray", vmin=panel.window[0], vmax=panel.window[1], extent=extent, aspect="auto")
    if panel.outline is not None and panel.outline.any() and not panel.outline.all():
        ax.contour(panel.outline, levels=[0.5], colors=[BONE_COLOR], linewidths=0.6, alpha=0.8, extent=extent, origin="upper")
    ax.set(xlim=extent[:2], ylim=extent[2:], xticks=[], yticks=[], facecolor=NOT_SCANNED)
    ax.spines[:].set_visible(False)
    ax.set_title(_shortened(panel.name), color=ink, fontsize=10, pad=3)
    ax.set_ylabel(panel.side, color=ink, fontsize=9)
    places = ((0.02, 0.5, "left", "center"), (0.98, 0.5, "right", "center"), (0.5, 0.98, "center", "top"), (0.5, 0.02, "center", "bottom"))
    around = [withStroke(linewidth=2, foreground=BACKGROUND)]
    for letter, (x, y, across, up) in zip(panel.edges, places, strict=True):
        ax.text(x, y, letter, fontsize=8, ha=across, va=up, transform=ax.transAxes, path_effects=around)


def _scale_bar(ax: Axes, size: tuple[float, float]) -> None:
    """A bar of a round length at the lower right of a panel."""
    width, height = size
    length = max(mm for mm in (1, 2, 5, 10, 20, 50, 100) if mm == 1 or mm <= width / 3)
    x, y = width - length - 0.04 * width, 0.93 * height
    ax.plot([x, x + length], [y, y], color=INK, linewidth=1.5, solid_capstyle="butt")
    ax.text(x + length / 2, y - 0.02 * height, f"{length:g} mm", fontsize=7, ha="center", va="bottom")


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
        arrays = [volume.array for volume in self.volumes.values()]
        is_8_bit = all(array.dtype == np.uint8 for array in arrays)
        return self.window or (0.0, 255.0 if is_8_bit else max(float(np.nanmax(array)) for array in arrays) or 1.0)

    @own_looks()
    def write(self, path: str | Path) -> None:
        """Draw into a PNG, PDF or SVG file; an OutputError when it cannot be written."""
        save_figure(path, _draw(self), PRINT_DPI if self.white else DPI)

    @own_looks()
    def png(self) -> bytes:
        """The picture as a PNG file; an OutputError when matplotlib is not installed."""
        return png_of(_draw(self))


def _draw(shown: ComparisonFigure) -> Figure:
    ways = planes(shown.ct is not None or shown.bone is not None)
    wholes = [whole_cut(next(iter(shown.volumes.values())).grid, plane, shown.center_ras) for plane in ways]
    width = max(size[0] for _, size in wholes)
    outlined = shown.bone if shown.ct is None else None
    seen = shown.gray_window, shown.mask, outlined
    columns = [(name, volume, seen) for name, volume in shown.volumes.items()]
    if shown.ct is not None:
        columns.insert(0, ("CT" if shown.bone is None else "CT and its bone", shown.ct, (CT_WINDOW, None, shown.bone)))
    rows = []
    for plane, (middle, (_, height)) in zip(ways, wholes, strict=True):
        place, is_first = (middle, (width, height)), plane is ways[0]
        row = [cut_panel(name if is_first else "", volume, plane, place, *how) for name, volume, how in columns]
        rows.append([replace(row[0], side=plane.name), *row[1:]])
    return draw_panels(rows, PANEL / width, shown.title, "" if shown.mask is None else "blue: not scanned", shown.white)


def _shortened(name: str) -> str:
    """The end of a name, for that is where methods tend to stand, as far as it fits over a panel."""
    return name if len(name) <= LONGEST_NAME else "\N{HORIZONTAL ELLIPSIS}" + name[1 - LONGEST_NAME :]

"""A look at one volume: three cuts through its bone and a projection, as Slicer lays them out."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats, Mask
from ..geometry.transforms import transform_points
from ..geometry.volume import Volume, VoxelGrid
from ..io.disk.atomic import atomic_output
from .figures import BACKGROUND, BONE_COLOR, CT_WINDOW, INK, edge_letters, new_figure, own_looks, png_of
from .slices import Plane, cut, whole_cut

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

AXIAL = Plane("axial", (-1, 0, 0), (0, -1, 0), ("R", "L", "A", "P"))
SAGITTAL = Plane("sagittal", (0, -1, 0), (0, 0, -1), ("A", "P", "S", "I"))
CORONAL = Plane("coronal", (-1, 0, 0), (0, 0, -1), ("R", "L", "S", "I"))
PLANES = (AXIAL, SAGITTAL, CORONAL)
"""As Slicer shows them: the patient's right on the left, or the front."""

BRIGHTEST = 0.998
"""Of what was scanned, this share is not brighter than white."""

LOOKED_AT = 500_000
"""Voxels from which gray levels are chosen, evenly spread."""

WIDTH, LONGEST_HEIGHT = 10.0, 9.0
"""Inches."""

GAP, TOP, BOTTOM, LONGEST_BAR = 0.1, 0.55, 0.1, 1.2
PITCHES = 600
"""Pixels along the longest side of a cut."""


@dataclass(frozen=True)
class Picture:
    """A drawn picture: a notebook shows it, `write` keeps it."""

    png: bytes

    def __repr__(self) -> str:
        return f"<Picture: PNG of {len(self.png) / 1024:.0f} KiB; a notebook shows it, write(path) keeps it>"

    def _repr_png_(self) -> bytes:
        return self.png

    def write(self, path: str | Path) -> None:
        """Write the PNG file, or no part of it; an OutputError where it cannot be written."""
        with atomic_output(path) as temporary:
            Path(temporary).write_bytes(self.png)


@dataclass(frozen=True)
class _Panel:
    """One picture of the figure: gray levels (NaN where there are none), its size in mm, and what is drawn in it."""

    name: str
    picture: Floats
    size: tuple[float, float]
    edges: tuple[str, str, str, str]
    window: tuple[float, float]
    outline: Mask | None = None


@own_looks()
def preview(volume: Volume, mask: Volume | None = None, labels: Volume | None = None, ct: Volume | None = None, title: str = "") -> Picture:
    """Draw axial, sagittal and coronal cuts through the bone, and the brightest of what lies behind each other, front to back.

    Parameters
    ----------
    volume : Volume
        A reconstruction, in Reference (RAS).
    mask : Volume or None
        As reconstructions give it: where it is 0 nothing was scanned. By default that is where the volume is 0.
    labels : Volume or None
        Segmentation of the CT, placed in Reference: its outline is drawn, and the cuts go through the middle of what shows of it.
        Without labels they meet in the middle of what was scanned.
    ct : Volume of HU or None
        Shown beside, placed in Reference.

    Raises
    ------
    OutputError
        When matplotlib is not installed.
    """
    scanned = (volume.array if mask is None else mask.array) != 0
    center = middle_of_bone(volume, scanned, labels)
    seen = Volume(scanned.view(np.uint8), volume.ijk_to_reference)
    some = max(volume.grid.voxels // LOOKED_AT, 1)
    levels = volume.array.reshape(-1)[::some][scanned.reshape(-1)[::some]]
    levels = levels[np.isfinite(levels)]
    window = (min(float(levels.min()), 0.0), float(np.quantile(levels, BRIGHTEST)) or 1.0) if levels.size else (0.0, 1.0)
    panels = [_cut_panel(volume, plane, center, window, seen, labels) for plane in PLANES]
    panels.append(_projection(volume, scanned, window))
    columns = 2
    if ct is not None:
        panels += [_cut_panel(ct, plane, center, CT_WINDOW, None, labels, volume.grid, "CT, ") for plane in PLANES]
        columns = 4
    notes = ["blue: not scanned" if mask is not None else "blue: 0, not scanned or black"]
    if labels is not None:
        notes.append("orange: bone of the CT")
    return Picture(png_of(_draw(panels, columns, title, ", ".join(notes))))


def middle_of_bone(volume: Volume, scanned: Mask, labels: Volume | None) -> Floats:
    """Where cuts through a volume meet, (3,) mm: the middle of the labeled bone that shows, else of what was scanned."""
    grid = volume.grid
    if labels is not None:
        every = max(np.count_nonzero(labels.array) // LOOKED_AT, 1)
        points = transform_points(labels.ijk_to_reference, np.argwhere(labels.array > 0)[::every, ::-1].astype(np.float64))
        ijk = np.rint(transform_points(grid.reference_to_ijk, points)).astype(int)
        inside = ((ijk >= 0) & (ijk < grid.size)).all(axis=1)
        i, j, k = ijk[inside].T
        met = points[inside][scanned[k, j, i]]
        if len(met):
            # Bone in the shadow of other bone is not worth a look
            bright = np.clip(np.nan_to_num(volume.array[k, j, i][scanned[k, j, i]].astype(np.float64)), 0, None) ** 2
            return np.array([_middle(along, bright) for along in met.T], dtype=np.float64)
    middle = [
        np.average(np.arange(n), weights=along) if (along := np.count_nonzero(scanned, axis=axes)).any() else (n - 1) / 2
        for n, axes in zip(grid.size, ((0, 1), (0, 2), (1, 2)), strict=True)
    ]
    center: Floats = transform_points(grid.ijk_to_reference, np.array([middle]))[0]
    return center


def _middle(values: Floats, weights: Floats) -> float:
    """The value on either side of which lies half of the weight."""
    order = np.argsort(values)
    upto = np.cumsum(weights[order])
    return float(values[order[np.searchsorted(upto, upto[-1] / 2)]])


def _cut_panel(
    volume: Volume,
    plane: Plane,
    center: Floats,
    window: tuple[float, float],
    seen: Volume | None,
    labels: Volume | None,
    grid: VoxelGrid | None = None,
    name: str = "",
) -> _Panel:
    """The cut through `center`, over all of `grid` (by default the volume's own)."""
    middle, size = whole_cut(grid or volume.grid, plane, center)
    pitch = max(size) / PITCHES
    picture = cut(volume, plane, middle, *size, pitch)
    if seen is not None:
        picture[~(cut(seen, plane, middle, *size, pitch, order=0) > 0)] = np.nan
    outline = None if labels is None else cut(labels, plane, middle, *size, pitch, order=0) > 0
    return _Panel(name + plane.name, picture, size, plane.edges, window, outline)


def _projection(volume: Volume, scanned: Mask, window: tuple[float, float]) -> _Panel:
    """The brightest voxel from front to back, along the axis of the grid that runs nearest to it."""
    to_reference = volume.ijk_to_reference[:3, :3] / volume.grid.spacing
    through = int(np.abs(to_reference[1]).argmax())
    right, down = (axis for axis in range(3) if axis != through)
    if abs(to_reference[0, right]) < abs(to_reference[0, down]):
        right, down = down, right
    brightest: Floats = np.where(scanned, volume.array, 0).max(axis=2 - through).astype(np.float64)
    brightest[~scanned.any(axis=2 - through)] = np.nan
    # Arrays are [k, j, i]: of the two axes left the one with the higher number comes first
    brightest = brightest if down > right else brightest.T
    # The picture's right is the patient's left, and its top the head
    brightest = brightest[:, ::-1] if to_reference[0, right] > 0 else brightest
    brightest = brightest[::-1] if to_reference[2, down] > 0 else brightest
    sides = [volume.grid.size[axis] * float(volume.grid.spacing[axis]) for axis in (right, down)]
    return _Panel("maximum intensity, from the front", brightest, (sides[0], sides[1]), CORONAL.edges, window)


def _draw(panels: list[_Panel], columns: int, title: str, note: str) -> Figure:
    rows = [panels[first : first + columns] for first in range(0, len(panels), columns)]
    widths = [max(row[column].size[0] for row in rows if column < len(row)) for column in range(columns)]
    heights = [max(panel.size[1] for panel in row) for row in rows]
    width = WIDTH * (1 if columns == 2 else 1.5)
    scale = min((width - (columns + 1) * GAP) / sum(widths), (LONGEST_HEIGHT - TOP - BOTTOM - len(rows) * (GAP + 0.2)) / sum(heights))
    width = max(scale * sum(widths) + (columns + 1) * GAP, 6.0)
    height = scale * sum(heights) + TOP + BOTTOM + len(rows) * (GAP + 0.2)
    figure = new_figure(width, height)
    top = height - TOP
    left_of_all = (width - scale * sum(widths) - (columns - 1) * GAP) / 2
    for row, tall in zip(rows, heights, strict=True):
        top -= 0.2
        left = left_of_all
        for panel, wide in zip(row, widths, strict=False):
            w, h = (scale * side for side in panel.size)
            x, y = left + (scale * wide - w) / 2, top - (scale * tall + h) / 2
            ax = figure.add_axes((x / width, y / height, w / width, h / height))
            _show(ax, panel)
            ax.set_title(panel.name, color=INK, fontsize=9, pad=3)
            left += scale * wide + GAP
        top -= scale * tall + GAP
    _scale_bar(figure, width, height, scale)
    figure.text(GAP / width, 1 - 0.1 / height, title, color=INK, fontsize=10, ha="left", va="top", parse_math=False)
    figure.text(GAP / width, 1 - 0.3 / height, note, color="#9fb3dd", fontsize=8, ha="left", va="top")
    return figure


def _show(ax: Axes, panel: _Panel) -> None:
    from matplotlib.patheffects import withStroke

    extent = (0.0, panel.size[0], panel.size[1], 0.0)
    ax.imshow(panel.picture, cmap="gray", vmin=panel.window[0], vmax=panel.window[1], extent=extent, aspect="auto")
    if panel.outline is not None and panel.outline.any() and not panel.outline.all():
        ax.contour(panel.outline, levels=[0.5], colors=[BONE_COLOR], linewidths=0.6, alpha=0.8, extent=extent, origin="upper")
    for text in edge_letters(ax, panel.edges, 0.015, 8):
        text.set_path_effects([withStroke(linewidth=2, foreground=BACKGROUND)])
    ax.set(xlim=extent[:2], ylim=extent[2:])


def _scale_bar(figure: Figure, width: float, height: float, scale: float) -> None:
    """A bar of a round length at the top right; all panels have one scale, in inches per mm."""
    from matplotlib.lines import Line2D

    length = max(mm for mm in (1, 2, 5, 10, 20, 50, 100, 200) if mm == 1 or scale * mm <= LONGEST_BAR)
    right, y = 1 - GAP / width, 1 - 0.4 / height
    figure.add_artist(Line2D([right - scale * length / width, right], [y, y], color=INK, linewidth=2, solid_capstyle="butt"))
    figure.text(right - scale * length / width / 2, y + 0.05 / height, f"{length:g} mm", color=INK, fontsize=8, ha="center", va="bottom")

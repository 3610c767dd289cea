"""Pictures of a registration, bone echoes on the outline of the CT's bone in three cuts; and of a calibration on wires."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ..arrays import Floats, Numbers
from ..geometry.transforms import transform_points
from ..geometry.volume import Volume
from .figures import BACKGROUND, INK, new_figure, own_looks, save_figure
from .surface import DISTANCE_LIMIT, distance_from_labels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

SLAB = 2.5
"""mm to either side of a cut from which echoes are drawn."""

FARTHEST = 4.0
"""mm from bone at which the colors end."""

NEAR = 10.0
"""mm. Echoes beyond do not decide what is shown."""

BONE, COLORS = "#8a8f98", ("#2fd6b5", "#9be564", "#ffd23f", "#ff7a30", "#ff2e63")
"""Bone, and the echoes from on it to far from it."""

CUTS = (("sagittal", 0, 1, 2), ("axial", 2, 0, 1), ("coronal", 1, 0, 2))
"""Name, axis across the cut, and the axes to the right and up; x to the patient's right, y anterior, z superior. Drawn as radiologists
look at it, the patient's right or front on the left."""


@own_looks()
def registration_figure(path: str | Path, echoes: Floats, labels: Volume, title: str) -> None:
    """Draw the echoes near three cuts through the middle of what was seen, colored by their distance to bone.

    Parameters
    ----------
    echoes : (n, 3) array, mm
        Where bone was seen, in the frame of the labels, whose axes are the patient's.
    """
    figure = new_figure(13.0, 5.2)
    panels = figure.subplots(1, 3)
    draw_cuts(figure, panels, echoes, distance_from_labels(labels))
    figure.suptitle(title, color=INK, fontsize=12, parse_math=False)
    save_figure(path, figure)


@own_looks()
def calibration_figure(path: str | Path, before: Floats, after: Floats, labels: Volume, titles: tuple[str, str]) -> None:
    """The same for echoes (n, 3), mm, as an old and a new calibration place them, one row each; `titles` are those of the rows."""
    figure, field_of_bone = new_figure(13.0, 10.4), distance_from_labels(labels)
    for rows, echoes, title in zip(figure.subfigures(2, 1), (before, after), titles, strict=True):
        rows.set_facecolor(figure.get_facecolor())
        draw_cuts(rows, rows.subplots(1, 3), echoes, field_of_bone)
        rows.suptitle(title, color=INK, fontsize=12, parse_math=False)
    save_figure(path, figure)


@own_looks()
def wire_figure(path: str | Path, images: Sequence[Numbers], points: Floats, expected: Floats, title: str) -> None:
    """Draw images of a phantom with the wires as they are found and as a calibration expects them, (images, n, 2) pixels each."""
    figure = new_figure(13.0, 4.2)
    for panel, image, found, wanted in zip(figure.subplots(1, len(images), squeeze=False)[0], images, points, expected, strict=True):
        # Echoes of wires are the brightest by far
        panel.imshow(np.sqrt(np.asarray(image, dtype=np.float64)), cmap="gray")
        panel.plot(*found.T, "o", mfc="none", mec=COLORS[0], ms=11, label="wires as found")
        panel.plot(*wanted.T, "+", color=COLORS[-1], ms=9, label="as the calibration expects them")
        low, high = found.min(axis=0) - 50, found.max(axis=0) + 50
        panel.set(xticks=[], yticks=[], xlim=(low[0], high[0]), ylim=(high[1], low[1]))
    figure.legend(*panel.get_legend_handles_labels(), loc="lower center", ncols=2, labelcolor=INK, frameon=False)
    figure.suptitle(title, color=INK, fontsize=12, parse_math=False)
    save_figure(path, figure)


def draw_cuts(figure: FigureBase, panels: Sequence[Axes], points: Floats, field_of_bone: Volume) -> None:
    """The echoes on the outline of bone, in three panels of a figure."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    distances = np.abs(_sample(field_of_bone, points))
    near = distances < NEAR
    middle = np.median(points[near] if near.any() else points, axis=0)
    colors = LinearSegmentedColormap.from_list("distance", COLORS)
    for panel, (name, across, right, up) in zip(panels, CUTS):
        # The cut that shows most: where echoes are densest along its axis
        offset = _densest(points[near, across], middle[across]) if near.any() else middle[across]
        seen = points[np.abs(points[:, across] - offset) < SLAB]
        own = distances[np.abs(points[:, across] - offset) < SLAB]
        low, high = (f(points[near], axis=0) if near.any() else middle for f in (np.min, np.max))
        spans = [np.arange(low[axis] - 12, high[axis] + (45 if axis == 1 else 12), 0.5) for axis in (right, up)]
        plane = np.zeros((len(spans[1]), len(spans[0]), 3))
        plane[..., across], plane[..., right], plane[..., up] = offset, spans[0][None, :], spans[1][:, None]
        field = _sample(field_of_bone, plane.reshape(-1, 3)).reshape(plane.shape[:2])
        if (field < 0).any():
            panel.contourf(*spans, field, levels=[-100, 0], colors=[BONE], alpha=0.35)
            panel.contour(*spans, field, levels=[0], colors=[BONE], linewidths=0.9)
        order = np.argsort(own)
        panel.scatter(
            seen[order, right], seen[order, up], c=own[order], s=4, cmap=colors, vmin=0, vmax=FARTHEST, linewidths=0, rasterized=True
        )
        panel.set(xlim=spans[0][[-1, 0]], ylim=spans[1][[0, -1]], aspect="equal", facecolor=BACKGROUND)
        panel.set_title(name, color=INK, fontsize=11)
        panel.set_xlabel("RAS"[right] + " (mm)", color=INK, fontsize=9)
        panel.set_ylabel("RAS"[up] + " (mm)", color=INK, fontsize=9)
        panel.tick_params(colors=INK, labelsize=8)
        for edge in panel.spines.values():
            edge.set_color("#444444")
    bar = figure.colorbar(ScalarMappable(Normalize(0, FARTHEST), colors), ax=panels, shrink=0.85, pad=0.015, extend="max")
    bar.set_label("distance of the bone echo to the CT's bone (mm)", color=INK, fontsize=9)
    bar.ax.tick_params(colors=INK, labelsize=8)


def _densest(values: Floats, otherwise: float) -> float:
    """Where most values lie within a slab; `otherwise` where there is none."""
    if not len(values):
        return otherwise
    counts, edges = np.histogram(values, bins=np.arange(values.min(), values.max() + 2 * SLAB, SLAB))
    best = int(counts.argmax())
    return float((edges[best] + edges[best + 1]) / 2)


def _sample(distance: Volume, points: Floats) -> Floats:
    """Distances (n,) at points (n, 3), by linear interpolation; the limit outside."""
    ijk = transform_points(distance.grid.reference_to_ijk, points)
    distances = scipy.ndimage.map_coordinates(distance.array, ijk.T[::-1], order=1, mode="constant", cval=DISTANCE_LIMIT)
    return np.asarray(distances, dtype=np.float64)

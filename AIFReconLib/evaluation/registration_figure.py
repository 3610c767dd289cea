"""Pictures of a registration, bone echoes on the outline of the CT's bone in three cuts; and of a calibration on wires."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ..arrays import Floats, Integers, Numbers
from ..geometry.volume import Volume
from .figures import new_figure, own_looks, save_figure
from .lines import values_at
from .surface import DISTANCE_LIMIT, distance_from_labels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

SLAB = 2.5
"""mm to either side of a cut from which echoes are drawn."""

WINDOW = 24.0
"""mm from the middle to the sides of what is shown of two angles."""

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
    figure = new_figure(13.0, 5.0, layout="constrained")
    draw_cuts(figure, echoes, distance_from_labels(labels))
    figure.suptitle(title, fontsize=12)
    save_figure(path, figure)


@own_looks()
def calibration_figure(
    path: str | Path, placed: tuple[Floats, Floats], angles: Integers, titles: tuple[str, str], labels: Volume | None = None
) -> None:
    """Draw what two angles show of one place, and the echoes on the bone where there is a CT: before a calibration and after it.

    Parameters
    ----------
    placed : two (n, 3) arrays, mm
        Where the old and the new calibration place the echoes, in the frame of the labels, else in Reference.
    angles : (n,) integer array
        From which angle each was seen.
    """
    figure = new_figure(13.0, 13.8 if labels is not None else 3.8, layout="constrained")
    *rows, last = figure.subfigures(3, 1, height_ratios=(5.0, 5.0, 3.8)) if labels is not None else [figure.subfigures(1, 1)]
    for part in (*rows, last):
        part.set_facecolor(figure.get_facecolor())
    if labels is not None:
        field_of_bone = distance_from_labels(labels)
        for part, echoes, title in zip(rows, placed, titles, strict=True):
            draw_cuts(part, echoes, field_of_bone, placed[1])
            part.suptitle(title, fontsize=12)
    names = ("before", "after") if labels is not None else titles
    draw_two_angles(last, placed, angles, names)
    save_figure(path, figure)


def draw_two_angles(figure: FigureBase, placed: tuple[Floats, Floats], angles: Integers, titles: tuple[str, str]) -> None:
    """What two angles show of one place, in a panel each: before and after."""
    points = placed[1]
    first, second = _crossing_pair(placed[0], angles)
    seen = (angles == first) | (angles == second)
    across = int(np.ptp(points[seen], axis=0).argmax())
    right, up = (axis for axis in range(3) if axis != across)
    # Where both saw something, and most of it
    beside = np.asarray(scipy.spatial.cKDTree(points[angles == first]).query(points[angles == second])[0]) < SLAB
    both = points[angles == second][beside] if beside.any() else points[seen]
    offset = _densest(both[:, across])
    shown = seen & (np.abs(points[:, across] - offset) < SLAB)
    both = both[np.abs(both[:, across] - offset) < SLAB]
    middle = _densest(both[:, right], WINDOW), float(np.median(both[:, up]))
    panels = figure.subplots(1, 2)
    for panel, echoes, title in zip(panels, placed, titles, strict=True):
        for angle, color, name in ((first, COLORS[0], "one angle"), (second, COLORS[3], "another angle")):
            mine = shown & (angles == angle)
            panel.scatter(echoes[mine, right], echoes[mine, up], s=14, color=color, linewidths=0, label=name, rasterized=True)
        panel.set(xlim=(middle[0] + WINDOW, middle[0] - WINDOW), ylim=(middle[1] - WINDOW / 3, middle[1] + WINDOW / 3), aspect="equal")
        _dress(panel, title, right, up)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, markerscale=2)
    figure.suptitle("the same bone seen from two angles", fontsize=12)


def _crossing_pair(points: Floats, angles: Integers) -> tuple[int, int]:
    """Of the angles that see much of the same, the two that place it farthest apart."""
    trees = {int(number): scipy.spatial.cKDTree(points[angles == number]) for number in np.unique(angles)}
    near = {}
    for one, other in itertools.combinations(trees, 2):
        distances = np.asarray(trees[one].query(trees[other].data, distance_upper_bound=SLAB)[0])
        distances = distances[np.isfinite(distances)]
        near[one, other] = (len(distances), float(np.median(distances)) if len(distances) else 0.0)
    most = max((count for count, _ in near.values()), default=0)
    first = next(iter(trees))
    return max((pair for pair in near if near[pair][0] >= most / 3), key=lambda pair: near[pair][1], default=(first, first))


def _dress(panel: Axes, title: str, right: int, up: int) -> None:
    """Title and axes in mm."""
    panel.set_title(title, fontsize=11)
    panel.set_xlabel("RAS"[right] + " (mm)", fontsize=9)
    panel.set_ylabel("RAS"[up] + " (mm)", fontsize=9)
    panel.tick_params(labelsize=8)
    for edge in panel.spines.values():
        edge.set_color("#444444")


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
    figure.legend(*panel.get_legend_handles_labels(), loc="lower center", ncols=2)
    figure.suptitle(title, fontsize=12)
    save_figure(path, figure)


def draw_cuts(figure: FigureBase, points: Floats, field_of_bone: Volume, like: Floats | None = None) -> None:
    """The echoes on the outline of bone, in three panels of a figure, where most of them are, or most of those that `like` gives."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    distances = np.abs(values_at(field_of_bone, points, DISTANCE_LIMIT))
    shown = points if like is None else like
    close = np.abs(values_at(field_of_bone, shown, DISTANCE_LIMIT)) < NEAR
    shown = shown[close] if close.any() else shown
    panels = figure.subplots(1, 3)
    colors = LinearSegmentedColormap.from_list("distance", COLORS)
    for panel, (name, across, right, up) in zip(panels, CUTS):
        # The cut that shows most: where echoes are densest along its axis
        offset = _densest(shown[:, across])
        seen = points[np.abs(points[:, across] - offset) < SLAB]
        own = distances[np.abs(points[:, across] - offset) < SLAB]
        low, high = shown.min(axis=0), shown.max(axis=0)
        spans = [np.arange(low[axis] - 12, high[axis] + (45 if axis == 1 else 12), 0.5) for axis in (right, up)]
        plane = np.zeros((len(spans[1]), len(spans[0]), 3))
        plane[..., across], plane[..., right], plane[..., up] = offset, spans[0][None, :], spans[1][:, None]
        field = values_at(field_of_bone, plane, DISTANCE_LIMIT)
        if (field < 0).any():
            panel.contourf(*spans, field, levels=[-100, 0], colors=[BONE], alpha=0.35)
            panel.contour(*spans, field, levels=[0], colors=[BONE], linewidths=0.9)
        order = np.argsort(own)
        panel.scatter(
            seen[order, right], seen[order, up], c=own[order], s=4, cmap=colors, vmin=0, vmax=FARTHEST, linewidths=0, rasterized=True
        )
        panel.set(xlim=spans[0][[-1, 0]], ylim=spans[1][[0, -1]], aspect="equal")
        _dress(panel, name, right, up)
    bar = figure.colorbar(ScalarMappable(Normalize(0, FARTHEST), colors), ax=panels, shrink=0.85, pad=0.015, extend="max")
    bar.set_label("distance of the bone echo to the CT's bone (mm)", fontsize=9)
    bar.ax.tick_params(labelsize=8)


def _densest(values: Floats, width: float = SLAB) -> float:
    """Where most values, of which there are some, lie within a width of mm."""
    counts, edges = np.histogram(values, bins=np.arange(values.min(), values.max() + 2 * width, width))
    best = int(counts.argmax())
    return float((edges[best] + edges[best + 1]) / 2)

"""Pictures of a registration, bone echoes on the outline of the CT's bone in three cuts; and of a calibration on wires."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats, Integers, Numbers, Singles
from ..geometry.volume import Volume
from .figures import new_figure, own_looks, save_figure
from .lines import values_at
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
    figure = new_figure(13.0, 5.0, layout="constrained")
    draw_cuts(figure, echoes, distance_from_labels(labels))
    figure.suptitle(title, fontsize=12)
    save_figure(path, figure)


@own_looks()
def calibration_figure(
    path: str | Path, placed: tuple[Floats, Floats], angles: Integers, titles: tuple[str, str], labels: Volume | None = None
) -> None:
    """Draw the echoes in three cuts, before a calibration and after it: on the bone of a CT, or in the colors of their angles.

    Parameters
    ----------
    placed : two (n, 3) arrays, mm
        Where the old and the new calibration place the echoes, in the frame of the labels, else in Reference.
    angles : (n,) integer array
        From which angle each was seen.
    """
    figure = new_figure(13.0, 10.0, layout="constrained")
    field_of_bone = None if labels is None else distance_from_labels(labels)
    for part, echoes, title in zip(figure.subfigures(2, 1), placed, titles, strict=True):
        part.set_facecolor(figure.get_facecolor())
        draw_cuts(part, echoes, field_of_bone, placed[1], angles)
        part.suptitle(title, fontsize=12)
    save_figure(path, figure)


def _dress(panel: Axes, title: str, right: int, up: int) -> None:
    """Title and axes in mm."""
    panel.set_title(title, fontsize=11)
    panel.set_xlabel("RAS"[right] + " (mm)", fontsize=9)
    panel.set_ylabel("RAS"[up] + " (mm)", fontsize=9)
    panel.tick_params(labelsize=8)
    panel.spines[:].set_color("#444444")


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


def draw_cuts(
    figure: FigureBase, points: Floats, field_of_bone: Volume | None, like: Floats | None = None, angles: Integers | None = None
) -> None:
    """Echoes in three panels of a figure, where most of them are, or most of those that `like` gives.

    On the outline of bone, by their distance to it; where there is none, by their angles.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    shown, colors = points if like is None else like, LinearSegmentedColormap.from_list("distance", COLORS)
    values = np.zeros(len(points)) if angles is None else angles % len(COLORS) * FARTHEST / (len(COLORS) - 1)
    if field_of_bone is not None:
        values = np.abs(values_at(field_of_bone, points, DISTANCE_LIMIT))
        close = np.abs(values_at(field_of_bone, shown, DISTANCE_LIMIT)) < NEAR
        shown = shown[close] if close.any() else shown
    panels = figure.subplots(1, 3)
    for panel, (name, across, right, up) in zip(panels, CUTS):
        # The cut that shows most: where echoes are densest along its axis
        offset = _densest(shown[:, across])
        near = np.flatnonzero(np.abs(points[:, across] - offset) < SLAB)
        near = near[np.argsort(values[near], kind="stable")]
        low, high = shown.min(axis=0), shown.max(axis=0)
        spans = [np.arange(low[axis] - 12, high[axis] + (45 if axis == 1 else 12), 0.5) for axis in (right, up)]
        if field_of_bone is not None:
            plane = np.zeros((len(spans[1]), len(spans[0]), 3))
            plane[..., across], plane[..., right], plane[..., up] = offset, spans[0][None, :], spans[1][:, None]
            _outline(panel, spans, values_at(field_of_bone, plane, DISTANCE_LIMIT))
        looks = {"s": 4, "cmap": colors, "vmin": 0, "vmax": FARTHEST, "linewidths": 0, "rasterized": True}
        panel.scatter(points[near, right], points[near, up], c=values[near], **looks)
        panel.set(xlim=spans[0][[-1, 0]], ylim=spans[1][[0, -1]], aspect="equal")
        _dress(panel, name, right, up)
    if field_of_bone is not None:
        bar = figure.colorbar(ScalarMappable(Normalize(0, FARTHEST), colors), ax=panels, shrink=0.85, pad=0.015, extend="max")
        bar.set_label("distance of the bone echo to the CT's bone (mm)", fontsize=9)
        bar.ax.tick_params(labelsize=8)


def _outline(panel: Axes, spans: list[Floats], field: Singles) -> None:
    if (field < 0).any():
        panel.contourf(*spans, field, levels=[-100, 0], colors=[BONE], alpha=0.35)
        panel.contour(*spans, field, levels=[0], colors=[BONE], linewidths=0.9)


def _densest(values: Floats, width: float = SLAB) -> float:
    """Where most values, of which there are some, lie within a width of mm."""
    counts, edges = np.histogram(values, bins=np.arange(values.min(), values.max() + 2 * width, width))
    best = int(counts.argmax())
    return float((edges[best] + edges[best + 1]) / 2)

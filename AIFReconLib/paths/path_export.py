"""Paths to look at: lines as Slicer's markups, a map on the skin, and a picture of the best line in its volume."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import scipy

from ..arrays import Floats, Integers
from ..evaluation.figures import INK, new_figure, own_looks, save_figure
from ..evaluation.slices import Plane, axis_ends, cut
from ..geometry.transforms import LPS_FROM_RAS, transform_points
from ..geometry.volume import Volume
from ..imaging.gray_window import gray_window
from ..io.volume.surfaces import write_surface
from .free_paths import RESEARCH, FreePaths
from .states import COLORS, FREE, NOT_SEEN, ROOM, STATES, TIGHT
from .windows import ENTRY_PITCH, Window

SCHEMA = "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#"

LONGEST_EDGE = 3.0
"""Times the distance between entries beyond which they do not lie on one patch of skin."""

THINNEST = 0.01
"""mm2 of a triangle between entries, at least."""

BESIDE, BEYOND = 35.0, 12.0
"""mm that the picture shows on both sides of the line, and before and behind it."""


def markups(found: FreePaths) -> dict[str, object]:
    """The lines of all windows, as Slicer's Markups module reads them from a file .mrk.json, each as a line of its own; in LPS."""
    lines = []
    for one in found.windows:
        ends = transform_points(LPS_FROM_RAS, np.stack([one.entry, one.end]))
        points = [
            {"id": str(n), "label": name, "position": np.round(place, 4).tolist(), "positionStatus": "defined"}
            for n, (name, place) in enumerate(zip(("entry", "target"), ends, strict=True), start=1)
        ]
        shade = _color(one)
        color = [round(int(shade[n : n + 2], 16) / 255, 4) for n in (1, 3, 5)]
        told = f"clearance {one.clearance:.1f} mm" if one.is_free else "not seen"
        lines.append(
            {
                "type": "Line",
                "name": f"{one.name}, {told}",
                "coordinateSystem": "LPS",
                "coordinateUnits": "mm",
                "locked": False,
                "labelFormat": "%N-%d",
                "description": RESEARCH,
                "controlPoints": points,
                "display": {"color": color, "selectedColor": color},
            }
        )
    return {"@schema": SCHEMA, "markups": lines}


def _color(window: Window) -> str:
    """As its lines have in the map: what was not seen must not look like what is free."""
    return COLORS[NOT_SEEN if not window.is_free else TIGHT if window.clearance < ROOM else FREE]


def write_skin_map(path: Path, found: FreePaths) -> None:
    """Write where lines begin as a .vtp with `state` (0 blocked, 1 not seen, 2 tight, 3 free), `clearance_mm`, `seen` of the best one.

    Raises OutputError when it cannot be written.
    """
    clearance, seen = found.clearances.astype(np.float32), found.seen.astype(np.float32)
    triangles = skin_triangles(found.entries, found.target)
    write_surface(path, found.entries, triangles, state=found.states, clearance_mm=clearance, seen=seen)


def skin_triangles(points: Floats, inside: Floats) -> Integers:
    """Triangles between points of the skin, (n, 3), counterclockwise seen from outside; none where they lie on a line."""
    middle = points.mean(axis=0)
    try:
        axes = np.linalg.svd(points - middle, full_matrices=False)[2]
        axes[1] *= np.sign((middle - inside) @ np.cross(axes[0], axes[1])) or 1.0
        flat = (points - middle) @ axes[:2].T
        triangles: Integers = scipy.spatial.Delaunay(flat).simplices
    except (scipy.spatial.QhullError, ValueError, IndexError):
        return np.empty((0, 3), dtype=np.int64)
    corners = points[triangles]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    triangles = triangles[sides.max(axis=1) <= LONGEST_EDGE * ENTRY_PITCH]
    a, b, c = flat[triangles].transpose(1, 2, 0)
    area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2
    # Three points on one line have no side
    triangles, area = triangles[np.abs(area) > THINNEST], area[np.abs(area) > THINNEST]
    return np.where((area < 0)[:, None], triangles[:, ::-1], triangles)


@own_looks()
def paths_figure(path: Path, volume: Volume, found: FreePaths) -> None:
    """Draw two slices along the best line, and the map on the skin as seen from outside.

    Raises OutputError when it cannot be written, or matplotlib is not there.
    """
    best = found.windows[0] if found.windows else None
    entry, end = (best.entry, best.end) if best else (found.entries[found.states.argmax()], found.target)
    color = COLORS[int(found.states.max())] if best is None else _color(best)
    down = (end - entry) / np.linalg.norm(end - entry)
    aside = np.linalg.svd(down[None])[2][1:]
    # As near to the axes of Reference as two ways across the line can be
    first = np.eye(3)[np.abs(down).argsort()[0]]
    right = aside.T @ (aside @ first)
    right /= np.linalg.norm(right)
    height = float(np.linalg.norm(end - entry)) + 2 * BEYOND
    figure = new_figure(13.0, 5.2, layout="constrained")
    figure.suptitle(RESEARCH, fontsize=11)
    slices = figure.subplots(1, 3)
    _, brightest = gray_window(volume.array, volume.array > 0)
    for ax, way in zip(slices[:2], (right, np.cross(down, right)), strict=True):
        plane = Plane("along the line", tuple(way), tuple(down), (*axis_ends(way), *axis_ends(down)))
        picture = cut(volume, plane, (entry + end) / 2, 2 * BESIDE, height)
        ax.imshow(picture, cmap="gray", vmin=0.0, vmax=brightest, extent=(-BESIDE, BESIDE, height - BEYOND, -BEYOND))
        ax.plot([0.0, 0.0], [0.0, height - 2 * BEYOND], color=color, linewidth=1.2)
        ax.set_xlabel(f"mm toward {axis_ends(way)[1]}")
        ax.set_ylabel("mm under the skin")
    places = (found.entries - entry) @ np.stack([right, np.cross(down, right)]).T
    for number, (name, shade) in enumerate(zip(STATES, COLORS, strict=True)):
        slices[2].scatter(*places[found.states == number].T, color=shade, s=14.0, label=name)
    slices[2].plot(0.0, 0.0, "+", color=INK, markersize=14)
    slices[2].set_aspect("equal")
    slices[2].set_xlabel("mm on the skin")
    figure.legend(*slices[2].get_legend_handles_labels(), loc="outside lower right", ncols=len(STATES))
    save_figure(path, figure)

"""A look at one volume: three cuts through its bone and a projection from the probe's side, laid out as Slicer does."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats, Mask, Numbers
from ..geometry.transforms import transform_points
from ..geometry.volume import Volume
from ..imaging.gray_window import gray_window
from ..io.disk.atomic import atomic_output
from .figures import CT_WINDOW, Panel, cut_panel, draw_panels, own_looks, png_of
from .slices import axis_ends, planes, whole_cut
from .surface import median

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BRIGHTEST = 0.998
"""Of what was scanned, this share is not brighter than white."""

LOOKED_AT = 500_000
"""Voxels from which gray levels are chosen, evenly spread."""

BEHIND, BONE, DIMMED, STEEP = 8.0, 0.6, 0.6, 0.8
"""mm over which bone has a shadow; part of the strongest from which on it is bone; part by which the farthest is dimmed; part of a beam
along z from which on y is up."""

WIDTH, LONGEST_HEIGHT = 9.5, 8.0
"""Inches that panels take together, at most; beside a CT half as much again across."""


@dataclass(frozen=True)
class PreviewImage:
    """A drawn picture: a notebook shows it, `write` keeps it."""

    png: bytes

    def __repr__(self) -> str:
        return f"<PreviewImage: PNG of {len(self.png) / 1024:.0f} KiB; a notebook shows it, write(path) keeps it>"

    def _repr_png_(self) -> bytes:
        return self.png

    def write(self, path: str | Path) -> None:
        """Write the PNG file, or no part of it; an OutputError where it cannot be written."""
        with atomic_output(path) as temporary:
            Path(temporary).write_bytes(self.png)


@own_looks()
def preview(
    volume: Volume,
    mask: Volume | None = None,
    labels: Volume | None = None,
    ct: Volume | None = None,
    title: str = "",
    score: Volume | None = None,
    beam: Floats | None = None,
    patient: bool | None = None,
) -> PreviewImage:
    """Draw three cuts through the bone, and bone as the probe sees it: at each place what is brightest above what lies behind it.

    Raises OutputError when matplotlib is not installed.

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
    score : Volume or None
        Of the same reconstruction: the projection goes through what it stands behind, the better half of what has any.
    beam : (3,) array or None
        The way sound goes, in Reference. By default from behind to the front of a patient; where there is none either, the projection is of
        the brightest voxels along y.
    patient : bool or None
        Whether Reference lies as the patient does, in RAS. By default where there are labels or a CT. Without, the planes have the names of
        the axes: x, y and z of the frame.
    """
    scanned = (volume.array if mask is None else mask.array) != 0
    center = middle_of_bone(volume, scanned, labels)
    seen = Volume(scanned.view(np.uint8), volume.ijk_to_reference)
    window = gray_window(volume.array, seen.array)
    patient = labels is not None or ct is not None if patient is None else patient
    ways = planes(patient)
    places = [whole_cut(volume.grid, plane, center) for plane in ways]
    panels = [cut_panel(plane.name, volume, plane, place, window, seen, labels) for plane, place in zip(ways, places, strict=True)]
    panels.append(_projection(volume, scanned, window, patient, beam, score))
    if ct is not None:
        beside = zip(ways, places, strict=True)
        panels += [cut_panel(f"CT, {plane.name}", ct, plane, place, CT_WINDOW, None, labels) for plane, place in beside]
    notes = ["blue: not scanned" if mask is not None else "blue: 0, not scanned or black"]
    if labels is not None:
        notes.append("orange: bone of the CT")
    return PreviewImage(png_of(_draw(panels, title, ", ".join(notes))))


def _draw(panels: list[Panel], title: str, note: str) -> Figure:
    """Two columns, or four with a CT."""
    columns = 2 if len(panels) == 4 else 4
    rows = [panels[:columns], panels[columns:]]
    wide = sum(max(panel.size[0] for panel in panels[n::columns]) for n in range(columns))
    tall = sum(max(panel.size[1] for panel in row) for row in rows)
    return draw_panels(rows, min(WIDTH * (1.0 if columns == 2 else 1.5) / wide, LONGEST_HEIGHT / tall), title, note)


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
            return np.array([median(along, bright) for along in met.T], dtype=np.float64)
    middle = [
        np.average(np.arange(n), weights=along) if (along := np.count_nonzero(scanned, axis=axes)).any() else (n - 1) / 2
        for n, axes in zip(grid.size, ((0, 1), (0, 2), (1, 2)), strict=True)
    ]
    center: Floats = transform_points(grid.ijk_to_reference, np.array([middle]))[0]
    return center


def _projection(
    volume: Volume, scanned: Mask, window: tuple[float, float], patient: bool, beam: Floats | None, score: Volume | None = None
) -> Panel:
    """Bone as the probe sees it, along the axis of the grid that runs nearest to its beams: the nearer, the brighter.

    Where nothing tells how they run, what is brightest along y.
    """
    from_behind = patient and beam is None
    ahead = np.array([0.0, 1.0, 0.0]) if beam is None else np.asarray(beam, dtype=np.float64)
    up = np.array([0.0, 0.0, 1.0] if abs(ahead[2]) < STEEP * np.linalg.norm(ahead) else [0.0, 1.0, 0.0])
    right = np.cross(ahead, up)
    to_reference = volume.ijk_to_reference[:3, :3] / volume.grid.spacing
    through = int(np.abs(ahead @ to_reference).argmax())
    down, across = (axis for axis in range(3) if axis != through)
    if abs(up @ to_reference[:, across]) > abs(up @ to_reference[:, down]):
        down, across = across, down

    def turned(array: Numbers) -> Numbers:
        """Rows downward, columns to the right, and on along the beams."""
        seen = np.moveaxis(array, [2 - down, 2 - across, 2 - through], [0, 1, 2])
        seen = seen[::-1] if up @ to_reference[:, down] > 0 else seen
        seen = seen[:, ::-1] if right @ to_reference[:, across] < 0 else seen
        return seen[..., ::-1] if ahead @ to_reference[:, through] < 0 else seen

    met = turned(scanned).astype(bool)
    side = (volume.grid.size[across] * float(volume.grid.spacing[across]), volume.grid.size[down] * float(volume.grid.spacing[down]))
    edges = ("L", "R", "S", "I") if from_behind else (*axis_ends(right), *axis_ends(-up))
    if beam is None and not patient:
        return Panel("brightest along y", _brightest(turned(volume.array), met), side, edges, window)
    trusted = np.ones(met.shape, bool) if score is None else turned(score.array) >= _better_half(score)
    behind = max(round(BEHIND / float(volume.grid.spacing[through])), 1)
    rows = [_bone_along(*row, behind) for row in zip(turned(volume.array), met, trusted, strict=True)]
    rises, depths = (np.array(each, dtype=np.float64) for each in zip(*rows, strict=True))
    top = float(np.nanquantile(rises, BRIGHTEST)) if np.isfinite(rises).any() else 1.0
    bone = rises > BONE * top
    if bone.any():
        first, last = np.quantile(depths[bone], (0.02, 0.98))
        rises *= 1 - DIMMED * np.clip((depths - first) / max(last - first, 1.0), 0, 1)
    name = "bone, from behind" if from_behind else f"bone, seen along {axis_ends(ahead)[1]}"
    return Panel(name, rises, side, edges, (0.0, top or 1.0))


def _brightest(levels: Numbers, met: Mask) -> Floats:
    """The brightest of each line (rows, columns, voxels); NaN where nothing was met."""
    picture = np.array([np.where(inside, row, 0).max(axis=-1) for inside, row in zip(met, levels, strict=True)], dtype=np.float64)
    picture[~met.any(axis=-1)] = np.nan
    return picture


def _better_half(score: Volume) -> float:
    """The score that half of what has any exceeds."""
    some = score.array.reshape(-1)[:: max(score.grid.voxels // LOOKED_AT, 1)]
    some = some[some > 0]
    return float(np.median(some)) if some.size else 0.0


def _bone_along(levels: Numbers, met: Mask, trusted: Mask, behind: int) -> tuple[Floats, Floats]:
    """By how much the brightest of each line (lines, voxels) exceeds the mean of so many behind, times that part, and how far along it is.

    Bone is bright and has a shadow; skin and fascia are as bright, and have none. NaN where nothing was met.
    """
    bright = np.where(met, np.nan_to_num(levels.astype(np.float64)), 0.0)
    sums, counts = (np.pad(np.cumsum(each, axis=1), ((0, 0), (0, behind)), mode="edge") for each in (bright, met.astype(np.float64)))
    total, known = (upto[:, behind:] - upto[:, : bright.shape[1]] for upto in (sums, counts))
    # Where little was met behind, nothing is known of a shadow
    rises = np.where(met & trusted & (known >= behind / 2), np.maximum(bright - total / np.maximum(known, 1.0), 0.0), 0.0)
    rises *= rises / np.maximum(bright, 1e-9)
    highest: Floats = rises.max(axis=1, initial=0.0)
    highest[~met.any(axis=1)] = np.nan
    return highest, rises.argmax(axis=1).astype(np.float64)

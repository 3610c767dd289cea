"""How far holes are to be filled where nobody says: as far as the gaps between neighboring frames ask for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..arrays import Floats, Integers, Mask, Matrix
from ..geometry.volume import VoxelGrid
from ..message import listed
from ..recipe.recipe import AUTOMATIC, Recipe
from .filling import HoleFilling

FARTHEST = 4.0
"""mm. What lies farther from every frame was not scanned: to fill it would be to invent it."""

LARGEST = 20.0
"""mm, of any hole limit."""

SHARE = 0.95
"""Of the space between neighboring frames, how much is to be filled."""

JUMP = 3.0
"""Frames this many times as far apart as is usual, and too far to be filled, are the end of a pass and the beginning of another."""

PIXELS = 5
"""Places in an image, along each side, at which the distance to the next frame is looked at."""

MOST_PLACES, FEWEST_PLACES, WORK = 1500, 200, 4_000_000
"""Places between frames that are looked at; with many frames fewer, so that places times frames stay below `WORK`."""

FRAMES_AT_ONCE = 1000
STILL = 0.05
"""mm. Frames nearer to each other are of a probe that rests."""


def with_limit(
    settings: Recipe, configured: tuple[HoleFilling, ...], poses: Matrix, shown: Mask, grid: VoxelGrid
) -> tuple[Recipe, tuple[str, ...]]:
    """The settings with a hole limit that is a number, and what a user should know of how holes are filled.

    The configuration's ways stay where the settings name neither a way nor a limit. The other arguments are those of `automatic_limit`.
    """
    if settings.holes == "off":
        return replace(settings, hole_limit=0.0), ()
    if settings.holes is None and configured and settings.hole_limit in (AUTOMATIC, 0):
        ways = listed((way.described() for way in configured), ", then ")
        return replace(settings, hole_limit=0.0), (f"Gaps are filled as the configuration asks: {ways}.",)
    if settings.hole_limit != AUTOMATIC:
        return settings, ()
    limit, notes = automatic_limit(poses, shown, grid)
    return replace(settings, hole_limit=limit), notes


def automatic_limit(poses: Matrix, shown: Mask, grid: VoxelGrid) -> tuple[float, tuple[str, ...]]:
    """The limit (mm) that fills `SHARE` of the space between neighboring frames, at most `FARTHEST` and at least a voxel's diagonal.

    Parameters
    ----------
    poses : (frames, 3, 4) array, pixels to mm
        Upper rows of image_to_reference, in the order in which the frames were taken.
    shown : (rows, columns) bool array
        The pixels that enter.
    grid : VoxelGrid
        What lies outside it does not count.

    Returns
    -------
    limit : float, mm
    notes : tuple of str
        What was chosen, and what would leave no gaps where frames lie too far apart.

    Notes
    -----
    A voxel is filled from the center of another, which a pixel entered anywhere: half a diagonal is added to the distance from the frame.
    Rounded up to tenths of mm, so that the number that is shown is the one that was used.
    """
    diagonal = float(np.linalg.norm(grid.spacing))
    distances = distances_between_frames(poses, shown, grid) if len(poses) > 1 else np.empty(0)
    apart = float(np.quantile(distances, SHARE)) if distances.size else 0.0
    # No more than the settings take, which voxels of centimeters would ask for
    most = min(max(FARTHEST, diagonal), LARGEST)
    limit = min(math.ceil(10 * max(diagonal, apart + diagonal / 2) - 1e-9) / 10, most)
    notes = [f"Gaps between frames are filled up to {limit:.3g} mm."]
    if diagonal <= FARTHEST < apart + diagonal / 2:
        times = apart / (most - diagonal / 2)
        notes.append(
            f"Frames lie up to {2 * apart / SHARE:.0f} mm apart, which leaves gaps between them: about "
            f"{math.ceil(times * len(poses))} frames on the same path, or moving the probe at {math.floor(100 / times):.0f}% of "
            "the speed, would leave none."
        )
    return limit, tuple(notes)


def distances_between_frames(poses: Matrix, shown: Mask, grid: VoxelGrid) -> Floats:
    """How far places between neighboring frames lie from the nearest frame, whichever that is, (places,) float64, mm.

    The arguments are those of `automatic_limit`. The places are spread evenly over the space between frames, so a quantile of their
    distances is one of its voxels.
    """
    normals = np.cross(poses[:, :, 0], poses[:, :, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    pixels = _lattice(shown)
    gaps = np.empty((len(poses) - 1, len(pixels)))
    for first in range(0, len(gaps), FRAMES_AT_ONCE):
        some = slice(first, min(first + FRAMES_AT_ONCE, len(gaps)))
        gaps[some] = np.abs(np.einsum("fx,fxp->fp", normals[some], _starts_and_ways(poses, np.arange(len(gaps))[some], pixels)[1]))
    gaps[_is_jump(gaps.mean(axis=1))] = 0.0
    upto = np.cumsum(gaps)
    if not upto.size or upto[-1] <= 0:
        return np.empty(0)
    count = int(np.clip(WORK // len(poses), FEWEST_PLACES, MOST_PLACES))
    steps = (np.arange(count) + 0.5) * (upto[-1] / count)
    which = np.minimum(np.searchsorted(upto, steps, side="right"), upto.size - 1)
    part = 1 - (upto[which] - steps) / gaps.reshape(-1)[which]
    frame, pixel = np.divmod(which, len(pixels))
    start, way = (ends[np.arange(count), :, pixel] for ends in _starts_and_ways(poses, frame, pixels))
    places = start + part[:, None] * way
    nearest: Floats = np.minimum(part, 1 - part) * gaps[frame, pixel]
    ijk = places @ grid.reference_to_ijk[:3, :3].T + grid.reference_to_ijk[:3, 3]
    inside = ((ijk > -0.5) & (ijk < np.array(grid.size) - 0.5)).all(axis=1)
    places, nearest = places[inside], nearest[inside]
    for first in range(0, len(poses), FRAMES_AT_ONCE):
        some = slice(first, first + FRAMES_AT_ONCE)
        _approach(nearest, places, poses[some], normals[some], shown)
    return nearest


def _starts_and_ways(poses: Matrix, frames: Integers, pixels: Floats) -> tuple[Floats, Floats]:
    """Where `pixels` (p, 2) of some frames lie, and from there to those of the next ones, (frames, 3, p), mm."""
    start, end = (poses[some, :, :2] @ pixels.T + poses[some, :, 3:] for some in (frames, frames + 1))
    return start, end - start


def _lattice(shown: Mask) -> Floats:
    """Pixels (column, row) spread over those that are shown, (pixels, 2)."""
    rows, columns = (np.flatnonzero(shown.any(axis=axis)) for axis in (1, 0))
    if not rows.size:
        return np.empty((0, 2))
    parts = (np.arange(PIXELS) + 0.5) / PIXELS
    row, column = (np.rint(along[0] + parts * (along[-1] - along[0])).astype(int) for along in (rows, columns))
    spread = np.array([(x, y) for y in row for x in column if shown[y, x]], dtype=np.float64)
    return spread if spread.size else np.argwhere(shown)[:1, ::-1].astype(np.float64)


def _is_jump(gaps: Floats) -> Mask:
    """Whether what lies between two frames is not theirs: another pass begins. `gaps` in mm, one per pair."""
    moving = gaps[gaps > STILL]
    usual = float(np.median(moving)) if moving.size else 0.0
    jump: Mask = gaps > max(2 * FARTHEST, JUMP * usual)
    return jump


def _approach(nearest: Floats, places: Floats, poses: Matrix, normals: Floats, shown: Mask) -> None:
    """Lower `nearest` to the distance of the nearest of these frames, wherever that shows a pixel straight below the place."""
    away = np.abs(places @ normals.T - np.einsum("fx,fx->f", normals, poses[:, :, 3]))
    place, frame = np.nonzero(away < nearest[:, None])
    to_pixels = np.linalg.pinv(poses[:, :, :2])
    column, row = np.rint(np.einsum("nax,nx->an", to_pixels[frame], places[place] - poses[frame, :, 3])).astype(int)
    rows, columns = shown.shape
    seen = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    seen[seen] = shown[row[seen], column[seen]]
    np.minimum.at(nearest, place[seen], away[place[seen], frame[seen]])

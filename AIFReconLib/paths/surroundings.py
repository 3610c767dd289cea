"""What a volume shows around straight lines: how far its bone is, and where sound came."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Matrix, Singles
from ..bone.field import FARTHEST_KNOWN, BoneField
from ..errors import GeometryError
from ..evaluation.lines import UNDER_SKIN
from ..geometry.box import in_cubes
from ..geometry.transforms import invert, transform_points
from ..geometry.volume import Volume
from ..machine.threads import in_parts, usable_cores
from ..provenance.record import settings_of
from ..recipe.recipe import RULES

BRIGHT, TOWARD_BRIGHT = 99.5, 2 / 3
"""Percentile of what was measured that stands for bone, and how far from the median toward it a voxel is bone: see docs/paths.md for what
other levels do."""

FAR = 10.0
"""mm from bone beyond which nobody asks how far."""

ONE_LOOK = 1.0
"""Pixels that sound reached in full, by which a voxel was seen."""

FILLED = 2
"""Of a mask: no frame was there, the value is a neighbor's."""

STEP = 0.75
"""mm between looks along a line: distances are then off by 0.1 mm at most 1 mm from bone."""

LINES_AT_ONCE = 1000

CLOSE, ENOUGH = 1.0, 200
"""mm that bright voxels lie from the surface of a CT's bone in the median, at most, where both agree; and voxels that tell it, at least."""

ASKED = 20_000
"""Bright voxels that are compared with a CT, at most."""


@dataclass(frozen=True, eq=False)
class ShownVolume:
    """A volume, and what is known of how it was measured."""

    intensity: Volume
    measured: Mask  #: [k, j, i]
    looks: Singles | None  #: [k, j, i]. Pixels that sound reached in full; None where that is not known.
    level: float  #: From it on a voxel is bone

    @classmethod
    def of(cls, intensity: Volume, mask: Volume | None = None, score: Volume | None = None) -> ShownVolume:
        """A volume with its mask (0 nothing, 2 filled from a neighbor; else measured) and the score of the method `weighted`, if known.

        Without a mask, what is not 0 was measured. The score of other methods knows nothing of shadows, and is not used.

        Raises GeometryError when they do not lie on one grid, or nothing stands out from the rest.
        """
        for name, other in (("mask", mask), ("score", score)):
            if other is not None and not other.grid.matches(intensity.grid):
                raise GeometryError(f"Input {name} must lie on the voxels of the volume; got another grid. Give that of the same result.")
        values = intensity.array
        measured = values != 0 if mask is None else (mask.array != 0) & (mask.array != FILLED)
        if values.dtype.kind == "f":
            measured &= np.isfinite(values)
        some = values[measured]
        if not some.size:
            raise GeometryError("Input volume must have measured voxels; got none. Was the right file chosen?")
        middle, bright = np.percentile(some, (50.0, BRIGHT))
        if not bright > middle:
            raise GeometryError("No voxel of the volume is brighter than most: it shows no bone. Was the right file chosen?")
        return cls(intensity, measured, _looks(score), float(middle + TOWARD_BRIGHT * (bright - middle)))

    def bone(self, skin: Floats) -> Integers:
        """The voxels that are bone, (n, 3) as (k, j, i); none near the skin, (m, 3) mm."""
        kji = np.argwhere((self.intensity.array >= self.level) & self.measured)
        places = transform_points(self.intensity.ijk_to_reference, kji[:, ::-1].astype(np.float64))
        depth, _ = scipy.spatial.cKDTree(skin).query(places, distance_upper_bound=UNDER_SKIN, workers=-1)
        return kji[~np.isfinite(depth)]


def _looks(score: Volume | None) -> Singles | None:
    if score is None or score.fields.get("AIFRecon_method") != "weighted":
        return None
    floor = float(str(settings_of(score).get("weight_floor", RULES["weight_floor"]["default"])))
    looks: Singles = score.array.astype(np.float32) / np.float32(floor)
    return looks


@dataclass(frozen=True, eq=False)
class Surroundings:
    """How far from bone a place is, and whether it was seen."""

    distance: Volume  #: float32, mm. To the nearest bone, `FAR` at most; negative inside a CT's.
    looks: Volume  #: float32. From `ONE_LOOK` on a place was seen.
    margin: float  #: mm that are taken off distances

    @classmethod
    def around(cls, shown: ShownVolume, bone: Integers, points: Floats, margin: float, ct: PlacedField | None = None) -> Surroundings:
        """Those of the box around points (n, 3), mm, of bone at the voxels (m, 3) as (k, j, i), and of a CT's."""
        grid = shown.intensity.grid
        reach = np.ceil(FAR / grid.spacing) + 1
        ijk = transform_points(grid.reference_to_ijk, points)
        low = np.clip(np.floor(ijk.min(axis=0) - reach), 0, np.array(grid.size) - 1).astype(int)
        high = np.clip(np.ceil(ijk.max(axis=0) + reach), low, np.array(grid.size) - 1).astype(int)
        box = tuple(slice(first, last + 1) for first, last in zip(low[::-1], high[::-1], strict=True))
        place = grid.ijk_to_reference.copy()
        place[:3, 3] = transform_points(grid.ijk_to_reference, low)
        empty = np.ones([s.stop - s.start for s in box], dtype=bool)
        inside = bone[((bone >= low[::-1]) & (bone <= high[::-1])).all(axis=1)] - low[::-1]
        empty[tuple(inside.T)] = False
        distance = np.full(empty.shape, FAR, dtype=np.float32)
        if len(inside):
            distance = np.minimum(scipy.ndimage.distance_transform_edt(empty, sampling=grid.spacing[::-1]).astype(np.float32), FAR)
        if ct is not None:
            distance = np.minimum(distance, ct.on_voxels(place, empty.shape))
        seen = shown.measured[box].astype(np.float32) * np.float32(2 * ONE_LOOK)
        looks = seen if shown.looks is None else np.where(shown.measured[box], shown.looks[box], np.float32(0.0))
        return cls(Volume(distance, place), Volume(looks, place), margin)

    def along(self, entries: Floats, ends: Floats) -> tuple[Floats, Floats]:
        """Of lines from entries to ends, (n, 3) mm: least distance from bone less the margin, (n,) mm, and the share that was seen."""
        clearance, seen = np.empty(len(entries)), np.empty(len(entries))

        def look(part: int) -> None:
            some = slice(part * LINES_AT_ONCE, (part + 1) * LINES_AT_ONCE)
            distance, looks = self.profile(entries[some], ends[some])
            clearance[some] = distance.min(axis=1) - self.margin
            seen[some] = (looks >= ONE_LOOK).mean(axis=1)

        in_parts(look, -(-len(entries) // LINES_AT_ONCE), usable_cores())
        return clearance, seen

    def profile(self, entries: Floats, ends: Floats) -> tuple[Singles, Singles]:
        """Distance from bone, mm, and looks at as many places of each line, (n, m), from `UNDER_SKIN` below the entry to the end."""
        to_ijk, along = self.distance.grid.reference_to_ijk, _places(entries, ends)
        start, step = transform_points(to_ijk, entries), (ends - entries) @ to_ijk[:3, :3].T
        kji = (start.T[::-1, :, None] + step.T[::-1, :, None] * along).astype(np.float32)
        distance = scipy.ndimage.map_coordinates(self.distance.array, kji, np.float32, 1, cval=FAR)
        looks = scipy.ndimage.map_coordinates(self.looks.array, kji, np.float32, 1, cval=0.0)
        return distance, looks

    def unseen(self, entries: Floats, ends: Floats, pitch: float) -> Floats:
        """Places of these lines that were not seen, (m, 3) mm: the middle of those in each cube of `pitch` mm."""
        found = []
        for first in range(0, len(entries), LINES_AT_ONCE):
            begin, way = entries[first : first + LINES_AT_ONCE], (ends - entries)[first : first + LINES_AT_ONCE]
            line, place = np.nonzero(self.profile(begin, begin + way)[1] < ONE_LOOK)
            along = _places(begin, begin + way)[line, place]
            found.append(begin[line] + along[:, None] * way[line])
        return in_cubes(np.concatenate(found), pitch)[0]


def _places(entries: Floats, ends: Floats) -> Floats:
    """Parts of the way from entries to ends (n, 3) at which lines are looked at, (n, m), from `UNDER_SKIN` below the entry on."""
    length = np.linalg.norm(ends - entries, axis=1)
    first = np.minimum(UNDER_SKIN / np.maximum(length, UNDER_SKIN), 1.0)[:, None]
    places: Floats = first + (1.0 - first) * np.linspace(0.0, 1.0, max(int(np.ceil(length.max(initial=0.0) / STEP)), 1) + 1)
    return places


@dataclass(frozen=True, eq=False)
class PlacedField:
    """Distance to the bone of a CT where it lies in Reference."""

    field: BoneField
    to_reference: Matrix  #: (4, 4)

    def distances(self, points: Floats) -> Floats:
        """Signed, at points (n, 3), (n,) mm."""
        return self.field.sample(transform_points(invert(self.to_reference), points))[0]

    def on_voxels(self, ijk_to_reference: Matrix, shape: tuple[int, ...]) -> Singles:
        """The same on the voxels [k, j, i] of a grid: many times as fast as one by one."""
        known = self.field.distance
        to_known = known.grid.reference_to_ijk @ invert(self.to_reference) @ ijk_to_reference
        turn, shift = to_known[:3, :3][::-1, ::-1], to_known[:3, 3][::-1]
        array = known.array.astype(np.float32, copy=False)
        distance: Singles = scipy.ndimage.affine_transform(array, turn, shift, shape, order=1, cval=FARTHEST_KNOWN)
        return distance

    def agrees(self, shown: ShownVolume, bone: Integers) -> bool:
        """Whether the bone that a volume shows, voxels (n, 3) as (k, j, i), lies on the CT's; too little does not."""
        some = bone[:: max(len(bone) // ASKED, 1), ::-1].astype(np.float64)
        off = np.abs(self.distances(transform_points(shown.intensity.ijk_to_reference, some)))
        off = off[off < FAR]
        return len(off) >= ENOUGH and bool(np.median(off) <= CLOSE)

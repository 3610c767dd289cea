"""What the frames of a scan have met of the bone so far: one frame after the other, as they come or as they are recorded."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from ..arrays import Bytes, Floats, Integers, Mask, Matrix, Singles
from ..evaluation.visibility import BEAM_THICKNESS, GRAZING_DEG, BoneRays, SweepBeams, in_beams
from ..geometry.box import block_sums
from ..geometry.transforms import pixel_spacing
from ..imaging.beams import LINEAR, ProbeGeometry
from ..imaging.region import ImageRegion
from .bone import GuidedBone

BEFORE = 5.0
"""mm before bone from which on its scan line must be lit somewhere: the tissue that sound passed, the echo, or what lies behind a bone that
is not where the CT has it."""

BEHIND = 11.0
"""mm behind bone up to which that is looked for: a CT that is farther off is not placed."""

LOOK_STEP = 1.0
"""mm between looks along a scan line, and the size of the cells whose mean is looked at, so that speckle counts for little."""

LIT = 48.0
"""Level of the standard gray scale from which a cell counts as lit: a third of what the brightest tissue has."""

SHADOWED, DARK, MET = 1, 2, 3
"""Of a point in a frame's beams: behind other bone, in an image that is dark there, met."""


Number = TypeVar("Number", Floats, Singles)

ANGLES_DEG = np.array([0.0, 35.0, 42.5, 52.5, 57.5, 62.5, 67.5, 72.5, 77.5, 85.0])
SUPPORT = np.array([6.4, 3.0, 2.0, 1.1, 0.83, 0.6, 0.32, 0.14, 0.1, 0.1])
"""What a frame at these angles of incidence adds. Most likely for what ten scans of 120 and 360 frames of two simulated patients, 100 and
101, show by the present `weighted`, borders of the interspinous gaps counted three times (docs/guidance.md)."""

MOST = 0.995
"""The chance that bone shows which was met squarely without end."""


def support_of(cosines: Floats) -> Floats:
    """What each of some frames that meet a point adds to its support, by the cosine of its angle of incidence."""
    support: Floats = np.interp(np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0))), ANGLES_DEG, SUPPORT)
    return support


def expected_visibility(support: Floats) -> Floats:
    """The chance that bone shows, 0 to 1, by the sum of the support of all frames that meet it.

    MOST (1 - exp(-sqrt(support))). Were frames independent, the root would not be there; but bone that many frames did not show is bone
    that is hard to show.
    """
    shown: Floats = MOST * (1.0 - unseen(support))
    return shown


def unseen(support: Number) -> Number:
    """The part of `MOST` that is still missing, in the precision of the support."""
    missing: Number = np.exp(-np.sqrt(support))
    return missing


def support_for(visibility: Floats) -> Floats:
    """The support by which bone is expected to show so likely: the inverse of `expected_visibility`."""
    support: Floats = np.log1p(-visibility / MOST) ** 2
    return support


class FrameGeometry:
    """Tells what a frame meets of the bone, for one kind of image.

    `frame_size` is (columns, rows), `thickness` (mm) the full width of the beam across the image plane.
    """

    def __init__(
        self, bone: GuidedBone, frame_size: tuple[int, int], probe: ProbeGeometry, region: ImageRegion, thickness: float = BEAM_THICKNESS
    ):
        self.bone = bone
        self.beams = SweepBeams(np.empty((0, 4, 4)), frame_size, probe, region, thickness)
        self._mask = region.mask(*frame_size)
        self._rays = BoneRays(bone.distance)
        self._starts = bone.starts

    def view(self, image_to_reference: Matrix, image: Bytes | None = None) -> tuple[Integers, Floats, Bytes]:
        """What a frame at this pose meets; without an image, as if it were lit everywhere.

        Numbers of the points in beams that come within `GRAZING_DEG` of their normals, (m,), cosines of the angles of incidence, and
        whether each is `SHADOWED`, `DARK` or `MET`.

        The pose is (4, 4), pixels to mm, the image (rows, columns) on the standard gray scale (see `GrayLevels`).
        """
        _, seen, pixels, cosines, blocked = self._look(image_to_reference[None])
        status = np.full(len(seen), MET, dtype=np.uint8)
        status[blocked] = SHADOWED
        if image is not None:
            open_ = np.flatnonzero(~blocked)
            status[open_[~self._lit(image, pixel_spacing(image_to_reference), pixels[open_])]] = DARK
        return seen, cosines, status

    def support(self, image_to_reference: Matrix) -> tuple[Integers, Integers, Floats]:
        """What several frames (m, 4, 4) meet as if they were lit: frame, point, and what that adds to its support, by `support_of`."""
        frame, seen, _, cosines, blocked = self._look(image_to_reference)
        met = np.flatnonzero(~blocked)
        return frame[met], seen[met], support_of(cosines[met])

    def _look(self, image_to_reference: Matrix) -> tuple[Integers, Integers, Floats, Floats, Mask]:
        """Of points in the beams of frames (m, 4, 4), within `GRAZING_DEG`: frame, point, pixel, cosine, and whether bone is before it."""
        surface = self.bone.surface
        frame, seen, pixels, beams, lengths = in_beams(surface.points_reference, image_to_reference, self.beams, self._mask)
        cosines = -np.einsum("ij,ij->i", beams, surface.normals_reference[seen])
        facing = np.flatnonzero(cosines >= math.cos(math.radians(GRAZING_DEG)))
        frame, seen, pixels, cosines = frame[facing], seen[facing], pixels[facing], cosines[facing]
        return frame, seen, pixels, cosines, self._rays.blocks(self._starts[seen], beams[facing], lengths[facing])

    def _lit(self, image: Bytes, spacing: tuple[float, float], pixels: Floats) -> Mask:
        """Whether the scan line through each point is lit somewhere from `BEFORE` mm before it on, (m,) bool."""
        x, y = spacing
        wide, high = max(round(LOOK_STEP / x), 1), max(round(LOOK_STEP / y), 1)
        level = block_sums(image, (high, wide), np.float32) / np.float32(wide * high)
        in_region = self._mask[high // 2 :: high, wide // 2 :: wide][: level.shape[0], : level.shape[1]]
        level = np.where(in_region, level, np.float32(0))
        if self.beams.probe.kind == LINEAR:
            way = np.tile([0.0, 1.0 / y], (len(pixels), 1))
        else:
            way = (pixels - self.beams.probe.apex) * spacing
            way /= np.maximum(np.hypot(*way.T), 1e-9)[:, None] * spacing
        places = pixels[:, None] + np.arange(-BEFORE, BEHIND, LOOK_STEP)[:, None] * way[:, None]
        # A rim of darkness stands for what lies outside of the image
        dark = np.pad(level, 1)
        column, row = (((places[..., n] + 0.5) / cell + 1.0).astype(np.int64) for n, cell in enumerate((wide, high)))
        lit = dark.take(row.clip(0, dark.shape[0] - 1) * dark.shape[1] + column.clip(0, dark.shape[1] - 1)) >= LIT
        return np.asarray(lit.any(axis=1))


class CoverageAccumulator:
    """What was met of each point until now.

    Attributes
    ----------
    best_cosine : (n,) float64 array
        Of the smallest angle of incidence so far; NaN where no frame has met the point.
    support : (n,) float64 array
        Sum over the frames that met the point; see `support_of`.
    frames, shadowed, dark : (n,) int32 arrays
        Frames that met the point; in whose beams it lay behind other bone; whose images were dark there.
    """

    def __init__(self, geometry: FrameGeometry):
        self.geometry = geometry
        count = len(geometry.bone)
        self.best_cosine = np.full(count, np.nan)
        self.support = np.zeros(count)
        self.frames, self.shadowed, self.dark = (np.zeros(count, dtype=np.int32) for _ in range(3))

    @property
    def bone(self) -> GuidedBone:
        """The bone."""
        return self.geometry.bone

    @property
    def expected(self) -> Floats:
        """The chance that `weighted` shows each point, (n,), 0 to 1."""
        return expected_visibility(self.support)

    def only(self, points: Integers) -> CoverageAccumulator:
        """What was met of some of the points, by their numbers."""
        beams = self.geometry.beams
        some = CoverageAccumulator(FrameGeometry(self.bone.only(points), beams.frame_size, beams.probe, beams.region, beams.thickness))
        for name in ("best_cosine", "support", "frames", "shadowed", "dark"):
            setattr(some, name, getattr(self, name)[points])
        return some

    def insert(self, image_to_reference: Matrix, image: Bytes | None = None) -> None:
        """Add a frame; the arguments are those of `FrameGeometry.view`."""
        seen, cosines, status = self.geometry.view(image_to_reference, image)
        met = status == MET
        points = seen[met]
        self.best_cosine[points] = np.fmax(self.best_cosine[points], cosines[met])
        self.support[points] += support_of(cosines[met])
        self.frames[points] += 1
        self.shadowed[seen[status == SHADOWED]] += 1
        self.dark[seen[status == DARK]] += 1

"""How clearly, sharply and completely a volume shows bone, measured along the normals of the true surface.

Every number comes from the volume and the true surface alone; none uses a bone probability, a weight or another formula of the
reconstruction. A profile runs along the outward normal of each surface point: s < 0 inside bone, s > 0 in the tissue before it.

References
----------
.. [1] Smith, Wagner, Sandrik and Lopez (1983), Low contrast detectability and contrast/detail analysis in medical ultrasound, IEEE
   Trans. Sonics Ultrason. 30:164-173, doi:10.1109/T-SU.1983.31405 (contrast to noise).
.. [2] Hanley and McNeil (1982), The meaning and use of the area under a ROC curve, Radiology 143:29-36,
   doi:10.1148/radiology.143.1.7063747 (the probability of ranking one class above the other).
.. [3] Leotta and Martin (1999), Three-dimensional spatial compounding of ultrasound scans with incidence angle weighting, IEEE
   Ultrasonics Symposium (full width at half maximum of bone borders).
.. [4] Xu et al. (2022), AutoInFocus, a new paradigm for ultrasound-guided spine intervention, Int J CARS,
   doi:10.1007/s11548-022-02583-6 (surface coverage and interspinous visibility).
.. [5] Burckhardt (1978), Speckle in ultrasound B-mode scans, IEEE Trans. Sonics Ultrason. 25:1-6, doi:10.1109/T-SU.1978.30978.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Numbers, Singles
from ..errors import GeometryError, require_kind
from ..geometry.box import block_sums
from ..geometry.transforms import transform_points
from ..geometry.volume import Volume, nearest
from ..registration.comparison import compared, warn_of_disagreement
from ..sweep.frames import TrackedSequence
from .quantities import NEAR, SHADOW_FROM_SURFACE, SPECKLE_BLOCK, SPECKLE_FROM_BONE, STANDS_OUT, TISSUE, BoneMetrics, SurfaceMetrics
from .surface import exceeds, mean_std, median, ratio
from .visibility import REACHED, SHADOWED, BoneTruth, SweepBeams, bone_truth

STEP = 0.25
"""mm between samples of a profile."""

OFFSETS = STEP * np.arange(-24, 33)
"""Of the samples: -6 to 8 mm."""

TISSUE_FROM_BONE = 2.0
"""mm that this tissue keeps from every bone."""

WINDOW_STARTS = (3.0, 4.0, 5.0)
"""mm before the surface, of windows in that tissue as wide as the one about the surface."""

OBLIQUE_DEG = 45.0
"""A surface is oblique when its best angle of incidence is beyond this."""

SPECKLE_FROM_EDGE = 10.0
"""mm that the cubes in which speckle is measured keep from the edge of what was measured (the skin)."""


def evaluate(
    volume: Volume,
    bone: Volume | BoneTruth,
    mask: Volume | None = None,
    *,
    sweep: TrackedSequence | Iterable[TrackedSequence] | SweepBeams | None = None,
) -> BoneMetrics:
    """Measure a volume against the true bone.

    Parameters
    ----------
    volume : Volume of gray levels, placed in Reference
    bone : Volume of labels, or BoneTruth
        The true bone, placed in Reference (`Volume.placed_by`): any label above 0, one for each vertebra. To measure several volumes, make
        the truth once, by `bone_truth`.
    mask : Volume or None
        Not 0 where voxels were measured or filled, on the same voxels. Without one, voxels of exactly 0 count as empty.
    sweep : TrackedSequence, several, or None
        Decides which bone counts: what its beams could reach. A `DisagreementWarning` tells where its bone lies elsewhere. Without one, or
        with a truth, which has its own, all that was measured.

    Raises
    ------
    GeometryError
        When the mask has other voxels than the volume, or the labels hold no bone.
    InputTypeError
        When something of another kind is given, such as the path of a file.
    """
    require_kind("volume", volume, Volume, "Read it first: read_volume(path).")
    require_kind("bone", bone, (Volume, BoneTruth), "Read it first: read_labels(path).")
    require_kind("mask", mask, (Volume, type(None)), "Read it first: read_volume(path).")
    truth = bone
    if isinstance(truth, Volume):
        beams = sweep if sweep is None or isinstance(sweep, SweepBeams) else SweepBeams.of_sequence(sweep)
        if sweep is not None and not isinstance(sweep, SweepBeams):
            warn_of_disagreement(compared(sweep, truth, np.eye(4)))
        truth = bone_truth(truth, beams)
    if mask is not None and not mask.grid.matches(volume.grid):
        raise GeometryError("Input mask must have the voxels of the volume; got others. Give the mask of this reconstruction.")
    gray, measured = _grays(volume, mask)
    chosen = _chosen(volume, truth)
    responses = _responses(gray, measured, volume, truth, chosen)
    if truth.best_cosine is None:
        everywhere = np.isfinite(responses.bone)
        oblique = np.zeros(len(chosen), dtype=bool)
    else:
        everywhere = np.ones(len(chosen), dtype=bool)
        oblique = truth.best_cosine[chosen] < np.cos(np.radians(OBLIQUE_DEG))
    shadow_mean, shadow_std = _shadow(gray, measured, volume, truth)
    lines_area, lines_called_free = (np.nan, np.nan) if truth.lines is None else truth.lines.told_by(-truth.lines.brightest(volume))
    return BoneMetrics(
        bone=responses.summary(everywhere),
        oblique=responses.summary(oblique),
        interspinous=responses.summary(everywhere & truth.border[chosen]),
        shadow_mean=shadow_mean,
        shadow_std=shadow_std,
        speckle_snr=_speckle_snr(gray, measured, volume, truth),
        lines_area=lines_area,
        lines_called_free=lines_called_free,
    )


def _grays(volume: Volume, mask: Volume | None) -> tuple[Singles, Mask]:
    gray = volume.array.astype(np.float32)
    measured: Mask = np.isfinite(gray) & ((gray if mask is None else mask.array) != 0)
    return np.where(measured, gray, np.float32(0)), measured


def _chosen(volume: Volume, truth: BoneTruth) -> Integers:
    ijk = transform_points(volume.grid.reference_to_ijk, truth.surface.points_reference)
    inside = np.all((ijk >= -0.5) & (ijk <= np.array(volume.grid.size) - 0.5), axis=1)
    return np.flatnonzero(inside if truth.best_cosine is None else inside & np.isfinite(truth.best_cosine))


@dataclass(frozen=True, eq=False)
class _Responses:
    """Of every chosen point of the surface: area (mm^2), response of bone (n,), gray levels of the tissue before it (n, samples) and
    their maxima in windows (n, 3), whether covered, place of the peak and width (mm; NaN where not covered)."""

    areas: Floats
    bone: Floats
    tissue: Floats
    windows: Floats
    covered: Mask
    peaks: Floats
    widths: Floats

    def summary(self, part: Mask) -> SurfaceMetrics:
        areas, bone, tissue, covered = self.areas[part], self.bone[part], self.tissue[part], self.covered[part]
        tissue_mean, tissue_std = mean_std(tissue, areas[:, None])
        contrast = mean_std(bone, areas)[0] - tissue_mean
        peaks = self.peaks[part]
        return SurfaceMetrics(
            area=float(areas.sum()),
            contrast=contrast,
            cnr=ratio(contrast, tissue_std),
            detectability=mean_std(exceeds(bone[:, None], self.windows[part]), areas[:, None])[0],
            thickness=median(self.widths[part], areas),
            localization_bias=mean_std(peaks, areas)[0],
            localization_error=mean_std(np.abs(peaks), areas)[0],
            coverage=ratio(float(areas[covered].sum()), float(areas.sum())),
        )


def _responses(gray: Singles, measured: Mask, volume: Volume, truth: BoneTruth, chosen: Integers) -> _Responses:
    surface = truth.surface
    normals = surface.normals_reference[chosen]
    points = surface.points_reference[chosen, None] + OFFSETS[:, None] * normals[:, None]
    profiles = _profiles(gray, measured, volume, points)
    tissue = _tissue(profiles, points, truth)
    response, _ = _highest(profiles, -NEAR, NEAR)
    beyond, _ = _highest(profiles, -NEAR - 2 * STEP, NEAR + 2 * STEP)
    windows = np.stack([_highest(tissue, start, start + 2 * NEAR, TISSUE[0])[0] for start in WINDOW_STARTS], axis=1)

    known = np.isfinite(tissue)
    samples = known.sum(axis=1)
    enough = 3 * samples >= tissue.shape[1]
    means = np.where(known, tissue, 0.0).sum(axis=1) / np.maximum(samples, 1)
    residuals = (tissue - means[:, None])[known & enough[:, None]]
    spread = float(residuals.std()) if residuals.size else np.nan
    # A point with bone or shadow before it is held against the tissue before the others
    local = np.where(enough, means, mean_std(means[enough], surface.areas[chosen][enough])[0])
    with np.errstate(invalid="ignore"):
        # Strictly above, by more than rounding: a volume of one gray level shows nothing
        covered = (response >= beyond) & (response - local > STANDS_OUT * spread + 1e-3 * np.abs(local))
    peaks, widths = _peaks_and_widths(profiles, local, covered)
    return _Responses(surface.areas[chosen], response, tissue, windows, covered, peaks, widths)


def _profiles(gray: Singles, measured: Mask, volume: Volume, points: Floats) -> Floats:
    """Linear values of the measured voxels at points (..., 3) in Reference; NaN where they hold less than half of the weight."""
    coordinates = transform_points(volume.grid.reference_to_ijk, points).reshape(-1, 3).T[::-1]
    weights = scipy.ndimage.map_coordinates(measured.astype(np.float32), coordinates, order=1, output=np.float32)
    values = scipy.ndimage.map_coordinates(gray, coordinates, order=1, output=np.float32)
    known = weights >= 0.5
    return np.where(known, values / np.where(known, weights, 1.0), np.nan).reshape(points.shape[:-1]).astype(np.float64)


def _tissue(profiles: Floats, points: Floats, truth: BoneTruth) -> Floats:
    """The part of the profiles from 3 to 8 mm; NaN where there is other bone, or no beam."""
    part = _columns(*TISSUE)
    places = points[:, part].reshape(-1, 3)
    is_tissue = _distances(truth, places) >= TISSUE_FROM_BONE
    if truth.shadows is not None:
        is_tissue &= _statuses(truth.shadows, places) == REACHED
    return np.where(is_tissue.reshape(profiles[:, part].shape), profiles[:, part], np.nan)


def _columns(first: float, last: float, profiles_start: float = OFFSETS[0]) -> slice:
    """The columns of profiles from `first` to `last`, both included, mm."""
    return slice(round((first - profiles_start) / STEP), round((last - profiles_start) / STEP) + 1)


def _highest(profiles: Floats, first: float, last: float, profiles_start: float = OFFSETS[0]) -> tuple[Floats, Integers]:
    """The greatest value of each profile from `first` to `last` (mm), and its column; NaN unless half of the samples are known."""
    part = _columns(first, last, profiles_start)
    window = profiles[:, part]
    known = np.isfinite(window)
    filled = np.where(known, window, -np.inf)
    place = filled.argmax(axis=1)
    highest = filled[np.arange(len(window)), place]
    return np.where(2 * known.sum(axis=1) >= window.shape[1], highest, np.nan), place + part.start


def _peaks_and_widths(profiles: Floats, local: Floats, covered: Mask) -> tuple[Floats, Floats]:
    """Where the peaks of covered points lie (mm before the surface), and their full widths at half maximum (mm).

    Notes
    -----
    The place is the vertex of the parabola through the highest sample and its neighbors. Half maximum is half-way between the highest
    sample and the local tissue; the profile's first crossings to either side, by linear interpolation, bound the width. NaN where
    the profile ends or is not known before it crosses.
    """
    peaks, widths = np.full(len(profiles), np.nan), np.full(len(profiles), np.nan)
    rows = np.flatnonzero(covered)
    if not rows.size:
        return peaks, widths
    chosen = profiles[rows]
    height, column = _highest(chosen, -NEAR, NEAR)
    number = np.arange(len(rows))
    left, right = chosen[number, column - 1], chosen[number, column + 1]
    bend = left - 2 * height + right
    straight = ~(bend < 0)
    shift = np.where(straight, 0.0, 0.5 * (left - right) / np.where(straight, 1.0, bend))
    peaks[rows] = OFFSETS[column] + STEP * np.clip(shift, -0.5, 0.5)
    level = (height + local[rows]) / 2
    width = np.zeros(len(rows))
    for direction in (-1, 1):
        # Samples outward from the peak; the profile's end is not known
        reach = column[:, None] + direction * np.arange(len(OFFSETS))
        outward = np.where((reach >= 0) & (reach < len(OFFSETS)), chosen[number[:, None], np.clip(reach, 0, len(OFFSETS) - 1)], np.nan)
        stops = ~(outward > level[:, None])
        first = np.maximum(stops.argmax(axis=1), 1)
        above, below = outward[number, first - 1], outward[number, first]
        width += STEP * (first - 1 + (above - level) / np.where(above > below, above - below, np.nan))
    widths[rows] = width
    return peaks, widths


def _shadow(gray: Singles, measured: Mask, volume: Volume, truth: BoneTruth) -> tuple[float, float]:
    """Mean and standard deviation of gray levels in the shadow of bone."""
    if truth.shadows is None:
        deep = np.argwhere(truth.distance.array <= -SHADOW_FROM_SURFACE)[:, ::-1]
        points = transform_points(truth.distance.ijk_to_reference, deep)
    else:
        # Beams are wider than the geometry says: keep one voxel of the map away from what they reach
        surrounded = scipy.ndimage.binary_erosion(truth.shadows.array == SHADOWED, border_value=1)
        points = transform_points(truth.shadows.ijk_to_reference, np.argwhere(surrounded)[:, ::-1])
        points = points[np.abs(_distances(truth, points)) >= SHADOW_FROM_SURFACE]
    ijk = transform_points(volume.grid.reference_to_ijk, points)
    known = nearest(Volume(measured, volume.ijk_to_reference), ijk).astype(bool)
    values = np.asarray(nearest(Volume(gray, volume.ijk_to_reference), ijk[known]), dtype=gray.dtype)
    return mean_std(values)


def _speckle_snr(gray: Singles, measured: Mask, volume: Volume, truth: BoneTruth) -> float:
    """Median of mean over standard deviation in cubes of soft tissue."""
    side = np.maximum(np.round(SPECKLE_BLOCK / volume.grid.spacing[::-1]), 2).astype(int)
    if (np.array(gray.shape) < side).any():
        return np.nan
    count = block_sums(measured, side, np.float64)
    filled = count >= 0.5 * side.prod()
    padded = scipy.ndimage.distance_transform_edt(np.pad(filled, 1), sampling=side * volume.grid.spacing[::-1])
    from_edge = np.asarray(padded, dtype=np.float64)[1:-1, 1:-1, 1:-1]
    used = np.argwhere(from_edge >= SPECKLE_FROM_EDGE)
    # Bone and shadow are looked for at the corners and the middle of each cube
    corners = np.array([(k, j, i) for k in (0, 1) for j in (0, 1) for i in (0, 1)] + [(0.5, 0.5, 0.5)])
    kji = (used[:, None] + corners) * side - 0.5
    points = transform_points(volume.ijk_to_reference, kji[..., ::-1].reshape(-1, 3))
    is_tissue = _distances(truth, points) >= SPECKLE_FROM_BONE
    if truth.shadows is not None:
        is_tissue &= _statuses(truth.shadows, points, outside=REACHED) == REACHED
    cubes = tuple(used[is_tissue.reshape(-1, len(corners)).all(axis=1)].T)
    mean = block_sums(gray, side, np.float64)[cubes] / count[cubes]
    variance = np.maximum(block_sums(np.square(gray, dtype=np.float64), side, np.float64)[cubes] / count[cubes] - mean**2, 0.0)
    speckled = variance > 1e-9 * mean**2
    return float(np.median(mean[speckled] / np.sqrt(variance[speckled]))) if speckled.any() else np.nan


def _distances(truth: BoneTruth, points: Floats) -> Numbers:
    """Signed distance to bone at points (n, 3) in Reference, mm; beyond the volume no bone is near."""
    return nearest(truth.distance, transform_points(truth.distance.grid.reference_to_ijk, points), outside=np.inf)


def _statuses(shadows: Volume, points: Floats, outside: int = 0) -> Numbers:
    return nearest(shadows, transform_points(shadows.grid.reference_to_ijk, points), outside)

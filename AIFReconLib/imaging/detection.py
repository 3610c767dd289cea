"""Recognizing the probe from its images: ultrasound stands on a black surround as a rectangle (linear) or a sector.

Where buttons and text stand around it, it is told from them by what changes between frames. Used where neither options nor a configuration
say what the image shows. It refuses rather than guesses.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import chain, combinations

import numpy as np

from ..arrays import Mask, Numbers
from ..errors import BeamGeometryError
from ..remedies import NAME_THE_PROBE
from .beams import LINEAR, SECTOR, ProbeGeometry
from .change import extremes, is_sharp, standing_out
from .images import ImageStack
from .masks import closed, large_areas, largest_area, opened
from .outline import BORDER_PX, MOST_LOPSIDED_DEG, STEP_PX, SectorFit, fit_sector, has_ragged_narrow_side
from .rectangle import (
    SMOOTH_ON_BLACK,
    Box,
    fit_rectangle,
    has_bent_ends,
    has_level_end,
    is_cut_off,
    overlap,
    without_trace,
)
from .region import ClipRectangle, Fan, ImageRegion

LIT = 0.01
"""A pixel is lit when it exceeds this part of the brightest pixel in any of the frames looked at."""

CLOSED_PX, OPENED_PX = 4, 2
"""Steps by which gaps between lit pixels are closed, and thin lines dropped."""

LEVELS, ARC_LEVEL = (0.024, 0.05, 0.1, 0.2, 0.28, 0.4), 0.2
"""Parts of the brightest pixel by which one must change: noise and video change too; at the last, ends are once more looked at for arcs."""

JOINED_PX, RINGING_PART = 7, 0.01
"""Steps over which changing parts belong together; part of the largest one that others have at least, where they count too."""

SMALLEST_PART, SAME = 0.02, 0.9
"""Part of an image that must change, and overlap of boxes that are one."""

SURE_ENOUGH, LARGEST_DOUBT, LARGEST_DOUBT_PX = 0.35, 0.6, 0.8
"""mm of `_doubt` about two levels below which no others are tried, and beyond which, and this many pixels, the probe is not told."""

LARGEST_CHANGE, WRONG = 0.2, 0.5
"""mm by which an apex may differ and still be the same, and by which it is another."""

BY_CHANGE = ", by what changes between frames"

NARROWEST = 0.45
"""Width of a linear image by its depth: what is narrower may be the middle of a sector whose sides were covered, straight to a pixel."""

MOST_STILL = 0.02
"""Part of what was found that may stand still, and of what changes that may lie elsewhere, before other evidence is asked."""


class _SidesCutOff(BeamGeometryError):
    """What stands on black has upright sides and is no linear image."""


@dataclass(frozen=True)
class DetectedImaging:
    """What was recognized: probe, the pixels that are ultrasound, and the finding in words."""

    probe: ProbeGeometry
    region: ImageRegion
    description: str


def detect_imaging(images: ImageStack, spacing: tuple[float, float] = (1.0, 1.0)) -> DetectedImaging:
    """Recognize a linear or sector image by its black surround, or by what changes between frames where other things stand around it.

    `images` are (frames, rows, columns), `spacing` is (x, y) in mm: a sector is round in mm.

    Raises BeamGeometryError when the outline is neither a rectangle nor a sector.
    """
    if len(images) == 0:
        raise _unrecognized("there are none")
    darkest, brightest = extremes(images)
    change = np.subtract(brightest, darkest)
    try:
        found = _by_black_surround(brightest, spacing)
    except BeamGeometryError as error:
        changing = _by_what_changes(change, brightest, spacing, isinstance(error, _SidesCutOff))
        if changing is None:
            raise
        return changing
    if not _is_doubtful(found, change, brightest):
        return found
    changing = _by_what_changes(change, brightest, spacing)
    if changing is not None and _differ(found, changing, change.shape, spacing):
        return changing
    if changing is None and _stands_still(found, change, brightest):
        raise _unrecognized("what stands on black does not change from frame to frame")
    fan = found.region.fan
    if changing is None and fan is not None and _is_lopsided(fan):
        changed = _changed_area(change, LEVELS[1] * float(brightest.max()))
        # The straight edge of a shadow looks like a side
        if has_ragged_narrow_side(changed, fan) or fit_sector(largest_area(changed), spacing) is not None:
            raise _unrecognized("one of its sides is dark, and where it ends is not seen")
    return found


def _changed_and_kept(found: DetectedImaging, change: Numbers, brightest: Numbers) -> tuple[Mask, Mask]:
    return change > LIT * brightest.max(), found.region.mask(change.shape[1], change.shape[0])


def _is_doubtful(found: DetectedImaging, change: Numbers, brightest: Numbers) -> bool:
    """Whether what stands on black holds much that stands still or is black, leaves out much that changes, or leans to one side."""
    changed, kept = _changed_and_kept(found, change, brightest)
    if found.region.fan is not None and _is_lopsided(found.region.fan):
        return True
    return bool((kept & ~changed).sum() > MOST_STILL * kept.sum() or (changed & ~kept).sum() > MOST_STILL * changed.sum())


def _is_lopsided(fan: Fan) -> bool:
    return abs(sum(fan.angles_deg)) > MOST_LOPSIDED_DEG


def _changed_area(change: Numbers, level: float) -> Mask:
    return opened(closed(change > level, CLOSED_PX), OPENED_PX)


def _stands_still(found: DetectedImaging, change: Numbers, brightest: Numbers) -> bool:
    """Whether most of what changes lies elsewhere, or most of what was found does not: then a panel or a picture is, or is in it."""
    changed, kept = _changed_and_kept(found, change, brightest)
    return bool(2 * (changed & kept).sum() < max(changed.sum(), kept.sum() * changed.any()))


def _differ(one: DetectedImaging, other: DetectedImaging, shape: tuple[int, ...], spacing: tuple[float, float]) -> bool:
    """Whether two findings differ by more than what does not matter."""
    if one.probe.kind != other.probe.kind:
        return True
    kept, others = (each.region.mask(shape[1], shape[0]) for each in (one, other))
    if (kept ^ others).sum() > 2 * MOST_STILL * others.sum():
        return True
    return one.probe.kind == SECTOR and bool(np.hypot(*(np.subtract(one.probe.apex, other.probe.apex) * spacing)) > LARGEST_CHANGE)


def _by_black_surround(brightest: Numbers, spacing: tuple[float, float]) -> DetectedImaging:
    """What stands on black, where nothing else does."""
    lit = _lit_area(brightest)
    box = fit_rectangle(lit, on_black=True)
    if box is not None:
        if has_bent_ends(lit, (*box[:2], 0, len(lit)), SMOOTH_ON_BLACK, only_down=False):
            raise _SidesCutOff(
                "The probe cannot be told from the images: its sides are upright and its upper or lower edge is bent, as of a sector whose "
                "sides were cut off.",
                NAME_THE_PROBE,
            )
        return _upright(box, brightest)
    found = fit_sector(lit, spacing, may_lean=True)
    if found is not None:
        return _as_imaging(found, found, lit.shape, spacing, "")
    if lit[:, :BORDER_PX].any() and lit[:, -BORDER_PX:].any():
        raise _unrecognized("they are lit from side to side, with no black surround that would show an outline")
    raise _unrecognized("its outline is neither a rectangle nor a sector")


def _lit_area(brightest: Numbers) -> Mask:
    """The largest connected area that is lit in any of the frames looked at, without its holes, (rows, columns) bool."""
    if not brightest.size or brightest.max() <= 0:
        raise _unrecognized("all images are black")
    # An opening drops rulers, text and borders that touch the sector by a thin line
    lit = opened(closed(brightest > LIT * brightest.max(), CLOSED_PX), OPENED_PX)
    if not lit.any():
        raise _unrecognized("no connected bright area was found")
    return largest_area(lit)


def _by_what_changes(
    change: Numbers, brightest: Numbers, spacing: tuple[float, float], sides_cut_off: bool = False
) -> DetectedImaging | None:
    """The probe by what differs between frames, as buttons, text and rulers do not; None where that does not tell it surely.

    `change` is the greatest less the least of each pixel; `sides_cut_off`: its outline may be that of a sector without its
    sides. How much of it is noise is not known, and so several levels are tried.
    """
    fits: list[SectorFit] = []
    boxes: list[Box] = []
    pair: tuple[SectorFit, SectorFit] | None = None
    evidence: list[Numbers] = []
    levels = iter(np.multiply(LEVELS, brightest.max(initial=0)))
    for level in levels:
        area = _changed_area(change, level)
        if area.sum() < SMALLEST_PART * area.size:
            break
        shown, more = _largest(area), _with_ringing(area)
        box, wider = fit_rectangle(shown), fit_rectangle(more, has_level_face=True)
        if wider is not None and (box is None or wider[1] - wider[0] > box[1] - box[0] + STEP_PX):
            box, shown = wider, more
        if box is not None:
            narrow = (box[1] - box[0]) * spacing[0] < NARROWEST * (box[3] - box[2]) * spacing[1]
            if narrow or has_bent_ends(shown, box):
                return None
            must_be_level = sides_cut_off or is_cut_off(shown)
            if must_be_level and not has_level_end(more):
                continue
            if boxes and overlap(box, boxes[-1]) > SAME:
                higher = _changed_area(change, ARC_LEVEL * brightest.max())
                part = _largest(higher) if higher.any() and not must_be_level else None
                bent = part is not None and has_bent_ends(part, fit_rectangle(part) or box)
                return None if bent else _upright(box, change, BY_CHANGE)
            boxes.append(box)
            continue
        evidence = evidence or standing_out(change, brightest)
        fits += _sector_at(level, evidence, spacing)
        pair = min(combinations(fits, 2), key=lambda two: _doubt(two[0], two[1], spacing), default=None)
        if pair is not None and _doubt(*pair, spacing) < SURE_ENOUGH:
            break
    if pair is None or _doubt(*pair, spacing) > max(LARGEST_DOUBT, LARGEST_DOUBT_PX * max(spacing)):
        return None
    # Noise of compressed video may move two levels alike; one that it does not reach is surer
    best = min(pair, key=lambda fit: fit.apex_error)
    for fit in chain(fits, *(_sector_at(level, evidence, spacing) for level in levels)):
        if fit.apex_error < best.apex_error and _apart(fit, best, spacing) > WRONG:
            return None
    return _as_imaging(*pair, change.shape, spacing)


def _largest(area: Mask) -> Mask:
    return without_trace(area & largest_area(closed(area, JOINED_PX)))


def _with_ringing(area: Mask) -> Mask:
    """Without specks; ringing at the probe's face may stand apart from the rest."""
    return without_trace(area & large_areas(closed(area, JOINED_PX), RINGING_PART))


def _sector_at(level: float, evidence: list[Numbers], spacing: tuple[float, float]) -> list[SectorFit]:
    """The sector by the first evidence that shows one at this level, if any."""
    sectors = (_surest_sector(_changed_area(out, level), spacing) for out in evidence)
    return next(([sector] for sector in sectors if sector), [])


def _surest_sector(area: Mask, spacing: tuple[float, float]) -> SectorFit | None:
    """The sector of an area, or of its largest part alone; None where it is none."""
    if area.sum() < SMALLEST_PART * area.size:
        return None
    largest, more = _largest(area), _with_ringing(area)
    both = [fit_sector(largest, spacing), fit_sector(more, spacing) if more.sum() > largest.sum() else None]
    # What stands apart and is no ringing does not end as a sector does
    return min((fit for n, fit in enumerate(both) if fit and (n == 0 or fit.far_end_seen)), key=lambda fit: fit.apex_error, default=None)


def _apart(one: SectorFit, other: SectorFit, spacing: tuple[float, float]) -> float:
    """How far two apexes are apart, mm."""
    return float(np.hypot(*(np.subtract(one.apex_px, other.apex_px) * spacing)))


def _doubt(one: SectorFit, other: SectorFit, spacing: tuple[float, float]) -> float:
    """How far the apexes of two levels are apart and may be off, mm; and the far ends, where apexes rest on them.

    What noise or compression does to an outline depends on the level; what the probe does, does not.
    """
    apart = _apart(one, other, spacing)
    if (one.dark_side or other.dark_side) and one.far_end_seen and other.far_end_seen:
        apart = max(apart, abs(one.radii[1] - other.radii[1]))
    return math.hypot(apart, one.apex_error, other.apex_error)


def _upright(box: Box, values: Numbers, how: str = "") -> DetectedImaging:
    """A linear image without the noise of compressed video around its `values`."""
    left, right, top, bottom = box
    shown = values[top : bottom + 1, left : right + 1]
    columns, rows = (np.flatnonzero(is_sharp(shown.mean(axis=axis))) for axis in (0, 1))
    left, right, top, bottom = left + int(columns[0]), left + int(columns[-1]), top + int(rows[0]), top + int(rows[-1])
    clip = ClipRectangle((float(left), float(top)), (float(right - left), float(bottom - top)))
    words = f"a linear probe, columns {left} to {right}, rows {top} to {bottom}{how}"
    return DetectedImaging(ProbeGeometry(LINEAR), ImageRegion(clip), words)


def _as_imaging(
    one: SectorFit, other: SectorFit, shape: tuple[int, ...], spacing: tuple[float, float], how: str = BY_CHANGE
) -> DetectedImaging:
    fit = min(one, other, key=lambda fit: fit.apex_error)
    clip = None
    if fit.flat_top is not None:
        clip = ClipRectangle((0.0, math.ceil(fit.flat_top)), (float(shape[1] - 1), float(shape[0] - 1 - math.ceil(fit.flat_top))))
    # At a higher level less of the far field changes
    fan = Fan(fit.apex_px, fit.angles_deg, (min(one.radii[0], other.radii[0]), max(one.radii[1], other.radii[1])), spacing)
    dark = "" if fit.dark_side is None else f"; its {fit.dark_side} side is dark and taken to be as wide as the other"
    words = (
        f"a sector probe, apex at column {fit.apex_px[0]:.1f}, row {fit.apex_px[1]:.1f}, "
        f"{fit.angles_deg[0]:.1f} to {fit.angles_deg[1]:.1f} degrees{how}{dark}"
    )
    return DetectedImaging(ProbeGeometry(SECTOR, fit.apex_px), ImageRegion(clip, fan), words)


def _unrecognized(why: str) -> BeamGeometryError:
    return BeamGeometryError(f"The probe cannot be told from the images: {why}.", NAME_THE_PROBE)

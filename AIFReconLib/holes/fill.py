"""Holes are filled as the settings ask for, else as a configuration does."""

from __future__ import annotations

from ..arrays import Bytes, Floats, Numbers
from ..progress import Progress
from ..recipe.recipe import AUTOMATIC, Recipe
from .filling import GAUSSIAN_BY_HITS, HoleFilling, within
from .igsio_hole_filling import fill_holes_by_kind
from .nearest import fill_holes


def fill_as_asked(
    values: Numbers,
    mask: Bytes,
    spacing: Floats,
    settings: Recipe,
    configured: tuple[HoleFilling, ...] = (),
    progress: Progress | None = None,
    *,
    threads: int | None = None,
    score: Numbers | None = None,
) -> int:
    """Fill holes in place as the settings ask for, else in the `configured` ways; returns how many were filled.

    Eight parameters: volumes in memory, how to fill them, and what the machine may take.
    Of the settings `holes`, `hole_limit` (a number: see `with_limit`) and `engine` count. Spacing is in mm along i, j, k; for `values`,
    `mask` and `score` see `fill_holes_by_kind`.
    """
    if settings.holes == "off":
        return 0
    if settings.holes is None and settings.hole_limit == 0:
        return fill_holes_by_kind(values, mask, configured, progress, engine=settings.engine, threads=threads, score=score)
    limit = float(settings.hole_limit)
    if settings.holes in (None, "nearest"):
        return fill_holes(values, mask, spacing, limit, progress, engine=settings.engine, threads=threads)
    return fill_holes_by_kind(values, mask, (within(settings.holes, limit, spacing),), progress, engine=settings.engine, threads=threads)


def as_configured(settings: Recipe, configured: tuple[HoleFilling, ...]) -> bool:
    """Whether holes are filled in the configuration's ways."""
    return settings.holes is None and bool(configured) and settings.hole_limit in (AUTOMATIC, 0)


def copies_values(settings: Recipe, configured: tuple[HoleFilling, ...]) -> bool:
    """Whether what fills a hole is a measured value as it is, so that it does not matter what values are rounded to before."""
    return settings.holes in (None, "off", "nearest") and not as_configured(settings, configured)


def asks_for_hits(settings: Recipe, configured: tuple[HoleFilling, ...]) -> bool:
    """Whether it matters to filling how many pixels entered a voxel."""
    return as_configured(settings, configured) and any(way.kind == GAUSSIAN_BY_HITS for way in configured)

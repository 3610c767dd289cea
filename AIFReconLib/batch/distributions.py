"""How a number is distributed over the cases, method by method: a small drawing for a page, in SVG."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from html import escape

WIDTH, ROW, TOP, BOTTOM = 320.0, 52.0, 0.0, 20.0
RADIUS = 2.6
SIDE = 3.0
"""Left and right of the outermost dots, in the units of the drawing."""

BINS = 48
MOST_DOTS = 200
"""Cases up to which each is a dot; of more, bars show how many there are."""


def strip_plot(values: dict[str, list[float]], form: str) -> str:
    """The distribution of one number, a row per method: all cases, the quartiles as a line and the median as a tick with its number.

    Parameters
    ----------
    values : dict of str to list of float
        Of every case, by method; finite, and not all empty.
    form : str
        How numbers are written, as Python's `format` takes it.
    """
    known = {method: sorted(each) for method, each in values.items() if each}
    low, high = min(each[0] for each in known.values()), max(each[-1] for each in known.values())
    if low == high:
        low, high = low - (abs(low) * 0.05 or 1.0), high + (abs(high) * 0.05 or 1.0)
    height = TOP + ROW * len(known) + BOTTOM

    def x(value: float) -> float:
        return SIDE + (WIDTH - 2 * SIDE) * (value - low) / (high - low)

    said = "; ".join(f"{method}: median {statistics.median(each):{form}} of {len(each)}" for method, each in known.items())
    parts = [f'<svg viewBox="0 0 {WIDTH:g} {height:g}" role="img" aria-label="{escape(said)}">']
    for number, (method, each) in enumerate(known.items()):
        base = TOP + ROW * number + ROW - 10
        parts.append(f'<text x="0" y="{base - 27:g}" class="name">{escape(method)}</text>')
        parts.append(_dots(each, x, base) if len(each) <= MOST_DOTS else _bars(each, x, base))
        first, median, third = statistics.quantiles(each, n=4, method="inclusive") if len(each) > 1 else each * 3
        parts.append(f'<path class="spread" d="M{x(first):.1f} {base + 5:.1f}H{x(third):.1f}"/>')
        parts.append(f'<path class="median" d="M{x(median):.1f} {base + 1:.1f}v8"/>')
        parts.append(f'<text x="{WIDTH:g}" y="{base - 27:g}" class="number">{median:{form}}</text>')
    axis = height - BOTTOM + 14
    parts.append(f'<text x="0" y="{axis:g}" class="axis">{low:{form}}</text>')
    parts.append(f'<text x="{WIDTH:g}" y="{axis:g}" class="axis end">{high:{form}}</text></svg>')
    return "".join(parts)


def _binned(each: list[float], x: Callable[[float], float]) -> dict[int, int]:
    """How many values lie in each of the bins along the drawing."""
    counts: dict[int, int] = {}
    for value in each:
        number = math.floor(BINS * x(value) / WIDTH)
        counts[number] = counts.get(number, 0) + 1
    return counts


def _dots(each: list[float], x: Callable[[float], float], base: float) -> str:
    """A dot per case, upon each other where they are alike."""
    stacked: dict[int, int] = {}
    tallest = max(_binned(each, x).values())
    step = min(2 * RADIUS, 20.0 / tallest)
    dots = []
    for value in each:
        at = x(value)
        number = math.floor(BINS * at / WIDTH)
        level = stacked[number] = stacked.get(number, -1) + 1
        dots.append(f'<circle cx="{at:.1f}" cy="{base - RADIUS - level * step:.1f}" r="{RADIUS:g}"/>')
    return f'<g class="cases">{"".join(dots)}</g>'


def _bars(each: list[float], x: Callable[[float], float], base: float) -> str:
    """A bar per bin."""
    counts = _binned(each, x)
    wide, tallest = WIDTH / BINS, max(counts.values())
    bars = (
        f'<rect x="{number * wide:.1f}" y="{base - 20 * count / tallest:.1f}" width="{wide - 1:.1f}" height="{20 * count / tallest:.1f}"/>'
        for number, count in sorted(counts.items())
    )
    return f'<g class="cases">{"".join(bars)}</g>'

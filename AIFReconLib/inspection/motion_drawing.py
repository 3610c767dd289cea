"""A drawing of how a patient moved during a scan: mm over time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import Floats
from ..motion.motion import AXES, PatientMotion
from .drawing import Drawing, Stroke, Words

PAGE, MARGINS = (330.0, 180.0), ((44.0, 12.0), (30.0, 36.0))
"""Points. Width and height; what is left free on the left and the right, above and below."""

COLORS = ("#c0392b", "#1e8449", "#2471a3")
GRAY = "#bbbbbb"
STEPS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 60.0, 120.0, 300.0)
"""mm or s from one number on an axis to the next: the least that leaves at most so many numbers."""

MOST_NUMBERS = 7


def draw_motion(motion: PatientMotion) -> Drawing:
    """The shifts of the patient against the reference over time, a line for each axis of Reference, broken between passes."""
    passes = motion.curve.passes
    known = np.isfinite(motion.shifts[:, 0]) & np.isfinite(passes.times)
    times, shifts, numbers = passes.times[known] - passes.times[known].min(), motion.shifts[known], passes.numbers[known]
    low, high = np.array([0.0, min(shifts.min(), -0.5)]), np.array([max(times.max(), 1.0), max(shifts.max(), 0.5)])
    corner, size = np.array([MARGINS[0][0], PAGE[1] - MARGINS[1][1]]), np.array(PAGE) - np.sum(MARGINS, axis=1)

    def on_page(x: Floats, y: Floats) -> Floats:
        placed: Floats = corner + (np.stack([x, y], axis=1) - low) / (high - low) * size * (1, -1)
        return placed

    drawn: list[Stroke | Words] = [Words(MARGINS[0][0], 18, "mm along Reference's"), Words(PAGE[0] / 2 - 20, PAGE[1] - 4, "time, s")]
    for second in _numbers(low[0], high[0]):
        ((x, y),) = on_page(np.array([second]), low[1:])
        drawn.append(Words(float(x) - 3 * len(f"{second:g}"), float(y) + 16, f"{second:g}"))
    for shift in _numbers(low[1], high[1]):
        ends = on_page(np.array([low[0], high[0]]), np.array([shift, shift]))
        drawn += [Stroke(ends, GRAY), Words(6, float(ends[0, 1]) + 4, f"{shift:+g}" if shift else "0")]
    for axis, (name, color) in enumerate(zip(AXES, COLORS, strict=True)):
        drawn.append(Words(MARGINS[0][0] + 145 + 20 * axis, 18, name, color))
        for number in np.unique(numbers):
            own = numbers == number
            drawn.append(Stroke(on_page(times[own], shifts[own, axis]), color, width=2.0))
    return Drawing.of(*PAGE, drawn)


def _numbers(low: float, high: float) -> Iterator[float]:
    """Round numbers from low to high."""
    step = next((step for step in STEPS if (high - low) / step < MOST_NUMBERS), high - low)
    yield from (float(round(each * step, 1)) for each in range(int(np.ceil(low / step)), int(np.floor(high / step)) + 1))

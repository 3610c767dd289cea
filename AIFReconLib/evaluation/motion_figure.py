"""A picture of how the patient moved during a scan."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .figures import new_figure, own_looks, png_of

if TYPE_CHECKING:
    from ..motion.motion import PatientMotion

COLORS = ("#9be564", "#4fb3d9", "#ff8a50")


@own_looks()
def motion_figure(motion: PatientMotion) -> bytes:
    """The shifts of the patient over time, a line broken between passes for each axis of Reference; a PNG file."""
    from ..motion.motion import AXES

    passes = motion.curve.passes
    times, shifts = passes.times - np.nanmin(passes.times), motion.shifts
    gaps = np.flatnonzero(np.diff(passes.numbers)) + 1
    figure = new_figure(8.0, 3.0, layout="constrained")
    axes = figure.add_subplot()
    for axis, (name, color) in enumerate(zip(AXES, COLORS, strict=True)):
        axes.plot(np.insert(times, gaps, np.nan), np.insert(shifts[:, axis], gaps, np.nan), color=color, label=name)
    axes.set(xlabel="time, s", ylabel="mm")
    axes.legend(ncols=len(AXES), title="axes of Reference")
    axes.spines[["top", "right"]].set_visible(False)
    return png_of(figure)

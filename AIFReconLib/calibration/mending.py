"""What a sweep says of its calibration, whether a CT tells it or crossing frames do: the correction, what is held of it, and doubts."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from ..arrays import Floats, Mask, Matrix
from ..geometry.transforms import as_matrix, with_unit_depth
from ..message import Judged, Sentence, listed
from ..remedies import ADD_TIME_OFFSET, SCAN_AGAIN
from .certainty import Halves
from .echoes import Correction, ImagedEchoes
from .solve import ALL, EXPECTED, PARAMETERS, UNITS, as_vector, in_words, named

FEWEST_ANGLES = 2

ONE_ANGLE = Sentence(
    "The sweep shows bone from one angle alone, and one angle says nothing of a calibration. Scan the same bone there and back with the "
    "probe tilted to all sides and turned by 90 degrees."
)

FARTHEST = 4.0
"""Times `EXPECTED`: a calibration that is more wrong than that is wrong in another way, see check.py."""

HALVES_APART = 0.8
"""mm. Farther apart the calibrations of two halves of a sweep do not tell the same."""

LATE = 0.005
"""s of a delay that is worth another import."""

MOVEMENTS = {
    "there and back": ("delay",),
    "tilted within its image plane": ("shift across", "shift along"),
    "tilted out of its image plane": ("shift out of the image", "shift along"),
    "turned by 90 degrees": ("turn about across", "turn about along", "turn in the image"),
    "so that bone is seen at both sides of the image": ("size across",),
    "so that bone is seen near and deep": ("size along",),
}
"""How to move the probe over the same bone, and what that would tell."""


@dataclass(frozen=True, eq=False, repr=False)
class Mending(Judged):
    """What is found of the calibration that a sweep came with."""

    asked: ClassVar[Mask] = ALL  #: (9,). Which numbers of a correction are looked for.
    correction: Correction
    held: Mask  #: (9,). Which numbers the sweep holds, in the order of `solve.PARAMETERS`; the others stay as given.
    deviation: Floats  #: (9,). Standard deviation of each, in mm, radians, parts and s; NaN where it is not known.
    halves: Halves
    changed: float  #: mm. How far the correction moves the echoes, in the median.
    reason: str | None  #: Why it must not be used; None where it may be
    echoes: ImagedEchoes = field(repr=False)

    @property
    def values(self) -> Floats:
        """(9,): the correction in the order of `solve.PARAMETERS`, mm, radians, parts, s."""
        return as_vector(self.correction)

    @property
    def image_correction(self) -> Matrix:
        """(4, 4), pixels: old image_to_probe @ this = new image_to_probe, as `mended` has it."""
        return self.correction.of_pixels(self.echoes.spacing)

    def mended(self, image_to_probe: Matrix) -> Matrix:
        """The calibration in place of this one, (4, 4), pixels to mm; `image_to_probe` may end in any frame, Reference too."""
        return with_unit_depth(as_matrix(image_to_probe, "image_to_probe")) @ self.image_correction

    @property
    def advice(self) -> str | None:
        """Which movement of the probe would tell what this sweep does not; None where it tells all."""
        return advice_for(self.asked & ~self.held)

    @property
    def by_halves(self) -> str:
        """What each half says of the other."""
        before, after = self.halves.before, self.halves.after
        return f"calibrated on one half of the sweep, the other half lies {after:.2f} mm off instead of {before:.2f} mm"

    def lines(self) -> list[str]:
        """The numbers that are held, one line each, and what is to be done."""
        lines, deviations = [], in_words(self.deviation)
        for name, value, deviation, unit, held in zip(PARAMETERS, in_words(self.values), deviations, UNITS, self.held, strict=True):
            within = "" if np.isnan(deviation) else f", give or take {deviation:.2f}"
            lines += [f"{name}: {value:+.2f} {unit}{within}"] if held else []
        delay = self.correction.delay
        if self.held[-1] and abs(delay) > np.fmax(2 * self.deviation[-1], LATE):
            lines.append(Sentence("the delay is not part of a calibration.", ADD_TIME_OFFSET, offset=f"{delay:.3f}"))
        return [*lines, *([self.advice] if self.advice else [])]

    def report(self) -> dict[str, object]:
        """The same as JSON holds it: mm, degrees, percent, ms; matrices as nested lists, row by row."""
        values, deviations = in_words(self.values).round(4).tolist(), in_words(self.deviation).round(4).tolist()
        numbers = {
            f"{name} ({unit})": {"change": value, "deviation": None if np.isnan(deviation) else deviation, "held": bool(held)}
            for name, value, deviation, unit, held in zip(PARAMETERS, values, deviations, UNITS, self.held, strict=True)
        }
        return {
            "accepted": self.accepted,
            "refusal": self.refusal,
            "image_correction": self.image_correction.tolist(),
            "numbers": numbers,
            "other_half_mm": {"before": round(self.halves.before, 4), "after": round(self.halves.after, 4)},
            "halves_apart_mm": round(self.halves.apart, 4),
            "changed_mm": round(self.changed, 4),
        }


def advice_for(missing: Mask) -> str | None:
    """What is said of numbers, (9,), that a sweep does not hold; None of none."""
    names = named(missing)
    moves = [move for move, tells in MOVEMENTS.items() if {*tells} & {*names}]
    if not names:
        return None
    kept = f"This sweep does not show these, and they stay as they were: {listed(names)}."
    return f"{kept} Scan the same bone with the probe also {listed(moves)}."


def doubt_of(apart: float, correction: Correction, held: Mask) -> Sentence | None:
    """Why a calibration must not be used whose halves lie so many mm apart, or that is larger than calibrations are wrong; else None."""
    if apart > HALVES_APART:
        return Sentence(f"The halves of this sweep give calibrations that lie {apart:.1f} mm apart.", SCAN_AGAIN)
    far = (np.abs(as_vector(correction)) > FARTHEST * EXPECTED) & held
    if not far.any():
        return None
    name, value = PARAMETERS[int(far.argmax())], in_words(as_vector(correction))[int(far.argmax())]
    return Sentence(f"The calibration would have to change by more than calibrations are wrong by ({name} {value:+.1f}).")

"""A calibration without a CT: what echoes of different angles show is one surface, whichever that is.

Reference
---------
Wein W, Khamene A (2008), Image-based method for in-vivo freehand ultrasound calibration, SPIE Medical Imaging 6920: frames that cross must
agree. Here their bone echoes must, as in Chen and Medioni (1992), Object modelling by registration of multiple range images, Image and
Vision Computing 10:145-155.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, cast

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask
from ..message import Sentence
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..registration.refine import welsch
from ..remedies import SCAN_AGAIN
from ..sweep.frames import TrackedSequence
from .certainty import Halves, halves
from .echoes import Correction, ImagedEchoes, imaged_echoes
from .mending import FEWEST_ANGLES, ONE_ANGLE, Mending, advice_for, doubt_of
from .solve import EXPECTED, FINE_ECHOES, KNOWN, NOISE, PARAMETERS, SEEN_TOGETHER, as_correction

UNKNOWN: Floats = np.full(len(PARAMETERS), np.nan)
"""Deviations: that of several angles says nothing of all of them together."""

LAST_CHANGE = 1.0
"""mm. A calibration that changes by more is worth to be started from again."""

ASKED: Mask = np.array([not name.startswith("size") for name in PARAMETERS])
"""What is solved: smaller pixels draw all echoes together, and so look right."""

SCALES = (8.0, 4.0, 4.0, 2.0, 2.0, 1.0, 1.0, 1.0, 1.0)
"""mm. Scales of the robust distance, one after the other; each looks for neighbors anew."""

NEIGHBORS, REACH, FLAT = 8, 6.0, 0.15
"""Echoes of other angles through which a plane is laid, how far they may lie in mm or two scales, and how thick they may be, as a part
of the variance along their narrower side."""

GAIN = 0.85
"""Part of the distance as given that may be left on frames which the solution has not seen."""

NOT_IN_COMMON = Sentence("Frames of different angles show no bone in common. Scan the same bone with the probe tilted to all sides.")

HELD = 0.35
"""Part of what is expected of a number within which crossing frames must tell it, one standard deviation; tilts about one axis do not."""

TILT, ROUGH_STEPS, STILL = np.radians(10.0), 3, 0.2
"""Turns from which a calibration that was measured by hand is begun, and how often it is begun again, until it changes by no more mm."""

ROUGH_SCALES, ROUGH_KNOWN = (24.0, 24.0, 16.0, 16.0, 8.0, 8.0, 4.0, 4.0, 2.0, 2.0, 1.0), KNOWN / 16
"""mm, and what is known beforehand of its numbers. Six rulers, 18 mm and 10 degrees off, were all mended from one of the starts at least;
with the scales and the knowledge of others, two of four were."""

REVERSED = {
    "": np.zeros(3),
    "right points": np.array([0.0, np.pi, 0.0]),
    "down points": np.array([np.pi, 0.0, 0.0]),
    "right and down point": np.array([0.0, 0.0, np.pi]),
}
"""Turns of the image about its face by which axes of `start-calibration` are confused with their opposites."""

AS_GOOD, ELSEWHERE = 1.25, 2.0
"""Times the cost of the best up to which another solution may be the right one, and mm from which it is another. Of two patients and ten
rulers it was 0.35 to 0.41 where the end was right, elsewhere 0.63 to 0.73."""

CONTRADICTED, PLAINLY, WIDE = 3.0, 1.0, 4.0
"""How many times as far as angles, and mm, parts of a recording lie apart that contradict each other; mm, the scale of neighbors there."""

CROSSING_ECHOES = 2000
"""By which angles are compared."""


@dataclass(frozen=True, eq=False, repr=False)
class _CrossedCalibration(Mending):
    """What the echoes of a sweep's angles say of the calibration that the sweep came with."""

    asked: ClassVar[Mask] = ASKED
    before: float  #: mm. Median distance of an echo to the surface that other angles show, by the calibration as given.
    after: float

    @property
    def placed_echoes(self) -> tuple[Floats, Floats]:
        """Where the echoes lie in Reference by the calibration as given and by the new one, (n, 3) mm each."""
        return self.echoes.placed(Correction.none(self.echoes.center)).points, self.echoes.placed(self.correction).points

    def _facts(self) -> list[tuple[str, str]]:
        return [("accepted", str(self.accepted)), ("before", f"{self.before:.2f} mm"), ("after", f"{self.after:.2f} mm")]


def calibrate_by_crossing(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    *,
    rough: bool = False,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
) -> _CrossedCalibration:
    """What is wrong with a sweep's calibration and delay, but for the sizes of pixels, from bone of any shape seen from several angles.

    Parameters
    ----------
    sequences : TrackedSequence or several in one Reference, all of one calibration
    rough : bool
        Whether it was measured by hand, and may be 20 mm and 12 degrees off: several starts are tried.
    recipe : Recipe or None
        As in `reconstruct`.

    Raises
    ------
    AIFReconError
        For input that cannot be used. A calibration that must not be used is no error: see its `refusal`.
    """
    echoes = imaged_echoes(sequences, recipe, part(progress, 0.0, 0.2 if rough else 0.6))
    return calibrate_crossing_echoes(echoes, part(progress, 0.2 if rough else 0.6, 1.0), rough)


def calibrate_crossing_echoes(echoes: ImagedEchoes, progress: Progress | None = None, rough: bool = False) -> _CrossedCalibration:
    """`calibrate_by_crossing`, for echoes that are there already."""
    none = Correction.none(echoes.center)
    if len(np.unique(echoes.angles)) < FEWEST_ANGLES:
        return _refused(echoes, ONE_ANGLE)
    report(progress, 0.0, "Solving the calibration")
    if not np.isfinite(off_the_surface(echoes, none)):
        return _refused(echoes, NOT_IN_COMMON)
    given, begun = echoes, none
    if rough:
        begun, doubt = _begun(echoes, part(progress, 0.0, 0.7))
        if doubt is not None:
            return _refused(echoes, doubt)
        echoes = echoes.moved(begun.plane)
    asked = ASKED if echoes.timed else ASKED & (np.arange(len(ASKED)) < len(ASKED) - 1)
    found, deviation = _solve(echoes, asked)
    held = asked & (deviation <= HELD)
    if not held.any():
        return _refused(echoes, Sentence(advice_for(asked) or ""))
    if (held != asked).any():
        # Along what is not held, any answer would do
        found, _ = _solve(echoes, held)
    sides = halves(echoes)
    ends = [_solve(side, held)[0] for side in sides]
    report(progress, 0.8, "Judging the calibration")
    before = float(np.mean([off_the_surface(side, none) for side in halves(given)]))
    after = float(np.mean([off_the_surface(side, end) for side, end in zip(reversed(sides), ends, strict=True)]))
    compared = Halves(before, after, _apart(echoes, *ends))
    reason = doubt_of(compared.apart, found, held)
    if not np.isfinite(before + after):
        reason = NOT_IN_COMMON
    elif after > GAIN * before:
        reason = Sentence(
            f"No better one is found: frames of other angles lie {before:.2f} mm apart as given, {after:.2f} mm by another calibration."
        )
    report(progress, 1.0, "Calibrated")
    off = off_the_surface(given, none), off_the_surface(echoes, found)
    whole = replace(begun.then(found), delay=found.delay) if rough else found
    return _CrossedCalibration(whole, held, UNKNOWN, compared, _apart(given, none, whole), reason, given, *off)


def _refused(echoes: ImagedEchoes, why: Sentence) -> _CrossedCalibration:
    none, nothing = Correction.none(echoes.center), Halves(np.nan, np.nan, np.nan)
    return _CrossedCalibration(none, np.zeros(len(ASKED), bool), UNKNOWN, nothing, 0.0, why, echoes, np.nan, np.nan)


def _begun(echoes: ImagedEchoes, progress: Progress | None) -> tuple[Correction, Sentence | None]:
    """Near which correction the right one is, of a calibration that was measured by hand; and why that must not be used."""
    center, asked = echoes.center, ASKED & (np.arange(len(ASKED)) < len(ASKED) - 1)
    face = np.array([echoes.frame_size[0] / 2 * echoes.spacing[0], 0.0, 0.0])
    starts = [(axes, Correction(_turned(by), np.zeros(3), np.ones(2), 0.0, face)) for axes, by in REVERSED.items()]
    tilts = [sign * TILT * axis for axis in np.eye(3) for sign in (-1, 1)]
    starts += [("", Correction(_turned(by), np.zeros(3), np.ones(2), 0.0, center)) for by in tilts]
    ends = []
    for number, (axes, start) in enumerate(starts):
        by = Correction.of_plane(start.plane, center)
        for step in range(ROUGH_STEPS):
            report(progress, (number + step / ROUGH_STEPS) / len(starts), "Looking for the calibration from several starts")
            before, by = by, by.then(_solve(echoes.moved(by.plane), asked, ROUGH_SCALES, ROUGH_KNOWN)[0])
            if _apart(echoes, before, by) < STILL:
                break
        ends.append((_cost(echoes.moved(by.plane)), axes, by))
    least, axes, best = min(ends, key=lambda end: end[0])
    if axes:
        words = f"Echoes of other angles lie closer when {axes} to the opposite side. Look at the marker's axes; are the images mirrored?"
        return best, Sentence(words, "Correct it, and write the start anew.")
    apart = [_apart(echoes, best, by) for cost, _, by in ends if cost < AS_GOOD * least]
    if max(apart) > ELSEWHERE:
        return best, Sentence(f"Calibrations that fit nearly as well lie {max(apart):.0f} mm apart.", SCAN_AGAIN)
    return best, None


def _turned(by: Floats) -> Floats:
    turn: Floats = scipy.spatial.transform.Rotation.from_rotvec(by).as_matrix()
    return turn


def _cost(echoes: ImagedEchoes) -> float:
    """The mean of 1 - exp(-d^2 / 2 s^2) over the echoes, s the finest scale; where no other angle shows a surface it is 1."""
    few, none = echoes.spread(FINE_ECHOES), Correction.none(echoes.center)
    off = _off(few.placed(none).points, *_planes(few, none, SCALES[-1]))
    return 1.0 - float(np.exp(-0.5 * (off / SCALES[-1]) ** 2).sum()) / len(few)


def crossing(echoes: ImagedEchoes) -> float:
    """mm. The median distance from an echo to the nearest that another angle shows: small where all angles place bone at one place."""
    chosen = echoes.spread(CROSSING_ECHOES)
    points, angles = chosen.placed(Correction.none(chosen.center)).points, chosen.angles[chosen.frames]
    distances = np.empty(len(points))
    for angle in np.unique(angles):
        others = scipy.spatial.cKDTree(points[angles != angle])
        distances[angles == angle] = others.query(points[angles == angle])[0]
    return float(np.median(distances))


def contradiction(echoes: ImagedEchoes) -> Sentence | None:
    """What is said where parts of a recording show the bone at places of their own, which no calibration explains; None where none do.

    The yardstick is the sweep's own: how far the echoes of different angles lie off each other's surface.
    """
    several = len(echoes.tracks) > 1
    half = np.arange(len(echoes.angles)) * 2 // len(echoes.angles)
    parts = "sweeps" if several else "first and the second half of the recording"
    none = Correction.none(echoes.center)
    alike = off_the_surface(echoes, none, WIDE)
    apart = off_the_surface(replace(echoes, angles=echoes.sweeps if several else half), none, WIDE)
    if not apart > max(CONTRADICTED * alike, PLAINLY):
        return None
    return Sentence(
        f"WARNING: The {parts} contradict each other: they show the bone {apart:.1f} mm apart, and different angles {alike:.1f} mm. "
        "Check that they are of one patient who did not move against the reference, with one calibration and one depth."
    )


def _solve(echoes: ImagedEchoes, asked: Mask, scales: tuple[float, ...] = SCALES, known: float = KNOWN) -> tuple[Correction, Floats]:
    """The numbers that are asked for with which each echo lies on the plane through its neighbors of other angles.

    Beside them their standard deviations, (9,), in units of `EXPECTED`; infinite where nothing was asked.
    """
    few, center = echoes.spread(FINE_ECHOES), echoes.center
    vector = np.zeros(len(asked))
    pull = np.sqrt(known * SEEN_TOGETHER * NOISE)
    for scale in scales:
        rows, neighbors, normals = _planes(few, as_correction(vector, center), scale)

        def residuals(
            steps: Floats, scale: float = scale, rows: Integers = rows, neighbors: Integers = neighbors, normals: Floats = normals
        ) -> Floats:
            points = few.placed(as_correction(_whole(steps, asked), center)).points
            return np.concatenate([_off(points, rows, neighbors, normals) / scale, pull * steps])

        # Typed in another way from one release of the stubs to the next
        solution = cast("Any", scipy.optimize.least_squares)(
            residuals,
            vector[asked] / EXPECTED[asked],
            loss=welsch(len(rows)),
            diff_step=1e-4,
            max_nfev=8,
            xtol=1e-4,
            ftol=1e-5,
        )
        vector = _whole(solution.x, asked)
    deviation = np.full(len(asked), np.inf)
    information = solution.jac.T @ solution.jac / (SEEN_TOGETHER * NOISE)
    deviation[asked] = np.sqrt(np.diag(np.linalg.pinv(information, hermitian=True)))
    return as_correction(vector, center), deviation


def _whole(steps: Floats, asked: Mask) -> Floats:
    vector = np.zeros(len(asked))
    vector[asked] = steps * EXPECTED[asked]
    return vector


def _planes(echoes: ImagedEchoes, correction: Correction, scale: float) -> tuple[Integers, Integers, Floats]:
    """Echoes (n,) with neighbors of other angles that lie flat, these (n, `NEIGHBORS`), and the planes' normals (n, 3)."""
    points, angles = echoes.placed(correction).points, echoes.angles[echoes.frames]
    found = []
    for angle in np.unique(angles):
        mine, others = np.flatnonzero(angles == angle), np.flatnonzero(angles != angle)
        count = np.arange(1, min(NEIGHBORS, len(others)) + 1)
        distances, nearest = (np.asarray(one) for one in scipy.spatial.cKDTree(points[others]).query(points[mine], k=count))
        around = points[others][nearest]
        arms = around - around.mean(axis=1, keepdims=True)
        variances, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", arms, arms))
        near = distances[:, -1] < max(2 * scale, REACH)
        flat = near & (variances[:, 1] > 1e-3) & (variances[:, 0] < FLAT * variances[:, 1])
        found.append((mine[flat], others[nearest[flat]], axes[flat, :, 0]))
    rows, neighbors, normals = (np.concatenate(one) for one in zip(*found, strict=True))
    return rows, neighbors, normals


def _off(points: Floats, rows: Integers, neighbors: Integers, normals: Floats) -> Floats:
    """(n,) mm from the planes, with sign."""
    off: Floats = np.einsum("ni,ni->n", normals, points[rows] - points[neighbors].mean(axis=1))
    return off


def off_the_surface(echoes: ImagedEchoes, correction: Correction, scale: float = SCALES[-1]) -> float:
    """mm. Median distance of the echoes to the planes of other angles, without sign; NaN where they have none in common."""
    few = echoes.spread(FINE_ECHOES)
    if len(np.unique(few.angles[few.frames])) < 2:
        return np.nan
    planes = _planes(few, correction, scale)
    return float(np.median(np.abs(_off(few.placed(correction).points, *planes)))) if len(planes[0]) else np.nan


def _apart(echoes: ImagedEchoes, one: Correction, other: Correction) -> float:
    """mm. How far apart two corrections place the echoes in the median, one laid on the other: where all of it lies is not asked."""
    first, second = (points - points.mean(axis=0) for points in (echoes.placed(one).points, echoes.placed(other).points))
    turn = scipy.spatial.transform.Rotation.align_vectors(second, first)[0]
    return float(np.median(np.linalg.norm(turn.apply(first) - second, axis=1)))


def crossing_findings(found: _CrossedCalibration) -> list[str]:
    """What a user should know, one line each."""
    if not np.isfinite(found.after):
        return []
    lines = [
        f"without a CT: echoes lie {found.before:.2f} mm off the surface that other angles show as given, {found.after:.2f} mm calibrated",
        found.by_halves,
        f"the calibrations of both halves place echoes {found.halves.apart:.1f} mm apart",
        f"the change is {found.changed:.1f} mm; sizes of pixels stay as given, which needs a CT or a phantom",
    ]
    if found.changed > LAST_CHANGE:
        lines.append("a change this large is seldom the last: calibrate again from the new one, until no better one is found")
    return [*lines, *found.lines()]


def crossing_report(found: _CrossedCalibration) -> dict[str, object]:
    """The calibration as JSON holds it, see `Mending.report`."""
    return {**found.report(), "between_angles_mm": {"before": round(found.before, 4), "after": round(found.after, 4)}}

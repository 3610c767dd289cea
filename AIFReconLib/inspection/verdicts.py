"""Verdicts on a sweep, each in a few words with what to do: tracked, the CT lies on it, bone was met, the calibration is right, the patient
lay still."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..bone.echoes.found import FEWEST
from ..message import Sentence, listed, message_of
from ..registration.agreement import ENOUGH, LARGEST_MEDIAN, Agreement

if TYPE_CHECKING:
    from ..calibration.check import CalibrationCheck
    from ..motion.motion import PatientMotion
    from .drawing import Drawing
    from .tracking_report import TrackingReport

MOST_FRAMES, FEW_FRAMES = 0.9, 0.5
"""Shares of the frames that were used. With one in ten missing a sweep is whole where its frames overlap; with half of them gone
what is reconstructed is not what was scanned, and nobody knows what lay in between."""

FAST = 60.0
"""mm/s, of the probe in the median. A lumbar sweep moves at 10 to 60; at 20 frames per second, 60 leaves 3 mm from frame to frame, the
thickness of the beam, so that beyond it there is bone that no beam crosses. A pose that comes 30 ms late is 2 mm off then."""

MANY_JUMPS = 0.02
"""Share of the frames before which the pose jumps. One jump is a marker that was seen wrongly once; one in fifty frames and more is a
tracker that cannot be believed."""

COVERED, BARELY_COVERED = 0.6, 0.3
"""Share of what faces the back of a vertebra that is expected to show. Simulated sweeps from nine angles show 67% to 80% of the vertebrae
that they pass over with 144 to 480 frames and 44% to 48% with 72; where they end, 30% to 56%."""

SCANNED = 0.1
"""Share of a vertebra that was met at all, from which on it counts as scanned: the CT may show others, which nobody looked at."""


CALIBRATE_ANEW = "Calibrate anew, on a scan at rest."
TAKE_OUT = "Take it out and compare, once the calibration is right: a wrong one looks much the same."
"""What to do about a motion that was found."""


class Level(enum.Enum):
    """How good something is; the panel has a sign and a color for each."""

    GOOD = "good"
    LOOK = "look"
    POOR = "poor"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Verdict:
    """What is to be thought of a sweep in one respect."""

    level: Level
    finding: str  #: What was found, with the number that decides
    advice: str = ""  #: What to do; empty where nothing is
    drawing: Drawing | None = None  #: That shows it


def unknown(why: str) -> Verdict:
    """Nothing can be said, for the reason `why`."""
    return Verdict(Level.UNKNOWN, why)


def tracking_verdict(report: TrackingReport) -> Verdict:
    """Whether the tracker saw the probe all the way, without jumps, and slow enough."""
    frames = f"{report.used} of {report.frames} frames"
    share = report.used / max(report.frames, 1)
    jumps = len(report.jumps)
    if not report.used:
        advice = "Check that the tracker sees the probe, and that the calibration belongs to it."
        return Verdict(Level.POOR, "no frame has a position", advice)
    if jumps >= max(2, MANY_JUMPS * report.frames):
        return Verdict(
            Level.POOR,
            f"{frames}; the tracked position jumps {jumps} times",
            "Fasten the markers, clear the tracker's view, and scan again.",
        )
    if share < FEW_FRAMES:
        return Verdict(Level.POOR, frames, "Keep the markers in the tracker's view, and scan again.")
    if jumps:
        advice = "Check the picture there, and scan again if it is torn: a marker was seen wrongly, or bumped."
        found = f"{frames}; the tracked position jumps once, after frame {report.jumps[0].before}"
        return Verdict(Level.LOOK, found, advice)
    if share < MOST_FRAMES:
        return Verdict(Level.LOOK, frames, "Keep the markers in the tracker's view; parts of the sweep are missing.")
    if report.median_speed is None:
        return Verdict(Level.GOOD, frames)
    found = f"{frames}, probe at {report.median_speed:.0f} mm/s"
    if report.median_speed > FAST:
        return Verdict(Level.LOOK, found, f"Move the probe more slowly: {FAST:.0f} mm/s at most.")
    return Verdict(Level.GOOD, found)


def registration_verdict(agreement: Agreement, names: Mapping[int, str] | None = None, guessed: str = "") -> Verdict:
    """Whether the bone of the CT lies on the bone that the sweep shows, by the rule that registrations are accepted by.

    `names` are those of the labels. What the sweep does not tell and was `guessed`, in words, makes it a caution.
    """
    if agreement.echoes + agreement.elsewhere < FEWEST:
        return unknown("the sweep shows too little bone to compare with the CT")
    place = "Place the CT on the sweep before you believe the picture."
    if not agreement.echoes:
        return Verdict(Level.POOR, "no bone of the CT is near the bone of the sweep", place)
    found = f"{agreement.share:.0%} of the echoes lie on its bone, {agreement.median_distance:.1f} mm off in the median"
    if agreement.enough and guessed:
        return Verdict(
            Level.LOOK, f"CT agrees: {found}; but the sweep does not tell {guessed}", "Place it there by landmarks, or scan more."
        )
    if agreement.enough:
        return Verdict(Level.GOOD, f"CT agrees: {found}")
    if agreement.share >= ENOUGH and agreement.median_distance <= LARGEST_MEDIAN:
        bones = listed([(names or {}).get(label) or f"label {label}" for label in agreement.disagreeing_labels])
        return Verdict(
            Level.LOOK,
            f"CT agrees but for {bones}: {found}",
            (
                "Do not trust the picture there, nor the names of the levels: the spine may have bent since the CT, or the CT lies one "
                "level off."
            ),
        )
    only = "only " if agreement.share < ENOUGH else ""
    return Verdict(Level.POOR, f"CT does not lie on the bone of the sweep: {only}{found}", place)


def coverage_verdict(shown: Mapping[str, float], met: Mapping[str, float]) -> Verdict:
    """How much of the vertebrae that were scanned is expected to show.

    Parameters
    ----------
    shown : mapping of str to float
        By the name of a vertebra, the share of what can be reached that is expected to show, 0 to 1; NaN: nothing can be reached.
    met : mapping of str to float
        By the same names, the share that any beam met.
    """
    scanned = {name: share for name, share in shown.items() if met[name] >= SCANNED and share == share}
    if not scanned:
        return Verdict(Level.POOR, "the sweep has hit no bone of the CT", "Scan over the bone, or place the CT on the sweep.")
    shares = listed([f"{name}: {share:.0%}" for name, share in scanned.items()])
    found = f"share of the bone that should show: {shares}"
    least = min(scanned.values())
    if least >= COVERED:
        return Verdict(Level.GOOD, found)
    return Verdict(Level.LOOK if least >= BARELY_COVERED else Level.POOR, found, "Scan again from other angles; “More” says where.")


def motion_verdict(motion: PatientMotion | None, taken_out: bool) -> Verdict:
    """How the patient moved, and whether that is out of the volume."""
    if motion is None:
        # Here, since it computes: nothing of that may be loaded where verdicts are only read
        from ..motion.motion import CANNOT_TELL

        return unknown(CANNOT_TELL)
    if motion.applied:
        from .motion_drawing import draw_motion

        found = f"{motion.moved} Passes show the bone {motion.before:.1f} mm apart, {motion.after:.1f} with that taken out."
        drawing = draw_motion(motion)
        if motion.is_calibration:
            return Verdict(Level.LOOK, found, CALIBRATE_ANEW, drawing)
        return Verdict(Level.GOOD if taken_out else Level.LOOK, found, "" if taken_out else TAKE_OUT, drawing)
    if motion.unexplained:
        return Verdict(Level.LOOK, f"passes show the bone {motion.before:.1f} mm apart, and no motion explains it", motion.unexplained)
    return Verdict(Level.GOOD, motion.still)


def calibration_verdict(checked: CalibrationCheck) -> Verdict:
    """Whether the calibration agrees with the bone of a CT that lies on the sweep."""
    level = Level.UNKNOWN if checked.agrees is None else Level.GOOD if checked.agrees else Level.LOOK
    return Verdict(level, checked.finding, Sentence(" ".join(checked.more), message_of(checked.finding)))

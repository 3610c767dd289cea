"""How well a sweep was tracked: frames used and why others were not, gaps, jumps, the probe's speed, and coverage of the grid."""

from __future__ import annotations

from dataclasses import dataclass, replace
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats, Integers
from ..geometry.transform_graph import capital
from ..holes.filling import FILLED, MEASURED
from ..message import listed
from ..recipe.recipe import LONGEST_GAP
from ..sweep.frames import TrackedSequence
from ..sweep.poses import SweepPoses, describe_frames, time_order
from ..sweep.still_images import STILL
from .offset_estimate import corner_track
from .summary import describe_coverage

if TYPE_CHECKING:
    from ..compounding.state import Reconstruction

JUMP_SPEED = 200.0
"""mm/s. Nobody moves a probe over skin faster."""

JUMP_FACTOR = 8.0
"""Times the median speed of the sweep: for sweeps that are fast as a whole."""


@dataclass(frozen=True)
class _PoseJump:
    """A place where the pose moves faster than a probe can: frame numbers before and after, distance in mm, time between in s."""

    before: int
    after: int
    distance: float
    seconds: float

    def to_text(self) -> str:
        """``frames 11 to 12: 34.0 mm in 0.05 s``."""
        return f"frames {self.before} to {self.after}: {self.distance:.1f} mm in {self.seconds:.2f} s"


@dataclass(frozen=True)
class TrackingReport:
    """What a user should know of the tracking of a sweep."""

    frames: int
    used: int
    """Frames of the recording, and those with an image and a valid pose (or, after a reconstruction, those inserted)."""
    skipped: dict[str, list[int]]  #: Numbers of the others by reason
    duration: float | None = None  #: s. From the first to the last used frame; None without time stamps.
    longest_gap: float | None = None  #: s. Between used frames.
    longest_gap_after: int | None = None  #: The frame after which it comes
    jumps: tuple[_PoseJump, ...] = ()
    """Where the image moves faster than `JUMP_SPEED` and than `JUMP_FACTOR` times the median speed."""
    median_speed: float | None = None
    highest_speed: float | None = None
    """mm/s. Root mean square over the image's corners, between used frames no more than half a second apart."""
    median_step: float | None = None
    largest_step: float | None = None
    """mm. The same as distances, whatever the time between."""
    coverage: dict[str, int] | None = None  #: Of a reconstruction: how many `voxels`, how many were `measured` and how many `filled`

    def rows(self) -> list[tuple[str, str]]:
        """Names and values for a table."""
        rows: list[tuple[str, str]] = [("frames used", f"{self.used} of {self.frames}")]
        if self.longest_gap is not None:
            rows.append(("longest gap", f"{self.longest_gap:.2f} s, after frame {self.longest_gap_after}"))
        if self.median_speed is not None:
            rows.append(("probe speed", f"{self.median_speed:.1f} mm/s in the median, {self.highest_speed:.1f} mm/s at most"))
        if self.median_step is not None:
            rows.append(("frame to frame", f"{self.median_step:.2f} mm in the median, {self.largest_step:.2f} mm at most"))
        rows.append(("pose jumps", str(len(self.jumps)) if self.jumps else "none"))
        if self.coverage is not None:
            measured, filled = (self.coverage[name] / self.coverage["voxels"] for name in ("measured", "filled"))
            rows.append(("volume", describe_coverage(measured, filled)))
        return rows

    def findings(self) -> list[str]:
        """Sentences on what may be wrong."""
        skipped = (f"Skipped: {describe_frames(n)}: {reason}." for reason, n in self.skipped.items())
        return [*skipped, *self.findings_on_poses()]

    def findings_on_poses(self) -> list[str]:
        """Sentences on what may be wrong with poses that count as valid, or with the images that belong to them."""
        sentences: list[str] = []
        if still := len(self.skipped.get(STILL, ())):
            sentences.append(
                f"{still} of {self.frames} images equal the one before although the probe moved meanwhile: was the frame grabber slower "
                "than the tracker, or the scanner frozen? Of equal images only the first is where its pose says; the others are left out."
            )
        if self.jumps:
            shown = [jump.to_text() for jump in self.jumps[:3]]
            where = listed([*shown, "..."] if len(self.jumps) > 3 else shown, "; ")
            sentences.append(f"The pose jumps faster than a probe can move ({where}): was a marker seen wrongly, or its place changed?")
        return sentences

    def as_text(self, title: str) -> str:
        """Title, names and values, and sentences, a line each."""
        return "\n".join([title, *(f"{capital(name)}: {value}" for name, value in self.rows()), *self.findings()])

    def as_html(self, title: str) -> str:
        """The same as a table."""
        cells = (f"<td style='padding-right: 8px'>{escape(capital(name))}</td><td>{escape(value)}</td>" for name, value in self.rows())
        rows = "".join(f"<tr>{each}</tr>" for each in cells)
        sentences = "".join(f"<p style='margin: 4px 0'>{escape(sentence)}</p>" for sentence in self.findings())
        return f"<p style='margin: 0 0 4px 0'><b>{escape(title)}</b></p><table cellspacing='0' cellpadding='2'>{rows}</table>{sentences}"

    def to_dict(self) -> dict[str, object]:
        """For JSON: numbers rounded to 6 places, units in the names."""
        return {
            "frames": self.frames,
            "frames_used": self.used,
            "frames_skipped": {reason: [int(n) for n in numbers] for reason, numbers in self.skipped.items()},
            "duration_s": _rounded(self.duration),
            "longest_gap_s": _rounded(self.longest_gap),
            "longest_gap_after_frame": self.longest_gap_after,
            "pose_jumps": [
                {"before": jump.before, "after": jump.after, "distance_mm": _rounded(jump.distance), "time_s": _rounded(jump.seconds)}
                for jump in self.jumps
            ],
            "speed_mm_per_s": {"median": _rounded(self.median_speed), "maximum": _rounded(self.highest_speed)},
            "step_mm": {"median": _rounded(self.median_step), "maximum": _rounded(self.largest_step)},
            "coverage": self.coverage,
        }


def tracking_report(sequence: TrackedSequence, poses: SweepPoses, result: Reconstruction | None = None, number: int = 0) -> TrackingReport:
    """The report of a sweep.

    Parameters
    ----------
    sequence : TrackedSequence
        Its images are not looked at.
    poses : SweepPoses
        As `sweep_poses` finds them.
    result : Reconstruction or None
        What became of it: then frames count as used when they were inserted, and coverage is known.
    number : int
        Which of the result's sweeps it is.
    """
    used, skipped, coverage = len(poses.usable), poses.skipped(), None
    if result is not None:
        used, skipped = result.frames_inserted, dict(result.skipped)
        if len(result.sweeps) > 1:
            used, skipped = result.sweeps[number].inserted, result.sweeps[number].skipped
        mask = result.mask.array
        coverage = {"voxels": mask.size, "measured": int((mask == MEASURED).sum()), "filled": int((mask == FILLED).sum())}
    numbers = np.array([n for n in time_order(sequence) if poses.problems[n] is None], dtype=np.int64)
    found = TrackingReport(len(sequence), used, skipped, coverage=coverage)
    if len(numbers) > 1:
        track = corner_track(poses.image_to_reference[numbers], sequence.frame_size)
        steps = np.linalg.norm(np.diff(track, axis=0), axis=1)
        found = replace(found, median_step=float(np.median(steps)), largest_step=float(steps.max()))
        stamps = sequence.timestamps[numbers]
        if np.isfinite(stamps).all():
            found = _with_times(found, numbers, steps, stamps)
    return found


def _with_times(report: TrackingReport, numbers: Integers, steps: Floats, times: Floats) -> TrackingReport:
    """With gaps, speeds and jumps of frames with these numbers, distances and times, in order of time."""
    gaps = np.diff(times)
    widest = int(np.argmax(gaps))
    seconds = float(times[-1] - times[0])
    report = replace(report, duration=seconds, longest_gap=float(gaps[widest]), longest_gap_after=int(numbers[widest]))
    near = (gaps > 0) & (gaps <= LONGEST_GAP)
    if not near.any():
        return report
    speeds = np.where(near, steps / np.where(near, gaps, 1.0), 0.0)
    median = float(np.median(speeds[near]))
    jumps = np.flatnonzero(speeds > max(JUMP_SPEED, JUMP_FACTOR * median))
    return replace(
        report,
        median_speed=median,
        highest_speed=float(speeds.max()),
        jumps=tuple(_PoseJump(int(numbers[n]), int(numbers[n + 1]), float(steps[n]), float(gaps[n])) for n in jumps),
    )


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(float(value), 6)

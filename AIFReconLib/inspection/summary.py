"""What a reconstruction did, in a few lines: said alike by the command line and the Slicer module."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..holes.filling import FILLED, MEASURED
from ..message import Spelling, advised, as_argument
from ..sweep.poses import describe_frames, describe_skipped

if TYPE_CHECKING:
    from ..compounding.state import Reconstruction


@dataclass(frozen=True)
class SweepSummary:
    """What a panel says of a sweep."""

    frames: int
    usable: int  #: Of them: with an image and a valid pose
    skipped: Mapping[str, list[int]]  #: Numbers of the others, by reason
    problem: str | None = None  #: Why nothing can be reconstructed from it, in a sentence

    @classmethod
    def of_frames(cls, name: str, frames: int, skipped: Mapping[str, list[int]]) -> SweepSummary:
        """Of a sweep of this name with so many frames, of which some are skipped."""
        usable = frames - sum(len(numbers) for numbers in skipped.values())
        lost = f"{name}: no frame has a position ({describe_skipped(skipped)}). Check the tracking of this recording."
        return cls(frames, usable, skipped, None if usable else lost)

    @property
    def lines(self) -> list[str]:
        """The findings in words, as `aifrecon info` has them."""
        if self.problem:
            return [self.problem]
        placed = f"{self.usable} of {self.frames} frames have a position."
        skipped = ((describe_frames(numbers), reason) for reason, numbers in self.skipped.items())
        return [placed, *(f"Will be skipped: {frames}: {reason}." for frames, reason in skipped)]


def summary_lines(result: Reconstruction, frames: int, seconds: float | None = None, spelling: Spelling = as_argument) -> list[str]:
    """Method, frames, voxels, how many of them hold something, which frames were skipped and why, and what else is to be known.

    `frames` are those of the sweep, `seconds` what it took; `words` say what to do as the reader knows it.
    """
    grid = result.grid
    measured = int((result.mask.array == MEASURED).sum())
    filled = int((result.mask.array == FILLED).sum())
    size = " x ".join(str(n) for n in grid.size)
    spacing = " x ".join(f"{s:.3g}" for s in grid.spacing)
    done = f"{result.method}: {result.frames_inserted} of {frames} frames into {size} voxels of {spacing} mm"
    return [
        done if seconds is None else f"{done}, in {seconds:.1f} s",
        describe_coverage(measured / grid.voxels, filled / grid.voxels if filled else None),
        *_skipped(result),
        *(advised(note, spelling) for note in result.messages),
    ]


def _skipped(result: Reconstruction) -> list[str]:
    """Which frames did not enter; of several sweeps, what each gave, with its own numbers."""
    if len(result.sweeps) < 2:
        return [f"skipped: {describe_frames(n)}: {reason}" for reason, n in result.skipped.items()]
    lines = []
    for sweep in result.sweeps:
        done = f"{sweep.name}: {sweep.inserted} of {sweep.frames} frames"
        why = describe_skipped(sweep.skipped)
        lines.append(f"{done}; skipped: {why}" if sweep.skipped else done)
    return lines


def describe_coverage(measured: float, filled: float | None = None) -> str:
    """How many of the voxels were measured and how many filled, both from 0 to 1, in words."""
    words = f"{100 * measured:.1f}% of the voxels measured"
    return words if filled is None else f"{words}, {100 * filled:.1f}% filled"

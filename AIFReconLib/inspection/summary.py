"""What a reconstruction did, in a few lines: said alike by the command line and the Slicer module."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..holes.nearest import FILLED, MEASURED
from ..message import Message
from ..sweep.poses import describe_frames, describe_skipped

if TYPE_CHECKING:
    from ..compounding.state import Reconstruction


def summary_lines(result: Reconstruction, frames: int, seconds: float | None = None) -> list[str]:
    """Method, frames, voxels, how many of them hold something, which frames were skipped and why, and what else is to be known.

    Parameters
    ----------
    result : Reconstruction
    frames : int
        How many the sweep has.
    seconds : float or None
        How long it took.
    """
    grid = result.grid
    measured = int((result.mask.array == MEASURED).sum())
    filled = int((result.mask.array == FILLED).sum())
    size = " x ".join(str(n) for n in grid.size)
    spacing = " x ".join(f"{s:.3g}" for s in grid.spacing)
    done = Message(
        "{method}: {used} of {frames} frames into {size} voxels of {spacing} mm",
        method=result.method,
        used=result.frames_inserted,
        frames=frames,
        size=size,
        spacing=spacing,
    )
    return [
        done if seconds is None else Message("{done}, in {seconds:.1f} s", done=done, seconds=seconds),
        describe_coverage(measured / grid.voxels, filled / grid.voxels if filled else None),
        *_skipped(result),
        *result.said,
    ]


def _skipped(result: Reconstruction) -> list[Message]:
    """Which frames did not enter; of several sweeps, what each gave, with its own numbers."""
    if len(result.sweeps) < 2:
        return [Message("skipped: {frames}: {reason}", frames=describe_frames(n), reason=reason) for reason, n in result.skipped.items()]
    lines = []
    for sweep in result.sweeps:
        done = Message("{sweep}: {used} of {frames} frames", sweep=sweep.name, used=sweep.inserted, frames=sweep.frames)
        why = describe_skipped(sweep.skipped)
        lines.append(Message("{done}; skipped: {reasons}", done=done, reasons=why) if sweep.skipped else done)
    return lines


def describe_coverage(measured: float, filled: float | None = None) -> Message:
    """How many of the voxels were measured and how many filled, both from 0 to 1, in words."""
    said = Message("{share:.1f}% of the voxels measured", share=100 * measured)
    return said if filled is None else Message("{measured}, {share:.1f}% filled", measured=said, share=100 * filled)

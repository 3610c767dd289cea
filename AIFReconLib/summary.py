"""What a reconstruction did, in a few lines: said alike by the command line and the Slicer module."""

from __future__ import annotations

from .compounding.reconstructor import Reconstruction
from .poses import describe_frames


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
    measured = int((result.mask.array == 1).sum())
    filled = int((result.mask.array == 2).sum())
    size = " x ".join(str(n) for n in grid.size)
    spacing = " x ".join(f"{s:.3g}" for s in grid.spacing)
    took = "" if seconds is None else f", in {seconds:.1f} s"
    shares = f"{100 * measured / grid.voxels:.1f}% of the voxels measured" + (
        f", {100 * filled / grid.voxels:.1f}% filled" if filled else ""
    )
    return [
        f"{result.method}: {result.frames_inserted} of {frames} frames into {size} voxels of {spacing} mm{took}",
        shares,
        *(f"skipped: {describe_frames(numbers)}: {reason}" for reason, numbers in result.skipped.items()),
        *result.notes,
    ]

"""`aifrecon benchmark`: whether this machine keeps up with a live scan, by each method."""

from __future__ import annotations

from typing import Annotated

from .. import __version__
from ..compounding.engines import INSTALL_NUMBA
from ..errors import SettingsError
from ..machine.threads import optional_module
from ..message import columns
from ..recipe.recipe import DEFAULT_SPACING
from ..terminal.arguments import Options, Output, count, positive
from ..terminal.console import ProgressBar
from ..terminal.outputs import write_json
from ..workflows.benchmark import JUST_KEEPS_UP, KEEPS_UP, TOO_SLOW, MeasuredSpeed, busy_warning, machine, measured_speed, verdict

LEAST_SIDE, LARGEST_SIDE = 16, 8192
_ANY = "any method"


class _BenchmarkOptions(Options):
    """Receive and insert made-up images with every method, and say whether this machine keeps up with a live scan of that size and rate.

    Parameters
    ----------
    size : COLUMNS ROWS
        of your images
    rate : FPS
        frames/s of your scan
    spacing : MM
        distance of voxels
    frames : N
        frames per repeat
    repeats : N
        the median of this many is shown
    json : FILE
        also write the numbers here, to compare later
    """

    size: tuple[int, int] = (640, 480)
    rate: Annotated[float, positive] = 30.0
    spacing: Annotated[float, positive] = DEFAULT_SPACING
    frames: int = 120
    repeats: Annotated[int, count] = 5
    json: Output | None = None


def run(asked: _BenchmarkOptions) -> None:
    """Measure, print, and answer."""
    if asked.frames < 2:
        raise SettingsError("A benchmark takes at least 2 --frames.")
    if not all(LEAST_SIDE <= n <= LARGEST_SIDE for n in asked.size):
        raise SettingsError(f"Input --size must be {LEAST_SIDE} to {LARGEST_SIDE} pixels each way; got {asked.size!r}.")
    with ProgressBar() as progress:
        found = measured_speed(asked.size, asked.rate, asked.spacing, asked.frames, asked.repeats, progress)
    write_json(asked.json, _report(found, asked.spacing))
    size, millions = " x ".join(map(str, found.size)), found.voxels / 1e6
    print(f"{machine()}\nAIFRecon {__version__}; {size} pixels into {millions:.1f} million voxels, with {found.engine}\n")
    rows = [("method", "frames/s", f"at {found.rate:g}/s")]
    rows += [(m, f"{found.rate / share:.0f}", f"{100 * share:.0f}% of the time, {verdict(share)}") for m, share in found.shares.items()]
    print(columns(rows))
    print(f"\n{answer(found.shares, found.size, found.rate)}")
    for text in filter(None, (found.warning, busy_warning(found.busy))):
        print(text)
    if asked.json:
        print(f"\n  wrote {asked.json}")


def _report(found: MeasuredSpeed, spacing: float) -> dict[str, object]:
    """The numbers, for JSON."""
    methods = {
        method: {"seconds_per_frame": seconds, "frames_per_second": 1 / seconds, "live": verdict(seconds * found.rate)}
        for method, seconds in found.seconds.items()
    }
    facts = {name: getattr(found, name) for name in ("size", "rate", "voxels", "engine", "busy")}
    return {"machine": machine(), "version": __version__, "spacing_mm": spacing, **facts, "methods": methods}


def answer(shares: dict[str, float], size: tuple[int, int], rate: float) -> str:
    """In words, whether this machine keeps up, and what helps where it does not; `shares` are of the time there is, by method."""
    by_verdict = {word: [m for m, share in shares.items() if verdict(share) == word] for word in (KEEPS_UP, JUST_KEEPS_UP, TOO_SLOW)}
    sentences = [f"{word} with {_ANY if len(ms) == len(shares) else ', '.join(ms)}" for word, ms in by_verdict.items() if ms]
    text = f"At {rate:g} frames/s of {size[0]} x {size[1]} pixels, this machine {'; '.join(sentences)}."
    if len(by_verdict[KEEPS_UP]) == len(shares):
        return text
    numba = "" if optional_module("AIFReconLib.compounding.compiled.numba_engine") else f"numba ({INSTALL_NUMBA}), "
    return (
        f"{text}\nWhat helps: {numba}larger voxels (--spacing), a smaller part of the image (--clip-px), every second frame (--skip 2).\n"
        "Frames that do not fit are left out evenly and counted; --record keeps them all, to be reconstructed afterwards."
    )

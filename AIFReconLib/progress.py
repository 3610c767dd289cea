"""One way to report progress and to be canceled, for the command line, Slicer and tests alike."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TypeVar, cast

from .errors import OperationCanceled

Progress = Callable[[float, str], bool]
"""Called with a fraction (0 to 1, never decreasing) and what is being done. Returning False means: stop."""

Made = TypeVar("Made")
Steps = Generator[tuple[float, str], None, Made]
"""Work in short steps, for whoever has something else to do between them. Before each it tells fraction and what is being done."""


def report(progress: Progress | None, fraction: float, step: str) -> None:
    """Tell the caller how far the work is, and what is being done.

    Raises OperationCanceled when the caller's function returns False. (None and other values mean: go on.)
    """
    if progress is None:
        return
    if progress(min(max(fraction, 0.0), 1.0), step) is False:
        raise OperationCanceled(f"Canceled in this step: {step}.")


def part(progress: Progress | None, start: float, stop: float) -> Progress | None:
    """A progress function for one stage of a longer task: its 0 to 1 is the caller's `start` to `stop`."""
    if progress is None:
        return None
    return lambda fraction, message: progress(start + (stop - start) * fraction, message)


def carry_out(steps: Steps[Made], progress: Progress | None = None) -> Made:
    """Do all steps, and return what they have made.

    Raises OperationCanceled when `progress` returns False.
    """
    while True:
        try:
            report(progress, *next(steps))
        except StopIteration as end:
            return cast("Made", end.value)

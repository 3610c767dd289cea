"""One way to report progress and to be canceled, for the command line, Slicer and tests alike."""

from __future__ import annotations

from collections.abc import Callable

from .errors import OperationCanceled

Progress = Callable[[float, str], bool]
"""Called with a fraction (0 to 1, never decreasing) and what is being done. Returning False means: stop."""


def report(progress: Progress | None, fraction: float, message: str) -> None:
    """Tell the caller how far the work is.

    Raises
    ------
    OperationCanceled
        When the caller's function returns False. (None and other values mean: go on.)
    """
    if progress is not None and progress(min(max(fraction, 0.0), 1.0), message) is False:
        first_word = message.split(" ", 1)[0]
        message = message if first_word.isupper() else message[:1].lower() + message[1:]
        raise OperationCanceled(f"Canceled while {message}.")


def part(progress: Progress | None, start: float, stop: float) -> Progress | None:
    """A progress function for one stage of a longer task: its 0 to 1 is the caller's `start` to `stop`."""
    if progress is None:
        return None
    return lambda fraction, message: progress(start + (stop - start) * fraction, message)

"""A program that is told to end does so as on Ctrl-C: what is unfinished is cleared away, and a live scan is saved."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from types import FrameType

SIGNALS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name))
"""Sent by `kill`, `timeout`, service managers and a system that shuts down; by a terminal that is closed; by Ctrl-Break."""


INTERRUPTED = "Interrupted. No file is left half-written."

TWICE = 1.0
"""s within which a signal counts once: Ctrl-C comes from the terminal, and from the guard at the door."""

SOON = 0.05
"""s after which a signal is sent again that came where an exception would be swallowed."""

_CALLED_FROM_C = "llvmlite"
"""Package whose functions compiled code calls back: what they raise is printed and lost, and with it the wish to end."""

_IMPORT_CALLBACK = "<frozen importlib._bootstrap>", "cb"
"""File and name of the function that is called when the lock of an import goes: what it raises is lost in the same way."""


class OrderlyEnd:
    """What ended the program, for its exit code.

    Attributes
    ----------
    told : bool
        Whether it was told to end, also where the interrupt was swallowed on its way.
    signal : int
        By what.
    when : float
        s of `time.monotonic`.
    """

    def __init__(self) -> None:
        self.told = False
        self.when = -TWICE
        self.signal = int(signal.SIGINT)

    @property
    def exit_code(self) -> int:
        """128 and the number of the signal, as shells say it."""
        return 128 + self.signal


def _swallows(frame: FrameType | None) -> bool:
    """Whether an exception raised in this frame would not reach us."""
    if frame is None:
        return False
    code = frame.f_code
    return _CALLED_FROM_C in code.co_filename or (code.co_filename, code.co_name) == _IMPORT_CALLBACK


@contextmanager
def _handled(handle: Callable[[int, FrameType | None], None], numbers: Collection[int]) -> Iterator[None]:
    """Within the block these signals are handled so; only in the main thread, which alone hears them."""
    is_main = threading.current_thread() is threading.main_thread()
    before = {number: signal.signal(number, handle) for number in (numbers if is_main else ())}
    try:
        # They wait in a process that the guard has started, until here
        if before and hasattr(signal, "pthread_sigmask"):
            signal.pthread_sigmask(signal.SIG_UNBLOCK, before)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def orderly_end(end: OrderlyEnd | None = None) -> Iterator[OrderlyEnd]:
    """Within the block these signals raise `KeyboardInterrupt` with their number; those that the caller has ignored or handled stay so.

    Only in the main thread: in others nothing changes. What ended the block is kept in `end`.
    """
    end = end or OrderlyEnd()

    def interrupt(number: int, frame: FrameType | None) -> None:
        if end.told and number == end.signal and time.monotonic() - end.when < TWICE:
            return
        if _swallows(frame):
            again = threading.Timer(SOON, signal.raise_signal, [number])
            again.daemon = True
            again.start()
            return
        end.told, end.signal, end.when = True, int(number), time.monotonic()
        raise KeyboardInterrupt(int(number))

    untouched = (signal.SIG_DFL, signal.default_int_handler)
    with _handled(interrupt, [number for number in (signal.SIGINT, *SIGNALS) if signal.getsignal(number) in untouched]):
        yield end


@contextmanager
def heard_in_pauses() -> Iterator[Callable[[float], None]]:
    """Within the block a signal to end is heard in the waits alone for which it hands out a function: it takes seconds, and raises there.

    Elsewhere an exception could come between the taking of a lock and the block that gives it back: whoever wants the lock next waits
    forever, as a scan's threads then would. What came after the last wait is heard at the end of the block.
    """
    came: list[int] = []
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, *SIGNALS)}
    held = {int(number): handler for number, handler in handlers.items() if callable(handler)}

    def hear() -> None:
        if came:
            number = came.pop()
            held[number](number, None)

    def wait(seconds: float) -> None:
        hear()
        time.sleep(seconds)
        hear()

    with _handled(lambda number, _frame: came.append(number), held):
        yield wait
    hear()

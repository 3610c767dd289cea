"""The worker's side: takes calls and answers them, each on a thread of its own, until the program that started it lets go."""

from __future__ import annotations

import contextlib
import inspect
import logging
import os
import pickle
import signal
import threading
import time
import traceback
from multiprocessing.connection import Connection
from typing import Any

from ..errors import WorkerDiedError
from .calls import Call, Cancel, Forget, Kept, Report, Returned
from .channel import Channel

logger = logging.getLogger(__name__)

REPORT_EVERY = 0.05
"""s between two reports of a call."""

LONGEST_END = 60.0
"""s that what is kept has to finish, such as the recording of a scan, when the program has ended."""


class TracebackInWorker(Exception):
    """The cause of an error that came from the worker: where it was raised there."""


def serve(connection: Connection) -> None:
    """Answer calls until the other end is closed; then finish what is kept, and end this process whatever still computes."""
    with contextlib.suppress(ValueError):
        # Ctrl-C is for the program that a user talks to
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    server = _Server(Channel(connection))
    with contextlib.suppress(EOFError, OSError):
        server.run()
    deadline = threading.Timer(LONGEST_END, os._exit, [1])
    deadline.daemon = True
    deadline.start()
    server.close()
    os._exit(0)


class _Server:
    def __init__(self, channel: Channel):
        self._channel = channel
        self._canceled: dict[int, threading.Event] = {}
        self._kept: dict[int, Any] = {}
        self._ending: list[threading.Thread] = []

    def run(self) -> None:
        while True:
            message = self._channel.receive()
            if isinstance(message, Call):
                self._canceled[message.number] = threading.Event()
                threading.Thread(target=self._answer, args=[message], name="aifrecon call", daemon=True).start()
            elif isinstance(message, Cancel) and message.number in self._canceled:
                self._canceled[message.number].set()
            elif isinstance(message, Forget):
                thread = threading.Thread(target=_close, args=[self._kept.pop(message.number, None)], name="aifrecon end", daemon=True)
                thread.start()
                self._ending.append(thread)
            del message  # and with it the arrays that came

    def close(self) -> None:
        for canceled in tuple(self._canceled.values()):
            canceled.set()
        for kept in tuple(self._kept.values()):
            _close(kept)
        for thread in self._ending:
            thread.join()

    def _answer(self, call: Call) -> None:
        number = call.number
        try:
            answer = Returned(number, self._called(call))
        except BaseException as error:
            answer = Returned(number, error=_that_crosses(error))
        del call
        self._canceled.pop(number, None)
        try:
            self._channel.send(answer)
        except OSError:
            logger.warning("The program that asked has ended")
        except Exception as error:  # of what cannot be pickled
            self._channel.send(Returned(number, error=_that_crosses(error)))

    def _called(self, call: Call) -> Any:
        arguments = [self._meant(each) for each in call.arguments]
        named = {name: self._meant(each) for name, each in call.named.items()}
        function = getattr(arguments.pop(0), call.function) if isinstance(call.function, str) else call.function
        if "progress" in inspect.signature(function).parameters:
            named["progress"] = self._progress_of(call.number)
        value = function(*arguments, **named)
        if not call.keep:
            return value
        self._kept[call.number] = value
        return Kept(call.number)

    def _meant(self, argument: Any) -> Any:
        """The argument, or the object that it stands for."""
        if not isinstance(argument, Kept):
            return argument
        if argument.number not in self._kept:
            raise WorkerDiedError("What was under way was lost with the process that computed it. Begin it again.")
        return self._kept[argument.number]

    def _progress_of(self, number: int) -> Any:
        canceled, last = self._canceled[number], (-REPORT_EVERY, "")

        def progress(fraction: float, step: str) -> bool:
            nonlocal last
            now = time.monotonic()
            if now - last[0] >= REPORT_EVERY or step != last[1]:
                last = now, step
                with contextlib.suppress(OSError):
                    self._channel.send(Report(number, fraction, step))
            return not canceled.is_set()

        return progress


def _close(kept: Any) -> None:
    """Let an object end what it does, where it can."""
    close = getattr(kept, "close", None)
    if close is not None:
        try:
            close()
        except Exception:
            logger.exception("%s could not be ended as it should", type(kept).__name__)


def _that_crosses(error: BaseException) -> BaseException:
    """The error, or one in its words where it cannot be sent, with where it was raised as its cause."""
    where = "".join(traceback.format_exception(error))
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        error = RuntimeError(f"{type(error).__name__}: {error}")
    # A cause is not pickled with an error
    error.__dict__["where"] = where
    return error

"""The worker's side: takes calls and answers them, each on a thread of its own, until the program that started it lets go."""

from __future__ import annotations

import contextlib
import faulthandler
import inspect
import logging
import os
import pickle
import threading
import time
import traceback
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from typing import Any

import numpy as np  # noqa: F401  # without it nothing computes, and that is said before the first call

from ..errors import WorkerDiedError
from ..progress import Progress
from .calls import CALL, CANCEL, ERROR, FORGET, LOG, PROGRESS, VALUE, Call, Message, RemoteObject
from .channel import Channel

LIBRARY = "AIFReconLib"
"""Whose log is heard in the program, too."""

MOST_CALLS = 64
"""At a time; more wait for their turn."""

REPORT_EVERY = 0.05
"""s between two reports of a call."""

GIVES_WAY = 5
"""Of 0, as a program begins, to 19: where all cores are wanted, the program's windows are drawn first."""

LONGEST_END = 60.0
"""s that what is kept has to finish, such as the recording of a scan, when the program has ended."""


def serve(connection: Connection, level: int) -> None:
    """Answer calls until the other end is closed; then finish what is kept, and end this process whatever still computes."""
    faulthandler.enable()
    if os.name != "nt":
        os.nice(GIVES_WAY)
    server = _Server(Channel(connection))
    logger = logging.getLogger(LIBRARY)
    logger.setLevel(level)
    logger.addHandler(server)
    logger.propagate = False
    with contextlib.suppress(EOFError, OSError):
        server.run()
    deadline = threading.Timer(LONGEST_END, os._exit, [1])
    deadline.daemon = True
    deadline.start()
    server.end()
    os._exit(0)


class _Server(logging.Handler):
    def __init__(self, channel: Channel):
        super().__init__()
        self._channel = channel
        self._canceled: dict[int, threading.Event] = {}
        self._kept: dict[int, Any] = {}
        self._calls, self._in_order, self._endings = ThreadPoolExecutor(MOST_CALLS), ThreadPoolExecutor(1), ThreadPoolExecutor()

    def run(self) -> None:
        while True:
            number, kind, content = self._channel.receive()
            if kind == CALL:
                self._canceled[number] = threading.Event()
                pool = self._in_order if self._is_short(content) else self._calls
                pool.submit(self._answer, number, content)
            elif kind == CANCEL:
                self._cancel(number)
            elif kind == FORGET:
                self._let_go(number)
            elif kind == ERROR:
                # A call that cannot be understood here
                self._calls.submit(self._send, Message(number, ERROR, _that_crosses(content)))
            del content  # and with it the arrays that came

    def end(self) -> None:
        for canceled in tuple(self._canceled.values()):
            canceled.set()
        for number in tuple(self._kept):
            self._let_go(number)
        self._endings.shutdown()

    def emit(self, record: logging.LogRecord) -> None:
        self._send(Message(-1, LOG, (record.name, record.levelno, self.format(record))))

    def _send(self, message: Message) -> None:
        with contextlib.suppress(ConnectionError):  # nobody hears it any more
            self._channel.send(message)

    def _cancel(self, number: int) -> None:
        if number in self._canceled:
            self._canceled[number].set()
        if number not in self._canceled:
            # It had ended, and nobody has heard what is kept of it
            self._let_go(number)

    def _let_go(self, number: int) -> None:
        """Have a kept object end what it does, if it can, while calls are heard."""
        kept = self._kept.pop(number, None)
        if hasattr(kept, "close"):
            self._endings.submit(_close, kept)

    def _is_short(self, call: Call) -> bool:
        """Whether a call is of a method that tells no progress: those are answered in the order in which they were asked."""
        first = call.arguments[0] if isinstance(call.function, str) else None
        method = getattr(self._kept.get(first.number), str(call.function), None) if isinstance(first, RemoteObject) else None
        return method is not None and "progress" not in inspect.signature(method).parameters

    def _answer(self, number: int, call: Call) -> None:
        canceled = self._canceled[number]
        try:
            answer = Message(number, VALUE, self._called(number, call, canceled))
        except BaseException as error:
            answer = Message(number, ERROR, _that_crosses(error))
        del call, self._canceled[number]
        if canceled.is_set():
            self._let_go(number)
        try:
            self._send(answer)
        except Exception as error:  # it cannot be pickled
            self._send(Message(number, ERROR, _that_crosses(error)))

    def _called(self, number: int, call: Call, canceled: threading.Event) -> Any:
        arguments = [self._meant(each) for each in call.arguments]
        named = {name: self._meant(each) for name, each in call.named.items()}
        function = getattr(arguments.pop(0), call.function) if isinstance(call.function, str) else call.function
        if "progress" in inspect.signature(function).parameters:
            named["progress"] = self._progress(number, canceled)
        value = function(*arguments, **named)
        if not call.keep:
            return value
        self._kept[number] = value
        return RemoteObject(number)

    def _meant(self, argument: Any) -> Any:
        """The argument, or the object that it stands for."""
        if not isinstance(argument, RemoteObject):
            return argument
        if argument.number not in self._kept:
            raise WorkerDiedError("What was under way was lost with the process that computed it.")
        return self._kept[argument.number]

    def _progress(self, number: int, canceled: threading.Event) -> Progress:
        last = -REPORT_EVERY, ""

        def progress(fraction: float, step: str) -> bool:
            nonlocal last
            now = time.monotonic()
            if now - last[0] >= REPORT_EVERY or step != last[1]:
                last = now, step
                self._send(Message(number, PROGRESS, (fraction, step)))
            return not canceled.is_set()

        return progress


def _close(kept: Any) -> None:
    try:
        kept.close()
    except Exception:
        logging.getLogger(__name__).exception("%s could not be ended as it should", type(kept).__name__)


def _that_crosses(error: BaseException) -> BaseException:
    """The error, or one in its words where it cannot be sent or would end the program, with where it was raised as its cause."""
    where = "".join(traceback.format_exception(error))
    try:
        if not isinstance(error, Exception):
            raise TypeError
        pickle.loads(pickle.dumps(error))
    except Exception:
        error = RuntimeError(f"{type(error).__name__}: {error}")
    # A cause is not pickled with an error
    error.__dict__["where"] = where
    return error

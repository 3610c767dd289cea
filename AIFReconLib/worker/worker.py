"""The program's side: a process that works for it, started when first needed, and again when it has died."""

from __future__ import annotations

import contextlib
import itertools
import logging
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

from ..errors import WorkerDiedError
from ..machine.processes import start_python
from ..progress import Progress, report
from .calls import CALL, CANCEL, ERROR, FORGET, LOG, PROGRESS, Call, Message, RemoteObject
from .channel import Channel
from .serving import LIBRARY, serve

LOOK_EVERY = 0.02
"""s between two reports to who waits."""

LONGEST_SILENCE = 5.0
"""s for which a worker may take nothing of what it is sent, or stop in the middle of an answer: one that was stopped is ended then."""

LONGEST_END = 1.0
"""s that a worker has to end once it is not connected any more."""

LONGEST_FAREWELL = 5.0
"""s that a worker has to end."""

STDERR = None if sys.platform == "win32" else 2
"""Where a crash is described: a window of Windows may have no streams."""

AGAIN = "Nothing was changed; try again."


class _TracebackInWorker(Exception):
    """The cause of an error that came from the worker: where it was raised there."""


class Task:
    """A call that the worker is busy with.

    Attributes
    ----------
    latest : (float, str)
        Its last report.
    """

    def __init__(self, worker: Worker, number: int):
        self._worker, self._number = worker, number
        self.latest: tuple[float, str] = (0.0, "")
        self._answer: Message | None = None

    @property
    def is_done(self) -> bool:
        """Whether `result` has something to return or to raise; returns at once."""
        self._worker.listen()
        return self._answer is not None

    def result(self, progress: Progress | None = None) -> Any:
        """What the call returns, waited for; what it raises is raised here.

        Raises OperationCanceled when `progress` returns False; WorkerDiedError.

        Parameters
        ----------
        progress : Progress or None
            Hears of the call every 20 ms at least, and may cancel it.
        """
        try:
            while self._answer is None:
                self._worker.listen(LOOK_EVERY)
                if self._answer is None or self._answer.kind != ERROR:
                    report(progress, *self.latest)
        except BaseException:
            self.cancel()
            if self._answer is not None and isinstance(self._answer.content, RemoteObject):
                self._worker.forget(self._answer.content)
            raise
        if self._answer.kind == ERROR:
            raise self._answer.content
        return self._answer.content

    def cancel(self) -> None:
        """The call is wanted no more: it ends at its next report, and nobody hears of it."""
        self._worker.drop(self._number)

    def take(self, message: Message) -> None:
        """Hear from the worker."""
        if message.kind == PROGRESS:
            self.latest = message.content
            return
        self._answer = message
        where = message.content.__dict__.pop("where", None) if message.kind == ERROR else None
        if where is not None:
            message.content.__cause__ = _TracebackInWorker(f"\n{where}")


class Worker:
    """A process that calls the library's functions for this one. One thread uses it; make one for each thread.

    Notes
    -----
    Functions and classes are named to it, so they must be found by import, those of AIFReconLib as well as others. It ends with this
    process, however that ends, when what is kept there has finished.
    """

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._channel: Channel | None = None
        self._tasks: dict[int, Task] = {}
        self._numbers = itertools.count()
        self._has_spoken = False

    def begin(self, function: Callable[..., Any] | str, *arguments: Any, keep: bool = False, **named: Any) -> Task:
        """Have ``function(*arguments, **named)`` called; returns at once.

        Parameters
        ----------
        function : callable or str
            It is given `progress` where it takes that. A name is a method's, of the first argument, a `RemoteObject`; those that
            take no progress are called one after the other.
        keep : bool
            What it returns stays in the worker; the task's result is a `RemoteObject`.
        """
        self.listen()
        if self._channel is None:
            self._start()
        task = Task(self, number := next(self._numbers))
        self._tasks[number] = task
        try:
            self._send(Message(number, CALL, Call(function, arguments, named, keep)))
        except BaseException:
            self._tasks.pop(number, None)
            raise
        return task

    def call(self, function: Callable[..., Any] | str, *arguments: Any, progress: Progress | None = None, **named: Any) -> Any:
        """What a function returns, as for `begin`; `progress` hears of it and may cancel it. Errors as of `Task.result`."""
        return self.begin(function, *arguments, **named).result(progress)

    def keep(self, function: Callable[..., Any], *arguments: Any, progress: Progress | None = None, **named: Any) -> RemoteObject:
        """As `call`, but what is returned stays in the worker. When that ends it is closed, where it has `close`."""
        kept: RemoteObject = self.call(function, *arguments, progress=progress, keep=True, **named)
        return kept

    def forget(self, kept: RemoteObject) -> None:
        """Close what is kept, where it has `close`, and let it go."""
        self._send(Message(kept.number, FORGET))

    @property
    def pid(self) -> int | None:
        """Of the process; None where there is none."""
        return None if self._process is None else self._process.pid

    def close(self) -> None:
        """End the process, when what is kept there has finished."""
        process, channel = self._process, self._channel
        self._lose("The worker was closed.")
        if channel is not None and process is not None:
            channel.close()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(LONGEST_FAREWELL)

    def listen(self, timeout: float = 0.0) -> None:
        """Hear what the worker says, waited for so many s where it says nothing, and for little longer where it says much."""
        if self._channel is None or self._process is None:
            return
        # Seen before: what it has said before its end is heard
        has_ended = self._process.poll() is not None
        enough = time.monotonic() + timeout + LOOK_EVERY
        try:
            while self._channel is not None and self._channel.poll(timeout):
                self._hear(self._channel.receive())
                timeout = 0.0
                if time.monotonic() > enough:
                    return
        except (EOFError, OSError):
            has_ended = True
        if has_ended:
            self._died()

    def drop(self, number: int) -> None:
        """Cancel a call; what it says from now on is not heard."""
        if self._tasks.pop(number, None) is not None:
            self._send(Message(number, CANCEL))

    def _hear(self, message: Message) -> None:
        self._has_spoken = True
        if message.kind == LOG:
            name, level, text = message.content
            logging.getLogger(name).log(level, "%s", text)
            return
        task = self._tasks.get(message.number)
        if message.kind != PROGRESS:
            self._tasks.pop(message.number, None)
        if task is not None:
            task.take(message)

    def _send(self, message: Message) -> None:
        if self._channel is None:
            return
        try:
            self._channel.send(message)
        except ConnectionError:
            self._died()

    def _start(self) -> None:
        try:
            # In a session of its own: Ctrl-C and the end of a terminal are for the program, which says when the worker ends
            self._process, connection = start_python(serve, logging.getLogger(LIBRARY).getEffectiveLevel(), stderr=STDERR)
        except OSError as error:
            raise WorkerDiedError(f"The process that computes could not be started ({error}). {AGAIN}") from error
        self._channel, self._has_spoken = Channel(connection, LONGEST_SILENCE), False

    def _died(self) -> None:
        """Say how it ended to whoever waits for it; one that has not ended is ended."""
        process, channel = self._process, self._channel
        if process is None or channel is None:
            return
        channel.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(LONGEST_END)
        code = process.poll()
        # And what it has started, or that which has started it, as Slicer's own Python is
        with contextlib.suppress(OSError):
            process.kill()
            if sys.platform != "win32":
                os.killpg(process.pid, signal.SIGTERM)
        if code is None:
            how = "did not answer and was ended"
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(LONGEST_END)
        elif code < 0:
            how = f"was ended by signal {-code}, perhaps for want of memory"
        else:
            how = f"ended with code {code}" if self._has_spoken else f"could not be started: it ended with code {code}"
        self._lose(f"The process that computes {how}. {AGAIN}")

    def _lose(self, why: str) -> None:
        """There is no process any more, and whoever waits for it hears that."""
        lost, self._tasks = self._tasks, {}
        self._process = self._channel = None
        for number, task in lost.items():
            task.take(Message(number, ERROR, WorkerDiedError(why)))

"""The program's side: a process that works for it, started when first needed, and again when it has died."""

from __future__ import annotations

import itertools
import multiprocessing
import sys
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.process import BaseProcess
from typing import Any

from ..errors import OperationCanceled, WorkerDiedError
from ..machine.processes import python_program
from ..progress import Progress, report
from .calls import Call, Cancel, Forget, Kept, Report, Returned
from .channel import Channel
from .serving import TracebackInWorker, serve

LOOK_EVERY = 0.02
"""s between two reports to who waits."""

LONGEST_FAREWELL = 5.0
"""s that a worker has to end."""


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
        self._returned: Returned | None = None

    @property
    def is_done(self) -> bool:
        """Whether `result` has something to return or to raise; returns at once."""
        self._worker.listen()
        return self._returned is not None

    def result(self, progress: Progress | None = None) -> Any:
        """What the call returns, waited for; what it raises is raised here.

        Parameters
        ----------
        progress : Progress or None
            Hears of the call every 20 ms at least, and may cancel it.

        Raises
        ------
        OperationCanceled
            When `progress` returns False.
        WorkerDiedError
        """
        while self._returned is None:
            self._worker.listen(LOOK_EVERY)
            if progress is not None and self._returned is None and progress(*self.latest) is False:
                self.cancel()
                raise OperationCanceled(f"Canceled in this step: {self.latest[1]}.")
        if self._returned.error is not None:
            where = self._returned.error.__dict__.pop("where", None)
            raise self._returned.error from (TracebackInWorker(f"\n{where}") if where else None)
        report(progress, *self.latest)
        return self._returned.value

    def cancel(self) -> None:
        """The call is wanted no more: it ends at its next report, and nobody hears of it."""
        self._worker.drop(self._number)

    def take(self, message: Report | Returned) -> None:
        """Hear from the worker."""
        if isinstance(message, Report):
            self.latest = message.fraction, message.step
        else:
            self._returned = message


class Worker:
    """A process that calls the library's functions for this one. To be used from one thread.

    Notes
    -----
    Functions and classes are named to it, so they must be found by import, those of AIFReconLib as well as others. It ends with this
    process, however that ends, when what is kept there has finished.
    """

    def __init__(self) -> None:
        self._process: BaseProcess | None = None
        self._channel: Channel | None = None
        self._tasks: dict[int, Task] = {}
        self._numbers = itertools.count()

    def begin(self, function: Callable[..., Any] | str, *arguments: Any, keep: bool = False, **named: Any) -> Task:
        """Have ``function(*arguments, **named)`` called; returns at once.

        Parameters
        ----------
        function : callable or str
            It is given `progress` where it takes that. A name is a method's, of the first argument, which is `Kept`.
        keep : bool
            What it returns stays in the worker; the task's result is `Kept`.
        """
        return self._begin(function, arguments, named, keep)

    def call(self, function: Callable[..., Any] | str, *arguments: Any, progress: Progress | None = None, **named: Any) -> Any:
        """What a function returns, as for `begin`; `progress` hears of it and may cancel it. Errors as of `Task.result`."""
        return self._begin(function, arguments, named).result(progress)

    def keep(self, function: Callable[..., Any], *arguments: Any, progress: Progress | None = None, **named: Any) -> Kept:
        """As `call`, but what is returned stays in the worker. When that ends it is closed, where it has `close`."""
        kept: Kept = self._begin(function, arguments, named, keep=True).result(progress)
        return kept

    def forget(self, kept: Kept) -> None:
        """Close what is kept, where it has `close`, and let it go."""
        self._send(Forget(kept.number))

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
            process.join(LONGEST_FAREWELL)

    def listen(self, timeout: float = 0.0) -> None:
        """Hear what the worker says, waited for so many s where it says nothing."""
        try:
            while self._channel is not None and self._channel.poll(timeout):
                message, timeout = self._channel.receive(), 0.0
                task = self._tasks.get(message.number)
                if isinstance(message, Returned):
                    self._tasks.pop(message.number, None)
                if task is not None:
                    task.take(message)
                elif isinstance(message, Returned) and isinstance(message.value, Kept):
                    self.forget(message.value)  # of a call that is wanted no more
        except (EOFError, OSError):
            self._died()

    def drop(self, number: int) -> None:
        """Cancel a call; what it says from now on is not heard."""
        if self._tasks.pop(number, None) is not None:
            self._send(Cancel(number))

    def _begin(self, function: Callable[..., Any] | str, arguments: tuple[Any, ...], named: dict[str, Any], keep: bool = False) -> Task:
        if self._channel is None or self._process is None or not self._process.is_alive():
            self._start()
        task = Task(self, next(self._numbers))
        self._tasks[task._number] = task
        self._send(Call(task._number, function, arguments, named, keep))
        return task

    def _send(self, message: object) -> None:
        if self._channel is None:
            return
        try:
            self._channel.send(message)
        except (BrokenPipeError, ConnectionError):
            self._died()

    def _start(self) -> None:
        self._died()
        context = multiprocessing.get_context("spawn")
        context.set_executable(python_program())
        ours, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=[theirs], name="AIFRecon worker", daemon=True)
        with _nothing_to_run_again():
            self._process.start()
        theirs.close()
        self._channel = Channel(ours)

    def _died(self) -> None:
        if self._process is None:
            return
        self._process.join(LONGEST_FAREWELL)
        code = self._process.exitcode
        how = "does not answer" if code is None else f"was ended by signal {-code}" if code < 0 else f"ended with code {code}"
        if self._channel is not None:
            self._channel.close()
        self._lose(f"The process that computes {how}, perhaps for want of memory. Nothing was changed; try again.")

    def _lose(self, why: str) -> None:
        """There is no process any more, and whoever waits for it hears that."""
        lost, self._tasks = self._tasks, {}
        self._process = self._channel = None
        for number, task in lost.items():
            task.take(Returned(number, error=WorkerDiedError(why)))


@contextmanager
def _nothing_to_run_again() -> Iterator[None]:
    """A spawned process runs the main program's file again, to find what that defines: here it is asked for nothing of it."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = types.ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main

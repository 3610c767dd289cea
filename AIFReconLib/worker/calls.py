"""What crosses between a program and its worker: calls, what becomes of them, and names of objects that stay in the worker."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple


class RemoteObject(NamedTuple):
    """An object that stays in the worker; given as an argument it stands for that object. `Worker.forget` lets it go."""

    number: int


class Call(NamedTuple):
    """``function(*arguments, **named)``, with `progress` where the function takes it."""

    number: int
    function: Callable[..., Any] | str  #: The name of a method: of the first argument, which is kept
    arguments: tuple[Any, ...] = ()
    named: Mapping[str, Any] = {}
    keep: bool = False  #: What is returned stays in the worker, as `RemoteObject` of this number


CANCEL, FORGET, RECEIVED = "cancel", "forget", "received"


class Told(NamedTuple):
    """A call is wanted no more and ends at its next report; what is kept of it is; or what it returned has come."""

    number: int
    what: str  #: `CANCEL`, `FORGET` or `RECEIVED`


class ProgressReport(NamedTuple):
    """How far a call is: fraction, 0 to 1, and what is being done."""

    number: int
    fraction: float
    step: str


class Returned(NamedTuple):
    """A call has ended, with a value or with an error."""

    number: int
    value: Any = None
    error: BaseException | None = None


class Logged(NamedTuple):
    """What the library notes for a log, of no call."""

    name: str
    level: int
    text: str
    number: int = -1


Message = Call | Told | ProgressReport | Returned | Logged

"""What crosses between a program and its worker: calls, what becomes of them, and names of objects that stay in the worker."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple


class RemoteObject(NamedTuple):
    """An object that stays in the worker; given as an argument it stands for that object. `Worker.forget` lets it go."""

    number: int


class Call(NamedTuple):
    """``function(*arguments, **named)``, with `progress` where the function takes it."""

    function: Callable[..., Any] | str  #: The name of a method: of the first argument, which is kept
    arguments: tuple[Any, ...]
    named: Mapping[str, Any]
    keep: bool  #: What is returned stays in the worker, as `RemoteObject` of this call's number


CALL, CANCEL, FORGET = "call", "cancel", "forget"
"""From the program: a call is wanted; it is wanted no more and ends at its next report; what is kept of it is."""

PROGRESS, VALUE, ERROR, LOG = "progress", "value", "error", "log"
"""From the worker: (fraction, what is being done) of a call; it has ended, with a value or an error; (logger, level, text) of no call."""


class Message(NamedTuple):
    """What one side tells the other of a call, by its number."""

    number: int
    kind: str
    content: Any = None

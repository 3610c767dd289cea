"""What crosses between a program and its worker: calls, what becomes of them, and names of objects that stay in the worker."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Kept:
    """An object that stays in the worker; given as an argument it stands for that object. `Worker.forget` lets it go."""

    number: int


@dataclass(frozen=True)
class Call:
    """``function(*arguments, **named)``, with `progress` where the function takes it."""

    number: int
    function: Callable[..., Any] | str  #: The name of a method: of the first argument, which is kept
    arguments: tuple[Any, ...] = ()
    named: Mapping[str, Any] = field(default_factory=dict)
    keep: bool = False  #: What is returned stays in the worker, as `Kept` of this number


@dataclass(frozen=True)
class Cancel:
    """A call is wanted no more: it ends at its next report."""

    number: int


@dataclass(frozen=True)
class Forget:
    """A `Kept` object is needed no more."""

    number: int


@dataclass(frozen=True)
class Report:
    """How far a call is: fraction, 0 to 1, and what is being done."""

    number: int
    fraction: float
    step: str


@dataclass(frozen=True)
class Returned:
    """A call has ended, with a value or with an error."""

    number: int
    value: Any = None
    error: BaseException | None = None


@dataclass(frozen=True)
class Logged:
    """What the library notes for a log, of no call."""

    name: str
    level: int
    text: str
    number: int = -1


Message = Call | Cancel | Forget | Report | Returned | Logged

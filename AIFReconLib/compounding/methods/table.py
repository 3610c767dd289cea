"""The table of methods: the built-in ones, and those of the user's own that somebody has registered.

The list of the latter is the one thing here that outlives a call. It is filled by whoever imports the module that holds a method; a name
that comes from elsewhere, such as from the header of a volume, finds a method in it or nothing: no module is imported because a file
names it.
"""

from __future__ import annotations

import re
from typing import Literal

from ...errors import MethodError
from ...message import listed
from .aif import AIF, AIF_COMPENSATED
from .average import AVERAGE
from .latest import LATEST
from .maximum import MAXIMUM
from .method import CompoundingMethod
from .weighted import WEIGHTED

BUILT_IN = (AVERAGE, LATEST, MAXIMUM, AIF, AIF_COMPENSATED, WEIGHTED)
"""In the order in which they are listed everywhere."""

OWN_METHOD = "module:function"
"""How a method of the user's own is called: the function, and the module that holds it."""

MethodName = Literal["average", "latest", "maximum", "aif", "aif-compensated", "weighted"]
"""Their names, for type checkers; a test compares."""

METHODS = tuple(method.name for method in BUILT_IN)
BONE_METHODS = tuple(method.name for method in BUILT_IN if method.needs_bone)
"""Methods that need a bone map and the direction of the beams."""
LINEAR_METHODS = tuple(method.name for method in BUILT_IN if method.spread is not None)
IN_WORDS = "; ".join(f"{method.name}: {method.words}" for method in BUILT_IN)
DEFAULT_METHOD_WITH_BONE, DEFAULT_METHOD_WITHOUT_BONE = WEIGHTED.name, AVERAGE.name
COMPARED_METHODS = tuple(method.name for method in BUILT_IN if method.compared)

_TABLE: dict[str, CompoundingMethod] = {method.name: method for method in BUILT_IN}


def is_own_method(name: str) -> bool:
    """Whether a name is that of a method of the user's own, `OWN_METHOD`; whether there is one is not asked."""
    return re.fullmatch(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*", name) is not None


def registered_methods() -> tuple[str, ...]:
    """The names of all methods of the user's own that are known, in the order in which they were registered."""
    return tuple(_TABLE)[len(BUILT_IN) :]


def enter(method: CompoundingMethod) -> None:
    """Put a method of the user's own into the table; it takes the place of an earlier one of its name."""
    _TABLE[method.name] = method


def method_named(name: str | CompoundingMethod) -> CompoundingMethod:
    """The method of that name, built in or registered, or itself; a MethodError when there is none."""
    if isinstance(name, CompoundingMethod):
        return name
    if name in _TABLE:
        return _TABLE[name]
    if is_own_method(name):
        raise MethodError(
            f"Method {name} is not known: no module that registers it was imported.",
            "Import {module} first, or choose another {method}: {methods}.",
            module=name.partition(":")[0],
            methods=listed(_TABLE),
        )
    raise MethodError(f"Method {name} is not known. Choose one of {listed(_TABLE)}.")

"""Signals and slots as PythonQt has them: by signature or by attribute, with as many arguments as the slot takes.

An exception in a slot does not reach the code that caused the signal, in PythonQt as here; the host keeps it, so that a test can
tell that a slot failed (`SlotErrors.take`).
"""

from __future__ import annotations

import functools
import inspect
import sys
import traceback

from PySide6 import QtCore

_QT_SIGNALS: dict[tuple[type, int], dict[str, list[str]]] = {}


class SlotErrors:
    """The exceptions that slots have raised since the last `take`."""

    caught: list[BaseException] = []

    @classmethod
    def take(cls) -> list[BaseException]:
        errors, cls.caught = cls.caught, []
        return errors


def accepted_count(function) -> int | None:
    """How many positional arguments PythonQt passes to a slot; None: all there are.

    Functions and bound methods without `*args` get what they have parameters for (a default value does not protect a parameter);
    any other callable gets everything.
    """
    method = inspect.ismethod(function)
    plain = function.__func__ if method else function
    if not inspect.isfunction(plain) or plain.__code__.co_flags & inspect.CO_VARARGS:
        return None
    return plain.__code__.co_argcount - method


def guarded(function, wrap=lambda value: value):
    """A callable for Qt that passes the arguments on as PythonQt would and keeps an exception for the tests."""
    count = accepted_count(function)

    @functools.wraps(function, assigned=(), updated=())
    def call(*args):
        try:
            return function(*(wrap(argument) for argument in args[:count]))
        except Exception as error:
            SlotErrors.caught.append(error)
            traceback.print_exc(file=sys.stderr)

    del call.__wrapped__
    return call


def tables_of(native: type) -> list[dict]:
    """The tables of what the stand-ins among a class and its bases offer; empty for a class of Qt."""
    return [base.__dict__["api"] for base in native.__mro__ if "api" in base.__dict__]


def signals_of(native, name: str) -> dict[str, str]:
    """The signals of that name: C++ signature to the name by which PySide6 knows it, in C++ order; empty where there is none."""
    kind: type = type(native)
    found = _offered_signals(kind, name)
    return {signature: signature for signature in _qt_signals(native).get(name, ())} if found is None else found


@functools.cache
def _offered_signals(kind: type, name: str) -> dict[str, str] | None:
    """The signals of that name that the stand-ins among a class and its bases offer; None where only Qt may have one."""
    for table in tables_of(kind):
        found = {signature: attribute for signature, attribute in table.get("signals", {}).items() if signature.split("(")[0] == name}
        if found:
            return found
    private = {attribute for table in tables_of(kind) for attribute in table.get("signals", {}).values()}
    return {} if name in private else None


def _qt_signals(native) -> dict[str, list[str]]:
    """The C++ signatures of a Qt object's signals by name. Asked of Qt once for a class: it tells of its methods one at a time."""
    meta = native.metaObject()
    key = type(native), meta.methodCount()
    if key not in _QT_SIGNALS:
        found = _QT_SIGNALS[key] = {}
        for method in (meta.method(i) for i in range(meta.methodCount())):
            if method.methodType() == QtCore.QMetaMethod.MethodType.Signal:
                signature = bytes(method.methodSignature().data()).decode()
                found.setdefault(signature.split("(")[0], []).append(signature)
    return _QT_SIGNALS[key]


def parameters(signature: str) -> list[str]:
    """The types of a signature's parameters."""
    inside = signature[signature.index("(") + 1 : signature.rindex(")")]
    return inside.split(",") if inside else []


class BoundSignal:
    """A signal of one object: `connect`, `disconnect`, `emit`, and a call, which emits.

    Parameters
    ----------
    owner : Wrapper
        The object.
    signals : dict of str to str
        C++ signature to the name by which PySide6 knows the signal. The first is the one that is meant.
    """

    def __init__(self, owner, signals: dict[str, str]):
        self._owner = owner
        self._signals = signals

    def _signature(self) -> str:
        # The declared form comes before the shorter ones that default arguments add
        return next(iter(self._signals))

    def connect(self, slot):
        return connect(self._owner, self._signature(), slot)

    def disconnect(self, *slot):
        """Disconnects a callable, or all of them; False where it was not connected."""
        return disconnect(self._owner, self._signature(), *slot)

    def emit(self, *args):
        self(*args)

    def __call__(self, *args):
        for signature, attribute in self._signals.items():
            if len(parameters(signature)) == len(args):
                native = self._owner._object
                signal = getattr(native, attribute.split("(")[0])
                if "(" in attribute and parameters(attribute):
                    signal = signal[",".join(parameters(attribute))]
                signal.emit(*map(self._owner._unwrap, args))
                return
        raise ValueError(f"Called {self._signature()} with wrong arguments: {args!r}")


class _Registry:
    """Which callable is connected to what: by id of the PySide6 object, as long as that object lives."""

    entries: dict[int, list] = {}

    @classmethod
    def of(cls, native) -> list:
        if id(native) not in cls.entries:
            cls.entries[id(native)] = []
            native.destroyed.connect(functools.partial(cls._forget, id(native)))
        return cls.entries[id(native)]

    @classmethod
    def _forget(cls, key, *_):
        cls.entries.pop(key, None)


def resolve(owner, signal: str) -> tuple[str, str]:
    """The normalized C++ signature of a signal and PySide6's name of it; raises RuntimeError where the class lacks it."""
    normalized = bytes(QtCore.QMetaObject.normalizedSignature(signal.lstrip("0123456789")).data()).decode()
    known = signals_of(owner._object, normalized.split("(")[0])
    if normalized not in known:
        raise RuntimeError(f"signal '{normalized}' does not exist on {type(owner).__name__}; it has {sorted(known) or 'none of that name'}")
    return normalized, known[normalized]


def connect(owner, signal: str, receiver) -> bool:
    """Connects a callable to a signal given by its signature; True.

    Slicer only prints a line where the signal does not exist; here that is a RuntimeError, since nobody reads that line in a test.
    """
    if not callable(receiver):
        raise TypeError(f"a slot must be callable; got {receiver!r}")
    signature, attribute = resolve(owner, signal)
    native = owner._object
    slot = guarded(receiver, owner._wrap)
    if "(" in attribute:
        connection = QtCore.QObject.connect(native, QtCore.SIGNAL(attribute), slot)
    else:
        connection = getattr(native, attribute).connect(slot)
    # The PySide6 wrapper is kept: were it to go, PySide6 could hand out its id for another object
    _Registry.of(native).append((signature, receiver, connection, slot, native))
    return True


def disconnect(owner, signal: str, receiver=None) -> bool:
    """Disconnects a callable, or all of them where none is given; False where nothing was connected."""
    signature, _ = resolve(owner, signal)
    entries = _Registry.of(owner._object)
    gone = [entry for entry in entries if entry[0] == signature and (receiver is None or entry[1] == receiver)]
    for entry in gone:
        QtCore.QObject.disconnect(entry[2])
        entries.remove(entry)
    return bool(gone)

"""Qt objects as PythonQt shows them: properties are attributes, and what C++ does not offer is an AttributeError.

Slicer's Python reaches Qt through PythonQt, which is property based; PySide6, which is installed here, is method based. Every Qt
object that a module gets hold of is therefore a wrapper around the PySide6 object. A name is looked up as PythonQt does it: Qt
property first (so `label.text` is a string, and `label.text()` fails), then signal or method; dynamic properties and children by name,
which PythonQt finds too, are not found here. Setting a name that is no property raises AttributeError, unless a Python class derives
from the Qt class. A stand-in for a class of CTK or Slicer shows only what its table `api` admits, beside what it
inherits from Qt.
"""

from __future__ import annotations

import enum
import functools
import inspect
import math
import weakref
from collections.abc import Callable
from typing import Any, ClassVar

import shiboken6
from PySide6 import QtCore, QtWidgets

from .connections import BoundSignal, connect, disconnect, guarded, signals_of

_BUILTIN = ("PySide6.", "Shiboken")

_PYSIDE_ONLY = (
    *("buttonText", "connectNotify", "create", "disconnectNotify", "emit", "find", "internalWinId", "isTopLevel", "painters", "receivers"),
    *("setButtonText", "standardIcon", "staticMetaObject", "topLevelWidget", "updateMicroFocus"),
)
"""Names that PySide6 has of Qt's classes and Slicer's Python has not; a test compares with the names that the application told."""


class EnumValue(int):
    """An enumeration value: an int, as in PythonQt, that remembers its Qt type so that PySide6 accepts it back.

    Parameters
    ----------
    native : enum.Enum
        The value as PySide6 has it; flags may be combined with `|`, `&` and `~`.
    """

    def __new__(cls, native):
        value = int.__new__(cls, native.value if isinstance(native.value, int) else 0)
        value.native = native
        return value

    def __or__(self, other):
        return EnumValue(self.native | unwrap(other))


class PythonQtMeta(type):
    """Class attributes of wrapped classes: static methods and enumeration values."""

    def __getattr__(cls, name):
        native = cls._native
        if native is not None and not name.startswith("_") and is_offered(native, name):
            found = getattr(native, name, None)
            if isinstance(found, enum.Enum):
                return EnumValue(found)
            if callable(found) and not isinstance(found, type):
                return lambda *args: wrap(found(*map(unwrap, args)))
        raise AttributeError(f"type object '{cls.__name__}' has no attribute '{name}'")


def _filtering(native, owner) -> type:
    """A Qt class whose event filter is that of a Python class which derives from its wrapper."""

    class Filtering(native):
        def eventFilter(self, watched, event):
            wrapper = owner()
            return wrapper is not None and bool(wrapper.eventFilter(wrap(watched), wrap(event)))

    return Filtering


class Wrapper(metaclass=PythonQtMeta):
    """A Qt object, or a value such as a color, as PythonQt shows it. Derived classes are made by `wrapper_class`."""

    __slots__ = ("__weakref__", "_destroyed", "_object")
    _native = None
    _wrappers: weakref.WeakValueDictionary = weakref.WeakValueDictionary()
    _wrap: ClassVar[Callable]
    _unwrap: ClassVar[Callable]

    def __init__(self, *args):
        native = type(self)._native
        if issubclass(native, QtCore.QObject) and any("eventFilter" in vars(each) for each in type(self).__mro__):
            native = _filtering(native, weakref.ref(self))
        self._adopt(native(*map(unwrap, args)))

    def _adopt(self, native):
        object.__setattr__(self, "_object", native)
        object.__setattr__(self, "_destroyed", False)
        Wrapper._wrappers[id(native)] = self
        if isinstance(native, QtCore.QObject):
            # PySide6 does not hear of the end of every object that C++ made and deletes
            native.destroyed.connect(functools.partial(_mark_destroyed, weakref.ref(self)))

    def __bool__(self):
        # Slicer 5.13 tells that a layout is false, whatever it holds; so `childWidgetVariables` passes layouts over
        return not self._destroyed and shiboken6.isValid(self._object) and not isinstance(self._object, QtWidgets.QLayout)

    def __getattr__(self, name):
        """A property's value, a method or a signal."""
        if name.startswith("_"):
            raise AttributeError(f"{type(self).__name__} has no attribute named '{name}'")
        native = _object(self)
        if _is_gone(self, native):
            raise ValueError(f"Trying to use '{name}' of a destroyed {type(self).__name__} object")
        if isinstance(native, QtCore.QObject):
            position = property_index(native, name)
            if position >= 0:
                return wrap(_read(native, native.metaObject().property(position)))
            if signals := signals_of(native, name):
                return BoundSignal(self, signals)
        if is_offered(type(native), name):
            found = getattr(native, name, None)
            if callable(found) and not isinstance(found, type):
                return lambda *args: wrap(found(*map(unwrap, args)))
        raise AttributeError(f"{type(self).__name__} has no attribute named '{name}'")

    def __setattr__(self, name, value):
        """Sets a property, or, in a Python class that derives from a Qt class, an attribute."""
        native = _object(self)
        kind = type(self).__name__
        if _is_gone(self, native):
            raise AttributeError(f"Trying to set property '{name}' on a destroyed {kind} object")
        if isinstance(native, QtCore.QObject):
            position = property_index(native, name)
            if position >= 0:
                _write(native, native.metaObject().property(position), value, kind)
                return
            if signals_of(native, name):
                raise AttributeError(f"Signal '{name}' can not be overwritten on {kind} object")
        if is_offered(type(native), name):
            raise AttributeError(f"Slot '{name}' can not be overwritten on {kind} object")
        if "_generated" not in type(self).__dict__:
            object.__setattr__(self, name, value)
        else:
            raise AttributeError(f"'{name}' does not exist on {kind} and creating new attributes on C++ objects is not allowed")

    def connect(self, signal, receiver, slot=None):
        """Connects `signal`, such as "clicked(bool)", to a callable, or to a slot of another Qt object."""
        return connect(self, signal, receiver if slot is None else getattr(receiver, slot.split("(")[0]))

    def disconnect(self, signal, receiver=None):
        """Disconnects a callable, or everything, from a signal; False where it was not connected."""
        return disconnect(self, signal, receiver)


def _mark_destroyed(reference, *_):
    wrapper = reference()
    if wrapper is not None:
        object.__setattr__(wrapper, "_destroyed", True)


def _object(wrapper):
    try:
        return object.__getattribute__(wrapper, "_object")
    except AttributeError:
        raise AttributeError(f"{type(wrapper).__name__} was not initialized: call super().__init__() first") from None


def _is_gone(wrapper, native) -> bool:
    return isinstance(native, QtCore.QObject) and (wrapper._destroyed or not shiboken6.isValid(native))


def property_index(native, name: str) -> int:
    """The number of a Qt property, -1 where there is none; `name` stands for `objectName`, as Slicer builds PythonQt."""
    position = native.metaObject().indexOfProperty(name)
    if position < 0 and name == "name":
        return native.metaObject().indexOfProperty("objectName")
    return position


def _read(native, meta):
    getter = getattr(type(native), meta.name(), None)
    if callable(getter) and not isinstance(getter, QtCore.Property):
        return getattr(native, meta.name())()
    return native.property(meta.name())


def converted(value, type_name: str):
    """A Python value as PythonQt makes it for a property of that C++ type; raises TypeError or ValueError where it cannot."""
    if isinstance(value, Wrapper | EnumValue):
        return unwrap(value)
    if type_name in ("int", "uint"):
        return math.floor(value) if type(value) is float else int(value.__index__() if hasattr(value, "__index__") else _refuse(value))
    if type_name in ("double", "float"):
        return float(value if not isinstance(value, str) else _refuse(value))
    if type_name == "bool":
        return bool(value)
    if type_name == "QString":
        return str(value)
    if type_name == "QStringList":
        return [str(item) for item in (value if not isinstance(value, str) else _refuse(value))]
    return unwrap(value)


def _refuse(value):
    raise TypeError(f"not accepted: {value!r}")


def _write(native, meta, value, kind):
    if not meta.isWritable():
        raise AttributeError(f"Property '{meta.name()}' of {kind} object is not writable")
    try:
        value = converted(value, meta.typeName())
        setter = getattr(native, f"set{meta.name()[0].upper()}{meta.name()[1:]}", None)
        if setter is not None and "api" not in type(native).__dict__:
            setter(value)
            return
        accepted = native.setProperty(meta.name(), value)
    except (TypeError, ValueError, OverflowError):
        accepted = False
    if not accepted:
        raise AttributeError(
            f"Property '{meta.name()}' of type '{meta.typeName()}' does not accept an object of type {type(value).__name__} ({value!r})"
        )


@functools.cache
def is_offered(native: type, name: str) -> bool:
    """Whether C++ offers a method or enumeration of that name on a class."""
    if name in _PYSIDE_ONLY:
        return False
    for base in native.__mro__:
        if base.__module__.startswith(_BUILTIN):
            if name in base.__dict__:
                return True
        elif name in base.__dict__.get("api", {}).get("methods", ()) or name in base.__dict__.get("api", {}).get("enums", ()):
            return True
    # PySide6 resolves the values of scoped enumerations by its own metaclass, so they are in no __dict__
    qt = next((base for base in native.__mro__ if base.__module__.startswith(_BUILTIN)), None)
    return qt is not None and isinstance(inspect.getattr_static(qt, name, None) or getattr(qt, name, None), enum.Enum)


def wrapper_class(native: Any) -> type:
    """The wrapper class of a PySide6 class or of a stand-in; the same one every time."""
    made = native.__dict__.get("_wrapper_class") if not native.__module__.startswith(_BUILTIN) else _MADE.get(native)
    if made is None:
        namespace = {"_native": native, "_generated": True, "__slots__": (), "__module__": "PythonQt"}
        made = PythonQtMeta(native.__name__, (Wrapper,), namespace)
        if native.__module__.startswith(_BUILTIN):
            _MADE[native] = made
        else:
            native._wrapper_class = made
    return made


_MADE: dict[type, type] = {}


def wrap(value):
    """A PySide6 result as PythonQt shows it; a list as a tuple; anything that is not Qt's as it is."""
    if isinstance(value, enum.Enum):
        return EnumValue(value)
    if type(value) in (list, tuple):
        # PythonQt makes a tuple of every list that it hands to Python
        return tuple(wrap(item) for item in value)
    if isinstance(value, shiboken6.Object):
        known = Wrapper._wrappers.get(id(value))
        if known is not None and known._object is value:
            return known
        made = object.__new__(wrapper_class(type(value)))
        made._adopt(value)
        return made
    return value


def unwrap(value):
    """What PySide6 takes for a value that came from a module: the PySide6 object, class or enumeration, a guarded callable."""
    if isinstance(value, Wrapper):
        native = _object(value)
        if _is_gone(value, native):
            raise ValueError(f"A destroyed {type(value).__name__} object was given to Qt")
        return native
    if isinstance(value, EnumValue):
        return value.native
    if isinstance(value, PythonQtMeta):
        return value._native
    if type(value) in (list, tuple):
        return type(value)(unwrap(item) for item in value)
    if inspect.isfunction(value) or inspect.ismethod(value):
        return guarded(value, wrap)
    return value


# For signals, which know of wrappers only what these tell them
Wrapper._wrap, Wrapper._unwrap = staticmethod(wrap), staticmethod(unwrap)

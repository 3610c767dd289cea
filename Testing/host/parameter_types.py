"""How a parameter of each type is kept in a vtkMRMLScriptedModuleNode: the keys and words are Slicer's, so scenes are interchangeable.

bool "True" or "False"; numbers, str and paths by str(); an enumeration by its member's name; a node as a node reference beside an
empty parameter; `A | B | None` under the name with ".0", ".1", ... of the member that applies; a list under ".len", ".0", ".1", ....
A list that is read is a plain one: what is put into it does not reach the node. Other types are not supported here.
"""

from __future__ import annotations

import enum
import pathlib
import types
import typing
from dataclasses import dataclass

import slicer


class Validator:
    """A rule for a parameter's value, told by `validate`."""

    validate: typing.Callable


@dataclass
class WithinRange(Validator):
    """From minimum to maximum, both allowed."""

    minimum: float
    maximum: float

    def validate(self, value) -> None:
        if not self.minimum <= value <= self.maximum:
            raise ValueError(f"Value must be within range [{self.minimum}, {self.maximum}], is {value}")


@dataclass
class Minimum(Validator):
    """Not below."""

    minimum: float

    def validate(self, value) -> None:
        if value < self.minimum:
            raise ValueError(f"Value must be greater than {self.minimum}, is {value}")


class Stored:
    """How a type is kept. `cached`: whether Slicer keeps the value it has read until the node changes."""

    def __init__(self, kind):
        self.kind = kind

    def default(self):
        return self.kind()

    def check(self, value) -> None:
        if not isinstance(value, self.kind):
            raise TypeError(f"Value must be of type '{self.kind}', is type '{type(value)}' value '{value}'")

    def is_in(self, node, name) -> bool:
        return node.HasParameter(name)

    def write(self, node, name, value) -> None:
        self.check(value)
        node.SetParameter(name, self.text(value))

    def text(self, value) -> str:
        return str(value)

    def read(self, node, name):
        return self.kind(node.GetParameter(name))

    def remove(self, node, name) -> None:
        node.UnsetParameter(name)


class StoredNumber(Stored):
    """int or float; an int will do for a float."""

    def check(self, value) -> None:
        if value is None:
            raise ValueError("Value must not be None")
        if not isinstance(value, (int, float) if self.kind is float else int):
            raise TypeError(f"Value must be of type '{self.kind}', is type '{type(value)}' value '{value}'")


class StoredBool(Stored):
    """bool."""

    def read(self, node, name):
        return node.GetParameter(name) == "True"


class StoredEnum(Stored):
    """A member of an enumeration."""

    def text(self, value) -> str:
        return value.name

    def read(self, node, name):
        key = node.GetParameter(name)
        if key not in self.kind.__members__:
            raise ValueError(f"Found {key!r} in parameter node but it is not a name in {self.kind!r}")
        return self.kind[key]


class StoredNone(Stored):
    """None, as one member of a union."""

    def text(self, value) -> str:
        return "True"

    def read(self, node, name):
        return


class StoredNode(Stored):
    """A node of the scene, by reference."""

    def default(self):
        return

    def check(self, value) -> None:
        if value is not None:
            super().check(value)

    def write(self, node, name, value) -> None:
        self.check(value)
        node.SetParameter(name, "")
        node.SetNodeReferenceID(name, value.GetID() if value is not None else None)

    def read(self, node, name):
        return node.GetNodeReference(name)

    def remove(self, node, name) -> None:
        node.UnsetParameter(name)
        node.RemoveNodeReferenceIDs(name)


class StoredUnion(Stored):
    """One of several types."""

    def __init__(self, members):
        self.members = members

    def default(self):
        if len(self.members) == 2 and isinstance(self.members[1], StoredNone):
            return None
        return self.members[0].default()

    def _member(self, value) -> int:
        for number, member in enumerate(self.members):
            if value is None and not isinstance(member, StoredNone):
                continue
            try:
                member.check(value)
            except (TypeError, ValueError):
                continue
            return number
        raise TypeError(f"Unable to write value '{value}' of type '{type(value)}'")

    def check(self, value) -> None:
        self._member(value)

    def is_in(self, node, name) -> bool:
        return any(member.is_in(node, f"{name}.{i}") for i, member in enumerate(self.members))

    def write(self, node, name, value) -> None:
        number = self._member(value)
        with slicer.util.NodeModify(node):
            self.remove(node, name)
            self.members[number].write(node, f"{name}.{number}", value)

    def read(self, node, name):
        for number, member in enumerate(self.members):
            if member.is_in(node, f"{name}.{number}"):
                return member.read(node, f"{name}.{number}")
        raise KeyError(f"Unable to find value for name: {name}")

    def remove(self, node, name) -> None:
        with slicer.util.NodeModify(node):
            for number, member in enumerate(self.members):
                member.remove(node, f"{name}.{number}")


class StoredList(Stored):
    """A list of one type."""

    def __init__(self, element):
        self.element = element

    def default(self):
        return []

    def check(self, value) -> None:
        for each in value:
            self.element.check(each)

    def _length(self, node, name) -> int:
        return int(node.GetParameter(f"{name}.len")) if self.is_in(node, name) else 0

    def is_in(self, node, name) -> bool:
        return node.HasParameter(f"{name}.len")

    def write(self, node, name, value) -> None:
        values = list(value)
        self.check(values)
        with slicer.util.NodeModify(node):
            before = self._length(node, name)
            for number, each in enumerate(values):
                self.element.write(node, f"{name}.{number}", each)
            node.SetParameter(f"{name}.len", str(len(values)))
            for number in range(len(values), before):
                self.element.remove(node, f"{name}.{number}")

    def read(self, node, name):
        return [self.element.read(node, f"{name}.{number}") for number in range(self._length(node, name))]


def stored(kind) -> Stored:
    """How a type, given by a class's annotation, is kept; raises TypeError for one that the host does not support."""
    origin = typing.get_origin(kind)
    if origin is typing.Annotated:
        return stored(typing.get_args(kind)[0])
    if origin in (typing.Union, types.UnionType):
        return StoredUnion([stored(each) for each in typing.get_args(kind)])
    if origin is list:
        return StoredList(stored(*typing.get_args(kind)))
    if kind is type(None):
        return StoredNone(kind)
    if kind is bool:
        return StoredBool(kind)
    if kind in (int, float):
        return StoredNumber(kind)
    if isinstance(kind, type):
        if issubclass(kind, enum.Enum):
            return StoredEnum(kind)
        if issubclass(kind, slicer.vtkMRMLNode):
            return StoredNode(kind)
        if kind is str or issubclass(kind, pathlib.PurePath):
            return Stored(kind)
    raise TypeError(f"the host does not support parameters of type {kind}")

"""`slicer.parameterNodeWrapper`: a class whose annotated fields are the parameters of a real vtkMRMLScriptedModuleNode.

Keys and words are Slicer's, so scenes are interchangeable: bool "True" or "False"; numbers, str and paths by str(); an enumeration by its
member's name; a node as a node reference beside an empty parameter; `A | B | None` under the name with ".0", ".1", ... of the member that
applies; a list under ".len", ".0", ".1", .... A list that is read is a plain one: what is put into it does not reach the node. Other types,
parameter packs, generated panels and one's own serializers are not supported.
"""

from __future__ import annotations

import enum
import math
import types
import typing
from dataclasses import dataclass
from functools import partial

import ctk
import qt
import slicer
import vtk

SlicerParameterNamePropertyName = "SlicerParameterName"

WIDGETS = {
    qt.QCheckBox: ("checked", "stateChanged"),
    qt.QSpinBox: ("value", "valueChanged"),
    qt.QDoubleSpinBox: ("value", "valueChanged"),
    ctk.ctkSliderWidget: ("value", "valueChanged"),
    qt.QLineEdit: ("text", "textChanged"),
    ctk.ctkPathLineEdit: ("currentPath", "currentPathChanged"),
}
"""Property that holds the value, and signal of a change. Lists of members and of nodes have more."""


@dataclass
class WithinRange:
    """From minimum to maximum, both allowed."""

    minimum: float
    maximum: float = math.inf

    def validate(self, value) -> None:
        if not self.minimum <= value <= self.maximum:
            raise ValueError(f"Value must be within range [{self.minimum}, {self.maximum}], is {value}")


class Minimum(WithinRange):
    """Not below."""


def _is_node(kind) -> bool:
    return issubclass(kind, slicer.vtkMRMLNode)


def _put(node, key, kind, value) -> None:
    if _is_node(kind):
        node.SetParameter(key, "")
        node.SetNodeReferenceID(key, value.GetID())
    else:
        node.SetParameter(key, value.name if isinstance(value, enum.Enum) else "True" if value is None else str(value))


def _get(node, key, kind):
    if _is_node(kind) or kind is type(None):
        return node.GetNodeReference(key)
    text = node.GetParameter(key)
    return text == "True" if kind is bool else kind[text] if issubclass(kind, enum.Enum) else kind(text)


def _remove(node, key) -> None:
    node.UnsetParameter(key)
    node.RemoveNodeReferenceIDs(key)


class _Parameter:
    """One field: its types, its rules and its default."""

    def __init__(self, owner, name, kind):
        plain, *self.rules = typing.get_args(kind) if typing.get_origin(kind) is typing.Annotated else [kind]
        self.name, origin = name, typing.get_origin(plain)
        self.is_list, self.is_union = origin is list, origin in (typing.Union, types.UnionType)
        self.kinds = typing.get_args(plain) or (plain,)
        self.default = getattr(owner, name) if hasattr(owner, name) else None if self.is_union else plain()

    def _number(self, value) -> int:
        """Of the type that a value has."""
        for number, kind in enumerate(self.kinds):
            if isinstance(value, (int, float) if kind is float else kind):
                return number
        raise TypeError(f"{self.name} must be of type {self.kinds}, is {value!r}")

    def _keys(self, node) -> list[str]:
        """Those in the node, of a union or of a list."""
        count = int(node.GetParameter(f"{self.name}.len") or 0) if self.is_list else len(self.kinds)
        keys = [f"{self.name}.{number}" for number in range(count)]
        return keys if self.is_list else [key for key in keys if node.HasParameter(key)]

    def is_in(self, node) -> bool:
        return bool(self._keys(node)) if self.is_union else node.HasParameter(f"{self.name}.len" if self.is_list else self.name)

    def write(self, node, value) -> None:
        for rule in self.rules:
            rule.validate(value)
        if self.is_list:
            before = self._keys(node)
            for number, each in enumerate(value):
                _put(node, f"{self.name}.{number}", self.kinds[self._number(each)], each)
            node.SetParameter(f"{self.name}.len", str(len(value)))
            for key in before[len(value) :]:
                _remove(node, key)
            return
        number = self._number(value)
        for key in self._keys(node) if self.is_union else ():
            _remove(node, key)
        _put(node, f"{self.name}.{number}" if self.is_union else self.name, self.kinds[number], value)

    def read(self, node):
        if not self.is_in(node):
            self.write(node, self.default)
        if self.is_list:
            return [_get(node, key, self.kinds[0]) for key in self._keys(node)]
        if not self.is_union:
            return _get(node, self.name, self.kinds[0])
        [key, *_] = self._keys(node)
        return _get(node, key, self.kinds[int(key.rpartition(".")[2])])

    def bound(self, widget):
        """How to read and to write a widget that stands for this, and the name of the signal of a change."""
        kind = self.kinds[0]
        if type(widget) is slicer.qMRMLNodeComboBox:
            widget.nodeTypes = [each().GetClassName() for each in self.kinds if each is not type(None)]
            return widget.currentNode, widget.setCurrentNode, "currentNodeChanged"
        if type(widget) is qt.QComboBox:
            members, before, choose = list(kind), widget.currentIndex, partial(setattr, widget, "currentIndex")
            widget.clear()
            for member in members:
                widget.addItem(getattr(kind, "label", lambda member: member.name)(member))
            widget.currentIndex = max(before, 0)
            return lambda: members[widget.currentIndex], lambda value: choose(members.index(value)), "currentIndexChanged"
        name, signal = WIDGETS[type(widget)]
        for rule in self.rules:
            widget.minimum, widget.maximum = rule.minimum, min(rule.maximum, 2**31 - 1) if kind is int else rule.maximum

        def write(value):
            value = str(value) if kind not in (bool, int, float) else value
            # Writing moves the cursor to the end, which must not happen while the user types
            if value != getattr(widget, name):
                setattr(widget, name, value)

        return lambda: kind(getattr(widget, name)), write, signal


class _Wrapped:
    """What every wrapped class gets."""

    allParameters: dict[str, _Parameter]

    def __init__(self, parameterNode):
        self.parameterNode = parameterNode
        self._guis = {}
        self._updating = False
        for parameter in self.allParameters.values():
            if not parameter.is_in(parameterNode):
                parameter.write(parameterNode, parameter.default)

    def connectGui(self, gui):
        """Binds the widgets that name a parameter in their property SlicerParameterName; returns a tag for `disconnectGui`."""
        writers, connected = {}, []
        for widget in vars(gui).values():
            if name := widget.property(SlicerParameterNamePropertyName):
                read, write, signal = self.allParameters[name].bound(widget)
                writers[name] = write
                write(getattr(self, name))
                changed = self._reader(name, read)
                getattr(widget, signal).connect(changed)
                connected.append((widget, signal, changed))
        tag = max(self._guis, default=-1) + 1
        self._guis[tag] = writers, connected, self.AddObserver(vtk.vtkCommand.ModifiedEvent, lambda caller, event: self._updateGui())
        return tag

    def disconnectGui(self, tag):
        _writers, connected, observer = self._guis.pop(tag)
        for widget, signal, changed in connected:
            getattr(widget, signal).disconnect(changed)
        self.RemoveObserver(observer)

    def _reader(self, name, read):
        def changed():
            with slicer.util.NodeModify(self):
                if not self._updating:
                    setattr(self, name, read())

        return changed

    def _updateGui(self):
        if self._updating:
            return
        self._updating = True
        try:
            with slicer.util.NodeModify(self):
                for writers, *_ in list(self._guis.values()):
                    for name, write in writers.items():
                        write(getattr(self, name))
        finally:
            self._updating = False

    def StartModify(self):
        return self.parameterNode.StartModify()

    def EndModify(self, wasModified):
        return self.parameterNode.EndModify(wasModified)

    def AddObserver(self, event, callback, priority=0.0):
        return self.parameterNode.AddObserver(event, callback, priority)

    def RemoveObserver(self, tag):
        self.parameterNode.RemoveObserver(tag)


def _property_of(parameter):
    def write(self, value):
        with slicer.util.NodeModify(self.parameterNode):
            parameter.write(self.parameterNode, value)

    return property(lambda self: parameter.read(self.parameterNode), write)


def parameterNodeWrapper(classtype):
    """Makes a class's annotated fields the parameters of the node that its constructor takes; a decorator."""
    parameters = {name: _Parameter(classtype, name, kind) for name, kind in typing.get_type_hints(classtype, include_extras=True).items()}
    properties = {name: _property_of(parameter) for name, parameter in parameters.items()}
    return type(classtype.__name__, (_Wrapped, classtype), {"allParameters": parameters, **properties})

"""Which widget can stand for a parameter of which type, and how: read, write, and the signal of a change."""

from __future__ import annotations

import enum
import pathlib
import types
import typing

import ctk
import qt
import slicer

from .parameter_types import Minimum, WithinRange


def split(kind):
    """A type without its annotations, and those."""
    if typing.get_origin(kind) is typing.Annotated:
        plain, *annotations = typing.get_args(kind)
        return plain, annotations
    return kind, []


def _first(annotations, kind):
    return next((each for each in annotations if isinstance(each, kind)), None)


def node_classes(kind) -> tuple[str, ...]:
    """The class names of a node type or of a union of them with None; empty for other types."""
    known = typing.get_args(kind) if typing.get_origin(kind) in (typing.Union, types.UnionType) else (kind,)
    members = [member for member in known if member is not type(None)]
    if members and all(isinstance(member, type) and issubclass(member, slicer.vtkMRMLNode) for member in members):
        return tuple(member().GetClassName() for member in members)
    return ()


class Connector:
    """A widget bound to a parameter.

    Parameters
    ----------
    widget : Wrapper
    signal : str
        Attribute name of the signal of a change.
    read, write : callable
        From the widget, to the widget.
    """

    def __init__(self, widget, signal, read, write):
        self.widget, self._signal, self.read, self.write = widget, signal, read, write
        self._callback = None

    def onChanged(self, callback):
        signal = getattr(self.widget, self._signal)
        if callback is None:
            signal.disconnect(self._changed)
        else:
            signal.connect(self._changed)
        self._callback = callback

    def _changed(self):
        if self._callback:
            self._callback()


def _property(widget, name, signal, convert=lambda value: value, back=lambda value: value):
    return Connector(widget, signal, lambda: convert(getattr(widget, name)), lambda value: setattr(widget, name, back(value)))


def _number(widget, plain, annotations):
    spin = type(widget) is qt.QSpinBox
    within, least = _first(annotations, WithinRange), _first(annotations, Minimum)
    low = within.minimum if within else least.minimum if least else None
    high = within.maximum if within else None
    if type(widget) is ctk.ctkSliderWidget and (low is None or high is None):
        raise RuntimeError("Cannot have a connection to ctkSliderWidget where the type is unbounded.")
    widget.minimum = low if low is not None else -(2**31) if spin else float("-inf")
    widget.maximum = high if high is not None else 2**31 - 1 if spin else float("inf")
    return _property(widget, "value", "valueChanged", plain, plain if plain is int else lambda value: value)


def _items(widget, labels, values):
    """A combo box with one item per value; what was selected by number stays selected."""
    before = widget.currentIndex
    widget.clear()
    for label in labels:
        widget.addItem(label)
    widget.currentIndex = max(before, 0)

    def write(value):
        if value not in values:
            raise ValueError(f"Unable to find value {value} in choices {values}")
        widget.currentIndex = values.index(value)

    return Connector(widget, "currentIndexChanged", lambda: values[widget.currentIndex], write)


def _text(widget):
    def write(value):
        # Writing moves the cursor to the end, which must not happen while the user types
        if value != widget.text:
            widget.text = value

    return Connector(widget, "textChanged", lambda: widget.text, write)


def make_connector(widget, kind) -> Connector:
    """The connector of a widget and a type; raises RuntimeError where Slicer has none."""
    plain, annotations = split(kind)
    look = type(widget)
    if plain is bool and look is qt.QCheckBox:
        return _property(widget, "checked", "stateChanged")
    if plain is int and look is qt.QSpinBox:
        return _number(widget, plain, annotations)
    if plain in (int, float) and look in (qt.QDoubleSpinBox, ctk.ctkSliderWidget):
        return _number(widget, plain, annotations)
    if look is qt.QComboBox and isinstance(plain, type) and issubclass(plain, enum.Enum):
        label = getattr(plain, "label", lambda member: member.name)
        return _items(widget, [label(member) for member in plain], list(plain))
    if plain is str and look is qt.QLineEdit:
        return _text(widget)
    if look is ctk.ctkPathLineEdit and isinstance(plain, type) and issubclass(plain, pathlib.PurePath):
        return _property(widget, "currentPath", "currentPathChanged", plain, str)
    if look is slicer.qMRMLNodeComboBox and node_classes(plain):
        widget.nodeTypes = node_classes(plain)
        return Connector(widget, "currentNodeChanged", widget.currentNode, widget.setCurrentNode)
    raise RuntimeError(f"Unable to create GUI connector from datatype '{kind}' to widget type '{look}'.")

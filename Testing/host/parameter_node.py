"""`slicer.parameterNodeWrapper`: a class whose annotated fields are the parameters of a real vtkMRMLScriptedModuleNode.

Supported are the types of `parameter_types.py` and the widgets of `gui_connectors.py`; parameter packs, generated panels and one's own
serializers are not.
"""

from __future__ import annotations

import typing

import qt
import slicer
import vtk

from .gui_connectors import make_connector, split
from .parameter_types import Minimum, Validator, WithinRange, stored

__all__ = [
    "Minimum",
    "SlicerParameterNamePropertyName",
    "Validator",
    "WithinRange",
    "parameterNodeWrapper",
]

SlicerParameterNamePropertyName = "SlicerParameterName"


class _Parameter:
    """One field: its type, how it is kept, its rules and its default."""

    def __init__(self, owner, name, kind):
        plain, annotations = split(kind)
        self.name, self.kind = name, kind
        self.stored = stored(plain)
        self.rules = [each for each in annotations if isinstance(each, Validator)]
        self.default = getattr(owner, name) if hasattr(owner, name) else self.stored.default()

    def write(self, node, value):
        for rule in self.rules:
            rule.validate(value)
        self.stored.write(node, self.name, value)

    def read(self, node):
        if not self.stored.is_in(node, self.name):
            self.write(node, self.default)
        return self.stored.read(node, self.name)


class _Methods:
    """What every wrapped class gets."""

    def __init__(self, parameterNode):
        self.parameterNode = parameterNode
        self._guis = {}
        self._updating = False
        for parameter in self.allParameters.values():
            if not parameter.stored.is_in(parameterNode, parameter.name):
                parameter.write(parameterNode, parameter.default)

    def getValue(self, name):
        return _known(self, name).read(self.parameterNode)

    def setValue(self, name, value):
        with slicer.util.NodeModify(self.parameterNode):
            _known(self, name).write(self.parameterNode, value)

    def connectGui(self, gui):
        """Binds the widgets that name a parameter in their property SlicerParameterName; returns a tag for `disconnectGui`."""
        is_widget = getattr(gui, "isWidgetType", lambda: False)()
        widgets = gui.findChildren(qt.QWidget) if is_widget else list(vars(gui).values())
        named = {}
        for widget in widgets:
            if name := widget.property(SlicerParameterNamePropertyName):
                named[name] = widget
        return self.connectParametersToGui(named)

    def connectParametersToGui(self, mapping):
        """Binds widgets given by parameter name; returns a tag for `disconnectGui`."""
        connectors = {name: make_connector(widget, _known(self, name).kind) for name, widget in mapping.items()}
        tag = max(self._guis, default=-1) + 1
        for name, connector in connectors.items():
            connector.write(self.getValue(name))
            connector.onChanged(self._reader(name, connector))
        observer = self.AddObserver(vtk.vtkCommand.ModifiedEvent, lambda caller, event: self._updateGui())
        self._guis[tag] = (connectors, observer)
        return tag

    def disconnectGui(self, tag):
        if tag in self._guis:
            connectors, observer = self._guis.pop(tag)
            for connector in connectors.values():
                connector.onChanged(None)
            self.RemoveObserver(observer)

    def _reader(self, name, connector):
        def changed():
            with slicer.util.NodeModify(self):
                if not self._updating:
                    self.setValue(name, connector.read())

        return changed

    def _updateGui(self):
        if self._updating:
            return
        self._updating = True
        try:
            with slicer.util.NodeModify(self):
                for connectors, _ in list(self._guis.values()):
                    for name, connector in connectors.items():
                        connector.write(self.getValue(name))
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


def _known(wrapper, name) -> _Parameter:
    if name not in wrapper.allParameters:
        raise ValueError(f"Cannot find a param with the given name: {name}; there are {sorted(wrapper.allParameters)}")
    return wrapper.allParameters[name]


def _property_of(parameter):
    return property(lambda self: parameter.read(self.parameterNode), lambda self, value: self.setValue(parameter.name, value))


def parameterNodeWrapper(classtype):
    """Makes a class's annotated fields the parameters of the node that its constructor takes; a decorator."""
    parameters = {name: _Parameter(classtype, name, kind) for name, kind in typing.get_type_hints(classtype, include_extras=True).items()}
    for name, value in vars(_Methods).items():
        if callable(value) and name != "__init__" and hasattr(classtype, name):
            raise ValueError(f"Cannot use reserved name '{name}' in a parameterNodeWrapper")
    for name, value in vars(_Methods).items():
        if callable(value):
            setattr(classtype, name, value)
    for name, parameter in parameters.items():
        setattr(classtype, name, _property_of(parameter))
    classtype.allParameters = parameters
    classtype.dataType = staticmethod(lambda name: parameters[name].kind)
    return classtype

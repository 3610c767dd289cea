"""Modules as the application holds them, and the life of a scripted one: loaded from its file, opened, left, reloaded, unloaded.

In Slicer an exception in a module's `setup`, `enter` or `exit` is printed and life goes on; here it reaches the test.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import shiboken6
import slicer
from PySide6 import QtCore, QtGui, QtWidgets
from PySide6.QtCore import Property

from .node_combo_box import kept
from .pythonqt import wrap
from .widgets_qmrml import qSlicerWidget


class _Module(QtCore.QObject):
    """What all kinds of modules have."""

    api: dict = {"methods": ("logic", "setMRMLScene", "widgetRepresentation")}

    def __init__(self, name, path="", logic=None):
        super().__init__()
        self.setObjectName(name)
        self._logic, self._path = logic, path

    def logic(self):
        return self._logic

    def setMRMLScene(self, scene):
        """Does nothing: there is one scene."""

    def widgetRepresentation(self):
        """The module's panel: None, since panels of C++ modules are not supplied."""
        return

    name = Property(str, lambda self: self.objectName())
    path = Property(str, lambda self: self._path)
    dependencies = kept("dependencies", "QStringList", [])


class qSlicerLoadableModule(_Module):
    """A module whose logic is C++: the logic is real, there is no panel."""

    api: dict = {}


class qMRMLSequenceBrowserToolBar(QtWidgets.QToolBar):
    """What replays a sequence browser in Slicer's main window: the one that it was told, and none by itself."""

    api = {"methods": ("activeBrowserNode", "setActiveBrowserNode")}

    def __init__(self):
        super().__init__()
        self._active = None

    def activeBrowserNode(self):
        return self._active if self._active is not None and self._active.GetScene() is not None else None

    def setActiveBrowserNode(self, node):
        self._active = node


class qSlicerSequencesModule(qSlicerLoadableModule):
    """The Sequences module with its tool bar."""

    api: dict = {"methods": ("toolBar", "isToolBarVisible", "setToolBarVisible", "showSequenceBrowser")}

    def __init__(self, name, path="", logic=None):
        super().__init__(name, path, logic)
        self._bar = qMRMLSequenceBrowserToolBar()

    def toolBar(self):
        return self._bar

    def isToolBarVisible(self):
        return not self._bar.isHidden()

    def setToolBarVisible(self, visible):
        self._bar.setVisible(visible)

    def showSequenceBrowser(self, node):
        self._bar.setActiveBrowserNode(node)
        self._bar.show()
        return True


class qSlicerScriptedLoadableModule(_Module):
    """A module made of a Python file."""

    api: dict = {}

    def __init__(self, path: str):
        super().__init__(Path(path).stem, path, slicer.vtkSlicerScriptedLoadableModuleLogic())
        self._widget = None

    def widgetRepresentation(self):
        if self._widget is None and hasattr(sys.modules[self.name], f"{self.name}Widget"):
            self._widget = qSlicerScriptedLoadableModuleWidget(self.name)
            self._widget.setPythonSource(self._path)
            self._widget.setMRMLScene(slicer.mrmlScene)
            self._widget.setup()
        return self._widget

    title = kept("title", str, "")
    categories = kept("categories", "QStringList", [])
    contributors = kept("contributors", "QStringList", [])
    helpText = kept("helpText", str, "")
    acknowledgementText = kept("acknowledgementText", str, "")
    icon = kept("icon", QtGui.QIcon, None)


class qSlicerScriptedLoadableModuleWidget(qSlicerWidget):
    """The panel of a scripted module."""

    api = {
        "methods": ("setMRMLScene", "enter", "exit", "reload"),
        "signals": {"mrmlSceneChanged(vtkMRMLScene*)": "mrmlSceneChanged"},
    }

    def __init__(self, module_name):
        super().__init__()
        QtWidgets.QVBoxLayout(self)
        self._module_name = module_name

    def setPythonSource(self, path):
        """Makes the Python object of the class that the loaded module has now."""
        self._path = path
        kind = getattr(sys.modules[self._module_name], f"{self._module_name}Widget")
        self._python = kind(wrap(self))
        setattr(slicer.modules, f"{self._module_name}Widget", self._python)

    def setup(self):
        self._python.setup()

    def reload(self):
        self.setPythonSource(self._path)
        self.setup()

    isEntered = kept("isEntered", bool, False)

    def enter(self):
        self.isEntered = True
        if hasattr(self._python, "enter"):
            self._python.enter()

    def exit(self):
        self.isEntered = False
        if hasattr(self._python, "exit"):
            self._python.exit()


def load_file(name: str, path: str):
    """Runs a module's file as Slicer does: under its bare name, with its folder on sys.path."""
    folder = str(Path(path).parent)
    if folder not in sys.path:
        sys.path.append(folder)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def instantiate(path: str) -> qSlicerScriptedLoadableModule:
    """A scripted module from its file, described by an object of its class; not loaded yet."""
    name = Path(path).stem
    python = load_file(name, path)
    module = qSlicerScriptedLoadableModule(path)
    setattr(slicer.modules, f"{name}Instance", getattr(python, name)(wrap(module)))
    return module


def load(application, module) -> None:
    """Makes a module known as `slicer.modules.<name>` and has it set itself up."""
    name = module.name
    register(application, module)
    instance = getattr(slicer.modules, f"{name}Instance", None)
    if instance is not None and hasattr(instance, "setup"):
        instance.setup()
    application.moduleManager().moduleLoaded.emit(name)


def register(application, module) -> None:
    """Makes a module known by its name."""
    name = module.name
    application.moduleManager().loaded[name] = module
    setattr(slicer.modules, name.lower(), wrap(module))
    setattr(slicer.moduleNames, name, name)


def forget(application, name: str) -> None:
    """Takes a module out of what is known by name."""
    del application.moduleManager().loaded[name]
    delattr(slicer.moduleNames, name)
    for attribute in (name.lower(), f"{name}Instance", f"{name}Widget"):
        if hasattr(slicer.modules, attribute):
            delattr(slicer.modules, attribute)


def unload_module(application, name: str) -> None:
    """Ends a module as the application does when it closes: its widget's `cleanup` runs, then its panel is destroyed, at once."""
    module = application.moduleManager().loaded[name]
    application.moduleManager().moduleAboutToBeUnloaded.emit(name)
    forget(application, name)
    if getattr(module, "_widget", None) is not None:
        if application.window.panel.isAncestorOf(module._widget):
            application.window.panel.put(None)
        shiboken6.delete(module._widget)
        module._widget = None
    sys.modules.pop(name, None)

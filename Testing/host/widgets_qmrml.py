"""Stand-ins for Slicer's MRML widgets on PySide6, over a real scene.

A widget knows the scene only when it was given one: by the .ui file's connection of mrmlSceneChanged with setMRMLScene, or by a call.
"""

from __future__ import annotations

from PySide6 import QtWidgets
from PySide6.QtCore import Signal

from .node_combo_box import WithScene, qMRMLNodeComboBox

__all__ = ["qMRMLNodeComboBox", "qMRMLWidget", "qSlicerWidget"]


class _PassesSceneOn(WithScene, QtWidgets.QWidget):
    """A widget that hands its scene on to those that are connected to mrmlSceneChanged."""

    mrmlSceneChanged = Signal(object)

    def __init__(self, parent=None):
        super().__init__(parent)

    def setMRMLScene(self, scene):
        if scene is not self._scene:
            self._scene = scene
            self.mrmlSceneChanged.emit(scene)


class qMRMLWidget(_PassesSceneOn):
    """The outermost widget of a .ui file."""

    api = {"methods": ("setMRMLScene",), "signals": {"mrmlSceneChanged(vtkMRMLScene*)": "mrmlSceneChanged"}}


class qSlicerWidget(_PassesSceneOn):
    """What Slicer's module panels derive from."""

    api = {"methods": ("setMRMLScene",), "signals": {"mrmlSceneChanged(vtkMRMLScene*)": "mrmlSceneChanged"}}

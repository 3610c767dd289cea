"""A stand-in for Slicer's node selector, over a real scene."""

from __future__ import annotations

import vtk
from PySide6 import QtWidgets
from PySide6.QtCore import Property, Signal


class WithScene:
    """Keeps a scene, by plain reference."""

    _scene = None


def kept(name: str, kind, default, then=lambda self: None):
    """A property that is kept, and what a change of it brings about."""

    def write(self, value):
        self.__dict__[name] = value
        then(self)

    return Property(kind, lambda self: self.__dict__.get(name, default), write)


class qMRMLNodeComboBox(WithScene, QtWidgets.QWidget):
    """None and the nodes of the scene that match; nobody picks anything here but by Python."""

    api = {
        "methods": ("setMRMLScene", "currentNode", "setCurrentNode", "addNode"),
        "signals": {"currentNodeChanged(vtkMRMLNode*)": "currentNodeChanged", "nodeAddedByUser(vtkMRMLNode*)": "nodeAddedByUser"},
    }
    currentNodeChanged = Signal(object)
    nodeAddedByUser = Signal(object)

    def __init__(self, parent=None) -> None:
        super().__init__(parent)
        self._nodes: list = []
        self._current = None
        self._observers: list = []
        self._box = QtWidgets.QComboBox(self)
        self._box.setSizePolicy(QtWidgets.QSizePolicy.Policy.Expanding, QtWidgets.QSizePolicy.Policy.Fixed)
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self._box)
        self.setSizePolicy(QtWidgets.QSizePolicy.Policy.Preferred, QtWidgets.QSizePolicy.Policy.Fixed)
        self.setFocusProxy(self._box)
        self.destroyed.connect(_unobserver(self._observers))
        self.setEnabled(False)

    def setMRMLScene(self, scene):
        """Sets the scene: the list is filled."""
        if scene is self._scene:
            return
        _unobserver(self._observers)()
        self._scene = scene
        if scene is not None:
            events = (scene.NodeAddedEvent, scene.NodeRemovedEvent, scene.EndBatchProcessEvent)
            self._observers += [(scene, scene.AddObserver(event, self._scene_changed)) for event in events]
        self._update()
        self.setEnabled(scene is not None)

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _scene_changed(self, caller, event, node=None):
        if self._scene is None or self._scene.IsBatchProcessing():
            return
        # Most nodes that come and go are of other kinds
        if node is None or self._matches(node):
            self._update()

    def _matches(self, node) -> bool:
        name, children = node.GetClassName(), self.showChildNodeTypes
        return not node.GetHideFromEditors() and any(name == kind or (children and node.IsA(kind)) for kind in self.nodeTypes)

    def _update(self):
        """Lists what there is. As a combo box does when its current row goes: the next row is selected, else the last one."""
        row = self._nodes.index(self._current) if self._current in self._nodes else 0
        scene = self._scene
        every = [] if scene is None else [scene.GetNthNode(number) for number in range(scene.GetNumberOfNodes())]
        self._nodes = [node for node in every if self._matches(node)]
        gone = self._current is not None and self._current not in self._nodes
        self.setCurrentNode(self._nodes[min(row, len(self._nodes) - 1)] if gone and self._nodes else None if gone else self._current)

    def currentNode(self):
        return self._current

    def setCurrentNode(self, node):
        """Selects a node; None where it is not listed."""
        before, self._current = self._current, node if node in self._nodes else None
        self._box.clear()
        self._box.addItem(self.noneDisplay)
        self._box.addItems([each.GetName() or "" for each in self._nodes])
        self._box.setCurrentIndex(self._nodes.index(self._current) + 1 if self._current is not None else 0)
        if self._current is not before:
            self.currentNodeChanged.emit(self._current)

    def addNode(self):
        """Creates a node of the first class and selects it; returns it."""
        node = self._scene.CreateNodeByClass(self.nodeTypes[0])
        node.UnRegister(None)
        node.SetName(self._scene.GetUniqueNameByString(self.baseName))
        self._scene.AddNode(node)
        self.setCurrentNode(node)
        self.nodeAddedByUser.emit(node)
        return node

    showChildNodeTypes = kept("showChildNodeTypes", bool, True, _update)
    noneEnabled = kept("noneEnabled", bool, False)
    addEnabled = kept("addEnabled", bool, True)
    removeEnabled = kept("removeEnabled", bool, True)
    renameEnabled = kept("renameEnabled", bool, False)
    noneDisplay = kept("noneDisplay", str, "None", _update)
    nodeTypes = kept("nodeTypes", "QStringList", [], _update)
    baseName = kept("baseName", str, "")
    sizeAdjustPolicy = Property(
        QtWidgets.QComboBox.SizeAdjustPolicy,
        lambda self: self._box.sizeAdjustPolicy(),
        lambda self, policy: self._box.setSizeAdjustPolicy(policy),
    )


def _unobserver(observers: list):
    """A function that removes observers, given as pairs of object and tag, and empties the list."""

    def remove(*_):
        while observers:
            observed, tag = observers.pop()
            observed.RemoveObserver(tag)

    return remove

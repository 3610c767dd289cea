"""A stand-in for Slicer's node selector, over a real scene."""

from __future__ import annotations

from typing import Any

import vtk
from PySide6 import QtWidgets
from PySide6.QtCore import Property, Signal


class WithScene:
    """Keeps a scene, by plain reference."""

    _scene = None


def _value(name: str, kind):
    """A property that decides what the list shows."""
    return Property(kind, lambda self: self._values[name], lambda self, value: self._set_value(name, value))


class qMRMLNodeComboBox(WithScene, QtWidgets.QWidget):
    """The nodes of the scene that match, and what the user could do with one; nobody picks anything here but by Python."""

    api = {
        "methods": (*("setMRMLScene", "nodeTypeLabel", "currentNode", "setCurrentNode", "setCurrentNodeID", "addNode"),),
        "signals": {
            "currentNodeChanged(vtkMRMLNode*)": "currentNodeChanged",
            "currentNodeIDChanged(QString)": "currentNodeIDChanged",
            "nodeAddedByUser(vtkMRMLNode*)": "nodeAddedByUser",
        },
    }
    currentNodeChanged = Signal(object)
    currentNodeIDChanged = Signal(str)
    nodeAddedByUser = Signal(object)

    def __init__(self, parent=None) -> None:
        super().__init__(parent)
        self._values: dict[str, Any] = {
            "showChildNodeTypes": True,
            "noneEnabled": False,
            "addEnabled": True,
            "removeEnabled": True,
            "renameEnabled": False,
            "noneDisplay": "None",
        }
        self._types: list[str] = []
        self._base_names: dict[str, str] = {}
        self._nodes: list = []
        self._current = None
        self._requested = ""
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

    # ---- scene

    def setMRMLScene(self, scene):
        """Sets the scene: the list is filled, and the node that was asked for, the one that was selected or the first is selected."""
        if scene is self._scene:
            return
        _unobserver(self._observers)()
        previous = self._current.GetID() if self._current is not None else ""
        self._scene = scene
        if scene is not None:
            events = (scene.NodeAddedEvent, scene.NodeRemovedEvent, scene.EndBatchProcessEvent)
            self._observers += [(scene, scene.AddObserver(event, self._scene_changed)) for event in events]
        self._list()
        wanted = self._requested or previous
        if not wanted and not self._values["noneEnabled"] and self._nodes:
            wanted = self._nodes[0].GetID()
        self._requested = ""
        self.setCurrentNodeID(wanted)
        self.setEnabled(scene is not None)

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _scene_changed(self, caller, event, node=None):
        if self._scene is None or self._scene.IsBatchProcessing():
            return
        # Most nodes that come and go are of other kinds
        if node is None or self._kinds_of(node):
            self._update()

    def _update(self):
        before, row = self._nodes, self._nodes.index(self._current) if self._current in self._nodes else None
        self._list()
        if self._current is not None and self._current not in self._nodes:
            # As a combo box does when its current row goes: the next row, else the last one
            self._select(self._nodes[min(row or 0, len(self._nodes) - 1)] if self._nodes else None)
        elif self._current is None and not before and self._nodes and not self._values["noneEnabled"] and not self._extra_items():
            self._select(self._nodes[0])
        else:
            self._show()

    def _kinds_of(self, node) -> list[str]:
        name, children = node.GetClassName(), self._values["showChildNodeTypes"]
        return [kind for kind in self._types if name == kind or (children and node.IsA(kind))]

    def _matches(self, node) -> bool:
        return not node.GetHideFromEditors() and bool(self._kinds_of(node))

    def _list(self):
        scene = self._scene
        all_nodes = [] if scene is None else [scene.GetNthNode(i) for i in range(scene.GetNumberOfNodes())]
        candidates = [node for node in all_nodes if self._kinds_of(node)]
        self._nodes = [node for node in candidates if self._matches(node)]
        # Names, attributes and visibility may change; a node that is gone is let go
        for entry in [entry for entry in self._observers if entry[0] is not scene and entry[0] not in candidates]:
            _unobserver([entry])()
            self._observers.remove(entry)
        watched = {observed for observed, _ in self._observers}
        self._observers += [(node, node.AddObserver("ModifiedEvent", self._modified)) for node in candidates if node not in watched]
        self._show()

    def _modified(self, node, event):
        if self._matches(node) != (node in self._nodes):
            self._update()
        elif node in self._nodes and self._box.itemText(self._row(node)) != node.GetName():
            self._show()

    def _row(self, node) -> int:
        return self._nodes.index(node) + self._values["noneEnabled"] if node in self._nodes else 0 if self._values["noneEnabled"] else -1

    def _extra_items(self) -> list[tuple[str, str]]:
        kind = self._types[0] if len(self._types) == 1 else ""
        items = []
        if self._values["renameEnabled"]:
            items.append((f"Rename current {self.nodeTypeLabel(kind)}", "RENAME"))
        if self._values["addEnabled"]:
            items += [(f"Create new {self.nodeTypeLabel(each)}", f"CREATE/{each}") for each in self._types]
        if self._values["removeEnabled"]:
            items.append((f"Delete current {self.nodeTypeLabel(kind)}", "DELETE"))
        return items

    def _show(self):
        """Makes the combo box show the list; selection and signals are not touched."""
        self._box.clear()
        if self._scene is None:
            return
        if self._values["noneEnabled"]:
            self._box.addItem(self._values["noneDisplay"])
        for node in self._nodes:
            self._box.addItem(node.GetName())
        extra = self._extra_items()
        if extra:
            self._box.insertSeparator(self._box.count())
        for text, action in extra:
            self._box.addItem(text, action)
        self._box.setPlaceholderText(f"Select a {self.nodeTypeLabel(self._types[0] if self._types else '')}")
        self._box.setCurrentIndex(self._row(self._current))

    def _select(self, node):
        if node is not None and node not in self._nodes:
            node = None
        if node is self._current:
            self._show()
            return
        self._current = node
        self._show()
        self.currentNodeChanged.emit(node)
        self.currentNodeIDChanged.emit(node.GetID() if node is not None else "")

    # ---- what Python may call

    def nodeTypeLabel(self, kind):
        return (self._scene.GetTypeDisplayNameByClassName(kind) if self._scene is not None and kind else "") or "node"

    def currentNode(self):
        return self._current

    def setCurrentNode(self, node):
        """Selects a node (a node, not its ID: that form is deprecated in Slicer); None where it is not listed."""
        if isinstance(node, str):
            raise TypeError("setCurrentNode takes a node; use setCurrentNodeID for an ID")
        self.setCurrentNodeID(node.GetID() if node is not None else "")

    def setCurrentNodeID(self, node_id):
        if self._scene is None:
            self._requested = node_id or ""
            return
        self._select(next((node for node in self._nodes if node.GetID() == node_id), None))

    def addNode(self, kind=None):
        """Creates a node of the first, or the given, class and selects it; returns it."""
        kind = kind or (self._types[0] if self._types else None)
        if self._scene is None or kind not in self._types:
            return None
        node = self._scene.CreateNodeByClass(kind)
        node.UnRegister(None)
        base = self._base_names.get(kind) or self._scene.GetTypeDisplayNameByClassName(kind) or kind
        node.SetName(self._scene.GetUniqueNameByString(base))
        self._scene.AddNode(node)
        self._select(node)
        self.nodeAddedByUser.emit(node)
        return node

    def _set_types(self, kinds):
        self._types = [kind for kind in kinds if kind]
        self._update()

    def _set_value(self, name, value):
        self._values[name] = value
        self._update()

    def _set_base_name(self, name):
        self._base_names = dict.fromkeys(self._types, name)

    showChildNodeTypes = _value("showChildNodeTypes", bool)
    noneEnabled = _value("noneEnabled", bool)
    addEnabled = _value("addEnabled", bool)
    removeEnabled = _value("removeEnabled", bool)
    renameEnabled = _value("renameEnabled", bool)
    noneDisplay = _value("noneDisplay", str)
    nodeTypes = Property("QStringList", lambda self: self._types, _set_types)
    currentNodeID = Property(str, lambda self: self._current.GetID() if self._current is not None else "", setCurrentNodeID)
    baseName = Property(str, lambda self: next(iter(self._base_names.values()), ""), _set_base_name)
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

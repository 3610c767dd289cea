"""Loads Qt Designer files with the stand-ins for CTK's and Slicer's widgets, by Qt's own QUiLoader.

Qt itself builds what is Qt's. A class that neither Qt nor the stand-ins know, a property that the class lacks, or a connection of a
signal or slot that does not exist is an error here; in Slicer it is a line in the log and a widget that does not work.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from PySide6 import QtCore, QtUiTools, QtWidgets

from .connections import connect
from .pythonqt import _write, is_offered, property_index, unwrap, wrap


class UiFileError(RuntimeError):
    """A .ui file that Slicer could not load as it is meant."""


def value_of(element, native, context=""):
    """The value in a property's element: bool, number, string, list of strings or enumeration of a stand-in.

    Strings are translated in the context of the form, lists of strings are not: so does Qt's own loader, which does the rest.
    """
    child = element[0]
    if child.tag == "bool":
        return child.text == "true"
    if child.tag == "number":
        return int(child.text)
    if child.tag == "double":
        return float(child.text)
    if child.tag == "stringlist":
        return [item.text or "" for item in child]
    if child.tag in ("enum", "set"):
        total = 0
        for word in filter(None, (child.text or "").split("|")):
            owner, _, name = word.rpartition("::")
            kind = getattr(QtWidgets, owner.split("::")[0], type(native)) if owner else type(native)
            found = getattr(kind, name, None)
            if found is None:
                raise UiFileError(f"{word} is no value that {type(native).__name__} knows")
            total = found if total == 0 else total | found
        return total
    if child.get("notr") == "true":
        return child.text or ""
    return QtCore.QCoreApplication.translate(context, child.text or "", child.get("comment"))


class QUiLoader(QtUiTools.QUiLoader):
    """Qt's loader with the stand-ins.

    Parameters
    ----------
    parent : QObject, optional
    """

    stand_ins: dict[str, type] = {}

    def __init__(self, parent=None) -> None:
        super().__init__(parent)
        self._made: list = []

    def createWidget(self, class_name, parent=None, name=""):
        if class_name in self.stand_ins:
            widget = self.stand_ins[class_name](parent)
            widget.setObjectName(name)
        else:
            widget = super().createWidget(class_name, parent, name)
        self._made.append(widget)
        return widget

    def load(self, device, parent=None):
        """The outermost widget of the file that `device`, a QFile or its path, reads."""
        path = device.fileName() if isinstance(device, QtCore.QFileDevice) else str(device)
        tree = ElementTree.parse(path)
        root = tree.getroot()
        self._check_classes(root, path)
        later = self._take_stand_in_properties(root)
        connections = [element for parent_element in root.findall("connections") for element in parent_element]
        for element in root.findall("connections"):
            root.remove(element)
        # Qt would warn that it does not know these classes' headers; it asks createWidget first
        for element in root.findall("customwidgets"):
            root.remove(element)
        buffer = QtCore.QBuffer()
        buffer.setData(ElementTree.tostring(root))
        buffer.open(QtCore.QIODevice.OpenModeFlag.ReadOnly)
        base = QtCore.QDir(str(Path(path).resolve().parent))
        self.setWorkingDirectory(base)
        widget = super().load(buffer, parent)
        if widget is None:
            raise UiFileError(f"{path}: {self.errorString()}")
        named = {made.objectName(): made for made in [widget, *widget.findChildren(QtCore.QObject)] if made.objectName()}
        for name, properties in later:
            for element in properties:
                native = named[name]
                meta = native.metaObject().property(property_index(native, element.get("name")))
                _write(native, meta, value_of(element, native, root.findtext("class")), type(native).__name__)
        for element in connections:
            self._connect(element, named, path)
        return widget

    def _check_classes(self, root, path):
        known = {*self.stand_ins, *self.availableWidgets()}
        names = {element.get("name") for element in root.iter("widget")}
        for element in root.iter("widget"):
            kind, name = element.get("class"), element.get("name")
            if kind not in known:
                raise UiFileError(f"{path}: {name} is a {kind}, which the host does not know")
            probe = self.stand_ins[kind](None) if kind in self.stand_ins else super().createWidget(kind)
            for each in element.findall("property"):
                if (kind, each.get("name")) == ("QLabel", "buddy"):
                    # No property of Qt's; the loader calls setBuddy, and says nothing when there is no such widget
                    if each.findtext("cstring") not in names:
                        raise UiFileError(f"{path}: {name} has the buddy {each.findtext('cstring')}, which is not in the file")
                    continue
                if each.get("stdset") != "0" and property_index(probe, each.get("name")) < 0:
                    raise UiFileError(f"{path}: {name} ({kind}) has no property {each.get('name')}")
            probe.deleteLater()

    def _take_stand_in_properties(self, root):
        """Properties that Qt's loader could not set, taken out of the tree: (object name, elements)."""
        taken = []
        for element in root.iter("widget"):
            kind = self.stand_ins.get(element.get("class"))
            if kind is None:
                continue
            own = {name for base in kind.__mro__ for name, value in vars(base).items() if isinstance(value, QtCore.Property)}
            properties = [each for each in element.findall("property") if each.get("name") in own and each.get("stdset") != "0"]
            for each in properties:
                element.remove(each)
            taken.append((element.get("name"), properties))
        return taken

    @staticmethod
    def _connect(element, named, path):
        sender, signal, receiver, slot = (element.findtext(tag) for tag in ("sender", "signal", "receiver", "slot"))
        for name in (sender, receiver):
            if name not in named:
                raise UiFileError(f"{path}: a connection names {name}, which is not in the file")
        method = slot.split("(")[0]
        target = named[receiver]
        if not is_offered(type(target), method):
            raise UiFileError(f"{path}: {type(target).__name__} has no slot {slot}")
        try:
            connect(wrap(named[sender]), signal, _slot(target, method, slot))
        except RuntimeError as error:
            raise UiFileError(f"{path}: {error}") from None


def _slot(target, method, slot):
    count = len([kind for kind in re.sub(r"^.*\(|\)$", "", slot).split(",") if kind])
    return lambda *args: getattr(target, method)(*map(unwrap, args[:count]))

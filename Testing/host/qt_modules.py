"""The modules `qt` and `ctk` as Slicer's Python has them, over PySide6 and the stand-ins."""

from __future__ import annotations

import types

from PySide6 import QtCore, QtGui, QtWidgets

from . import dialogs, ui_loader, widgets_collapsible, widgets_ctk, widgets_qmrml
from .pythonqt import PythonQtMeta, Wrapper, wrapper_class

CTK_NOT_MADE = (
    "ctkCheckBox",
    "ctkCheckablePushButton",
    "ctkColorPickerButton",
    "ctkDirectoryButton",
    "ctkDoubleRangeSlider",
    "ctkDoubleSlider",
    "ctkDoubleSpinBox",
    "ctkRangeWidget",
)
SLICER_NOT_MADE = ("qMRMLRangeWidget", "qMRMLSpinBox")
"""Classes that Slicer's own Python names when it looks for the kind of a widget. They exist and cannot be created."""

OWN_CLASSES = {"QUiLoader": ui_loader.QUiLoader, "QProgressDialog": dialogs.QProgressDialog}


def stand_ins(module) -> dict[str, type]:
    """The stand-in classes of a module, by name."""
    return {name: kind for name, kind in vars(module).items() if isinstance(kind, type) and "api" in kind.__dict__}


def not_made(name: str) -> type:
    """A class that cannot be created."""
    return PythonQtMeta(name, (Wrapper,), {"_native": None, "_generated": True, "__slots__": ()})


class _Dialog:
    """What a wrapper of a dialog does in place of waiting."""

    def exec_(self):
        return dialogs.execute(self._object)

    def exec(self):
        return dialogs.execute(self._object)


class QtModule(types.ModuleType):
    """Every class of QtCore, QtGui and QtWidgets under one name, wrapped when first asked for."""

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        native = OWN_CLASSES.get(name) or next((getattr(m, name) for m in (QtWidgets, QtGui, QtCore) if hasattr(m, name)), None)
        if not isinstance(native, type) or name in ("Signal", "Slot", "Property", "QObjectCleanupHandler"):
            raise AttributeError(f"module 'qt' has no attribute '{name}'")
        made = wrapper_class(native)
        for method, default in dialogs.STATIC.items() if name == "QFileDialog" else ():
            type.__setattr__(made, method, staticmethod(dialogs.ask_statically(name, default)))
        setattr(self, name, made)
        return made


def make_modules():
    """The modules `qt` and `ctk`, and the wrapped MRML widgets for `slicer`, as (qt, ctk, dict of name to class)."""
    for kind in (QtWidgets.QDialog, *_subclasses(QtWidgets.QDialog), widgets_ctk.ctkMessageBox):
        made = wrapper_class(kind)
        if kind is not dialogs.QProgressDialog:
            made.exec_, made.exec = _Dialog.exec_, _Dialog.exec
    ctk_kinds = {**stand_ins(widgets_collapsible), **stand_ins(widgets_ctk)}
    ui_loader.QUiLoader.stand_ins = {**ctk_kinds, **stand_ins(widgets_qmrml)}
    qt = QtModule("qt")
    ctk = types.ModuleType("ctk")
    for name, kind in ctk_kinds.items():
        setattr(ctk, name, wrapper_class(kind))
    for name in CTK_NOT_MADE:
        setattr(ctk, name, not_made(name))
    mrml = {name: wrapper_class(kind) for name, kind in stand_ins(widgets_qmrml).items() if "ctk" not in name}
    return qt, ctk, mrml | {name: not_made(name) for name in SLICER_NOT_MADE}


def _subclasses(kind):
    for child in kind.__subclasses__():
        yield child
        yield from _subclasses(child)

"""The modules `qt` and `ctk` as Slicer's Python has them, over PySide6 and the stand-ins."""

from __future__ import annotations

import types

from PySide6 import QtCore, QtGui, QtWidgets

from . import dialogs, ui_loader, widgets_collapsible, widgets_ctk, widgets_qmrml
from .pythonqt import wrapper_class

OWN_CLASSES = {"QUiLoader": ui_loader.QUiLoader, "QProgressDialog": dialogs.QProgressDialog}


def stand_ins(module) -> dict[str, type]:
    """The stand-in classes of a module, by name."""
    return {name: kind for name, kind in vars(module).items() if isinstance(kind, type) and "api" in kind.__dict__}


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
            type.__setattr__(made, method, staticmethod(dialogs.ask_statically(default)))
        setattr(self, name, made)
        return made


def make_modules():
    """The modules `qt` and `ctk`, and the wrapped MRML widgets for `slicer`, as (qt, ctk, dict of name to class)."""
    for kind in (QtWidgets.QDialog, *_subclasses(QtWidgets.QDialog), widgets_ctk.ctkMessageBox):
        made = wrapper_class(kind)
        if kind is not dialogs.QProgressDialog:
            made.exec_ = made.exec = lambda self: dialogs.execute(self._object)
    ctk_kinds = {**stand_ins(widgets_collapsible), **stand_ins(widgets_ctk)}
    ui_loader.QUiLoader.stand_ins = {**ctk_kinds, **stand_ins(widgets_qmrml)}
    qt = QtModule("qt")
    ctk = types.ModuleType("ctk")
    for name, kind in ctk_kinds.items():
        setattr(ctk, name, wrapper_class(kind))
    return qt, ctk, {name: wrapper_class(kind) for name, kind in stand_ins(widgets_qmrml).items()}


def _subclasses(kind):
    for child in kind.__subclasses__():
        yield child
        yield from _subclasses(child)

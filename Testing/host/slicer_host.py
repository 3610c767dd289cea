"""The host itself: puts `slicer`, `qt`, `ctk` and `SampleData` in place and drives modules as the application would."""

from __future__ import annotations

import atexit
import importlib
import importlib.util
import os
import sys
import tempfile
import types
from pathlib import Path
from typing import Any

QT_PACKAGES = "libegl1 libgl1 libxkbcommon0 libdbus-1-3 libfontconfig1 libglib2.0-0"
"""Debian packages of the system libraries that Qt needs, which its wheel does not hold."""


def missing() -> str:
    """Why the host cannot run here; "" where it can."""
    for package, name in (("PySide6", "PySide6"), ("slicer", "slicer-core"), ("vtk", "vtk")):
        if importlib.util.find_spec(package) is None:
            return f"{name} is not installed"
    try:
        importlib.import_module("PySide6.QtWidgets")
        importlib.import_module("PySide6.QtUiTools")
    except ImportError as error:
        return f"Qt does not start here: {error}. On Debian: apt install {QT_PACKAGES}"
    return ""


class SlicerHost:
    """Slicer as far as a scripted module sees it, in this process. There can be one; `runHost` gives it.

    Parameters
    ----------
    testing : bool
        What `slicer.app.testingEnabled()` says. False: message boxes are noted in `dialogs`; True: `slicer.util` only logs them.

    Attributes
    ----------
    scene : vtkMRMLScene
    dialogs : Dialogs
        What was shown, and the answers to give.
    documents : pathlib.Path
        The folder of the user's files, where scenes are saved.
    """

    def __init__(self, testing: bool = False):
        if reason := missing():
            raise RuntimeError(f"The Slicer host cannot run here: {reason}.")
        os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
        import slicer

        from . import qt_modules
        from .application import qSlicerApplication
        from .dialogs import DIALOGS
        from .mrml_scene import createScene

        self.dialogs = DIALOGS
        self._folder = tempfile.TemporaryDirectory(prefix="aifrecon-host-", ignore_cleanup_errors=True)
        _quiet()
        self._application: Any = qSlicerApplication(self._folder.name, testing)
        _register_fonts()
        self.scene = createScene()
        self.documents = Path(self._folder.name) / "Documents"
        self.documents.mkdir()
        self.scene.SetRootDirectory(str(self.documents))
        qt, ctk, widgets = qt_modules.make_modules()
        sys.modules.update(qt=qt, ctk=ctk)
        _tidy(slicer)
        slicer.mrmlScene = self.scene
        slicer.modules = types.ModuleType("slicer.modules")
        slicer.moduleNames = types.ModuleType("slicer.moduleNames")
        sys.modules.update({"slicer.modules": slicer.modules, "slicer.moduleNames": slicer.moduleNames})
        for name, kind in widgets.items():
            setattr(slicer, name, kind)
        from . import modules
        from .pythonqt import wrap, wrapper_class

        for kind in (qSlicerApplication, modules.qSlicerScriptedLoadableModule, modules.qSlicerScriptedLoadableModuleWidget):
            setattr(slicer, kind.__name__, wrapper_class(kind))
        self._modules = modules
        self._application.start(self.scene.host)
        self._application.aboutToQuit.connect(self._unload_modules)
        slicer.app = wrap(self._application)
        self._keep = [slicer.app]
        for name, logic in self.scene.host.logics.items():
            if not name.islower():
                kind = modules.qSlicerSequencesModule if name == "Sequences" else modules.qSlicerLoadableModule
                module = kind(name, logic=logic)
                self._keep.append(module)
                modules.register(self._application, module)
        self._install_python(slicer)
        self._hold_nodes()
        self._hear_observers()
        atexit.register(self.close)

    def _hold_nodes(self) -> None:
        """Keeps the Python side of every node of the scene.

        VTK shows Python's garbage collector the observers of an object but not that C++ holds the object: a callback that only leads
        back to its own node would be cleared while it can still be called, and the process would crash.
        """
        import slicer
        import vtk

        scene = self.scene
        self._nodes = dict.fromkeys(scene.GetNthNode(i) for i in range(scene.GetNumberOfNodes()))

        @vtk.calldata_type(vtk.VTK_OBJECT)
        def added(caller, event, node):
            self._nodes[node] = None

        @vtk.calldata_type(vtk.VTK_OBJECT)
        def removed(caller, event, node):
            self._nodes.pop(node, None)

        events = ((slicer.vtkMRMLScene.NodeAddedEvent, added), (slicer.vtkMRMLScene.NodeRemovedEvent, removed))
        self._tags = [scene.AddObserver(event, callback) for event, callback in events]

    def _hear_observers(self) -> None:
        """Keeps exceptions of VTK observers with those of slots: VTK prints them and goes on."""
        from .connections import SlotErrors

        before = self._hook = sys.excepthook

        def hook(kind, error, trace):
            SlotErrors.caught.append(error)
            before(kind, error, trace)

        sys.excepthook = hook

    def _install_python(self, slicer) -> None:
        """The Python files of `slicer` that slicer-core lacks."""
        from . import sample_data

        sys.modules["SampleData"] = sample_data
        for name, own in (("i18n", "i18n"), ("ScriptedLoadableModule", "scripted_module"), ("parameterNodeWrapper", "parameter_node")):
            module = importlib.import_module(f"{__package__}.{own}")
            sys.modules[f"slicer.{name}"] = module
            setattr(slicer, name, module)
        slicer.util.pip_install = self._refuse_install

    @staticmethod
    def _refuse_install(requirements, *args, **kwargs):
        raise RuntimeError(f"the host does not install packages: {requirements}")

    # ---- modules

    def start(self, *paths) -> None:
        """Starts the application with scripted modules from these files, as when Slicer knows their folders; see `start_up`."""
        from .start_up import start

        start(self._application, [Path(path).resolve() for path in paths])
        self.raise_slot_errors()

    def load_module(self, path) -> None:
        """Loads a scripted module while the application runs: its start is past."""
        self._modules.load(self._application, self._modules.instantiate(str(Path(path).resolve())))

    def open(self, name: str):
        """Opens a module as the user does, leaving the one that was open; returns its Python widget."""
        import slicer

        slicer.util.selectModule(name)
        return getattr(slicer.modules, f"{name}Widget", None)

    def run(self) -> int:
        """Runs until the application is closed: by the window, or by `slicer.util.exit`; returns the exit status.

        As in Slicer, all modules are unloaded and their panels destroyed within the very call that closes it, also when that comes in the
        middle of what Python does in an event; Python goes on afterwards.
        """
        return self._application.exec()

    def _unload_modules(self) -> None:
        for name in reversed(list(self._application.moduleManager().loaded)):
            self._modules.unload_module(self._application, name)

    # ---- tests

    def process_events(self) -> None:
        from PySide6 import QtCore

        self._application.processEvents()
        self._application.sendPostedEvents(None, QtCore.QEvent.Type.DeferredDelete)
        self._application.processEvents()

    def take_slot_errors(self) -> list[BaseException]:
        """The exceptions raised in slots and VTK observers since the last call; neither Qt nor VTK passes them on."""
        from .connections import SlotErrors

        return SlotErrors.take()

    def raise_slot_errors(self) -> None:
        """Raises the first exception that a slot has raised since the last call, if any."""
        errors = self.take_slot_errors()
        if errors:
            raise errors[0]

    def reset(self) -> None:
        """Clears scene, dialogs, settings and slot errors, as between two tests."""
        self.scene.Clear(False)
        self.dialogs.clear()
        self._application.moduleManager().module("Sequences").setToolBarVisible(False)
        self._application.settings().clear()
        while self._application.overrideCursor() is not None:
            self._application.restoreOverrideCursor()
        self.process_events()
        self.take_slot_errors()

    def take_out(self, widget):
        """Takes a module's panel out of the main window, if it is there, so that it can be given any size; returns it as Qt has it."""
        from .pythonqt import unwrap

        native = unwrap(widget)
        if self._application.window.panel.isAncestorOf(native):
            self._application.window.panel.put(None)
        return native

    def picture(self, widget, width: int):
        """A picture, a QImage, of a widget of so many pixels and of the height that its contents need at that width."""
        native = self.take_out(widget)
        native.ensurePolished()
        native.resize(width, native.height())
        native.show()
        self.process_events()
        native.resize(width, native.layout().totalHeightForWidth(width))
        self.process_events()
        return native.grab().toImage()

    def close(self) -> None:
        atexit.unregister(self.close)
        if self._application is None:
            return
        self._unload_modules()
        self.process_events()
        import shiboken6
        from PySide6 import QtCore

        # Those with a parent, such as the lists of combo boxes, go with it
        for window in [window for window in self._application.topLevelWidgets() if window.parent() is None]:
            window.deleteLater()
        self.process_events()
        for tag in self._tags:
            self.scene.RemoveObserver(tag)
        self._nodes.clear()
        sys.excepthook = self._hook
        self._application.layoutManager().stop()
        self.scene.host.close()
        self._application.window = None
        self._application.processEvents()
        shiboken6.delete(self._application)
        self._application = None
        QtCore.qInstallMessageHandler(None)
        self._folder.cleanup()


def _tidy(slicer) -> None:
    """Takes out of slicer-core's namespace what Slicer's does not have: the functions of `slicer.util` and what it imported."""
    import slicer.util as util

    helpers = ("item_name", "info", "module", "me", "extend_path", "import_module", "iter_modules")
    for name in [name for name in vars(slicer) if not name.startswith(("_", "vtk"))]:
        if name in helpers or (hasattr(util, name) and getattr(slicer, name) is getattr(util, name)):
            delattr(slicer, name)
    slicer.util = util


def _register_fonts() -> None:
    """Where the machine has no fonts, text would be drawn as boxes: Matplotlib's DejaVu serves then."""
    from PySide6 import QtGui

    if QtGui.QFontDatabase.families():
        return
    found = importlib.util.find_spec("matplotlib")
    if found is not None and found.origin is not None:
        for file in sorted((Path(found.origin).parent / "mpl-data" / "fonts" / "ttf").glob("DejaVuSans*.ttf")):
            QtGui.QFontDatabase.addApplicationFont(str(file))


def _quiet() -> None:
    """Keeps the offscreen platform from saying, for every window, what it lacks; all else that Qt says goes to stderr."""
    from PySide6 import QtCore

    def say(kind, context, text):
        if not text.startswith("This plugin does not support"):
            print(text, file=sys.stderr)

    QtCore.qInstallMessageHandler(say)


class _Running:
    host: SlicerHost | None = None


def runHost(testing: bool | None = None) -> SlicerHost:
    """The host of this process; made at the first call.

    Parameters
    ----------
    testing : bool, optional
        See `SlicerHost`; changes an existing host too.
    """
    if _Running.host is None:
        _Running.host = SlicerHost(bool(testing))
    elif testing is not None:
        _Running.host._application.testing = testing
    return _Running.host

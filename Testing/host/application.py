"""What Slicer's application object offers to Python, as far as a module may need it."""

from __future__ import annotations

from PySide6 import QtCore, QtWidgets
from PySide6.QtCore import Property, Signal

from .node_combo_box import kept
from .views import qSlicerLayoutManager
from .windows import qSlicerMainWindow

VERSION = (5, 11)
"""The Slicer that the host takes itself for."""


class qSlicerModuleManager(QtCore.QObject):
    """The modules, and the signals of their coming and going."""

    api = {
        "methods": ("module",),
        "signals": {"moduleLoaded(QString)": "moduleLoaded", "moduleAboutToBeUnloaded(QString)": "moduleAboutToBeUnloaded"},
    }
    moduleLoaded = Signal(str)
    moduleAboutToBeUnloaded = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.loaded: dict = {}

    def module(self, name):
        return self.loaded.get(name)


class qSlicerCommandOptions(QtCore.QObject):
    """What was asked for when the application was started: nothing. `slicer.util.exit` writes into it."""

    api: dict = {}
    runPythonAndExit = kept("runPythonAndExit", bool, False)


class qSlicerApplication(QtWidgets.QApplication):
    """The application.

    Parameters
    ----------
    folder : str
        Where temporary files and settings go.
    testing : bool
        Whether it says that it runs tests; `slicer.util` then shows no message boxes.
    """

    api = {
        "methods": (
            *("applicationLogic", "commandOptions", "moduleManager", "layoutManager"),
            *("settings", "userSettings", "testingEnabled", "pauseRender", "resumeRender"),
        ),
        "signals": {"startupCompleted()": "startupCompleted", "renderPaused(bool)": "renderPaused"},
    }
    startupCompleted = Signal()
    renderPaused = Signal(bool)

    def __init__(self, folder: str, testing: bool):
        super().__init__(["Slicer", "-style", "fusion"])
        self.setApplicationName("Slicer")
        self.setOrganizationName("NA-MIC")
        self.setQuitOnLastWindowClosed(False)
        QtCore.QSettings.setDefaultFormat(QtCore.QSettings.Format.IniFormat)
        for scope in (QtCore.QSettings.Scope.UserScope, QtCore.QSettings.Scope.SystemScope):
            QtCore.QSettings.setPath(QtCore.QSettings.Format.IniFormat, scope, folder)
        self._folder = folder
        self.testing = testing
        self._mrml = None
        self._settings = QtCore.QSettings()
        self._manager = qSlicerModuleManager()
        self._options = qSlicerCommandOptions()

    def start(self, mrml):
        self._mrml = mrml
        self._layout_manager = qSlicerLayoutManager(mrml)
        self.window = qSlicerMainWindow(self._manager)
        self.window.show()

    def applicationLogic(self):
        return self._mrml.applicationLogic

    def moduleManager(self):
        return self._manager

    def layoutManager(self):
        return self._layout_manager

    def commandOptions(self):
        return self._options

    def settings(self):
        return self._settings

    userSettings = settings

    def testingEnabled(self):
        return self.testing

    def pauseRender(self):
        self.renderPaused.emit(True)

    def resumeRender(self):
        self.renderPaused.emit(False)

    temporaryPath = Property(str, lambda self: self._folder)

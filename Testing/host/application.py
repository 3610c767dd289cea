"""What Slicer's application object offers to Python, as far as a module may need it."""

from __future__ import annotations

from PySide6 import QtCore, QtWidgets
from PySide6.QtCore import Property, Signal

VERSION = (5, 11)
"""The Slicer that the host takes itself for."""


class qMRMLSliceWidget(QtWidgets.QWidget):
    """A slice view: its node and logic are real, nothing is drawn."""

    api = {"methods": ("sliceLogic", "mrmlSliceNode", "mrmlSliceCompositeNode", "fitSliceToBackground")}

    def __init__(self, logic):
        super().__init__()
        self._logic = logic

    def sliceLogic(self):
        """The slice's logic."""
        return self._logic

    def mrmlSliceNode(self):
        """The slice's node."""
        return self._logic.GetSliceNode()

    def mrmlSliceCompositeNode(self):
        """The node that says which volumes the slice shows."""
        return self._logic.GetSliceCompositeNode()

    def fitSliceToBackground(self):
        """Makes the background volume fill the view."""
        self._logic.FitSliceToBackground()


class qSlicerLayoutManager(QtCore.QObject):
    """The views: nodes and logics are real, nothing is drawn."""

    api = {
        "methods": (
            "mrmlScene",
            "sliceWidget",
            "sliceViewNames",
            "mrmlSliceLogics",
            "layoutLogic",
            "setLayout",
            "resetThreeDViews",
            "resetSliceViews",
            "pauseRender",
            "resumeRender",
            "setRenderPaused",
        ),
        "signals": {"layoutChanged(int)": "layoutChanged"},
    }
    layoutChanged = Signal(int)

    def __init__(self, mrml):
        super().__init__()
        self._mrml = mrml
        self._widgets: dict = {}

    def _node(self):
        return self._mrml.scene.GetFirstNodeByClass("vtkMRMLLayoutNode")

    def mrmlScene(self):
        """The scene."""
        return self._mrml.scene

    def _logics(self) -> dict:
        logics = self._mrml.applicationLogic.GetSliceLogics()
        found = [logics.GetItemAsObject(i) for i in range(logics.GetNumberOfItems())]
        return {logic.GetSliceNode().GetLayoutName(): logic for logic in found if logic.GetSliceNode() is not None}

    def sliceViewNames(self):
        """The names of the slice views that the layout shows."""
        return [name for name, logic in self._logics().items() if logic.GetSliceNode().IsMappedInLayout()]

    def sliceWidget(self, name):
        """A slice view by name, or None."""
        logic = self._logics().get(name)
        if logic is None:
            return None
        if name not in self._widgets or self._widgets[name].sliceLogic() is not logic:
            self._widgets[name] = qMRMLSliceWidget(logic)
        return self._widgets[name]

    def mrmlSliceLogics(self):
        """The logics of all slice views."""
        return self._mrml.applicationLogic.GetSliceLogics()

    def layoutLogic(self):
        """The layout's logic."""
        return self._mrml.layoutLogic

    def setLayout(self, layout):
        """Shows another layout."""
        self._node().SetViewArrangement(layout)
        self.layoutChanged.emit(layout)

    def resetThreeDViews(self):
        """Does nothing: there is no 3D view."""

    def resetSliceViews(self):
        """Makes what the slice views show fill them."""
        for logic in self._logics().values():
            logic.FitSliceToBackground()

    def pauseRender(self):
        """Does nothing: nothing is drawn."""

    def resumeRender(self):
        """Does nothing: nothing is drawn."""

    def setRenderPaused(self, paused):
        """Does nothing: nothing is drawn."""

    layout = Property(int, lambda self: self._node().GetViewArrangement(), setLayout)
    threeDViewCount = Property(int, lambda self: 0)
    tableViewCount = Property(int, lambda self: 0)
    plotViewCount = Property(int, lambda self: 0)


class qSlicerModuleFactoryManager(QtCore.QObject):
    """Which modules were loaded."""

    api = {"methods": ("loadedModuleNames", "isLoaded", "registeredModuleNames", "instantiatedModuleNames")}

    def __init__(self, modules):
        super().__init__()
        self._modules = modules

    def loadedModuleNames(self):
        """The names of the modules."""
        return list(self._modules)

    registeredModuleNames = instantiatedModuleNames = loadedModuleNames

    def isLoaded(self, name):
        """Whether a module was loaded."""
        return name in self._modules


class qSlicerModuleManager(QtCore.QObject):
    """The modules, and the signals of their coming and going."""

    api = {
        "methods": ("factoryManager", "modulesNames", "module"),
        "signals": {"moduleLoaded(QString)": "moduleLoaded", "moduleAboutToBeUnloaded(QString)": "moduleAboutToBeUnloaded"},
    }
    moduleLoaded = Signal(str)
    moduleAboutToBeUnloaded = Signal(str)

    def __init__(self):
        super().__init__()
        self.loaded: dict = {}
        self._factory = qSlicerModuleFactoryManager(self.loaded)

    def factoryManager(self):
        """Which modules were loaded."""
        return self._factory

    def modulesNames(self):
        """The names of the modules."""
        return list(self.loaded)

    def module(self, name):
        """A module by name, or None."""
        return self.loaded.get(name)


class qSlicerModuleSelectorToolBar(QtWidgets.QWidget):
    """Opens modules."""

    api = {"methods": ("selectModule",), "signals": {"moduleSelected(QString)": "moduleSelected"}}
    moduleSelected = Signal(str)

    def __init__(self, manager):
        super().__init__()
        self._manager = manager
        self._current = ""

    def selectModule(self, name):
        """Leaves the module that is open and enters another; "" only leaves."""
        previous = self._manager.module(self._current)
        if previous is not None and previous.widgetRepresentation() is not None:
            previous.widgetRepresentation().exit()
        self._current = name
        module = self._manager.module(name)
        if module is not None and module.widgetRepresentation() is not None:
            module.widgetRepresentation().enter()
        self.moduleSelected.emit(name)

    selectedModule = Property(str, lambda self: self._current)


class qSlicerMainWindow(QtWidgets.QMainWindow):
    """The main window, never shown."""

    api = {"methods": ("moduleSelector",)}

    def __init__(self, manager):
        super().__init__()
        self.setObjectName("qSlicerMainWindow")
        self._selector = qSlicerModuleSelectorToolBar(manager)

    def moduleSelector(self):
        """What opens modules."""
        return self._selector


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
            "mrmlScene",
            "applicationLogic",
            "moduleLogic",
            "moduleManager",
            "layoutManager",
            "settings",
            "userSettings",
            "revisionUserSettings",
            "defaultSettings",
            "testingEnabled",
            "moduleDocumentationUrl",
            "toSlicerHomeAbsolutePath",
            "startupEnvironment",
            "pauseRender",
            "resumeRender",
            "setRenderPaused",
            "restart",
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

    def start(self, mrml):
        """Gives the application its scene and views, a `MRMLApplication`."""
        self._mrml = mrml
        self._layout_manager = qSlicerLayoutManager(mrml)
        self.window = qSlicerMainWindow(self._manager)

    def mrmlScene(self):
        """The scene."""
        return self._mrml.scene

    def applicationLogic(self):
        """The application's logic."""
        return self._mrml.applicationLogic

    def moduleLogic(self, name):
        """A module's logic, by the module's name."""
        return self._mrml.logics.get(name)

    def moduleManager(self):
        """The modules."""
        return self._manager

    def layoutManager(self):
        """The views."""
        return self._layout_manager

    def settings(self):
        """The settings, in the host's temporary folder."""
        return self._settings

    userSettings = revisionUserSettings = defaultSettings = settings

    def testingEnabled(self):
        """Whether the application runs tests."""
        return self.testing

    def moduleDocumentationUrl(self, name):
        """Where a module is documented."""
        return f"{self.documentationBaseUrl}/user_guide/modules/{name.lower()}.html"

    def toSlicerHomeAbsolutePath(self, path):
        """A path below the application's folder."""
        return str(QtCore.QDir(self._folder).absoluteFilePath(path))

    def startupEnvironment(self):
        """The environment."""
        return QtCore.QProcessEnvironment.systemEnvironment()

    def pauseRender(self):
        """Says that drawing pauses."""
        self.renderPaused.emit(True)

    def resumeRender(self):
        """Says that drawing goes on."""
        self.renderPaused.emit(False)

    def setRenderPaused(self, paused):
        """Says that drawing pauses or goes on."""
        self.renderPaused.emit(paused)

    def restart(self):
        """Does nothing here."""

    temporaryPath = Property(str, lambda self: self._folder)
    slicerHome = Property(str, lambda self: self._folder)
    cachePath = Property(str, lambda self: self._folder)
    documentationBaseUrl = Property(str, lambda self: "https://slicer.readthedocs.io/en/latest")
    majorVersion = Property(int, lambda self: VERSION[0])
    minorVersion = Property(int, lambda self: VERSION[1])
    revision = Property(str, lambda self: "0")
    repositoryRevision = Property(str, lambda self: "0")
    intDir = Property(str, lambda self: "")

"""A small scripted module, written to a folder, on which the tests of the host are run."""

from __future__ import annotations

from pathlib import Path

SOURCE = """
import enum
import pathlib
from typing import Annotated

import slicer
import vtk
from slicer import vtkMRMLModelNode, vtkMRMLScalarVolumeNode
from slicer.i18n import tr as _
from slicer.i18n import translate
from slicer.parameterNodeWrapper import Choice, Default, Minimum, WithinRange, parameterNodeWrapper
from slicer.ScriptedLoadableModule import *
from slicer.util import VTKObservationMixin


class Color(enum.Enum):
    RED = "red"
    GREEN = "green"

    def label(self):
        return _("Color {name}").format(name=self.value)


class Tiny(ScriptedLoadableModule):
    def __init__(self, parent):
        ScriptedLoadableModule.__init__(self, parent)
        parent.title = _("Tiny")
        parent.categories = [translate("qSlicerAbstractCoreModule", "Examples")]
        slicer.app.connect("startupCompleted()", started)


def started():
    slicer.modules.tinyStarted = True


@parameterNodeWrapper
class TinyParameterNode:
    volume: vtkMRMLScalarVolumeNode | None
    shape: vtkMRMLScalarVolumeNode | vtkMRMLModelNode | None
    threshold: Annotated[float, WithinRange(-10, 10)] = 2.5
    count: Annotated[int, Minimum(1)] = 3
    bright: bool = True
    color: Color = Color.GREEN
    word: Annotated[str, Choice(["one", "two"]), Default("two")]
    path: pathlib.Path
    names: list[str]


class TinyWidget(ScriptedLoadableModuleWidget, VTKObservationMixin):
    def __init__(self, parent=None):
        ScriptedLoadableModuleWidget.__init__(self, parent)
        VTKObservationMixin.__init__(self)
        self.log = []
        self._parameterNode = None
        self._tag = None

    def setup(self):
        ScriptedLoadableModuleWidget.setup(self)
        panel = slicer.util.loadUI(self.resourcePath("UI/Tiny.ui"))
        self.layout.addWidget(panel)
        self.ui = slicer.util.childWidgetVariables(panel)
        panel.setMRMLScene(slicer.mrmlScene)
        self.logic = TinyLogic()
        self.addObserver(slicer.mrmlScene, slicer.mrmlScene.StartCloseEvent, self.onStartClose)
        self.addObserver(slicer.mrmlScene, slicer.mrmlScene.EndCloseEvent, self.onEndClose)
        self.ui.applyButton.connect("clicked(bool)", self.onApply)
        self.take()
        self.log.append("setup")

    def cleanup(self):
        self.drop()
        self.removeObservers()
        self.log.append("cleanup")

    def enter(self):
        self.take()
        self.log.append("enter")

    def exit(self):
        self.drop()
        self.log.append("exit")

    def onStartClose(self, caller, event):
        self.drop()
        self.log.append("StartClose")

    def onEndClose(self, caller, event):
        if self.parent.isEntered:
            self.take()
        self.log.append("EndClose")

    def take(self):
        self.drop()
        self._parameterNode = self.logic.getParameterNode()
        self._tag = self._parameterNode.connectGui(self.ui)
        self.addObserver(self._parameterNode, vtk.vtkCommand.ModifiedEvent, self.check)
        self.check()

    def drop(self):
        if self._parameterNode:
            self._parameterNode.disconnectGui(self._tag)
            self.removeObserver(self._parameterNode, vtk.vtkCommand.ModifiedEvent, self.check)
        self._parameterNode = None

    def check(self, caller=None, event=None):
        ready = self._parameterNode is not None and self._parameterNode.volume is not None
        self.ui.applyButton.enabled = ready
        self.ui.applyButton.toolTip = _("Run") if ready else _("Select a volume")

    def onApply(self):
        with slicer.util.tryWithErrorDisplay(_("It failed."), waitCursor=True):
            self.logic.run(self._parameterNode)


class TinyLogic(ScriptedLoadableModuleLogic):
    def getParameterNode(self):
        return TinyParameterNode(super().getParameterNode())

    def run(self, parameters):
        dialog = slicer.util.createProgressDialog(labelText="Begin", windowTitle="Tiny", maximum=10)
        try:
            for step in range(1, 11):
                dialog.value = step
                slicer.app.processEvents()
                if dialog.wasCanceled:
                    return "canceled"
        finally:
            dialog.close()
        if parameters.word == "one":
            raise ValueError("Input word must not be one")
        return "done"


class TinyTest(ScriptedLoadableModuleTest):
    ran = []

    def setUp(self):
        slicer.mrmlScene.Clear()

    def test_first(self):
        TinyTest.ran.append("first")

    def test_second(self):
        TinyTest.ran.append("second")
        self.assertEqual(TinyLogic().getParameterNode().count, 3)
"""

WIDGETS = (
    ("qMRMLNodeComboBox", "volumeSelector", "volume", ""),
    ("qMRMLNodeComboBox", "shapeSelector", "shape", ""),
    ("ctkSliderWidget", "thresholdSlider", "threshold", ""),
    ("QSpinBox", "countSpinBox", "count", ""),
    ("QCheckBox", "brightCheckBox", "bright", ""),
    ("QComboBox", "colorComboBox", "color", ""),
    ("QComboBox", "wordComboBox", "word", ""),
    ("ctkPathLineEdit", "pathLineEdit", "path", ""),
)
NO_NODE = '<property name="noneEnabled"><bool>true</bool></property>'


def ui(connected=("volumeSelector", "shapeSelector"), more="", connections="") -> str:
    """The text of the module's .ui file.

    Parameters
    ----------
    connected : sequence of str
        The node selectors that get the scene.
    more, connections : str
        Further items of the layout, further connections.
    """
    items = "".join(
        f'<item><widget class="{kind}" name="{name}">{NO_NODE if kind == "qMRMLNodeComboBox" else ""}{extra}'
        f'<property name="SlicerParameterName" stdset="0"><string>{parameter}</string></property></widget></item>'
        for kind, name, parameter, extra in WIDGETS
    )
    links = "".join(
        f"<connection><sender>Tiny</sender><signal>mrmlSceneChanged(vtkMRMLScene*)</signal>"
        f"<receiver>{name}</receiver><slot>setMRMLScene(vtkMRMLScene*)</slot></connection>"
        for name in connected
    )
    return (
        '<ui version="4.0"><class>Tiny</class><widget class="qMRMLWidget" name="Tiny"><layout class="QVBoxLayout" name="outer">'
        '<item><widget class="ctkCollapsibleButton" name="section"><property name="text"><string>Section</string></property>'
        f'<layout class="QVBoxLayout" name="inner">{items}{more}</layout></widget></item>'
        '<item><widget class="QPushButton" name="applyButton"><property name="text"><string>Apply</string></property></widget></item>'
        f"</layout></widget><resources/><connections>{links}{connections}</connections></ui>"
    )


def write_module(folder: Path, **changes) -> Path:
    """Writes the module and its .ui file; returns the module's path."""
    (folder / "Resources" / "UI").mkdir(parents=True, exist_ok=True)
    (folder / "Resources" / "UI" / "Tiny.ui").write_text(ui(**changes), "utf-8")
    path = folder / "Tiny.py"
    path.write_text(SOURCE, "utf-8")
    return path

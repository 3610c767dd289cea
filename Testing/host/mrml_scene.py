"""A MRML scene as Slicer's application sets it up, without Qt: real nodes and real logics from slicer-core.

What the application does before a module sees the scene is repeated here: the application logic with its selection, interaction and
crosshair nodes, the logics of the modules that register node classes (sequences, markups, segmentations, volume rendering, ...), the
layout logic that makes view and slice nodes from a layout, and a slice logic for every slice node.

Limits: no view renders, so nothing that only a displayable manager or a view widget does happens here. What Slicer reads
from its share directory is missing: presets of volume rendering (but for a plain one), color files, terminologies.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import slicer
import vtk

SLICE_VIEW_SIZE = (480, 360)
"""Pixels that a slice view is taken to have; fitting a slice to a volume needs some."""

LOGICS = {
    "Colors": "vtkSlicerColorLogic",
    "Cameras": "vtkSlicerCamerasModuleLogic",
    "Units": "vtkSlicerUnitsLogic",
    "SubjectHierarchy": "vtkSlicerSubjectHierarchyModuleLogic",
    "Markups": "vtkSlicerMarkupsLogic",
    "Models": "vtkSlicerModelsLogic",
    "Tables": "vtkSlicerTablesLogic",
    "Texts": "vtkSlicerTextsLogic",
    "Transforms": "vtkSlicerTransformLogic",
    "Volumes": "vtkSlicerVolumesLogic",
    "VolumeRendering": "vtkSlicerVolumeRenderingLogic",
    "Segmentations": "vtkSlicerSegmentationsModuleLogic",
    "Sequences": "vtkSlicerSequencesLogic",
}
"""Module name -> class of its logic, in the order in which they are set up."""

COMPLAIN_WITHOUT_SCENE = ("SubjectHierarchy", "Segmentations")
"""Their logics log a warning when their scene is taken away; they go with the scene instead."""


class MRMLApplication:
    """A scene and everything that belongs to it.

    Attributes
    ----------
    scene : vtkMRMLScene
    applicationLogic : vtkSlicerApplicationLogic
    layoutLogic : vtkMRMLLayoutLogic
    logics : dict of str to vtkMRMLAbstractLogic
        By Slicer's module name ("Sequences") and by that name in lower case ("sequences").
    """

    def __init__(self):
        self.scene = slicer.vtkMRMLScene()
        self.temporaryFolder = tempfile.TemporaryDirectory(prefix="aifrecon-mrml-", ignore_cleanup_errors=True)
        self.applicationLogic = slicer.vtkSlicerApplicationLogic()
        self.applicationLogic.SetTemporaryPath(self.temporaryFolder.name)
        # Color files are looked for in <home>/<share>/ColorFiles; there are none
        (Path(self.temporaryFolder.name) / "share" / "ColorFiles").mkdir(parents=True)
        self.applicationLogic.SetHomeDirectory(self.temporaryFolder.name)
        self.applicationLogic.SetShareDirectory("share")
        self._addDataIO()
        crosshair = slicer.vtkMRMLCrosshairNode()
        crosshair.SetCrosshairName("default")
        self.scene.AddNode(crosshair)
        self.applicationLogic.SetMRMLScene(self.scene)
        self.logics = {}
        for module, className in LOGICS.items():
            self._addLogic(module, className)
        self._sliceLogics = vtk.vtkCollection()
        self.applicationLogic.SetSliceLogics(self._sliceLogics)
        self._observers = [
            self.scene.AddObserver(slicer.vtkMRMLScene.NodeAddedEvent, self._onNodeAdded),
            self.scene.AddObserver(slicer.vtkMRMLScene.NodeRemovedEvent, self._onNodeRemoved),
            self.scene.AddObserver(slicer.vtkMRMLScene.EndImportEvent, self._onSceneImported),
            self.scene.AddObserver(slicer.vtkMRMLScene.EndCloseEvent, self._onSceneImported),
        ]
        self.layoutLogic = slicer.vtkMRMLLayoutLogic()
        self.layoutLogic.SetMRMLApplicationLogic(self.applicationLogic)
        self.layoutLogic.SetMRMLScene(self.scene)
        self.scene.GetFirstNodeByClass("vtkMRMLLayoutNode").SetViewArrangement(slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView)

    def close(self) -> None:
        """Let go of the scene: logics first, so that none of them hears of the nodes' end."""
        for tag in self._observers:
            self.scene.RemoveObserver(tag)
        self._observers = []
        for index in range(self._sliceLogics.GetNumberOfItems()):
            self._sliceLogics.GetItemAsObject(index).SetMRMLScene(None)
        self._sliceLogics.RemoveAllItems()
        self.layoutLogic.SetMRMLScene(None)
        for module in reversed([module for module in LOGICS if module not in COMPLAIN_WITHOUT_SCENE]):
            self.logics[module].SetMRMLScene(None)
        self.logics = {}
        self.applicationLogic.SetMRMLScene(None)
        self.scene.Clear(True)
        self.temporaryFolder.cleanup()

    def _addDataIO(self) -> None:
        self._cache = slicer.vtkCacheManager()
        folder = Path(self.temporaryFolder.name) / "cache"
        folder.mkdir()
        self._cache.CreateSentinelFileInDirectory(str(folder))
        self._cache.SetRemoteCacheDirectory(str(folder))
        self._cache.SetMRMLScene(self.scene)
        self._dataIO = slicer.vtkDataIOManager()
        self._dataIO.SetCacheManager(self._cache)
        self.scene.SetCacheManager(self._cache)
        self.scene.SetDataIOManager(self._dataIO)

    def _addLogic(self, module: str, className: str) -> None:
        logic = getattr(slicer, className)()
        logic.SetMRMLApplicationLogic(self.applicationLogic)
        if module == "VolumeRendering":
            logic.RegisterRenderingMethod("VTK CPU Ray Casting", "vtkMRMLCPURayCastVolumeRenderingDisplayNode")
            logic.RegisterRenderingMethod("VTK GPU Ray Casting", "vtkMRMLGPURayCastVolumeRenderingDisplayNode")
            logic.SetDefaultRenderingMethod("vtkMRMLGPURayCastVolumeRenderingDisplayNode")
            logic.SetModuleShareDirectory(str(self._presets()))
        if module == "Colors":
            self.applicationLogic.SetColorLogic(logic)
        logic.SetMRMLScene(self.scene)
        self.applicationLogic.SetModuleLogic(module, logic)
        self.logics[module] = self.logics[module.lower()] = logic

    def _presets(self) -> Path:
        """A folder with the one preset that the logic takes for granted: of 8-bit volumes. Here it is a plain one."""
        folder = Path(self.temporaryFolder.name) / "VolumeRendering"
        folder.mkdir()
        preset = '<VolumeProperty id="vtkMRMLVolumePropertyNode1" name="US-Fetal" selectable="true"></VolumeProperty>'
        (folder / "presets.xml").write_text(f'<MRML version="Slicer4" userTags="">{preset}</MRML>', encoding="utf-8")
        return folder

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _onNodeAdded(self, caller, event, node) -> None:
        if node.IsA("vtkMRMLSliceNode") and not self.scene.IsImporting():
            self._addSliceLogic(node)

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _onNodeRemoved(self, caller, event, node) -> None:
        if not node.IsA("vtkMRMLSliceNode"):
            return
        logic = self.applicationLogic.GetSliceLogic(node)
        if logic is not None:
            self._sliceLogics.RemoveItem(logic)

    def _onSceneImported(self, caller, event) -> None:
        for index in range(self.scene.GetNumberOfNodesByClass("vtkMRMLSliceNode")):
            node = self.scene.GetNthNodeByClass(index, "vtkMRMLSliceNode")
            if self.applicationLogic.GetSliceLogic(node) is None:
                self._addSliceLogic(node)

    def _addSliceLogic(self, sliceNode) -> None:
        logic = slicer.vtkMRMLSliceLogic()
        logic.SetMRMLApplicationLogic(self.applicationLogic)
        # The collection comes first: nodes that the logic adds make others ask which logics there are
        self._sliceLogics.AddItem(logic)
        logic.SetMRMLScene(self.scene)
        logic.SetSliceNode(sliceNode)
        sliceNode.SetDimensions(*SLICE_VIEW_SIZE, 1)


def createScene():
    """A new scene with its application: `scene.host` is the `MRMLApplication`, which must be closed by `scene.host.close()`."""
    application = MRMLApplication()
    application.scene.host = application
    return application.scene

"""The views of the application: their nodes, logics and cameras are real, nothing is drawn.

As in Slicer, a slice view fits its field of view to the size of its widget whenever events are handled after either has changed, and a 3D
view looks at what appears in it only when it is told to. A slice view's own controls follow what it shows, and save a step of undo for
every such change.
"""

from __future__ import annotations

import types

import slicer
import vtk
from PySide6 import QtCore, QtWidgets
from PySide6.QtCore import Property

from .node_combo_box import kept


class ctkVTKAbstractView(QtWidgets.QWidget):
    """What a view draws into; nothing is drawn."""

    maximumUpdateRate = kept("maximumUpdateRate", float, 60.0)


class qMRMLSliceWidget(QtWidgets.QWidget):
    """A slice view: its node and logic are real, nothing is drawn."""

    api = {
        "methods": (*("sliceLogic", "sliceView", "mrmlSliceNode", "mrmlSliceCompositeNode"),),
    }

    def __init__(self, logic):
        super().__init__()
        self._logic = logic
        self._view = ctkVTKAbstractView()

    def sliceView(self):
        return self._view

    def sliceLogic(self):
        return self._logic

    def mrmlSliceNode(self):
        return self._logic.GetSliceNode()

    def mrmlSliceCompositeNode(self):
        return self._logic.GetSliceCompositeNode()


class qMRMLThreeDView(ctkVTKAbstractView):
    """What a 3D view draws into: its node and camera are real, nothing is drawn."""

    api = {
        "methods": ("mrmlViewNode", "cameraNode", "resetFocalPoint", "resetCamera", "cornerAnnotation", "scheduleRender", "renderWindow")
    }

    def __init__(self, node):
        super().__init__()
        self._node = node
        self._annotation = vtk.vtkCornerAnnotation()
        self._annotation.SetMaximumLineHeight(0.07)  # as CTK's views do

    def cornerAnnotation(self):
        return self._annotation

    def scheduleRender(self):
        """Draws the view soon; here never."""

    def renderWindow(self):
        renderers = vtk.vtkRendererCollection()
        renderers.AddItem(self._renderer(self._node.GetBoxVisible()))
        return types.SimpleNamespace(GetRenderers=lambda: renderers)

    def _renderer(self, with_box):
        """With a box in the place of all that shows, of what the view's own box is drawn around, and the text, which has no place."""
        renderer = vtk.vtkRenderer()
        renderer.GetActiveCamera()
        renderer.AddViewProp(self._annotation)
        for node in slicer.util.getNodesByClass("vtkMRMLDisplayableNode", self._node.GetScene()):
            displays = [node.GetNthDisplayNode(number) for number in range(node.GetNumberOfDisplayNodes())]
            shown = []
            if any(_showsIn3D(node, display) for display in displays if display is not None):
                shown += _surfaceBounds(node) if node.IsA("vtkMRMLSegmentationNode") else [_rasBounds(node)]
            if with_box and any(display is not None and display.IsDisplayableInView(self._node.GetID()) for display in displays):
                # Volumes too, which 3D views do not show
                shown += [] if slicer.vtkMRMLSliceLogic.IsSliceModelNode(node) else [_rasBounds(node)]
            for bounds in filter(vtk.vtkMath.AreBoundsInitialized, shown):
                renderer.AddActor(_boxActor(bounds))
        return renderer

    def mrmlViewNode(self):
        return self._node

    def cameraNode(self):
        return cameraOf(self._node)

    def resetFocalPoint(self):
        camera = self.cameraNode()
        bounds = self._renderer(False).ComputeVisiblePropBounds()
        if vtk.vtkMath.AreBoundsInitialized(bounds):
            camera.SetFocalPoint([(bounds[axis] + bounds[axis + 1]) / 2 for axis in (0, 2, 4)])

    def resetCamera(self, rotation=True, translation=True, distance=True):
        """Looks at what appears from a main axis, and takes all of it in, its box too where the view shows one."""
        self.cameraNode().Reset(rotation, translation, distance, self._renderer(self._node.GetBoxVisible()))


class qMRMLThreeDWidget(QtWidgets.QWidget):
    """A 3D view under its bar."""

    api = {"methods": ("mrmlViewNode", "threeDView")}

    def __init__(self, node):
        super().__init__()
        self._view = qMRMLThreeDView(node)

    def mrmlViewNode(self):
        return self._view.mrmlViewNode()

    def threeDView(self):
        return self._view


def cameraOf(viewNode):
    """The camera of a 3D view: the view makes it, at Slicer's first place for it, and lets it be from then on."""
    scene, name = viewNode.GetScene(), viewNode.GetLayoutName()
    camera = scene.GetSingletonNode(name, "vtkMRMLCameraNode")
    if camera is None:
        camera = slicer.vtkMRMLCameraNode()
        camera.SetName("Camera")
        camera.SetLayoutName(name)
        camera = scene.AddNode(camera)
    return camera


def _boxActor(bounds):
    box = vtk.vtkCubeSource()
    box.SetBounds(bounds)
    box.Update()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(box.GetOutput())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    return actor


def _rasBounds(node) -> list[float]:
    bounds = [0.0] * 6
    node.GetRASBounds(bounds)
    return bounds


def _surfaceBounds(node):
    """Of what is drawn of each segment; the node's own bounds are those of its labels' whole image."""
    toRAS = vtk.vtkGeneralTransform()
    slicer.vtkMRMLTransformNode.GetTransformBetweenNodes(node.GetParentTransformNode(), None, toRAS)
    for segmentID in node.GetSegmentation().GetSegmentIDs():
        inWorld = vtk.vtkTransformPolyDataFilter()
        inWorld.SetTransform(toRAS)
        inWorld.SetInputData(node.GetClosedSurfaceInternalRepresentation(segmentID))
        inWorld.Update()
        yield inWorld.GetOutput().GetBounds()


def _showsIn3D(node, display) -> bool:
    if not display.GetVisibility():
        return False
    if node.IsA("vtkMRMLVolumeNode"):
        return display.IsA("vtkMRMLVolumeRenderingDisplayNode")
    if node.IsA("vtkMRMLSegmentationNode"):
        surface = slicer.vtkSegmentationConverter.GetClosedSurfaceRepresentationName()
        return bool(display.GetVisibility3D()) and node.GetSegmentation().ContainsRepresentation(surface)
    return bool(display.GetVisibility3D()) and (node.IsA("vtkMRMLModelNode") or node.IsA("vtkMRMLMarkupsNode"))


class _SavesUndo:
    """The controls of a slice view, to which it is the user who changes opacities and interpolation, whoever did."""

    def __init__(self, composite):
        self._shown = _layers(composite)

    def __call__(self, composite, event) -> None:
        before, self._shown = self._shown, _layers(composite)
        if before != self._shown and composite.GetScene() is not None:
            composite.GetScene().SaveStateForUndo()


def _layers(composite) -> tuple:
    volumes = composite.GetBackgroundVolumeID(), composite.GetForegroundVolumeID(), composite.GetLabelVolumeID()
    return (*volumes, composite.GetForegroundOpacity(), composite.GetLabelOpacity())


class qSlicerLayoutManager(QtCore.QObject):
    """The views: nodes and logics are real, nothing is drawn."""

    api = {
        "methods": (*("sliceWidget", "sliceViewNames", "threeDWidget", "setLayout"),),
    }

    def __init__(self, mrml) -> None:
        super().__init__()
        self._mrml = mrml
        self._widgets: dict = {}
        self._observed: dict = {}
        self._fitting = QtCore.QTimer(self)
        self._fitting.setSingleShot(True)
        self._fitting.timeout.connect(self._fit)
        scene = mrml.scene
        self._tag = scene.AddObserver(scene.NodeAddedEvent, self._nodeAdded)
        self._watch()

    def stop(self):
        self._mrml.scene.RemoveObserver(self._tag)
        for node, tag in self._observed.values():
            node.RemoveObserver(tag)
        self._observed = {}

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _nodeAdded(self, caller, event, node):
        if node.IsA("vtkMRMLSliceNode") or node.IsA("vtkMRMLViewNode"):
            self._watch()

    def _watch(self):
        """Fits every slice view after it has changed, and gives every 3D view its camera."""
        for name, logic in self._logics().items():
            self._observe(name, logic.GetSliceNode(), lambda _: lambda *_: self._fitting.start(0))
            self._observe((name, "layers"), logic.GetSliceCompositeNode(), _SavesUndo)
        for node in self._viewNodes():
            cameraOf(node)
        self._observe("layout", self._node(), lambda _: lambda *_: self._map())
        self._map()

    def _observe(self, key, node, make):
        if node is not None and self._observed.get(key, (None, 0))[0] is not node:
            self._observed[key] = node, node.AddObserver("ModifiedEvent", make(node))

    def _map(self):
        shown = self._mrml.layoutLogic.GetViewNodes()
        shown = [shown.GetItemAsObject(i) for i in range(shown.GetNumberOfItems())]
        for node in [logic.GetSliceNode() for logic in self._logics().values()] + self._viewNodes():
            node.SetMappedInLayout(any(node is each for each in shown))

    def _fit(self):
        for logic in self._logics().values():
            width, height, _depth = logic.GetSliceNode().GetDimensions()
            logic.ResizeSliceNode(width, height)

    def _node(self):
        return self._mrml.scene.GetFirstNodeByClass("vtkMRMLLayoutNode")

    def _logics(self) -> dict:
        logics = self._mrml.applicationLogic.GetSliceLogics()
        found = [logics.GetItemAsObject(i) for i in range(logics.GetNumberOfItems())]
        return {logic.GetSliceNode().GetLayoutName(): logic for logic in found if logic.GetSliceNode() is not None}

    def _viewNodes(self) -> list:
        scene = self._mrml.scene
        return [scene.GetNthNodeByClass(i, "vtkMRMLViewNode") for i in range(scene.GetNumberOfNodesByClass("vtkMRMLViewNode"))]

    def sliceViewNames(self):
        return [name for name, logic in self._logics().items() if logic.GetSliceNode().IsMappedInLayout()]

    def sliceWidget(self, name):
        logic = self._logics()[name]
        if name not in self._widgets or self._widgets[name].sliceLogic() is not logic:
            self._widgets[name] = qMRMLSliceWidget(logic)
        return self._widgets[name]

    def threeDWidget(self, number):
        """A 3D view, among those that the layout shows."""
        node = [node for node in self._viewNodes() if node.IsMappedInLayout()][number]
        if self._widgets.get(node.GetID()) is None or self._widgets[node.GetID()].mrmlViewNode() is not node:
            self._widgets[node.GetID()] = qMRMLThreeDWidget(node)
        return self._widgets[node.GetID()]

    def setLayout(self, layout):
        self._node().SetViewArrangement(layout)

    layout = Property(int, lambda self: self._node().GetViewArrangement(), setLayout)
    threeDViewCount = Property(int, lambda self: len([node for node in self._viewNodes() if node.IsMappedInLayout()]))

"""Bone in the colors of how squarely a scan has met it: a model of its own, with display, colors and legend of its own."""

import numpy as np
import slicer
import vtk
from slicer.i18n import tr as _
from vtk.util import numpy_support

from ..sceneNodes import nodesOfClass, removeNodes
from .borrowed import Borrowed

MET = "Met"
"""The array of the model's points."""

COLORS = ((0.32, 0.30, 0.29), (0.72, 0.72, 0.72), (0.00, 0.27, 0.68), (0.35, 0.76, 1.00), (1.00, 0.62, 0.00))
"""Of `AIFReconLib.guidance.mesh.OUT_OF_REACH` to `SQUARELY`: grays where nothing was met, blue to orange where something was. No two
of them are alike to the color-blind."""

HIDDEN = Borrowed("Visibility3D", False, "AIFRecon.HiddenIn3D")
"""Segments are not drawn in 3D while these colors are."""

LEGEND, LETTERS = (0.32, 0.42), 16
"""Part of a view that the legend takes, across and up, and its letters in points: Slicer makes them so small that the longest fits."""


class BoneColors:
    """One model node in the bone's own coordinates, under the bone's transform: it goes where the CT goes.

    Notes
    -----
    It is drawn from the scan, so it is neither saved with the scene nor offered where a model can be chosen. While nothing but colors
    changes, one array is written anew and nothing else is touched. Segments are not drawn in 3D meanwhile: their surface is the same, so
    that its color would show through in specks, and where it is translucent it takes a view several times as long to draw.
    """

    def __init__(self):
        self._modelID, self._ownIDs = None, []
        self._mesh = self._levels = None

    @property
    def node(self):
        """The model node, or None where nothing is drawn."""
        return slicer.mrmlScene.GetNodeByID(self._modelID) if self._modelID else None

    def show(self, bone, mesh, levels: np.ndarray):
        """Draw a `BoneMesh` of a node of bone, with the level of each corner (n,); the model node."""
        node = self.node
        if node is None:
            node = self._made(_surface(mesh, levels))
            self._mesh = mesh
        elif node.GetPolyData() is None or self._mesh is not mesh:
            node.SetAndObservePolyData(_surface(mesh, levels))
            self._mesh = mesh
        elif not np.array_equal(levels, self._levels):
            array = node.GetPolyData().GetPointData().GetArray(MET)
            numpy_support.vtk_to_numpy(array)[:] = levels
            array.Modified()
            node.GetPolyData().Modified()
        self._levels = levels
        if node.GetTransformNodeID() != bone.GetTransformNodeID():
            node.SetAndObserveTransformNodeID(bone.GetTransformNodeID())
        # Once: what the user shows again stays
        _hideSegments(bone)
        return node

    def clear(self) -> None:
        """Remove everything, also what is left where somebody has deleted the model alone."""
        scene = slicer.mrmlScene
        own = [scene.GetNodeByID(each) for each in self._ownIDs]
        self._modelID, self._ownIDs, self._mesh, self._levels = None, [], None, None
        _hideSegments(None)
        removeNodes(own, scene)

    def _made(self, surface):
        self.clear()
        scene = slicer.mrmlScene
        self._own(_colors())
        # With a display that is as it is to be, views look at the model once
        display = scene.AddNewNodeByClass("vtkMRMLModelDisplayNode")
        with slicer.util.NodeModify(display):
            display.SetAndObserveColorNodeID(self._ownIDs[0])
            display.SetActiveScalar(MET, vtk.vtkAssignAttribute.POINT_DATA)
            display.SetScalarRangeFlag(slicer.vtkMRMLDisplayNode.UseManualScalarRange)
            display.SetScalarRange(-0.5, len(COLORS) - 0.5)
            display.SetScalarVisibility(True)
            # Slices show bone already, and would have to cut this surface anew wherever the probe goes
            display.SetVisibility2D(False)
        self._own(display)
        node = slicer.vtkMRMLModelNode()
        node.SetName("Bone met")
        node.SetSelectable(False)
        node.SetAndObserveDisplayNodeID(display.GetID())
        node.SetAndObservePolyData(surface)
        self._own(scene.AddNode(node))
        legend = slicer.modules.colors.logic().AddDefaultColorLegendDisplayNode(node)
        if legend is not None:
            _arrange(legend)
            self._own(legend)
        self._modelID = node.GetID()
        return node

    def _own(self, node) -> None:
        node.SetSaveWithScene(False)
        self._ownIDs.append(node.GetID())


def _hideSegments(bone) -> None:
    """Do not draw these segments in 3D, but draw all others again that were hidden here."""
    isSegmented = bone is not None and bone.IsA("vtkMRMLSegmentationNode")
    HIDDEN.follow(bone.GetDisplayNode() if isSegmented else None)


def _colors():
    node = slicer.vtkMRMLColorTableNode()
    node.SetName("Colors of bone met")
    node.SetTypeToUser()
    node.SetHideFromEditors(True)
    node.SetNumberOfColors(len(COLORS))
    for number, (name, color) in enumerate(zip(levelNames(), COLORS)):
        node.SetColor(number, name, *color, 1.0)
    return slicer.mrmlScene.AddNode(node)


def levelNames() -> tuple:
    """What the colors stand for, in the user's language."""
    return _("out of reach"), _("not hit"), _("grazing, over 60\u00b0"), _("obliquely, 45 to 60\u00b0"), _("squarely, below 45\u00b0")


def _arrange(legend) -> None:
    with slicer.util.NodeModify(legend):
        legend.SetTitleText(_("How the beam hits bone"))
        legend.SetUseColorNamesForLabels(True)
        legend.SetMaxNumberOfColors(len(COLORS))
        legend.SetNumberOfLabels(len(COLORS))
        legend.SetSize(*LEGEND)
        legend.SetPosition(0.97, 0.1)
        for letters in (legend.GetTitleTextProperty(), legend.GetLabelTextProperty()):
            letters.SetFontFamilyToArial()
            letters.SetFontSize(LETTERS)
        # Slice views do not show these colors
        for view in nodesOfClass("vtkMRMLViewNode", slicer.mrmlScene):
            legend.AddViewNodeID(view.GetID())


def _surface(mesh, levels: np.ndarray) -> vtk.vtkPolyData:
    """Triangles as polydata with normals, which would otherwise be made at every change of color."""
    points, cells = vtk.vtkPoints(), vtk.vtkCellArray()
    points.SetData(numpy_support.numpy_to_vtk(np.ascontiguousarray(mesh.points_reference, dtype=np.float32), deep=True))
    cells.SetData(3, numpy_support.numpy_to_vtkIdTypeArray(np.ascontiguousarray(mesh.triangles.ravel(), dtype=np.int64), deep=True))
    drawn = vtk.vtkPolyData()
    drawn.SetPoints(points)
    drawn.SetPolys(cells)
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputData(drawn)
    normals.SplittingOff()
    normals.ConsistencyOff()
    normals.Update()
    result = vtk.vtkPolyData()
    result.ShallowCopy(normals.GetOutput())
    scalars = numpy_support.numpy_to_vtk(levels.astype(np.int16), deep=True)
    scalars.SetName(MET)
    result.GetPointData().SetScalars(scalars)
    return result

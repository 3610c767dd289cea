"""The bone echoes of a sweep in the views, colored by how far they lie from the CT's bone."""

import numpy as np
import slicer
import vtk
from vtk.util import numpy_support

from ..sceneNodes import removeNodes

DISTANCE = "Distance (mm)"
FARTHEST = 5.0
"""mm that has the last color, as has all beyond."""

RADIUS = 0.8
"""mm of an echo: slices cut solids, and would pass by points."""

COLORS = ((0.10, 0.60, 1.00), (1.00, 0.90, 0.25), (0.90, 0.10, 0.15))
"""On bone, halfway, and far: told apart by the color-blind too."""

CORNERS = np.concatenate([np.eye(3), -np.eye(3)])
FACES = np.array([(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)])
"""Of an octahedron, outward."""


class EchoPoints:
    """One model node, which every new set of echoes replaces.

    Notes
    -----
    The echoes are the sweep's, in RAS world: the node is under no transform, and stays where it is when the CT is moved; `show` colors it
    anew then. It is neither saved with the scene nor offered where a model can be chosen.
    """

    def __init__(self):
        self._modelID = self._colorsID = None

    @property
    def node(self):
        """The model node, or None where nothing is drawn."""
        return slicer.mrmlScene.GetNodeByID(self._modelID) if self._modelID else None

    def show(self, points: np.ndarray, distances: np.ndarray, visible: bool = True):
        """Draw echoes at points (n, 3) of RAS world in mm, colored by their distances (n,) in mm; the model node."""
        node = self.node or self._made()
        node.SetAndObservePolyData(_octahedra(points, np.abs(distances)))
        node.SetAndObserveTransformNodeID(None)
        display = node.GetDisplayNode()
        with slicer.util.NodeModify(display):
            display.SetAndObserveColorNodeID(self._colors().GetID())
            display.SetActiveScalar(DISTANCE, vtk.vtkAssignAttribute.POINT_DATA)
            display.SetScalarRangeFlag(slicer.vtkMRMLDisplayNode.UseManualScalarRange)
            display.SetScalarRange(0.0, FARTHEST)
            display.SetScalarVisibility(True)
            display.SetVisibility2D(True)
            display.SetSliceIntersectionThickness(3)
            display.SetVisibility(visible)
        return node

    def setVisible(self, visible: bool) -> None:
        """Show or hide what is drawn."""
        node = self.node
        if node is not None and bool(node.GetDisplayNode().GetVisibility()) != visible:
            node.GetDisplayNode().SetVisibility(visible)

    def clear(self) -> None:
        """Remove everything."""
        scene = slicer.mrmlScene
        removeNodes([scene.GetNodeByID(each) for each in (self._colorsID, self._modelID) if each], scene)
        self._modelID = self._colorsID = None

    def _made(self):
        node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode", "Bone echoes")
        node.SetSaveWithScene(False)
        node.SetSelectable(False)
        node.CreateDefaultDisplayNodes()
        node.GetDisplayNode().SetSaveWithScene(False)
        self._modelID = node.GetID()
        return node

    def _colors(self):
        node = slicer.mrmlScene.GetNodeByID(self._colorsID) if self._colorsID else None
        if node is not None:
            return node
        node = slicer.vtkMRMLColorTableNode()
        node.SetName("Distance to bone")
        node.SetTypeToUser()
        node.SetHideFromEditors(True)
        node.SetSaveWithScene(False)
        node.SetNumberOfColors(256)
        shares = np.linspace(0.0, 1.0, 256)
        for number, color in enumerate(np.column_stack([np.interp(shares, (0.0, 0.5, 1.0), channel) for channel in zip(*COLORS)])):
            node.SetColor(number, f"{FARTHEST * shares[number]:.1f} mm", *color, 1.0)
        slicer.mrmlScene.AddNode(node)
        self._colorsID = node.GetID()
        return node


def _octahedra(points: np.ndarray, distances: np.ndarray) -> vtk.vtkPolyData:
    """A small octahedron at each point, with its distance at every corner."""
    corners = (points[:, None] + RADIUS * CORNERS).reshape(-1, 3)
    faces = (FACES + len(CORNERS) * np.arange(len(points))[:, None, None]).reshape(-1, 3)
    places, cells = vtk.vtkPoints(), vtk.vtkCellArray()
    places.SetData(numpy_support.numpy_to_vtk(np.ascontiguousarray(corners), deep=True))
    cells.SetData(3, numpy_support.numpy_to_vtkIdTypeArray(np.ascontiguousarray(faces.ravel(), dtype=np.int64), deep=True))
    scalars = numpy_support.numpy_to_vtk(np.repeat(distances, len(CORNERS)).astype(np.float32), deep=True)
    scalars.SetName(DISTANCE)
    drawn = vtk.vtkPolyData()
    drawn.SetPoints(places)
    drawn.SetPolys(cells)
    drawn.GetPointData().SetScalars(scalars)
    return drawn

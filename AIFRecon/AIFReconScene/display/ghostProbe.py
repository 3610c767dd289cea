"""A ghost of the probe where it should go: its body and its image plane in 3D, and where that plane cuts the slice views."""

import numpy as np
import slicer
import vtk
from vtk.util import numpy_support

from AIFReconLib.geometry.transforms import transform_points

from ..sceneNodes import removeNodes

COLOR = (1.00, 0.93, 0.25)
"""None of the bone's."""

LINES = 3
"""Pixels. It is drawn in lines, through which bone is seen: what is translucent takes a 3D view twice as long to draw, depth by depth."""


class GhostProbe:
    """One model node at the advised pose in RAS world; neither saved with the scene nor offered where a model can be chosen."""

    def __init__(self):
        self._modelID = self._pose = None

    @property
    def node(self):
        """The model node, or None where nothing is drawn."""
        return slicer.mrmlScene.GetNodeByID(self._modelID) if self._modelID else None

    def show(self, image_to_world: np.ndarray, shape):
        """Draw the probe of this `ProbeShape` whose image has this pose, (4, 4); the model node."""
        node = self.node
        if node is not None and self._pose is not None and np.array_equal(self._pose, image_to_world):
            return node
        node = node or self._made()
        node.SetAndObservePolyData(_polyData(transform_points(image_to_world, shape.points_image), shape.polygons, shape.border))
        self._pose = np.array(image_to_world)
        return node

    def clear(self) -> None:
        """Remove it."""
        if self._modelID:
            removeNodes([slicer.mrmlScene.GetNodeByID(self._modelID)], slicer.mrmlScene)
        self._modelID = self._pose = None

    def _made(self):
        node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode", "Advised probe")
        node.SetSaveWithScene(False)
        node.SetSelectable(False)
        node.CreateDefaultDisplayNodes()
        display = node.GetDisplayNode()
        display.SetSaveWithScene(False)
        with slicer.util.NodeModify(display):
            display.SetColor(*COLOR)
            display.SetRepresentation(slicer.vtkMRMLDisplayNode.WireframeRepresentation)
            display.SetLineWidth(LINES)
            display.SetBackfaceCulling(False)
            display.SetLighting(False)
            display.SetVisibility2D(True)
            display.SetSliceIntersectionThickness(3)
        self._modelID = node.GetID()
        return node


def _polyData(points: np.ndarray, polygons, line) -> vtk.vtkPolyData:
    places, polys, lines = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkCellArray()
    places.SetData(numpy_support.numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    for cells, corners in [*((polys, each) for each in polygons), (lines, line)]:
        cells.InsertNextCell(len(corners))
        for corner in corners:
            cells.InsertCellPoint(corner)
    drawn = vtk.vtkPolyData()
    drawn.SetPoints(places)
    drawn.SetPolys(polys)
    drawn.SetLines(lines)
    return drawn

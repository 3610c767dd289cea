"""Nodes that are drawn for a while: neither saved with the scene nor offered where a node can be chosen."""

import numpy as np
import slicer
import vtk
from vtk.util import numpy_support

from ..sceneNodes import colorTable, removeNodes


class OwnNodes:
    """Nodes by what they are for, made when they are first wanted, and anew where somebody has deleted them."""

    def __init__(self):
        self._ids = {}

    def get(self, what: str):
        """The node; None where there is none."""
        return slicer.mrmlScene.GetNodeByID(self._ids[what]) if what in self._ids else None

    def add(self, what: str, node):
        """Put a node into the scene, if it is in none, and keep it; returns it."""
        node.SetSaveWithScene(False)
        node = node if node.GetScene() is not None else slicer.mrmlScene.AddNode(node)
        self._ids[what] = node.GetID()
        return node

    def model(self, what: str, name: str):
        """A model node with its display."""
        node = self.get(what)
        if node is None:
            node = self.add(what, slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode", name))
            node.SetSelectable(False)
            node.CreateDefaultDisplayNodes()
            node.GetDisplayNode().SetSaveWithScene(False)
        return node

    def colors(self, what: str, name: str, colors):
        """A table of colors, each a name and (red, green, blue, opacity)."""
        node = self.get(what)
        if node is None:
            node = self.add(what, colorTable(name, colors))
            node.SetHideFromEditors(True)
        return node

    def remove(self, *what: str) -> None:
        """Take these out of the scene, or all of them, the last one first."""
        taken = [self._ids.pop(each) for each in what or tuple(self._ids) if each in self._ids]
        removeNodes([slicer.mrmlScene.GetNodeByID(each) for each in taken])


def polyData(points: np.ndarray, polygons=(), lines=()) -> vtk.vtkPolyData:
    """Points (n, 3), and polygons and lines, each the numbers of its points; those of one length are fast as an array."""
    places, drawn = vtk.vtkPoints(), vtk.vtkPolyData()
    places.SetData(numpy_support.numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    drawn.SetPoints(places)
    for cells, take in ((polygons, drawn.SetPolys), (lines, drawn.SetLines)):
        if len(cells):
            isArray, array = isinstance(cells, np.ndarray), vtk.vtkCellArray()
            numbers = np.ascontiguousarray(cells, dtype=np.int64).ravel() if isArray else np.concatenate(cells)
            starts = np.arange(0, numbers.size + 1, cells.shape[1]) if isArray else np.cumsum([0, *map(len, cells)])
            array.SetData(*(numpy_support.numpy_to_vtkIdTypeArray(each, deep=True) for each in (starts, numbers)))
            take(array)
    return drawn


def setScalars(attributes, name: str, values: np.ndarray) -> None:
    """Give the points or the cells of polydata a value each."""
    array = numpy_support.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    attributes.SetScalars(array)


def legend(title: str, colors, names) -> str:
    """What colors, each (red, green, blue) from 0 to 1, stand for, as HTML: in the panel, where it covers nothing of what is colored."""
    told = [title]
    for color, name in zip(colors, names):
        square = "".join(f"{round(255 * part):02x}" for part in color)
        told.append(f"<span style='background-color:#{square}'>&nbsp;&nbsp;&nbsp;</span>&nbsp;{name.replace(' ', '&nbsp;')}")
    return " &nbsp; ".join(told)


def colorBy(display, name: str, colors, low: float, high: float) -> None:
    """Color a model by the scalars of its points, from `low` to `high`."""
    display.SetAndObserveColorNodeID(colors.GetID())
    display.SetActiveScalar(name, vtk.vtkAssignAttribute.POINT_DATA)
    display.SetScalarRangeFlag(slicer.vtkMRMLDisplayNode.UseManualScalarRange)
    display.SetScalarRange(low, high)
    display.SetScalarVisibility(True)

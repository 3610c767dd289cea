"""The names of levels in the slice views: those of the segments that a slice cuts near their middle."""

import contextlib

import numpy as np
import slicer
import vtk
from vtk.util import numpy_support

from AIFReconLib.errors import AIFReconError
from AIFReconLib.geometry.box import box_around, corners_of, middle_on_plane
from AIFReconLib.geometry.transforms import transform_points

from ..display import sliceDisplay
from ..display.ownNodes import OwnNodes
from ..inputs.boneNodes import imageToWorld
from ..transforms import matrixToWorld

LETTERS = 4.0
"""Size of the letters, in percent of the view."""

COLOR = (1.0, 0.95, 0.6)


class LevelNames:
    """A markups node for each of the red, yellow and green view, whose points follow the slice; drawn for orientation, and never saved."""

    def __init__(self):
        self._own, self._observed, self._shown = OwnNodes(), [], {}
        self._levels, self._key = [], None

    def update(self, parameters) -> None:
        """Follow the box and the bone."""
        bone = parameters.bone
        if not parameters.showLevels or bone is None or not bone.IsA("vtkMRMLSegmentationNode"):
            self.clear()
            return
        key = _keyOf(bone)
        if key is None or key == self._key:
            return
        self._key, self._levels = key, _levelsOf(bone)
        if not self._observed:
            for node in sliceDisplay.mainViews():
                self._observed.append((node, node.AddObserver(vtk.vtkCommand.ModifiedEvent, lambda caller, event: self._follow(caller))))
        with slicer.util.RenderBlocker():
            for node, _tag in self._observed:
                self._follow(node)

    def clear(self) -> None:
        """Take the names out of the views and of the scene."""
        for node, tag in self._observed:
            node.RemoveObserver(tag)
        self._observed, self._shown = [], {}
        self._levels, self._key = [], None
        self._own.remove()

    def _follow(self, sliceNode) -> None:
        plane = slicer.util.arrayFromVTKMatrix(sliceNode.GetSliceToRAS())
        places = [(name, middle_on_plane(corners, plane)) for name, corners in self._levels]
        names = [(name, place) for name, place in places if place is not None]
        shown = [(name, tuple(np.round(place, 2))) for name, place in names]
        if self._shown.get(sliceNode.GetID()) == shown:
            return
        self._shown[sliceNode.GetID()] = shown
        node = self._nodeOf(sliceNode)
        with slicer.util.NodeModify(node):
            node.RemoveAllControlPoints()
            for name, place in names:
                node.AddControlPoint(vtk.vtkVector3d(*place), name)
            node.SetLocked(True)

    def _nodeOf(self, sliceNode):
        node = self._own.get(sliceNode.GetLayoutName())
        if node is not None:
            return node
        node = slicer.vtkMRMLMarkupsFiducialNode()
        node.SetName(f"Levels {sliceNode.GetLayoutName()}")
        node.SetHideFromEditors(True)
        with placingKept():
            node = self._own.add(sliceNode.GetLayoutName(), node)
        node.SetSelectable(False)
        node.CreateDefaultDisplayNodes()
        display = node.GetDisplayNode()
        display.SetSaveWithScene(False)
        with slicer.util.NodeModify(display):
            display.AddViewNodeID(sliceNode.GetID())
            display.SetPointLabelsVisibility(True)
            display.SetUseGlyphScale(False)
            display.SetGlyphSize(0.1)
            display.SetTextScale(LETTERS)
            display.SetSelectedColor(*COLOR)
        return node


@contextlib.contextmanager
def placingKept():
    """Slicer has the mouse place points into whatever list has just come: within, it stays with the one that the user has."""
    selection = slicer.app.applicationLogic().GetSelectionNode()
    className, nodeID = selection.GetActivePlaceNodeClassName(), selection.GetActivePlaceNodeID()
    try:
        yield
    finally:
        selection.SetReferenceActivePlaceNodeClassName(className)
        selection.SetReferenceActivePlaceNodeID(nodeID)


def _keyOf(bone):
    try:
        place = matrixToWorld(bone)
    except AIFReconError:
        return None
    return bone.GetID(), bone.GetSegmentation().GetMTime(), place.tobytes()


def _levelsOf(bone) -> list:
    segmentation, place, levels = bone.GetSegmentation(), matrixToWorld(bone), []
    for number in range(segmentation.GetNumberOfSegments()):
        segment = segmentation.GetNthSegment(number)
        corners = _cornersOf(segment)
        if corners is not None:
            levels.append((segment.GetName(), transform_points(place, corners)))
    return levels


def _cornersOf(segment):
    """The corners of a segment's box, (8, 3) in the segmentation's coordinates, or None where it is empty.

    Segments share labelmaps, and `vtkSegment.GetBounds` is the box of the whole labelmap.
    """
    image = segment.GetRepresentation(slicer.vtkSegmentationConverter.GetBinaryLabelmapRepresentationName())
    if image is None:
        bounds = np.zeros(6)
        segment.GetBounds(bounds)
        return corners_of(bounds.reshape(3, 2)) if vtk.vtkMath.AreBoundsInitialized(bounds) else None
    if image.IsEmpty():
        return None
    extent = np.array(image.GetExtent()).reshape(3, 2)
    voxels = numpy_support.vtk_to_numpy(image.GetPointData().GetScalars()).reshape((extent[:, 1] - extent[:, 0] + 1)[::-1])
    inside = voxels == segment.GetLabelValue()
    if not inside.any():
        return None
    ends = np.array([(each.start - 0.5, each.stop - 0.5) for each in box_around(inside)[::-1]]) + extent[:, :1]
    return transform_points(imageToWorld(image), corners_of(ends))

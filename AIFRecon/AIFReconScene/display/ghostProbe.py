"""A ghost of the probe where it should go: its body and its image plane in 3D, and where that plane cuts the slice views."""

import numpy as np
import slicer
import vtk
from vtk.util import numpy_support

from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.imaging.region import extreme_pixels

from ..sceneNodes import removeNodes

COLOR = (1.00, 0.93, 0.25)
"""None of the bone's."""

LINES = 3
"""Pixels. It is drawn in lines, through which bone is seen: what is translucent takes a 3D view twice as long to draw, depth by depth."""

BODY = 55.0, 14.0
"""mm: how long and how thick the body is; it is as wide as its face."""

MOST_ROWS = 24
"""Of the image plane, between which its border runs straight."""


class GhostProbe:
    """One model node at the advised pose in RAS world; neither saved with the scene nor offered where a model can be chosen."""

    def __init__(self):
        self._modelID = self._pose = None

    @property
    def node(self):
        """The model node, or None where nothing is drawn."""
        return slicer.mrmlScene.GetNodeByID(self._modelID) if self._modelID else None

    def show(self, image_to_world: np.ndarray, beams):
        """Draw the probe whose image has this pose, (4, 4); `beams` (`SweepBeams`) know its images. The model node."""
        node = self.node
        if node is not None and self._pose is not None and np.array_equal(self._pose, image_to_world):
            return node
        node = node or self._made()
        node.SetAndObservePolyData(_probe(image_to_world, beams))
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


def _probe(image_to_world: np.ndarray, beams) -> vtk.vtkPolyData:
    """Image plane with its outline, and a body behind its face."""
    from AIFReconLib.guidance.probe import images_like

    columns, rows = beams.frame_size
    images = images_like(image_to_world, beams.frame_size, beams.probe, beams.region)
    ends = extreme_pixels(beams.region.mask(columns, rows)).astype(np.float64)
    left, right = ends[: len(ends) // 2], ends[len(ends) // 2 :]
    chosen = np.unique(np.linspace(0, len(left) - 1, min(len(left), MOST_ROWS)).round().astype(int))
    left, right = left[chosen], right[chosen]
    border = np.concatenate([left, right[::-1], left[:1]])
    count = len(chosen)
    plane = [(n, n + 1, count + n + 1, count + n) for n in range(count - 1)]
    width = np.ptp(_contact(images)[:, 0]) * images.spacing[0] / 2 + 4.0
    body = _body(images, width)
    faces = np.array([(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)])
    flat = np.concatenate([left, right, border])
    placed = transform_points(image_to_world, np.column_stack([flat, np.zeros(len(flat))]))
    points = np.concatenate([placed, transform_points(image_to_world, body)])
    return _polyData(points, [*plane, *(faces + len(flat)).tolist()], range(2 * count, 2 * count + len(border)))


def _contact(images) -> np.ndarray:
    """Pixels (column, row) of the part of the ultrasound that is nearest to the face, within some mm of it."""
    rows, columns = np.nonzero(images.region.mask(*images.frame_size))
    column, row = images.face_px
    x, y = images.spacing
    near = np.hypot((columns - column) * x, (rows - row) * y) < 8.0
    return np.column_stack([columns[near], rows[near]])


def _body(images, half: float) -> np.ndarray:
    """Corners of the body in the image's coordinates, (8, 3): a block that stands on the face and narrows away from it."""
    length, thickness = BODY
    outward = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    corners = [(x * wide, back, z * thickness / 2) for back, wide in ((0.0, half), (-length, 0.6 * half)) for x, z in outward]
    return transform_points(np.linalg.inv(images.image_to_face), np.array(corners))


def _polyData(points: np.ndarray, polygons: list, line) -> vtk.vtkPolyData:
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

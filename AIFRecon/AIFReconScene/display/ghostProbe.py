"""A ghost of the probe where it should go: its body and its image plane in 3D, and where that plane cuts the slice views."""

import numpy as np
import slicer

from AIFReconLib.geometry.transforms import transform_points

from .ownNodes import OwnNodes, polyData

COLOR = (1.00, 0.93, 0.25)
"""None of the bone's."""

LINES = 3
"""Pixels. It is drawn in lines, through which bone is seen: what is translucent takes a 3D view twice as long to draw, depth by depth."""


class GhostProbe:
    """One model node at the advised pose in RAS world."""

    def __init__(self):
        self._own, self._pose = OwnNodes(), None

    def show(self, image_to_world: np.ndarray, shape) -> None:
        """Draw the probe of this `ProbeShape` whose image has this pose, (4, 4)."""
        if self._own.get("probe") is not None and np.array_equal(self._pose, image_to_world):
            return
        node, self._pose = self._own.model("probe", "Advised probe"), np.array(image_to_world)
        node.SetAndObservePolyData(polyData(transform_points(image_to_world, shape.points_image), shape.polygons, [shape.border]))
        display = node.GetDisplayNode()
        with slicer.util.NodeModify(display):
            display.SetColor(*COLOR)
            display.SetRepresentation(slicer.vtkMRMLDisplayNode.WireframeRepresentation)
            display.SetLineWidth(LINES)
            display.SetBackfaceCulling(False)
            display.SetLighting(False)
            display.SetVisibility2D(True)
            display.SetSliceIntersectionThickness(3)

    def clear(self) -> None:
        """Remove it."""
        self._own.remove()

"""The bone echoes of a sweep in the views, colored by how far they lie from the CT's bone."""

import numpy as np
import slicer

from AIFReconLib.geometry.solid import octahedra

from .ownNodes import OwnNodes, colorBy, polyData, setScalars

DISTANCE = "Distance (mm)"
FARTHEST = 5.0
"""mm that has the last color, as has all beyond."""

RADIUS = 0.8
"""mm of an echo: slices cut solids, and would pass by points."""

COLORS = ((0.10, 0.60, 1.00), (1.00, 0.90, 0.25), (0.90, 0.10, 0.15))
"""On bone, halfway, and far: told apart by the color-blind too."""


class EchoPoints:
    """One model node, which every new set of echoes replaces.

    Notes
    -----
    The echoes are the sweep's, in RAS world: the node is under no transform, and stays where it is when the CT is moved; `show` colors it
    anew then.
    """

    def __init__(self):
        self._own = OwnNodes()

    @property
    def node(self):
        """The model node, or None where nothing is drawn."""
        return self._own.get("echoes")

    def show(self, points: np.ndarray, distances: np.ndarray, visible: bool = True):
        """Draw echoes at points (n, 3) of RAS world in mm, colored by their distances (n,) in mm; the model node."""
        colors = self._own.colors("colors", "Distance to bone", _colors())
        node = self._own.model("echoes", "Bone echoes")
        corners, faces, owners = octahedra(points, RADIUS)
        drawn = polyData(corners, faces)
        setScalars(drawn.GetPointData(), DISTANCE, np.abs(distances)[owners].astype(np.float32))
        node.SetAndObservePolyData(drawn)
        node.SetAndObserveTransformNodeID(None)
        display = node.GetDisplayNode()
        with slicer.util.NodeModify(display):
            colorBy(display, DISTANCE, colors, 0.0, FARTHEST)
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
        self._own.remove()


def _colors():
    shares = np.linspace(0.0, 1.0, 256)
    channels = [np.interp(shares, (0.0, 0.5, 1.0), channel) for channel in zip(*COLORS)]
    return [(f"{FARTHEST * share:.1f} mm", (*color, 1.0)) for share, *color in zip(shares, *channels)]

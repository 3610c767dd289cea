"""The probe on the screen: its sector and some beams on the current frame, and the outlines of all frames in 3D."""

import itertools
import math

import numpy as np
import vtk

from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ImageRegion, outline_of
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

from ..sweep.browserItems import BrowserItems
from ..sweep.sequenceReader import orientationFlips
from ..transforms import ijkToRAS
from .ownNodes import OwnNodes, polyData, setScalars

MOST_OUTLINES = 300
OUTLINE_POINTS = 40
"""Of the outline of one frame in 3D, about."""

BAND = 1.0
"""mm, width of the bands that a slice in the plane of the frame cuts."""

PROBE_COLOR = (0.2, 0.9, 1.0)


class ProbeOverlay:
    """Model nodes that show where sound goes and where frames were taken.

    The sector is in the image's own coordinates and under its parent transform, so it moves with the frame that is replayed. Images that
    carry their pose in their own matrix have no such transform: for them `showProbe` is to be called again with every frame. `hide`
    removes the nodes.
    """

    def __init__(self) -> None:
        self._own = OwnNodes()

    def showProbe(self, browser, imageSequence, probe: ProbeGeometry, region: ImageRegion):
        """Draw the area that is ultrasound and some beams; the model node, made or brought up to date.

        Nodes are given as to `sequenceFromBrowser`, the region in pixels of the image in MF orientation.
        """
        items = BrowserItems(browser, imageSequence)
        image = items.shownImage()
        columns, rows, _ = image.GetImageData().GetDimensions()
        toStored = np.eye(4)
        for axis, (flip, last) in enumerate(zip(orientationFlips(items.images), (columns - 1, rows - 1))):
            if flip:
                toStored[axis, axis], toStored[axis, 3] = -1.0, last
        kept = region.mask(columns, rows)
        lines = [outline_of(kept), *probe.lines(kept)]
        toRAS = ijkToRAS(image) @ toStored
        drawn = _upright([_place(toRAS, line) for line in lines], np.cross(toRAS[:3, 0], toRAS[:3, 1]))
        node = self._own.model("probe", f"{browser.GetName()} beams")
        node.SetAndObservePolyData(drawn)
        proxy = items.browser.GetProxyNode(items.images)
        parent = proxy.GetParentTransformNode() if proxy is not None else None
        node.SetAndObserveTransformNodeID(parent.GetID() if parent is not None else None)
        display = node.GetDisplayNode()
        display.SetColor(*PROBE_COLOR)
        display.SetLineWidth(2)
        display.SetLighting(False)
        display.SetVisibility2D(True)
        display.SetSliceIntersectionThickness(2)
        return node

    def showOutlines(self, browser, sequence: TrackedSequence, region: ImageRegion | None = None):
        """Draw the outlines of all frames with a valid pose, at most some hundred, colored from first to last; the model node.

        The browser names the node, the region is the whole image by default.
        """
        poses = sweep_poses(sequence)
        usable = poses.require_usable(sequence.name)
        columns, rows = sequence.frame_size
        points = outline_of((region or ImageRegion()).mask(columns, rows))[:-1]
        points = points[:: max(1, len(points) // OUTLINE_POINTS)]
        points = np.concatenate([points, points[:1]])
        shown = usable[:: math.ceil(len(usable) / MOST_OUTLINES)]
        lines = [_place(poses.image_to_reference[number], points) for number in shown]
        node = self._own.model("outlines", f"{browser.GetName()} outlines")
        drawn = polyData(np.concatenate(lines), lines=_numbered(lines))
        setScalars(drawn.GetCellData(), "frame", shown.astype(np.float32))
        node.SetAndObservePolyData(drawn)
        node.SetAndObserveTransformNodeID(None)
        display = node.GetDisplayNode()
        display.SetActiveScalar("frame", vtk.vtkAssignAttribute.CELL_DATA)
        display.SetAndObserveColorNodeID("vtkMRMLColorTableNodeRainbow")
        display.SetScalarVisibility(True)
        display.SetLighting(False)
        display.SetOpacity(0.6)
        display.SetVisibility2D(False)
        return node

    def hide(self, *what: str) -> None:
        """Remove the "probe", the "outlines", or everything."""
        self._own.remove(*what)


def _place(toRAS: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    """Points (n, 2) (column, row) where a matrix (4, 4) puts them, (n, 3) mm."""
    return transform_points(toRAS, np.column_stack([pixels, np.zeros(len(pixels))]))


def _upright(lines: list[np.ndarray], normal: np.ndarray) -> vtk.vtkPolyData:
    """Lines of points (n, 3) and, along each, a band that stands upright on their plane: a slice in that plane would not meet lines."""
    across, points = BAND * normal / np.linalg.norm(normal) / 2, np.concatenate(lines)
    starts = np.setdiff1d(np.arange(len(points)), np.cumsum([len(line) for line in lines]) - 1)
    low, high = len(points) + starts, 2 * len(points) + starts
    bands = np.stack([low, low + 1, high + 1, high], axis=1)
    return polyData(np.concatenate([points, points - across, points + across]), bands, _numbered(lines))


def _numbered(lines: list[np.ndarray]) -> list[np.ndarray]:
    """The numbers of the points of each line, counted through."""
    return [np.arange(*ends) for ends in itertools.pairwise(np.cumsum([0, *map(len, lines)]))]

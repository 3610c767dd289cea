"""Bone in the colors of how squarely a scan has met it: a model of its own, with display and colors of its own."""

import numpy as np
import slicer
import vtk
from slicer.i18n import tr as _
from vtk.util import numpy_support

from .ownNodes import OwnNodes, colorBy, legend, polyData, setScalars
from .segmentDisplay import Borrowed, displayOf

MET = "Met"
"""The array of the model's points."""

COLORS = ((0.32, 0.30, 0.29), (0.72, 0.72, 0.72), (0.00, 0.27, 0.68), (0.35, 0.76, 1.00), (1.00, 0.62, 0.00))
"""Of `AIFReconLib.guidance.mesh.OUT_OF_REACH` to `SQUARELY`: grays where nothing was met, blue to orange where something was. No two
of them are alike to the color-blind."""

HIDDEN = Borrowed("Visibility3D", False, "AIFRecon.HiddenIn3D")
"""Segments are not drawn in 3D while these colors are."""


class BoneColors:
    """One model node in the bone's own coordinates, under the bone's transform: it goes where the CT goes. Without a CT, in the world.

    Notes
    -----
    While nothing but colors changes, one array is written anew and nothing else is touched. Segments are not drawn in 3D meanwhile: their
    surface is the same, so that its color would show through in specks, and where it is translucent it takes a view several times as long
    to draw.
    """

    def __init__(self):
        self._own = OwnNodes()
        self._mesh = self._levels = None

    @property
    def node(self):
        """The model node, or None where nothing is drawn."""
        return self._own.get("bone")

    def show(self, bone, mesh, levels: np.ndarray) -> None:
        """Draw a `BoneMesh` of a node of bone, or of none, with the level of each corner (n,)."""
        node = self.node
        if node is None:
            node = self._made(_surface(mesh, levels))
        elif node.GetPolyData() is None or self._mesh is not mesh:
            node.SetAndObservePolyData(_surface(mesh, levels))
        elif not np.array_equal(levels, self._levels):
            array = node.GetPolyData().GetPointData().GetArray(MET)
            numpy_support.vtk_to_numpy(array)[:] = levels
            array.Modified()
            node.GetPolyData().Modified()
        self._mesh, self._levels = mesh, levels
        transform = None if bone is None else bone.GetTransformNodeID()
        if node.GetTransformNodeID() != transform:
            node.SetAndObserveTransformNodeID(transform)
        # Once: what the user shows again stays
        HIDDEN.follow(displayOf(bone))

    def clear(self) -> None:
        """Remove everything, also what is left where somebody has deleted the model alone."""
        self._mesh = self._levels = None
        HIDDEN.follow(None)
        self._own.remove()

    def _made(self, surface):
        self.clear()
        colors = self._own.colors("colors", "Colors of bone met", [(name, (*color, 1.0)) for name, color in zip(levelNames(), COLORS)])
        # With a display that is as it is to be, views look at the model once
        display = self._own.add("display", slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelDisplayNode"))
        with slicer.util.NodeModify(display):
            colorBy(display, MET, colors, -0.5, len(COLORS) - 0.5)
            # Slices show bone already, and would have to cut this surface anew wherever the probe goes
            display.SetVisibility2D(False)
        node = slicer.vtkMRMLModelNode()
        node.SetName("Bone met")
        node.SetSelectable(False)
        node.SetAndObserveDisplayNodeID(display.GetID())
        node.SetAndObservePolyData(surface)
        return self._own.add("bone", node)


def levelNames() -> tuple:
    """What the colors stand for, in the user's language."""
    return _("out of reach"), _("not hit"), _("grazing, over 60\u00b0"), _("obliquely, 45 to 60\u00b0"), _("squarely, below 45\u00b0")


def colorsInWords() -> str:
    """What the colors stand for, as HTML."""
    return legend(_("How the beam hits bone:"), reversed(COLORS), reversed(levelNames()))


def _surface(mesh, levels: np.ndarray) -> vtk.vtkPolyData:
    """Triangles as polydata with normals, which would otherwise be made at every change of color."""
    drawn = polyData(mesh.points_reference.astype(np.float32), mesh.triangles)
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputData(drawn)
    normals.SplittingOff()
    normals.ConsistencyOff()
    normals.Update()
    result = vtk.vtkPolyData()
    result.ShallowCopy(normals.GetOutput())
    setScalars(result.GetPointData(), MET, levels.astype(np.int16))
    return result

"""Bone in 3D: a model of what the reconstruction shows of it, kept with the volume, before the translucent bone of the CT, from behind."""

import contextlib

import numpy as np
import slicer
import vtk
from vtk.util import numpy_support

from ..display import threeDViews
from ..display.ownNodes import colorBy, polyData, setScalars
from ..display.segmentDisplay import Borrowed, displayOf
from ..registration.sweepVerdicts import isOfNow
from ..sceneNodes import removeNodes, sharedColors
from ..transforms import placeOf
from ..volumes.volumeNodes import SPINE_ROLE, giveName, hasGivenName, intoFolder

TRANSLUCENT = Borrowed("Opacity3D", 0.3, "AIFRecon.OpacityBefore")
"""Opacity of the CT's bone behind."""

NEAR_SIDES = Borrowed("BackfaceCulling", True, "AIFRecon.CullingBefore")
"""What is translucent is sorted by depth, layer by layer, and its far sides, seen through the near ones, tell nothing of where it lies."""

DISTANCE = "Distance to the CT's bone (mm)"
FARTHEST = 6.0
"""mm that has the last color, as has all beyond."""

AT = (0.0, 2.5, 4.0, FARTHEST)
COLORS = np.array([(0.94, 0.88, 0.76), (0.94, 0.88, 0.76), (1.00, 0.62, 0.10), (0.80, 0.05, 0.10)])
"""Bone keeps the color of bone where the CT has it too: the surface lies some 2 mm outside of what it is drawn around."""

_COLORS = "AIFRecon.SpineColors"
"""Attribute of the color table, one for all models."""


def keepSpine(node, surface, sweepName: str):
    """The model of a `ShownBoneMesh`, made or brought up to date beside the volume `node`; where there is none, an earlier one goes."""
    model = spineOf(node)
    if surface is None:
        node.SetNodeReferenceID(SPINE_ROLE, None)
        if model is not None and hasGivenName(model):
            removeNodes([model])
        return None
    if model is None:
        model = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode")
        giveName(model, f"{sweepName} bone")
        node.SetNodeReferenceID(SPINE_ROLE, model.GetID())
    model.SetAndObserveTransformNodeID(None)
    model.SetAndObservePolyData(surfaceOf(surface))
    model.SetDescription("Smoothed for display: not for measuring.")
    _show(model)
    intoFolder([model], sweepName)
    return model


def spineOf(node):
    """The model of the bone that a volume shows, or None."""
    model = node.GetNodeReference(SPINE_ROLE) if node is not None else None
    return model if model is not None and model.GetPolyData() is not None else None


def _show(model) -> None:
    if model.GetDisplayNode() is None:
        model.CreateDefaultDisplayNodes()
        model.GetDisplayNode().SetVisibility(False)
    display = model.GetDisplayNode()
    with slicer.util.NodeModify(display):
        display.SetColor(*distanceColors(2)[0])
        # Slices show the volume itself
        display.SetVisibility2D(False)
        if model.GetPolyData().GetPointData().GetArray(DISTANCE) is not None:
            shares = np.linspace(0.0, 1.0, 256)
            colors = [(f"{FARTHEST * share:.1f} mm", (*color, 1.0)) for share, color in zip(shares, distanceColors(256))]
            colorBy(display, DISTANCE, sharedColors("Distance of shown bone", _COLORS, colors), 0.0, FARTHEST)


def _color(model, isOfNow: bool) -> None:
    """Distances to the CT's bone are colors while that lies where it lay."""
    hasDistance = model.GetPolyData().GetPointData().GetArray(DISTANCE) is not None
    model.GetDisplayNode().SetScalarVisibility(hasDistance and isOfNow)


def surfaceOf(found) -> vtk.vtkPolyData:
    """A `ShownBoneMesh` as VTK has it."""
    surface = polyData(found.points, found.triangles)
    surface.GetPointData().SetNormals(numpy_support.numpy_to_vtk(found.normals, deep=True))
    if found.distances is not None:
        setScalars(surface.GetPointData(), DISTANCE, found.distances)
    return surface


def distanceColors(count: int = 256) -> np.ndarray:
    """(count, 3) colors from 0 to `FARTHEST` mm."""
    distances = np.linspace(0.0, FARTHEST, count)
    return np.column_stack([np.interp(distances, AT, channel) for channel in COLORS.T])


class SpineView:
    """Shows the model of the chosen output, and of no other, with the CT's bone translucent behind it.

    A model that has just come is looked at from the back, as a surgeon looks at a spine; the view is the user's after that. The opacity
    of the CT's bone is given back when the model goes or the user leaves.
    """

    def __init__(self):
        self._modelID = self._seen = None

    def update(self, parameters) -> None:
        """Follow output, box and bone."""
        model = spineOf(parameters.output)
        # In the colors of guidance the bone itself is what is looked at
        visible = model is not None and parameters.showSpine and not parameters.guidance
        self._hideOther(model)
        if model is not None and bool(model.GetDisplayVisibility()) != visible:
            model.SetDisplayVisibility(visible)
        if model is not None:
            _color(model, isOfNow(parameters))
        bone = parameters.bone
        _seeThrough(displayOf(bone) if visible else None)
        if visible and self._seen != model.GetID():
            self._seen = model.GetID()
            place = placeOf(bone)
            threeDViews.lookAlong(place[:3, 1], place[:3, 2], model)

    def clear(self) -> None:
        """The user leaves: the CT's bone as it was."""
        _seeThrough(None)
        self._seen = self._modelID = None

    def _hideOther(self, model) -> None:
        before = slicer.mrmlScene.GetNodeByID(self._modelID) if self._modelID else None
        if before is not None and before is not model:
            before.SetDisplayVisibility(False)
        self._modelID = model.GetID() if model is not None else None


def _seeThrough(display) -> None:
    with slicer.util.NodeModify(display) if display is not None else contextlib.nullcontext():
        for each in (TRANSLUCENT, NEAR_SIDES):
            each.follow(display)

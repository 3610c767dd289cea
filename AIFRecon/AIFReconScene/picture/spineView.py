"""Bone in 3D: a model of what the reconstruction shows of it, kept with the volume, before the translucent bone of the CT, from behind."""

import contextlib

import numpy as np
import slicer
import vtk

from AIFReconLib.errors import AIFReconError

from ..display import threeDViews
from ..display.borrowed import Borrowed
from ..sceneNodes import removeNodes
from ..transforms import matrixToWorld
from ..volumes.volumeNodes import SPINE_ROLE, giveName, hasGivenName, intoFolder
from .spineSurface import DISTANCE, FARTHEST, distanceColors, surfaceOf

TRANSLUCENT = Borrowed("Opacity3D", 0.3, "AIFRecon.OpacityBefore")
"""Opacity of the CT's bone behind."""

NEAR_SIDES = Borrowed("BackfaceCulling", True, "AIFRecon.CullingBefore")
"""What is translucent is sorted by depth, layer by layer, and its far sides, seen through the near ones, tell nothing of where it lies."""

_COLORS = "AIFRecon.SpineColors"


def keepSpine(node, surface, sweepName: str):
    """The model of a `BoneSurface`, made or brought up to date beside the volume `node`; where there is none, an earlier one goes."""
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
        hasDistance = model.GetPolyData().GetPointData().GetArray(DISTANCE) is not None
        if hasDistance:
            display.SetAndObserveColorNodeID(_colors(model.GetScene()).GetID())
            display.SetActiveScalar(DISTANCE, vtk.vtkAssignAttribute.POINT_DATA)
            display.SetScalarRangeFlag(slicer.vtkMRMLDisplayNode.UseManualScalarRange)
            display.SetScalarRange(0.0, FARTHEST)
        display.SetScalarVisibility(hasDistance)


def _colors(scene):
    """The color table, one for all models."""
    for number in range(scene.GetNumberOfNodesByClass("vtkMRMLColorTableNode")):
        node = scene.GetNthNodeByClass(number, "vtkMRMLColorTableNode")
        if node.GetAttribute(_COLORS):
            return node
    node = slicer.vtkMRMLColorTableNode()
    node.SetName("Distance of shown bone")
    node.SetTypeToUser()
    colors = distanceColors()
    node.SetNumberOfColors(len(colors))
    for number, color in enumerate(colors):
        node.SetColor(number, f"{FARTHEST * number / (len(colors) - 1):.1f} mm", *color, 1.0)
    node.SetAttribute(_COLORS, "1")
    node.SetAttribute("Category", "AIFRecon")
    return scene.AddNode(node)


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
        bone = parameters.bone
        isSegmented = bone is not None and bone.IsA("vtkMRMLSegmentationNode")
        _seeThrough(bone.GetDisplayNode() if visible and isSegmented else None)
        if visible and self._seen != model.GetID():
            self._seen = model.GetID()
            _lookFromBehind(model, bone)

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


def _lookFromBehind(model, bone) -> None:
    """From the back, the head up: as the CT says, or RAS world without one."""
    try:
        place = matrixToWorld(bone) if bone is not None else np.eye(4)
    except AIFReconError:
        place = np.eye(4)
    threeDViews.lookAlong(place[:3, 1], place[:3, 2], model)

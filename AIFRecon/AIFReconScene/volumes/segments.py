"""Labels become a segmentation, whose segments views can outline, draw in 3D and name; a labelmap volume does neither."""

import numpy as np
import slicer
from slicer.i18n import tr as _

from AIFReconLib.geometry.box import box_around
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.progress import part, report
from AIFReconLib.worker.evaluating import bone_of_ct

from ..inputs.boneNodes import named
from ..sceneNodes import addedTogether
from ..transforms import ijkToRAS
from ..work import inWorker
from .volumeNodes import updateVolumeNode

COLORS = ((0.95, 0.84, 0.57), (0.70, 0.82, 0.93), (0.80, 0.90, 0.67), (0.93, 0.72, 0.66), (0.78, 0.74, 0.90), (0.90, 0.90, 0.90))
"""Of the segments in turn: pale, so that ultrasound stays in front."""


def boneFromCT(parameters, progress=None) -> str:
    """Find the bone of the chosen CT, select its segmentation below the same transform, and return what a user should know of it."""
    ct = parameters.ctVolume
    with named(ct):
        volume = Volume(slicer.util.arrayFromVolume(ct), ijkToRAS(ct))
        labels = inWorker(bone_of_ct, volume, progress=part(progress, 0.0, 0.9))
    with addedTogether():
        name = f"{ct.GetName()} bone"
        parameters.bone = segmentationNode(name, labels, labels.names, ct, part(progress, 0.9, 1.0))
    return "\n".join(labels.notes)


def bentBone(bone, labels: Volume, names: dict[int, str]):
    """A new segmentation of labels in RAS world, called after the bone that they were before each was moved on its own."""
    name = _("{bone} as scanned").format(bone=bone.GetName())
    with addedTogether():
        return segmentationNode(name, labels, names or {int(n): str(n) for n in np.unique(labels.array[labels.array > 0])}, None)


def segmentationNode(name: str, labels: Volume, names: dict[int, str], ct, progress=None):
    """A new segmentation of labels in a CT's own coordinates, on its voxels and under its transform; without a CT in RAS world."""
    scene = slicer.mrmlScene
    node = scene.AddNewNodeByClass("vtkMRMLSegmentationNode", scene.GenerateUniqueName(name))
    node.CreateDefaultDisplayNodes()
    if ct is not None:
        # First: the voxels are those of the CT as seen from where the segmentation is
        node.SetAndObserveTransformNodeID(ct.GetTransformNodeID())
        node.SetReferenceImageGeometryParameterFromVolumeNode(ct)
    addSegments(node, labels, names, progress)
    return node


def addSegments(node, labels: Volume, names: dict[int, str], progress=None) -> None:
    """Add a segment for each of the labels that have names to a segmentation; after a cancel some are there.

    `labels` lie in the node's own coordinates, RAS in mm.
    """
    for number, (label, name) in enumerate(names.items()):
        report(progress, number / len(names), f"Adding {name}")
        part = labels[box_around(labels.array == label)]
        image, holder = slicer.vtkOrientedImageData(), slicer.vtkMRMLScalarVolumeNode()
        updateVolumeNode(holder, Volume((part.array == label).astype(np.uint8), part.ijk_to_reference))
        image.ShallowCopy(holder.GetImageData())
        image.SetGeometryFromImageToWorldMatrix(slicer.util.vtkMatrixFromArray(part.ijk_to_reference))
        node.AddSegmentFromBinaryLabelmapRepresentation(image, name, COLORS[number % len(COLORS)])

"""The box to reconstruct in. A new one has no size: it is laid around what there is to be reconstructed."""

import numpy as np
import slicer

from AIFReconLib.errors import AIFReconError


def isEmpty(roiNode) -> bool:
    """Whether a box has no place or no size, as "Create new" makes it."""
    return not roiNode.GetNumberOfControlPoints() or min(roiNode.GetSize()) <= 0


def layAround(roiNode, parameters) -> bool:
    """Lay a box along the axes of RAS around the chosen sweep, else around the CT; False where neither has a place.

    Parameters
    ----------
    roiNode : vtkMRMLMarkupsROINode
        It is shown as its edges, with handles: filled and with its name across, which is Slicer's default, it would hide the images.
    parameters : AIFReconParameterNode
    """
    found = _aroundSweep(parameters)
    found = _aroundVolume(parameters.ctVolume) if found is None else found
    if found is None:
        return False
    least, most = found
    with slicer.util.NodeModify(roiNode):
        roiNode.SetCenterWorld(*((least + most) / 2))
        roiNode.SetSize(*(most - least))
    if roiNode.GetDisplayNode() is None:
        roiNode.CreateDefaultDisplayNodes()
    display = roiNode.GetDisplayNode()
    with slicer.util.NodeModify(display):
        display.SetFillVisibility(False)
        display.SetOutlineVisibility(True)
        display.SetPropertiesLabelVisibility(False)
        display.SetHandlesInteractive(True)
    return True


def _aroundSweep(parameters) -> tuple | None:
    """Least and most RAS coordinates, (3,) mm each, of the voxels that hold every pixel of the sweep that counts."""
    from AIFReconLib.geometry.transforms import transform_points
    from AIFReconLib.imaging.region import extreme_pixels
    from AIFReconLib.resolve import resolve_imaging
    from AIFReconLib.sweep.poses import sweep_poses

    from .inputs import Inputs

    if parameters.sweep is None:
        return None
    try:
        inputs = Inputs.fromParameters(parameters)
        sequence = inputs.sequence()
        poses = sweep_poses(sequence)
        usable = poses.require_usable(sequence.name)
        region = resolve_imaging(sequence, poses, False, inputs.recipe).region
    except AIFReconError:
        return None  # the panel says what is wrong with the sweep
    pixels = extreme_pixels(region.mask(*sequence.frame_size))
    corners = np.column_stack([pixels, np.zeros(len(pixels))])
    points = np.concatenate([transform_points(poses.image_to_reference[number], corners) for number in usable])
    half = parameters.spacing / 2
    return points.min(axis=0) - half, points.max(axis=0) + half


def _aroundVolume(volumeNode) -> tuple | None:
    """Least and most RAS coordinates, (3,) mm each, of a volume."""
    if volumeNode is None or volumeNode.GetImageData() is None:
        return None
    bounds = [0.0] * 6
    volumeNode.GetRASBounds(bounds)
    return np.array(bounds[::2]), np.array(bounds[1::2])

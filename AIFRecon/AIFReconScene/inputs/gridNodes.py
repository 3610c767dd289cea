"""Where to reconstruct, from what the scene has: a box that the user draws, or the voxels of a volume."""

import numpy as np
import slicer

from AIFReconLib.errors import GeometryError, SettingsError
from AIFReconLib.geometry.volume import VoxelGrid

from ..transforms import ijkToRAS, matrixToWorld
from .boneNodes import named


def gridFromROI(roiNode, spacing) -> VoxelGrid:
    """The voxels of `spacing` (mm, one or x, y, z) that cover a markups ROI, along its own axes, in RAS world.

    Raises GeometryError when it is empty, or its transforms shear it; TransformError for a parent transform that is not linear.
    """
    spacings = np.broadcast_to(np.asarray(spacing, dtype=np.float64), 3)
    if not (np.isfinite(spacings).all() and (spacings > 0).all()):
        raise SettingsError(f"Input spacing must be positive mm; got {spacing!r}.")
    objectToWorld = matrixToWorld(roiNode) @ slicer.util.arrayFromVTKMatrix(roiNode.GetObjectToNodeMatrix())
    lengths = np.linalg.norm(objectToWorld[:3, :3], axis=0)
    size = np.array(roiNode.GetSize(), dtype=np.float64) * lengths
    if not (np.isfinite(size).all() and (size > 0).all()) or not roiNode.GetNumberOfControlPoints():
        raise GeometryError(
            "{node}: the region must be a box; got {size} mm. Place it or enlarge it.".format(
                node=roiNode.GetName(), size=" x ".join(f"{mm:g}" for mm in size)
            )
        )
    with named(roiNode):
        return VoxelGrid.covering(objectToWorld, roiNode.GetSize(), spacings)


def gridFromVolume(volumeNode) -> VoxelGrid:
    """The voxels of a volume node in RAS world, its parent transforms included; errors as for `gridFromROI`."""
    image = volumeNode.GetImageData()
    if image is None or not image.GetNumberOfPoints():
        raise GeometryError(f"{volumeNode.GetName()}: it has no voxels. Choose a volume that is loaded.")
    with named(volumeNode):
        return VoxelGrid(image.GetDimensions(), matrixToWorld(volumeNode) @ ijkToRAS(volumeNode))

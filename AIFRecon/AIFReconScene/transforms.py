"""Matrices of MRML as numpy arrays, and the way from a node to the world through its parent transforms."""

import numpy as np
import slicer
import vtk

from AIFReconLib.errors import AIFReconError, TransformError


def matrixToParent(transformNode) -> np.ndarray:
    """The (4, 4) matrix of a linear transform node, from its children to its parent, mm; a TransformError for another."""
    if not transformNode.IsLinear():
        raise TransformError(
            f"Transform {transformNode.GetName()!r} must be linear; got a warping one, which cannot place an image or a grid. Harden "
            "it onto the node that it moves, or replace it by a linear transform."
        )
    return slicer.util.arrayFromTransformMatrix(transformNode)


def parentTransforms(node) -> list:
    """The transform nodes above a node, the nearest first."""
    parents = []
    parent = node.GetParentTransformNode()
    while parent is not None:
        parents.append(parent)
        parent = parent.GetParentTransformNode()
    return parents


def matrixToWorld(node) -> np.ndarray:
    """From a node's own coordinates to RAS world: the product of its parent transforms, (4, 4), mm; errors as of `matrixToParent`."""
    matrix = np.eye(4)
    for parent in parentTransforms(node):
        matrix = matrixToParent(parent) @ matrix
    return matrix


def placeOf(bone) -> np.ndarray:
    """The same of the bone of a CT, to look at it from its back; RAS world's own where there is none, or what is above it warps."""
    try:
        return np.eye(4) if bone is None else matrixToWorld(bone)
    except AIFReconError:
        return np.eye(4)


def ijkToRAS(volumeNode) -> np.ndarray:
    """Voxel numbers (i, j, k) to the volume node's own RAS, without its parent transforms, (4, 4) float64, mm."""
    matrix = vtk.vtkMatrix4x4()
    volumeNode.GetIJKToRASMatrix(matrix)
    return slicer.util.arrayFromVTKMatrix(matrix)


def atRightAngles(imageToWorld: np.ndarray, columns: int, rows: int) -> np.ndarray:
    """The placement of an image that is nearest to an affine one among those that a volume node can hold, for display.

    `imageToWorld` (4, 4) takes pixels (column, row) to RAS world, mm. Calibrations are affine fits: axes some degrees off a right angle are
    usual. What comes back has the same plane, pixel sizes and middle of the image.

    Notes
    -----
    The directions are the orthogonal factor of the polar decomposition M = U P of the unit axes and the plane's normal, the orthogonal
    matrix that is nearest to M (Fan and Hoffman 1955): each axis turns by half of what they are off. Where M is orthogonal, U is M.
    """
    linear = np.array(imageToWorld[:3, :3], dtype=np.float64)
    sizes = np.linalg.norm(linear, axis=0)
    normal = np.cross(linear[:, 0], linear[:, 1])
    turned = -1.0 if np.linalg.det(linear) < 0 else 1.0
    sizes[2] = sizes[2] or 1.0
    axes = np.column_stack([linear[:, 0] / sizes[0], linear[:, 1] / sizes[1], turned * normal / np.linalg.norm(normal)])
    left, _stretches, right = np.linalg.svd(axes)
    middle = np.array([(columns - 1) / 2, (rows - 1) / 2, 0.0])
    placement = np.eye(4)
    placement[:3, :3] = left @ right * sizes
    placement[:3, 3] = imageToWorld[:3, 3] + (linear - placement[:3, :3]) @ middle
    return placement

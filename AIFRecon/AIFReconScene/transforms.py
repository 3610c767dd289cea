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

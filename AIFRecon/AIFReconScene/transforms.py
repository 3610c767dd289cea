"""Matrices of MRML as numpy arrays, and the way from a node to the world through its parent transforms."""

import numpy as np
import slicer
import vtk

from AIFReconLib.errors import TransformError


def arrayOf(matrix) -> np.ndarray:
    """The (4, 4) float64 array of a vtkMatrix4x4."""
    return slicer.util.arrayFromVTKMatrix(matrix)


def vtkMatrixOf(array):
    """The vtkMatrix4x4 of a (4, 4) array."""
    return slicer.util.vtkMatrixFromArray(np.asarray(array, dtype=np.float64))


def matrixToParent(transformNode) -> np.ndarray:
    """The (4, 4) matrix of a linear transform node, from its children to its parent, mm.

    Raises
    ------
    TransformError
        When the transform is not linear.
    """
    if not transformNode.IsLinear():
        raise TransformError(
            "Transform {node!r} must be linear; got a warping one, which cannot place an image or a grid. "
            "Harden it onto the node that it moves, or replace it by a linear transform.",
            node=transformNode.GetName(),
        )
    matrix = vtk.vtkMatrix4x4()
    transformNode.GetMatrixTransformToParent(matrix)
    return arrayOf(matrix)


def parentTransforms(node) -> list:
    """The transform nodes above a node, the nearest first."""
    parents = []
    parent = node.GetParentTransformNode()
    while parent is not None:
        parents.append(parent)
        parent = parent.GetParentTransformNode()
    return parents


def matrixToWorld(node) -> np.ndarray:
    """From a node's own coordinates to RAS world: the product of its parent transforms, (4, 4) float64, mm.

    Raises
    ------
    TransformError
        Names the transform that is not linear.
    """
    matrix = np.eye(4)
    for parent in parentTransforms(node):
        matrix = matrixToParent(parent) @ matrix
    return matrix


def ijkToRAS(volumeNode) -> np.ndarray:
    """Voxel numbers (i, j, k) to the volume node's own RAS, without its parent transforms, (4, 4) float64, mm."""
    matrix = vtk.vtkMatrix4x4()
    volumeNode.GetIJKToRASMatrix(matrix)
    return arrayOf(matrix)

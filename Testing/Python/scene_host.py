"""A MRML scene for tests of AIFRecon/AIFReconScene, and small nodes to put into it. Needs slicer-core; import it after `importorskip`."""

from __future__ import annotations

import numpy as np
import slicer


def transform_node(scene, matrix, name="Transform", parent=None):
    """A linear transform node with a (4, 4) matrix to its parent."""
    node = scene.AddNewNodeByClass("vtkMRMLLinearTransformNode", name)
    node.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(np.asarray(matrix, dtype=np.float64)))
    if parent is not None:
        node.SetAndObserveTransformNodeID(parent.GetID())
    return node


def warping_node(scene, name="Warp"):
    """A transform node that is not linear."""
    import vtk

    node = scene.AddNewNodeByClass("vtkMRMLTransformNode", name)
    spline = vtk.vtkThinPlateSplineTransform()
    source, target = vtk.vtkPoints(), vtk.vtkPoints()
    for point in ((0, 0, 0), (50, 0, 0), (0, 50, 0), (0, 0, 50), (50, 50, 50)):
        source.InsertNextPoint(*point)
        target.InsertNextPoint(point[0] + 0.1 * point[1], point[1], point[2] + 1)
    spline.SetSourceLandmarks(source)
    spline.SetTargetLandmarks(target)
    spline.SetBasisToR()
    node.SetAndObserveTransformToParent(spline)
    return node


def volume_node(scene, array, ijk_to_ras, name="Volume", class_name="vtkMRMLScalarVolumeNode", parent=None):
    """A volume node with an array [k, j, i]."""
    node = scene.AddNewNodeByClass(class_name, name)
    slicer.util.updateVolumeFromArray(node, array)
    node.SetIJKToRASMatrix(slicer.util.vtkMatrixFromArray(np.asarray(ijk_to_ras, dtype=np.float64)))
    if parent is not None:
        node.SetAndObserveTransformNodeID(parent.GetID())
    return node


def class_counts(scene) -> dict[str, int]:
    """How many nodes of which class a scene holds, those included that users do not see."""
    counts: dict[str, int] = {}
    for number in range(scene.GetNumberOfNodes()):
        name = scene.GetNthNode(number).GetClassName()
        counts[name] = counts.get(name, 0) + 1
    return counts

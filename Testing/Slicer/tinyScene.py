"""A slab of bone, a tracked sweep over it and its registered CT, small enough for every self test to make anew.

The slab's near face is the plane y = 20 mm of the world. The sweep sees it as a bright line with darkness behind it, in tilted frames of
anisotropic pixels; one frame was not tracked. The CT holds the slab in coordinates of its own, which a transform node turns and moves
to where it belongs.
"""

import pathlib
import tempfile
import unittest

import numpy as np
import slicer
import vtk

FACE = 20.0
"""mm, y of the near face of the bone."""

FRAMES = 12
UNTRACKED = 5
FRAME_SIZE = 64, 80
PIXEL = 0.5, 0.4
MARGIN = 6
"""Black columns at both sides, by which the probe is recognized."""

ECHO, TISSUE = 220, 40


def requireLivePackages() -> None:
    """Skip a test that speaks OpenIGTLink where pyigtl is not there: Slicer installs nothing while it runs tests."""
    from AIFReconGui.packages import missingLivePackages

    if missing := missingLivePackages():
        raise unittest.SkipTest(f"{', '.join(missing)} is not installed, and Slicer installs nothing in testing mode")


def saveAndOpenAgain(test, beside=False) -> None:
    """Save the scene, close it, and load it from its file; or load it beside what there is."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "scene.mrb"
        test.assertTrue(slicer.mrmlScene.WriteToMRB(str(path)))
        if not beside:
            slicer.mrmlScene.Clear()
        test.assertTrue(slicer.mrmlScene.ReadFromMRB(str(path), not beside))


def rotation(axis: int, degrees: float) -> np.ndarray:
    """(4, 4) rotation about an axis."""
    turned = vtk.vtkTransform()
    turned.RotateWXYZ(degrees, *np.eye(3)[axis])
    return slicer.util.arrayFromVTKMatrix(turned.GetMatrix())


def moved(x: float, y: float, z: float) -> np.ndarray:
    """(4, 4) translation."""
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


CT_TO_WORLD = moved(12.0, -7.0, 30.0) @ rotation(2, 25.0) @ rotation(0, -10.0)


def makeSequence(shift=(0.0, 0.0, 0.0)):
    """The sweep as the library has it: poses to world, moved by `shift` (mm), frame 5 out of view."""
    from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
    from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence

    columns, rows = FRAME_SIZE
    random = np.random.default_rng(1)
    images, records = [], []
    for number in range(FRAMES):
        pose = moved(-16.0, 0.0, number - 5.5) @ rotation(0, 12.0 * np.sin(number)) @ rotation(2, 6.0 * np.cos(number))
        pose = moved(*shift) @ pose @ np.diag([*PIXEL, 0.45, 1.0])
        row, column = np.indices((rows, columns))
        y = pose[1, 0] * column + pose[1, 1] * row + pose[1, 3]
        image = np.where(y < FACE, TISSUE + random.integers(-15, 15, y.shape), 2)
        image[np.abs(y - FACE) < 0.5] = ECHO
        image[:, :MARGIN] = image[:, columns - MARGIN :] = 0
        images.append(image.astype(np.uint8))
        status = TransformStatus.OUT_OF_VIEW if number == UNTRACKED else TransformStatus.OK
        name = TransformName("Image", "Reference")
        records.append(FrameRecord(timestamp=0.1 * number, transforms={name: TransformSample(pose, status)}))
    return TrackedSequence(np.stack(images), records)


def writeForeign(folder, sequence) -> np.ndarray:
    """A sweep as an array of images, images.npy, and a table of two tools, poses.csv, in ms; its poses, (frames, 4, 4)."""
    from AIFReconLib.sweep.poses import sweep_poses

    np.save(folder / "images.npy", np.asarray(sequence.images))
    columns = [f"{tool}_{word}" for tool in ("Probe", "Patient") for word in ("x", "y", "z", "qx", "qy", "qz", "qw")]
    lines, poses = [",".join(["stamp", *columns])], sweep_poses(sequence).image_to_reference
    for number, pose in enumerate(poses):
        seen, turn = [""] * 7, [0.0] * 4
        if np.isfinite(pose).all():
            vtk.vtkMath.Matrix3x3ToQuaternion((pose[:3, :3] / np.linalg.norm(pose[:3, :3], axis=0)).tolist(), turn)
            seen = [repr(float(each)) for each in (*pose[:3, 3], *turn[1:], turn[0])]
        lines.append(",".join([str(100 * number), *seen, "1", "2", f"{3 + number / 100}", "0", "0", "0", "1"]))
    (folder / "poses.csv").write_text("\n".join(lines))
    return poses


def addSweep(name="Sweep", shift=(0.0, 0.0, 0.0)):
    """The sweep as a sequence browser node of the scene, moved by `shift` (mm)."""
    from AIFReconScene.sweep.sequenceNodes import browserFromSequence

    return browserFromSequence(makeSequence(shift), name)


def addCT():
    """CT volume and segmentation of the slab, both under the transform node that registers them; (ct, segmentation, transform)."""
    size, spacing = (50, 50, 40), 1.0
    center = np.linalg.inv(CT_TO_WORLD) @ [0.0, FACE, 0.0, 1.0]
    ijkToCT = moved(*(center[:3] - np.array(size) / 2 * spacing)) @ np.diag([spacing, spacing, spacing, 1.0])
    k, j, i = np.indices(size[::-1])
    world = CT_TO_WORLD @ ijkToCT @ np.stack([i, j, k, np.ones_like(i)]).reshape(4, -1)
    bone = ((world[1] >= FACE) & (world[1] < FACE + 8)).reshape(size[::-1])
    ct = addVolume("vtkMRMLScalarVolumeNode", "CT", np.where(bone, 900, 30).astype(np.int16), ijkToCT)
    labels = addVolume("vtkMRMLLabelMapVolumeNode", "Bone labels", bone.astype(np.uint8), ijkToCT)
    segmentation = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLSegmentationNode", "Bone")
    segmentation.SetReferenceImageGeometryParameterFromVolumeNode(ct)
    slicer.modules.segmentations.logic().ImportLabelmapToSegmentationNode(labels, segmentation)
    slicer.mrmlScene.RemoveNode(labels)
    return ct, segmentation, addTransform("CTToReference", CT_TO_WORLD, ct, segmentation)


def addVolume(className: str, name: str, array: np.ndarray, ijkToRAS: np.ndarray):
    """A volume node with these voxels, [k, j, i]."""
    node = slicer.mrmlScene.AddNewNodeByClass(className, name)
    slicer.util.updateVolumeFromArray(node, array)
    node.SetIJKToRASMatrix(slicer.util.vtkMatrixFromArray(ijkToRAS))
    node.CreateDefaultDisplayNodes()
    return node


def addTransform(name: str, matrix: np.ndarray, *below):
    """A linear transform node with a (4, 4) matrix, above these nodes."""
    node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLLinearTransformNode", name)
    setMatrix(node, matrix)
    for each in below:
        each.SetAndObserveTransformNodeID(node.GetID())
    return node


def ijkToRAS(volumeNode) -> np.ndarray:
    """(4, 4) matrix of a volume node, without its parent transforms."""
    matrix = vtk.vtkMatrix4x4()
    volumeNode.GetIJKToRASMatrix(matrix)
    return slicer.util.arrayFromVTKMatrix(matrix)


def boundsOf(node) -> np.ndarray:
    """(3, 2) least and most RAS of a node."""
    bounds = np.zeros(6)
    node.GetRASBounds(bounds)
    return bounds.reshape(3, 2)


def nodeIDs() -> list:
    """Of every node of the scene."""
    nodes = slicer.mrmlScene.GetNodes()
    return sorted(nodes.GetItemAsObject(index).GetID() for index in range(nodes.GetNumberOfItems()))


def write(node, path) -> None:
    """A volume, segmentation or transform into a file."""
    kinds = {"vtkMRMLScalarVolumeNode": "NRRD", "vtkMRMLSegmentationNode": "Segmentation", "vtkMRMLLinearTransformNode": "Transform"}
    storage = getattr(slicer, f"vtkMRML{kinds[node.GetClassName()]}StorageNode")()
    storage.SetFileName(str(path))
    assert storage.WriteData(node), path


def scaleOf(sliceNode) -> float:
    """mm per pixel of a slice view; the width of its field of view says less, for the view fits that to its widget."""
    return sliceNode.GetFieldOfView()[1] / sliceNode.GetDimensions()[1]


def placeOf(sliceNode) -> np.ndarray:
    """(4, 4) where a slice view looks, and how: center and axes."""
    return slicer.util.arrayFromVTKMatrix(sliceNode.GetSliceToRAS()).copy()


def worldOfBrightVoxels(volumeNode, threshold: float) -> np.ndarray:
    """Centers of the voxels above `threshold` in RAS, (n, 3) mm."""
    array = slicer.util.arrayFromVolume(volumeNode)
    k, j, i = np.nonzero(array > threshold)
    points = ijkToRAS(volumeNode) @ np.stack([i, j, k, np.ones_like(i)]).astype(float)
    return points[:3].T


def matrixOf(transformNode) -> np.ndarray:
    """(4, 4) matrix of a linear transform node to its parent."""
    matrix = vtk.vtkMatrix4x4()
    transformNode.GetMatrixTransformToParent(matrix)
    return slicer.util.arrayFromVTKMatrix(matrix)


def setMatrix(transformNode, matrix: np.ndarray) -> None:
    """Sets the (4, 4) matrix of a linear transform node to its parent."""
    transformNode.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(matrix))


def worldOf(node) -> np.ndarray:
    """(4, 4) matrix of the transforms above a node, to the world."""
    matrix = vtk.vtkMatrix4x4()
    if node.GetParentTransformNode() is not None:
        node.GetParentTransformNode().GetMatrixTransformToWorld(matrix)
    return slicer.util.arrayFromVTKMatrix(matrix)


def putSweepUnder(browser, transformNode) -> None:
    """Puts the last transforms above everything that a browser replays under another one."""
    proxies = vtk.vtkCollection()
    browser.GetAllProxyNodes(proxies)
    for node in [proxies.GetItemAsObject(number) for number in range(proxies.GetNumberOfItems())]:
        top = node
        while top.GetParentTransformNode() is not None:
            top = top.GetParentTransformNode()
        if top is not transformNode:
            top.SetAndObserveTransformNodeID(transformNode.GetID())


def warp(browser):
    """Puts a sweep's image under a transform that warps; the transform of its poses."""
    pose = browser.GetProxyNode(browser.GetMasterSequenceNode()).GetParentTransformNode()
    addWarping(pose)
    return pose


def addWarping(*below) -> None:
    """A transform node that is not linear, above these nodes."""
    node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLTransformNode", "Warp")
    node.SetAndObserveTransformToParent(vtk.vtkThinPlateSplineTransform())
    for each in below:
        each.SetAndObserveTransformNodeID(node.GetID())

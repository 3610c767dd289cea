"""Bone, grids and volumes between nodes and library, in millimeters: under transforms, turned, anisotropic."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from sweeps import rigid

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")
import tinyScene  # noqa: E402
import vtk  # noqa: E402

from AIFReconLib.bone.map import BoneMap  # noqa: E402
from AIFReconLib.bone.widths import SIGMA_VOXELS, voxels_around  # noqa: E402
from AIFReconLib.geometry.transforms import transform_points  # noqa: E402
from AIFReconLib.geometry.volume import Volume  # noqa: E402

CT_MATRIX = rigid((4.0, -7.0, 11.0), (-30.0, 12.0, 44.0)) @ np.diag([0.8, 0.9, 1.5, 1.0])
REGISTRATION = rigid((10.0, 20.0, 30.0), (7.0, -9.0, 100.0))
ROI_MATRIX = rigid((25.0, -35.0, 15.0), (12.0, -8.0, 30.0))


def ball_labels(shape=(20, 24, 22), radius=5.0, label=1) -> np.ndarray:
    k, j, i = np.indices(shape)
    center = (np.array(shape) - 1) / 2
    return ((((k - center[0]) ** 2 + (j - center[1]) ** 2 + (i - center[2]) ** 2) < radius**2) * label).astype(np.uint8)


def segmentation_node(scene, parts, matrix=CT_MATRIX, reference=True, name="Bone"):
    """A segmentation with a segment for every array [k, j, i] of a dict by name."""
    node = scene.AddNewNodeByClass("vtkMRMLSegmentationNode", name)
    node.CreateDefaultDisplayNodes()
    for segment_name, array in parts.items():
        holder = slicer.vtkMRMLScalarVolumeNode()
        slicer.util.updateVolumeFromArray(holder, array)
        image = slicer.vtkOrientedImageData()
        image.DeepCopy(holder.GetImageData())
        image.SetGeometryFromImageToWorldMatrix(slicer.util.vtkMatrixFromArray(matrix))
        if reference:
            geometry = slicer.vtkSegmentationConverter.SerializeImageGeometry(image)
            parameter = slicer.vtkSegmentationConverter.GetReferenceImageGeometryParameterName()
            node.GetSegmentation().SetConversionParameter(parameter, geometry)
        node.AddSegmentFromBinaryLabelmapRepresentation(image, segment_name, [1.0, 0.5, 0.2])
    return node


def ids(node, *names):
    return [node.GetSegmentation().GetSegmentIdBySegmentName(name) for name in names]


def under(node, matrix):
    tinyScene.addTransform("Registration", matrix, node)
    return node


def bone_of(node, chosen=None, referenceVolumeNode=None, sigmaVoxels=None) -> BoneMap:
    """The map that the worker makes of a node."""
    from AIFReconScene.inputs.boneNodes import isLabeled, labelsFromNode, probabilityFromNode
    from AIFReconScene.transforms import matrixToWorld

    place = matrixToWorld(node)
    if not isLabeled(node):
        return BoneMap.from_probability(probabilityFromNode(node), place)
    reach = partial(voxels_around, sigma_voxels=sigmaVoxels or SIGMA_VOXELS)
    labels = labelsFromNode(node, chosen, referenceVolumeNode=referenceVolumeNode, world=False, reach=reach)
    return BoneMap.from_labels(labels, sigmaVoxels or SIGMA_VOXELS, None, place)


# ---- bone


@pytest.mark.parametrize("kind", ["segmentation", "labelmap", "probability"])
def test_a_ct_under_a_transform_lies_where_the_registration_puts_it_in_millimeters(scene, kind):
    made = {
        "segmentation": lambda: segmentation_node(scene, {"L3": ball_labels()}),
        "labelmap": lambda: tinyScene.addVolume("vtkMRMLLabelMapVolumeNode", "Labels", ball_labels(), CT_MATRIX),
        "probability": lambda: tinyScene.addVolume("vtkMRMLScalarVolumeNode", "Sure", ball_labels().astype(np.float32), CT_MATRIX),
    }[kind]()
    bone = bone_of(under(made, REGISTRATION), **({} if kind == "probability" else {"sigmaVoxels": 1.0}))
    k, j, i = np.nonzero(bone.probability.array > (0.5 if kind == "probability" else -1))
    center = bone.probability.ijk_to_reference @ [i.mean(), j.mean(), k.mean(), 1.0]
    expected = REGISTRATION @ CT_MATRIX @ [10.5, 11.5, 9.5, 1.0]
    assert np.allclose(center[:3], expected[:3], atol=1e-6)


def test_a_segment_between_the_voxels_of_the_others_is_resampled(scene):
    from AIFReconScene.inputs.boneNodes import labelsFromNode

    node = segmentation_node(scene, {"L3": ball_labels()})
    shift = np.eye(4)
    shift[:3, 3] = 3.3, -2.2, 0.4
    segment = segmentation_node(scene, {"L3": ball_labels()}, CT_MATRIX @ shift).GetSegmentation().GetNthSegment(0)
    node.GetSegmentation().AddSegment(segment, "between")
    labels = labelsFromNode(node, ["between"])
    assert np.array_equal(np.argwhere(labels.array).mean(0), np.add(np.argwhere(ball_labels()).mean(0), [0, -2, 3]))


def test_every_segment_that_is_read_gets_a_label_of_its_own_is_reported_and_may_go_meanwhile(scene):
    from AIFReconScene.inputs.boneNodes import labelsFromNode

    far, told = np.roll(ball_labels(radius=3.0), 8, axis=1), []
    node = segmentation_node(scene, {"L3": ball_labels(radius=4.0), "L4": far})

    def progress(fraction, message):
        told.append(fraction)
        node.GetSegmentation().RemoveAllSegments()

    labels = labelsFromNode(node, progress=progress)
    assert told == [0.5, 1.0]
    assert np.array_equal(labels.array, np.where(far > 0, 2, ball_labels(radius=4.0)))
    assert np.allclose(labels.ijk_to_reference, CT_MATRIX, atol=1e-9)


def test_a_segment_that_goes_while_surfaces_are_made_keeps_none_from_the_others(scene):
    from AIFReconScene.display.threeDViews import makeSurface

    surface = slicer.vtkSegmentationConverter.GetClosedSurfaceRepresentationName()
    node, told = segmentation_node(scene, {name: ball_labels() for name in ("L3", "L4", "L5")}), []

    def progress(fraction, message):
        told.append(round(fraction * 6))
        if told[-1] == 1:
            node.GetSegmentation().RemoveSegment(ids(node, "L3")[0])

    makeSurface(node, progress)
    assert told == [0, 1, 2, 3, 4, 6]
    assert node.GetSegmentation().GetNumberOfSegments() == 2
    assert all(node.GetSegmentation().GetNthSegment(number).GetRepresentation(surface).GetNumberOfPolys() for number in range(2))


def test_a_segmentation_without_reference_geometry_is_not_cut_off(scene):
    bone = bone_of(segmentation_node(scene, {"L3": ball_labels()}, reference=False), sigmaVoxels=1.5)
    roomy = np.pad(ball_labels(), 20)
    shift = np.eye(4)
    shift[:3, 3] = -20
    expected = BoneMap.from_labels(Volume(roomy, CT_MATRIX @ shift), sigma_voxels=1.5)
    assert np.array_equal(bone.probability.array, expected.probability.array)
    assert np.allclose(bone.probability.ijk_to_reference, expected.probability.ijk_to_reference, atol=1e-9)


def sphere_surface_node(scene):
    source = vtk.vtkSphereSource()
    source.SetCenter(10.0, 20.0, 30.0)
    source.SetRadius(8.0)
    source.SetThetaResolution(48)
    source.SetPhiResolution(48)
    source.Update()
    node = scene.AddNewNodeByClass("vtkMRMLSegmentationNode", "Surface")
    node.GetSegmentation().SetSourceRepresentationName(slicer.vtkSegmentationConverter.GetClosedSurfaceRepresentationName())
    segment = slicer.vtkSegment()
    segment.SetName("ball")
    segment.AddRepresentation(slicer.vtkSegmentationConverter.GetClosedSurfaceRepresentationName(), source.GetOutput())
    node.GetSegmentation().AddSegment(segment)
    return node


def test_surfaces_become_voxels_of_the_ct_and_stay_as_they_were(scene):
    from AIFReconScene.inputs.boneNodes import labelsFromNode

    ct = tinyScene.addVolume("vtkMRMLScalarVolumeNode", "CT", np.zeros((40, 40, 40), np.int16), tinyScene.moved(-10.0, 0.0, 10.0))
    node = sphere_surface_node(scene)
    before = tinyScene.nodeIDs()
    labels = labelsFromNode(node, referenceVolumeNode=ct)
    k, j, i = np.nonzero(labels.array)
    center = labels.ijk_to_reference @ [i.mean(), j.mean(), k.mean(), 1]
    assert np.allclose(center[:3], (10, 20, 30), atol=0.2)
    assert len(i) == pytest.approx(4 / 3 * np.pi * 8**3, rel=0.05)
    assert tinyScene.nodeIDs() == before
    assert not node.GetSegmentation().ContainsRepresentation(slicer.vtkSegmentationConverter.GetBinaryLabelmapRepresentationName())


# ---- grids


def test_a_rotated_roi_under_a_transform_is_covered_by_its_voxels_about_its_center(scene):
    from AIFReconScene.inputs.gridNodes import gridFromROI

    node = under(scene.AddNewNodeByClass("vtkMRMLMarkupsROINode", "R"), REGISTRATION)
    node.SetSize(20.0, 30.0, 41.0)
    node.SetAndObserveObjectToNodeMatrix(slicer.util.vtkMatrixFromArray(ROI_MATRIX))
    grid = gridFromROI(node, (0.9, 1.1, 2.0))
    edges = (2 * np.array(list(np.ndindex(2, 2, 2))) - 1) * (10.0, 15.0, 20.5)
    ijk = transform_points(grid.reference_to_ijk @ REGISTRATION @ ROI_MATRIX, edges)
    assert (ijk >= -0.5 - 1e-6).all()
    assert (ijk <= np.array(grid.size) - 0.5 + 1e-6).all()
    assert grid.size == (23, 28, 21)
    assert np.allclose(grid.corners().mean(axis=0), node.GetCenterWorld(), atol=1e-6)


# ---- volumes


def test_a_volume_file_and_a_volume_node_lie_in_the_same_place(scene, tmp_path):
    from AIFReconScene.volumes.volumeNodes import updateVolumeNode

    volume = Volume(np.arange(210, dtype=np.int16).reshape(5, 6, 7), CT_MATRIX)
    volume.write(tmp_path / "volume.nrrd")
    loaded = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    storage = slicer.vtkMRMLVolumeArchetypeStorageNode()
    storage.SetFileName(str(tmp_path / "volume.nrrd"))
    assert storage.ReadData(loaded)
    made = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    updateVolumeNode(made, volume)
    assert np.allclose(tinyScene.ijkToRAS(loaded), tinyScene.ijkToRAS(made), atol=1e-6)
    assert np.array_equal(slicer.util.arrayFromVolume(loaded), slicer.util.arrayFromVolume(made))


def test_an_existing_node_under_a_transform_shows_the_result_in_its_place(scene):
    from AIFReconScene.volumes.volumeNodes import outputNodes

    node = under(tinyScene.addVolume("vtkMRMLScalarVolumeNode", "Shown", np.zeros((2, 2, 2), np.int16), np.eye(4)), REGISTRATION)
    made = Volume(np.ones((6, 7, 8), np.uint8), CT_MATRIX)
    outputNodes(SimpleNamespace(intensity=made, mask=made, method="weighted"), "Sweep", nodes={"intensity": node})
    expected = [CT_MATRIX @ [i, j, k, 1] for i in (-0.5, 7.5) for j in (-0.5, 6.5) for k in (-0.5, 5.5)]
    assert np.allclose(tinyScene.boundsOf(node), np.array([np.min(expected, axis=0), np.max(expected, axis=0)]).T[:3], atol=1e-6)

"""Bone as the scene has it of a CT: a segmentation, a labelmap volume, or a volume of probabilities. The scene stays as it is."""

from contextlib import contextmanager

import numpy as np
import slicer
import vtk
from vtk.util import numpy_support

from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.transforms import whole_shift
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.message import listed
from AIFReconLib.progress import Progress, report

from ..transforms import ijkToRAS, matrixToWorld


def probabilityFromNode(node) -> Volume:
    """The bone probability of a scalar volume in its own coordinates; a GeometryError where it holds none."""
    with named(node):
        return _volumeOf(node)


def isLabeled(node) -> bool:
    """Whether a node says of every voxel which bone it is, if any; a bone probability does not."""
    return node.IsA("vtkMRMLSegmentationNode") or node.IsA("vtkMRMLLabelMapVolumeNode")


def labelsFromNode(
    node,
    segmentIDs: list[str] | None = None,
    *,
    referenceVolumeNode=None,
    world: bool = True,
    reach=lambda spacing: 0,
    progress: Progress | None = None,
) -> Volume:
    """The labels of a segmentation or labelmap volume as a `Volume` of uint8 or uint16.

    A label per segment, 1, 2, ... in their order, so that metrics can tell vertebrae apart; later ones win where they overlap.

    By default all segments are bone, shown or not. Those that are surfaces only and know no reference geometry are brought to the voxels of
    the reference volume, usually the CT; `reach` leads from (3,) spacing in mm to the voxels to go around them where there is none. Without
    `world`, they are in the node's own coordinates, without its parent transforms.
    """
    isSegmented = node.IsA("vtkMRMLSegmentationNode")
    labels = _mergedSegments(node, segmentIDs, referenceVolumeNode, reach, progress) if isSegmented else _volumeOf(node)
    if not world:
        return labels
    with named(node):
        return labels.placed_by(matrixToWorld(node))


def boneNames(node, segmentIDs: list[str] | None = None) -> dict[int, str]:
    """What the labels of `labelsFromNode` stand for, where that is known: the names of the segments."""
    if not node.IsA("vtkMRMLSegmentationNode"):
        return {}
    segmentation = node.GetSegmentation()
    chosen = segmentIDs or [segmentation.GetNthSegmentID(index) for index in range(segmentation.GetNumberOfSegments())]
    segments = [segmentation.GetSegment(segmentID) for segmentID in chosen]
    return {number: segment.GetName() for number, segment in enumerate(segments, start=1) if segment is not None}


def nameOf(label: int, names: dict[int, str]) -> str:
    """What a label is called: by its segment, else by its number."""
    return names.get(label) or f"label {label}"


def inNames(labels, names: dict[int, str]) -> str:
    """Neighbors, from one to the other."""
    return listed([nameOf(label, names) for label in labels], " \N{EN DASH} ")


@contextmanager
def named(node):
    """Errors of geometry say which node they are about."""
    try:
        yield
    except GeometryError as error:
        raise GeometryError(f"{node.GetName()}: {error}") from error


def _volumeOf(node) -> Volume:
    image = node.GetImageData()
    if image is None or image.GetPointData().GetScalars() is None or not image.GetNumberOfPoints():
        raise GeometryError(f"{node.GetName()}: it has no voxels. Choose a volume that is loaded.")
    channels = image.GetNumberOfScalarComponents()
    if channels != 1:
        raise GeometryError(f"{node.GetName()}: voxels must have 1 value; got {channels}. Choose a scalar volume.")
    with named(node):
        return Volume(slicer.util.arrayFromVolume(node), ijkToRAS(node))


def _mergedSegments(node, segmentIDs: list[str] | None, referenceVolumeNode, reach, progress) -> Volume:
    segmentation = node.GetSegmentation()
    present = [segmentation.GetNthSegmentID(index) for index in range(segmentation.GetNumberOfSegments())]
    chosen = present if segmentIDs is None else list(segmentIDs)
    unknown = [segmentID for segmentID in chosen if segmentID not in present]
    if unknown or not chosen:
        names = ", ".join(segmentation.GetSegment(segmentID).GetName() for segmentID in present) or "none"
        raise GeometryError(
            "{node}: segments must be one or more of those there are ({names}); got {chosen}. Choose the bone.".format(
                node=node.GetName(), names=names, chosen=", ".join(unknown) or "none"
            )
        )
    segmentation = _withLabelmaps(segmentation, chosen, referenceVolumeNode, node)
    ids = vtk.vtkStringArray()
    for segmentID in chosen:
        ids.InsertNextValue(segmentID)
    geometry = slicer.vtkOrientedImageData()
    mode = slicer.vtkSegmentation.EXTENT_UNION_OF_EFFECTIVE_SEGMENTS_AND_REFERENCE_GEOMETRY
    if not segmentation.SetImageGeometryFromCommonLabelmapGeometry(geometry, ids, mode) or geometry.IsEmpty():
        raise GeometryError(f"{node.GetName()}: the chosen segments are empty. Choose the segments that hold bone.")
    extent = np.array(geometry.GetExtent()).reshape(3, 2)
    if not _hasReference(segmentation):
        extent += np.array([-1, 1]) * reach(geometry.GetSpacing())
    geometry.SetExtent(extent.ravel().tolist())
    labels = np.zeros((extent[:, 1] - extent[:, 0] + 1)[::-1], dtype=np.uint8 if len(chosen) < 256 else np.uint16)
    # As they are now: a segment may go while the progress function has windows go on
    segments = [segmentation.GetSegment(segmentID) for segmentID in chosen]
    images = [(segment.GetRepresentation(_labelmap()), segment.GetLabelValue()) for segment in segments]
    for number, (image, value) in enumerate(images, start=1):
        report(progress, number / len(images), "Reading the CT's bone")
        _paint(labels, extent, geometry, image, value, number)
    shift = np.eye(4)
    shift[:3, 3] = extent[:, 0]
    with named(node):
        return Volume(labels, imageToWorld(geometry) @ shift)


def _withLabelmaps(segmentation, chosen: list[str], referenceVolumeNode, node):
    """The segmentation itself where it has labelmaps; else a copy of it that has, outside of any scene."""
    if segmentation.ContainsRepresentation(_labelmap()):
        return segmentation
    copy = slicer.vtkSegmentation()
    copy.SetSourceRepresentationName(segmentation.GetSourceRepresentationName())
    copy.CopyConversionParameters(segmentation)
    for segmentID in chosen:
        copy.CopySegmentFromSegmentation(segmentation, segmentID)
    if not _hasReference(copy) and referenceVolumeNode is not None:
        _setReference(copy, referenceVolumeNode, node)
    if not copy.CreateRepresentation(_labelmap()):
        raise GeometryError(f"{node.GetName()}: its segments cannot be made into voxels. Convert them to binary labelmaps in Slicer.")
    return copy


def _labelmap() -> str:
    return slicer.vtkSegmentationConverter.GetBinaryLabelmapRepresentationName()


def _hasReference(segmentation) -> bool:
    name = slicer.vtkSegmentationConverter.GetReferenceImageGeometryParameterName()
    return bool(segmentation.GetConversionParameter(name))


def _setReference(segmentation, volumeNode, node) -> None:
    """Voxels like those of `volumeNode`, as seen from the segmentation's own coordinates."""
    volumeToSegmentation = np.linalg.inv(matrixToWorld(node)) @ matrixToWorld(volumeNode) @ ijkToRAS(volumeNode)
    geometry = slicer.vtkOrientedImageData()
    geometry.SetDimensions(volumeNode.GetImageData().GetDimensions())
    geometry.SetGeometryFromImageToWorldMatrix(slicer.util.vtkMatrixFromArray(volumeToSegmentation))
    name = slicer.vtkSegmentationConverter.GetReferenceImageGeometryParameterName()
    segmentation.SetConversionParameter(name, slicer.vtkSegmentationConverter.SerializeImageGeometry(geometry))


def _paint(labels: np.ndarray, extent: np.ndarray, geometry, image, value: int, number: int) -> None:
    """Write `number` where a segment's image is `value`, into labels [k, j, i] that start at `extent` of `geometry`."""
    if image is None or image.IsEmpty():
        return
    shift = whole_shift(imageToWorld(image), imageToWorld(geometry))
    if shift is None:
        resampled = slicer.vtkOrientedImageData()
        single = slicer.vtkOrientedImageData()
        single.DeepCopy(image)
        voxels = numpy_support.vtk_to_numpy(single.GetPointData().GetScalars())
        voxels[:] = voxels == value
        slicer.vtkOrientedImageDataResample.ResampleOrientedImageToReferenceOrientedImage(single, geometry, resampled)
        image, value, shift = resampled, 1, np.zeros(3, dtype=int)
    own = np.array(image.GetExtent()).reshape(3, 2)
    voxels = numpy_support.vtk_to_numpy(image.GetPointData().GetScalars()).reshape((own[:, 1] - own[:, 0] + 1)[::-1])
    own += shift[:, None]
    first, last = np.maximum(own[:, 0], extent[:, 0]), np.minimum(own[:, 1], extent[:, 1])
    if (first > last).any():
        return
    source = tuple(slice(a, b) for a, b in zip((first - own[:, 0])[::-1], (last - own[:, 0] + 1)[::-1]))
    target = tuple(slice(a, b) for a, b in zip((first - extent[:, 0])[::-1], (last - extent[:, 0] + 1)[::-1]))
    # Several times as fast as an index of truth values
    np.copyto(labels[target], number, where=voxels[source] == value)


def imageToWorld(image) -> np.ndarray:
    """Of a vtkOrientedImageData, (4, 4): its voxels in the segmentation's coordinates."""
    matrix = vtk.vtkMatrix4x4()
    image.GetImageToWorldMatrix(matrix)
    return slicer.util.arrayFromVTKMatrix(matrix)

"""Files of any kind that a reconstruction needs, read into the scene in one go; CT and labels by nothing but MRML's own readers."""

import numpy as np
import slicer
from slicer.i18n import tr as _

from AIFReconLib.errors import FileFormatError
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.progress import part

from ..inputs.boneSource import BoneSource
from ..sceneNodes import freeName, removeNodes
from ..sweep.fileKinds import CONFIGURATION, PREDICTIONS, RECORDING, SEGMENTATION, TRANSFORM, VOLUME, kindOf
from ..transforms import ijkToRAS
from .segments import addSegments

MOST_LABELS = 64
"""A volume of so few whole numbers from 0 to 255 is a labelmap; a CT has hundreds."""


def openFiles(parameters, paths, loadRecording, progress=None) -> str:
    """Read files and choose what they hold; returns what was done.

    Parameters
    ----------
    parameters : AIFReconParameterNode
    paths : list of Path
    loadRecording : callable
        ``loadRecording(parameters, progress)`` reads the recording that the parameters name.
    progress : callable or None

    Raises
    ------
    AIFReconError
        With the file that cannot be read. Nothing is read where one is of no known kind.
    """
    of: dict = {}
    for path in paths:
        of.setdefault(kindOf(path), []).append(path)
    parameters.configurationPath = of.get(CONFIGURATION, [parameters.configurationPath])[0]
    for path in of.get(VOLUME, ()):
        node = openVolume(path)
        setattr(parameters, "bone" if node.IsA("vtkMRMLSegmentationNode") else "ctVolume", node)
    for path in of.get(SEGMENTATION, ()):
        parameters.bone = openSegmentation(path)
    for path in of.get(TRANSFORM, ()):
        above = openTransform(path)
        for node in (parameters.ctVolume, parameters.bone):
            if node is not None:
                node.SetAndObserveTransformNodeID(above.GetID())
    for path in of.get(PREDICTIONS, ()):
        _openPredictions(parameters, path, loadRecording)
    recordings, loaded = of.get(RECORDING, ()), []
    for number, path in enumerate(recordings):
        parameters.recordingPath = path
        loadRecording(parameters, part(progress, number / len(recordings), (number + 1) / len(recordings)))
        loaded.append(parameters.sweep)
    if loaded:
        parameters.sweep, parameters.otherSweeps = loaded[0], loaded[1:]
    return _("Opened {names}.").format(names=", ".join(path.name for path in paths))


def _openPredictions(parameters, path, loadRecording) -> None:
    """Read what a network has said of a sweep, and let that tell where bone is; the sweep that is chosen stays chosen."""
    chosen = {name: getattr(parameters, name) for name in ("sweep", "imageSequence", "recordingPath", "spacing")}
    parameters.recordingPath = path
    try:
        loadRecording(parameters, None)
        parameters.bonePredictions, parameters.boneSource = parameters.sweep.GetMasterSequenceNode(), BoneSource.PREDICTIONS
    finally:
        for name, value in chosen.items():
            setattr(parameters, name, value)


def openVolume(path):
    """The node of a volume: a segmentation where it holds labels.

    Raises
    ------
    FileFormatError
        When it cannot be read; the scene is then as before.
    """
    node = _read("vtkMRMLScalarVolumeNode", "vtkMRMLVolumeArchetypeStorageNode", path)
    return _segmentationOf(node) if _holdsLabels(slicer.util.arrayFromVolume(node)) else node


def openSegmentation(path):
    """The node of a segmentation saved by Slicer; errors as for `openVolume`."""
    return _read("vtkMRMLSegmentationNode", "vtkMRMLSegmentationStorageNode", path)


def openTransform(path):
    """The node of a transform; errors as for `openVolume`."""
    return _read("vtkMRMLTransformNode", "vtkMRMLTransformStorageNode", path)


def _read(kind: str, reader: str, path):
    scene = slicer.mrmlScene
    node = scene.AddNewNodeByClass(kind, freeName(path.name.split(".")[0], scene))
    storage = scene.AddNewNodeByClass(reader)
    storage.SetFileName(str(path))
    if not storage.ReadData(node):
        removeNodes([node, storage], scene)
        raise FileFormatError("{path}: the file cannot be read. Open it with Slicer's own Add Data, which says more.", path=path)
    node.SetAndObserveStorageNodeID(storage.GetID())
    if node.IsA("vtkMRMLDisplayableNode"):
        node.CreateDefaultDisplayNodes()
    return node


def _segmentationOf(volumeNode):
    """A segmentation of the labels of a volume, which it takes the place of, with that volume's voxels."""
    scene, name = slicer.mrmlScene, volumeNode.GetName()
    labels = Volume(slicer.util.arrayFromVolume(volumeNode).copy(), ijkToRAS(volumeNode))
    node = slicer.vtkMRMLSegmentationNode()
    node.SetReferenceImageGeometryParameterFromVolumeNode(volumeNode)
    removeNodes([volumeNode], scene)
    node.SetName(name)
    scene.AddNode(node)
    node.CreateDefaultDisplayNodes()
    addSegments(node, labels, {label: _("Label {number}").format(number=label) for label in np.unique(labels.array).tolist() if label})
    return node


def _holdsLabels(array: np.ndarray) -> bool:
    if array.dtype.kind not in "iu" or array.min() < 0 or array.max() > 255:
        return False
    return len(np.unique(array[:: max(1, len(array) // MOST_LABELS)])) <= MOST_LABELS

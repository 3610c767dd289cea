"""Files of any kind that a reconstruction needs, read into the scene in one go; CT and labels by nothing but MRML's own readers."""

import contextlib

import numpy as np
import slicer
from slicer.i18n import tr as _

from AIFReconLib.errors import FileFormatError
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.progress import part, report
from AIFReconLib.worker.recordings import CONFIGURATION, PREDICTIONS, RECORDING, SEGMENTATION, TRANSFORM, VOLUME, kind_of

from ..inputs.boneSource import BoneSource
from ..sceneNodes import addedTogether, freeName, proxiesOf, removeNodes, sequencesOf
from ..transforms import ijkToRAS
from ..work import inWorker
from .segments import addSegments

WAITS = "AIFRecon.PlaceOfCT"
"""Of a transform that was opened before a CT."""

MOST_LABELS = 64
"""A volume of so few whole numbers from 0 to 255 is a labelmap; a CT has hundreds."""

ORDER = (CONFIGURATION, VOLUME, SEGMENTATION, TRANSFORM, PREDICTIONS, RECORDING)
"""A transform is laid above what came before it; a recording needs its configuration."""

CHOSEN = (
    *("configurationPath", "recordingPath", "sweep", "otherSweeps", "imageSequence", "spacing"),
    *("ctVolume", "bone", "boneSource", "bonePredictions"),
)
"""Parameters that follow what is opened."""


def openFiles(parameters, paths, loadRecording, progress=None) -> tuple:
    """Read files and choose what they hold; returns what was done, and the sweep that was read anew, or None: see `replaceSweep`.

    Where one cannot be read, or after a cancel, all is as before. ``loadRecording(parameters, progress)`` reads the recording that the
    parameters name.
    """
    kinds = [(inWorker(kind_of, path), path) for path in paths]
    before = parameters.sweep if isReadAnew(parameters, [kind for kind, _path in kinds]) else None
    if before is not None:
        kinds.append((RECORDING, parameters.recordingPath))
    ordered = [(kind, path) for wanted in ORDER for kind, path in kinds if kind == wanted]
    sweeps = []
    with openedTogether(parameters):
        for number, (kind, path) in enumerate(ordered):
            share = part(progress, number / len(ordered), (number + 1) / len(ordered))
            report(share, 0.0, f"Opening {path.name}")
            if kind == RECORDING:
                parameters.recordingPath = path
                loadRecording(parameters, share)
                sweeps.append(parameters.sweep)
            elif kind == PREDICTIONS:
                _openPredictions(parameters, path, loadRecording, share)
            else:
                _openOther(parameters, kind, path, share)
        if sweeps:
            parameters.sweep, parameters.otherSweeps = sweeps[0], sweeps[1:]
        goesWith = _goesWith(parameters, [kind for kind, _path in ordered]) if sweeps and before is None else []
        lies = [*goesWith, *_placeCT(parameters)]
    done = [_("Opened {names}.").format(names=", ".join(path.name for path in paths)), *lies]
    if before is not None:
        done.append(_("The recording was read again with this calibration."))
    return " ".join(done), before


def replaceSweep(before, sweep) -> None:
    """Remove a sweep in whose place another has come, which takes its name. After that nothing can be as before: do it last."""
    name = before.GetName()
    removeNodes([*sequencesOf(before), *proxiesOf(before), before])
    sweep.SetName(name)


def _goesWith(parameters, kinds) -> list[str]:
    """What a recording is taken with that was opened before it: that may be another patient's."""
    before = (
        (_("the calibration {name}"), CONFIGURATION, parameters.configurationPath.name),
        (_("the CT {name}"), VOLUME, parameters.ctVolume.GetName() if parameters.ctVolume is not None else ""),
    )
    found = [words.format(name=name) for words, kind, name in before if name and kind not in kinds]
    return [_("It goes with {names}.").format(names=_(" and ").join(found))] if found else []


def isReadAnew(parameters, kinds) -> bool:
    """Whether what is opened is a calibration of the recording that was opened before."""
    path = parameters.recordingPath
    return CONFIGURATION in kinds and RECORDING not in kinds and parameters.sweep is not None and bool(path.name) and path.exists()


def _placeCT(parameters) -> list[str]:
    """Lay CT and bone below a transform that was opened before them; what is said of it."""
    waiting = [node for node in slicer.util.getNodesByClass("vtkMRMLTransformNode") if node.GetAttribute(WAITS)]
    opened = [node for node in (parameters.ctVolume, parameters.bone) if node is not None]
    if not waiting or not opened:
        return [_("{name} is taken for the place of the CT that is opened next.").format(name=waiting[-1].GetName())] if waiting else []
    for node in opened:
        if node.GetTransformNodeID() is None:
            node.SetAndObserveTransformNodeID(waiting[-1].GetID())
    for node in waiting:
        node.RemoveAttribute(WAITS)
    return [_("The CT lies where {name} says.").format(name=waiting[-1].GetName())]


@contextlib.contextmanager
def openedTogether(parameters):
    """The scene, what is chosen of it, and what CT and bone lie under, is as before where something within raises, a cancel too."""
    chosen = {name: getattr(parameters, name) for name in CHOSEN}
    chosen["otherSweeps"] = list(chosen["otherSweeps"])
    above = [(node, node.GetTransformNodeID()) for node in (parameters.ctVolume, parameters.bone) if node is not None]
    try:
        with addedTogether():
            yield
    except BaseException:
        for node, transformID in above:
            if _isThere(node):
                node.SetAndObserveTransformNodeID(transformID)
        for name, value in chosen.items():
            value = list(filter(_isThere, value)) if isinstance(value, list) else value
            setattr(parameters, name, value if _isThere(value) else None)
        raise


def _isThere(value) -> bool:
    """Whether this is no node that somebody has deleted meanwhile."""
    return not hasattr(value, "GetScene") or value.GetScene() is not None


def _openOther(parameters, kind: str, path, progress) -> None:
    if kind == CONFIGURATION:
        parameters.configurationPath = path
    elif kind == SEGMENTATION:
        parameters.bone = _read("vtkMRMLSegmentationNode", "vtkMRMLSegmentationStorageNode", path)
    elif kind == TRANSFORM:
        above = _read("vtkMRMLTransformNode", "vtkMRMLTransformStorageNode", path)
        placed = [node for node in (parameters.ctVolume, parameters.bone) if node is not None]
        for node in placed:
            node.SetAndObserveTransformNodeID(above.GetID())
        if not placed:
            above.SetAttribute(WAITS, "1")
    else:
        node = openVolume(path, progress)
        setattr(parameters, "bone" if node.IsA("vtkMRMLSegmentationNode") else "ctVolume", node)


def _openPredictions(parameters, path, loadRecording, progress) -> None:
    """Read what a network has said of a sweep, and let that tell where bone is; the sweep that is chosen stays chosen."""
    chosen = {name: getattr(parameters, name) for name in ("sweep", "imageSequence", "recordingPath", "spacing")}
    parameters.recordingPath = path
    try:
        loadRecording(parameters, progress)
        parameters.bonePredictions, parameters.boneSource = parameters.sweep.GetMasterSequenceNode(), BoneSource.PREDICTIONS
    finally:
        for name, value in chosen.items():
            setattr(parameters, name, value)


def openVolume(path, progress=None):
    """The node of a volume: a segmentation where it holds labels. A FileFormatError when it cannot be read; the scene is then as before."""
    node = _read("vtkMRMLScalarVolumeNode", "vtkMRMLVolumeArchetypeStorageNode", path)
    return _segmentationOf(node, progress) if _holdsLabels(slicer.util.arrayFromVolume(node)) else node


def _read(kind: str, reader: str, path):
    """A new node of this class, read by the storage node of that one; errors as for `openVolume`."""
    scene = slicer.mrmlScene
    node = scene.AddNewNodeByClass(kind, freeName(path.name.split(".")[0]))
    storage = scene.AddNewNodeByClass(reader)
    storage.SetFileName(str(path))
    if not storage.ReadData(node):
        removeNodes([node, storage])
        raise FileFormatError(f"{path}: the file cannot be read. Open it with Slicer's own Add Data, which says more.")
    node.SetAndObserveStorageNodeID(storage.GetID())
    if node.IsA("vtkMRMLDisplayableNode"):
        node.CreateDefaultDisplayNodes()
    return node


def _segmentationOf(volumeNode, progress):
    """A segmentation of the labels of a volume, which it takes the place of, with that volume's voxels."""
    scene, name = slicer.mrmlScene, volumeNode.GetName()
    labels = Volume(slicer.util.arrayFromVolume(volumeNode).copy(), ijkToRAS(volumeNode))
    node = slicer.vtkMRMLSegmentationNode()
    node.SetReferenceImageGeometryParameterFromVolumeNode(volumeNode)
    removeNodes([volumeNode])
    node.SetName(name)
    scene.AddNode(node)
    node.CreateDefaultDisplayNodes()
    named = {label: _("Label {number}").format(number=label) for label in np.unique(labels.array).tolist() if label}
    addSegments(node, labels, named, progress)
    return node


def _holdsLabels(array: np.ndarray) -> bool:
    if array.dtype.kind not in "iu" or array.min() < 0 or array.max() > 255:
        return False
    return len(np.unique(array[:: max(1, len(array) // MOST_LABELS)])) <= MOST_LABELS

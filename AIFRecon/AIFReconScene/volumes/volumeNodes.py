"""The volumes of a reconstruction as nodes: in RAS world, named for sweep and method, in one folder, shown as ultrasound."""

import json
import re

import numpy as np
import slicer
import vtk

from AIFReconLib.compounding.methods.average import AVERAGE
from AIFReconLib.errors import SettingsError
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.imaging.gray_window import gray_window
from AIFReconLib.worker.evaluating import write_settings

from ..sceneNodes import freeName, newImage, removeNodes, setWindow, sharedColors
from ..transforms import ijkToRAS, matrixToWorld
from ..work import inWorker

INTENSITY, SCORE, HITS, COSINE, MASK = "intensity", "score", "hits", "cosine", "mask"
KINDS = (INTENSITY, SCORE, HITS, COSINE, MASK)
"""The volumes of a `Reconstruction`, by their names there."""

MEASURED = "measured"
"""The plain mean of the same echoes, kept beside intensities that a method has raised."""

MASK_NAMES = ("empty", "measured", "filled")
MASK_COLORS = ((0.0, 0.0, 0.0, 0.0), (0.25, 0.65, 0.35, 1.0), (0.95, 0.7, 0.2, 1.0))
_MASK_ATTRIBUTE = "AIFRecon.MaskColors"
KIND_ATTRIBUTE = "AIFRecon.Volume"
"""Which of `KINDS` a volume that was made here is, or `MEASURED`."""

_NAME_ATTRIBUTE = "AIFRecon.Name"
"""The name that a node was given here, by which one that the user has changed is known."""

OWN_FIELDS, SETTINGS_ATTRIBUTE = "AIFRecon_", "AIFRecon_settings"
"""How a volume says in attributes where it comes from: as the library's files do in their headers."""

_ROLE = "AIFRecon.{kind}"
"""Of the references from the intensities to the other volumes of the same reconstruction."""

SPINE_ROLE = "AIFRecon.spine"
"""Of the reference from a volume to the model of the bone that it shows."""

COMPARED_ROLE = "AIFRecon.ComparedSweep"
"""Of the reference from a comparison's volumes and table to the sweep that was compared; a volume that is written to otherwise loses it."""


def updateVolumeNode(node, volume: Volume) -> None:
    """Put a volume into a volume node, in RAS world; its voxels are copied once. A parent transform is taken off."""
    _place(node, _imageData(volume.array), volume)


def volumeOf(node) -> Volume:
    """The voxels of a volume node where they lie in RAS world, with what it says of where it comes from."""
    fields = {name: node.GetAttribute(name) for name in node.GetAttributeNames() if name.startswith(OWN_FIELDS)}
    return Volume(slicer.util.arrayFromVolume(node), matrixToWorld(node) @ ijkToRAS(node), fields)


def besideOf(node, kind: str):
    """What of `KINDS` was kept beside a volume, on its voxels; None where it was not."""
    kept = node.GetNodeReference(_ROLE.format(kind=kind))
    return None if kept is None or kept.GetImageData() is None else volumeOf(kept)


def saveSettings(node, path) -> None:
    """Write how a volume of the scene was made (.json or .toml), so that `aifrecon reconstruct --settings` repeats it.

    Raises SettingsError when the volume does not say how it was made; OutputError when the file cannot be written.
    """
    text = node.GetAttribute(SETTINGS_ATTRIBUTE)
    if text is None:
        raise SettingsError(f"{node.GetName()} does not say how it was made. Choose a volume that AIFRecon reconstructed.")
    inWorker(write_settings, json.loads(text), path)


def outputNodes(
    result,
    sweepName: str,
    kinds: tuple[str, ...] = (INTENSITY,),
    nodes: dict | None = None,
    *,
    inputs: tuple = (),
    measured: Volume | None = None,
) -> dict:
    """Nodes for the volumes of a `Reconstruction` by kind, made or brought up to date, in one folder of the subject hierarchy.

    Parameters
    ----------
    sweepName : str
        What was reconstructed; with the method it names the nodes.
    kinds : tuple of str
        Which of `KINDS`; a cosine that was not computed is left out.
    nodes : dict of str to node, or None
        Nodes to use again, by kind. Those that were made together with the intensities are used again with them. They lose their parent
        transform, because the result holds world coordinates. A name that was given here follows the method; one of the user's stays.
    inputs : tuple of node
        What must not be overwritten: CT, bone, volume of the region. A SettingsError names it, or a labelmap for anything but the mask;
        whatever is raised, the scene is as it was.
    measured : Volume or None
        The plain mean of the same echoes, on the same voxels; one that was kept with earlier intensities goes where there is none now.
    """
    given = {kind: node for kind, node in (nodes or {}).items() if node is not None and kind in kinds}
    if INTENSITY in given:
        earlier = {kind: given[INTENSITY].GetNodeReference(_ROLE.format(kind=kind)) for kind in kinds if kind not in given}
        earlier[MEASURED] = measuredOf(given[INTENSITY]) if measured is not None else None
        given.update({kind: node for kind, node in earlier.items() if node is not None})
    for kind, node in given.items():
        if kind != MASK and node.IsA("vtkMRMLLabelMapVolumeNode"):
            raise SettingsError(f"Output must be a scalar volume; got the labelmap {node.GetName()!r}. Choose or create another one.")
        if any(node is each for each in inputs):
            raise SettingsError(f"Output must be another volume than the inputs; got {node.GetName()!r}. Choose or create another one.")
    volumes = {kind: getattr(result, kind) for kind in KINDS if kind in kinds and getattr(result, kind) is not None}
    if measured is not None:
        volumes[MEASURED] = measured
    # All memory is taken before the first node changes
    images = {kind: _imageData(volume.array) for kind, volume in volumes.items()}
    window = gray_window(result.intensity.array, result.mask.array)
    made = []
    try:
        placed = {}
        for kind, volume in volumes.items():
            node = given.get(kind)
            name = " ".join([sweepName, *{INTENSITY: [result.method], MEASURED: [MEASURED]}.get(kind, [result.method, kind])])
            if node is None:
                className = "vtkMRMLLabelMapVolumeNode" if kind == MASK else "vtkMRMLScalarVolumeNode"
                node = slicer.mrmlScene.AddNewNodeByClass(className)
                made.append(node)
                giveName(node, name)
            elif hasGivenName(node) and re.sub(r"_\d+$", "", node.GetName()) != name:
                giveName(node, name)
            _place(node, images[kind], volume)
            node.SetAttribute("AIFRecon.Method", AVERAGE.name if kind == MEASURED else result.method)
            node.SetAttribute(KIND_ATTRIBUTE, kind)
            node.SetNodeReferenceID(COMPARED_ROLE, None)
            _show(node, kind, window)
            placed[kind] = node
        for kind, node in placed.items():
            if INTENSITY in placed and kind != INTENSITY:
                placed[INTENSITY].SetNodeReferenceID(_ROLE.format(kind=kind), node.GetID())
        if INTENSITY in placed and measured is None:
            _forgetMeasured(placed[INTENSITY])
        intoFolder(placed.values(), sweepName)
    except Exception:
        removeNodes(made)
        raise
    return placed


def measuredOf(node):
    """The plain mean of the echoes that a volume was made of; None where none was kept, or what was kept is something else by now."""
    kept = node.GetNodeReference(_ROLE.format(kind=MEASURED)) if node is not None else None
    if kept is None or kept.GetAttribute(KIND_ATTRIBUTE) != MEASURED or None in (kept.GetImageData(), node.GetImageData()):
        return None
    return kept if kept.GetImageData().GetDimensions() == node.GetImageData().GetDimensions() else None


def _forgetMeasured(node) -> None:
    """What was kept beside the voxels that a volume held before is not of those that it holds now."""
    _removeHelpers(node, [_ROLE.format(kind=MEASURED)])
    node.SetNodeReferenceID(_ROLE.format(kind=MEASURED), None)


def goneWith(node) -> None:
    """Remove what was kept beside a volume that has left the scene, for the panel alone; what the user has named or asked for stays."""
    if node.GetAttribute(KIND_ATTRIBUTE) == INTENSITY:
        _removeHelpers(node, [_ROLE.format(kind=MEASURED), SPINE_ROLE])


def _removeHelpers(node, roles) -> None:
    kept = filter(None, (slicer.mrmlScene.GetNodeByID(node.GetNodeReferenceID(role) or "") for role in roles))
    removeNodes([each for each in kept if hasGivenName(each) and each.GetAttribute(KIND_ATTRIBUTE) in (None, MEASURED)])


def ultrasoundWindowOf(node) -> tuple[float, float]:
    """Darkest and brightest gray level to show of a volume node, whose voxels are 0 where nothing was measured."""
    array = slicer.util.arrayFromVolume(node)
    return gray_window(array, array)


def _imageData(array: np.ndarray):
    """The vtkImageData of an array [k, j, i]: the one copy of its voxels."""
    image, voxels = newImage(array)
    voxels[:] = array
    return image


def _place(node, imageData, volume: Volume) -> None:
    """Voxels, place, and where they come from: attributes, which the scene keeps, and an NRRD header that vtkMRMLNRRDStorageNode writes."""
    with slicer.util.NodeModify(node):
        for name in node.GetAttributeNames():
            if name.startswith(OWN_FIELDS) and name not in volume.fields:
                node.RemoveAttribute(name)
        for name, text in volume.fields.items():
            node.SetAttribute(name, text)
        node.SetAndObserveTransformNodeID(None)
        node.SetAndObserveImageData(imageData)
        node.SetIJKToRASMatrix(slicer.util.vtkMatrixFromArray(volume.ijk_to_reference))


def _show(node, kind: str, window: tuple[float, float]) -> None:
    """Window, level and colors. What was not measured is transparent, so that a CT below shows through.

    Nothing is interpolated: the empty voxels beside what was measured would darken its rim.
    """
    if node.GetDisplayNode() is None:
        node.CreateDefaultDisplayNodes()
    display = node.GetDisplayNode()
    if kind == MASK:
        display.SetAndObserveColorNodeID(sharedColors("AIFRecon mask", _MASK_ATTRIBUTE, zip(MASK_NAMES, MASK_COLORS)).GetID())
        return
    if kind in (INTENSITY, MEASURED, COSINE):
        setWindow(display, *((0.0, 1.0) if kind == COSINE else window))
    display.SetInterpolate(False)
    if kind in (INTENSITY, MEASURED):
        isByte = node.GetImageData().GetScalarType() == vtk.VTK_UNSIGNED_CHAR
        smallest, high = (1.0, 255.0) if isByte else (float(np.finfo(np.float32).tiny), node.GetImageData().GetScalarRange()[1])
        display.AutoThresholdOff()
        display.SetThreshold(smallest, max(high, smallest))
        display.SetApplyThreshold(True)


def followIntensity(node, result, shown: tuple[float, float] | None = None) -> tuple[float, float]:
    """Window and threshold for what a volume that grows holds now, ``result.intensity``; returns the window that was meant to be shown.

    `shown` is what this function returned the last time. A window that is another by now is the user's, and stays.
    """
    window = gray_window(result.intensity.array, result.mask.array)
    if node.GetDisplayNode() is not None and shown in (None, windowOf(node)):
        _show(node, INTENSITY, window)
        return window
    return shown or window


def windowOf(node) -> tuple[float, float]:
    """Darkest and brightest gray level that a volume node shows."""
    display = node.GetDisplayNode()
    return display.GetWindowLevelMin(), display.GetWindowLevelMax()


def hasGivenName(node) -> bool:
    """Whether a node still has the name that it was given here; else the user has named it."""
    return node.GetAttribute(_NAME_ATTRIBUTE) == node.GetName()


def isRenamed(node) -> bool:
    """Whether the user has named what was made here, so that it is theirs."""
    return node is not None and node.GetAttribute(_NAME_ATTRIBUTE) is not None and not hasGivenName(node)


def giveName(node, name: str) -> None:
    """Name a node, with a number where that name is taken, and remember it as given here."""
    node.SetName(freeName(name))
    node.SetAttribute(_NAME_ATTRIBUTE, node.GetName())


def intoFolder(nodes, sweepName: str) -> None:
    """Put nodes into the subject hierarchy's folder for what was made from a sweep, which is made where it is not there."""
    hierarchy = slicer.vtkMRMLSubjectHierarchyNode.GetSubjectHierarchyNode(slicer.mrmlScene)
    top, name = hierarchy.GetSceneItemID(), f"AIFRecon {sweepName}"
    folder = hierarchy.GetItemChildWithName(top, name) or hierarchy.CreateFolderItem(top, name)
    for node in nodes:
        item = hierarchy.GetItemByDataNode(node)
        # Slicer makes items for new nodes itself, but not before a batch of changes has ended
        if item:
            hierarchy.SetItemParent(item, folder)
        else:
            hierarchy.CreateItem(folder, node)

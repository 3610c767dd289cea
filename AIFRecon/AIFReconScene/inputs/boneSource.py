"""Who says where bone is: the CT, a network, or the echoes themselves; what is missing of each, and what it means."""

import enum

import slicer
from slicer.i18n import tr as _

from .parameters import LiveSource, fileFrom


class BoneSource(enum.Enum):
    """Who says where bone is."""

    CT = "CT"
    PREDICTIONS = "predictions"
    MODEL = "model"
    ECHOES = "echoes"

    def label(self, live: bool = False) -> str:
        """What the panel shows, of a scan where it is `live`."""
        return {
            BoneSource.CT: _("The CT"),
            BoneSource.PREDICTIONS: _("An AI model that runs elsewhere") if live else _("An AI model, as it was recorded"),
            BoneSource.MODEL: _("An AI model in a file"),
            BoneSource.ECHOES: _("The echoes themselves"),
        }[self]


def hasBone(parameters, live: bool = False) -> bool:
    """Whether something says where bone is, in a scan where it is `live`."""
    return {
        BoneSource.CT: parameters.bone is not None,
        BoneSource.PREDICTIONS: bool(parameters.liveBoneDevice.strip()) if live else parameters.bonePredictions is not None,
        BoneSource.MODEL: fileFrom(parameters.boneModelPath) is not None,
        BoneSource.ECHOES: True,
    }[parameters.boneSource]


def lacksBoneOfCT(parameters) -> bool:
    """Whether there is a CT whose bone nobody has segmented, and it is to say where bone is."""
    return parameters.boneSource == BoneSource.CT and parameters.bone is None and parameters.ctVolume is not None


def whyNoBone(parameters, live: bool = False) -> str:
    """What is missing of the source that is chosen; empty where nothing is: no CT is needed."""
    source, model = parameters.boneSource, fileFrom(parameters.boneModelPath)
    if source == BoneSource.MODEL:
        if model is None:
            return _("Choose the file of the AI model, or choose another “Bone told by”.")
        return "" if model.is_file() else _("There is no file {path}.").format(path=model)
    if source == BoneSource.PREDICTIONS:
        return _whyNotStreamed(parameters) if live else _whyNotRecorded(parameters)
    return ""


def _whyNotRecorded(parameters) -> str:
    if parameters.bonePredictions is None:
        return _("Select the recorded output of the AI model, or choose another “Bone told by”.")
    if parameters.otherSweeps:
        return _("The output of the AI model belongs to one sweep: leave the others out, or choose another “Bone told by”.")
    return ""


def _whyNotStreamed(parameters) -> str:
    if parameters.liveSource != LiveSource.OPENIGTLINK:
        return _("What an AI model says comes from a server: take the images from there too, or choose another “Bone told by”.")
    name = parameters.liveBoneDevice.strip()
    if not name:
        return _("Enter the name under which the server sends what the AI model says, or choose another “Bone told by”.")
    if name == parameters.liveImageDevice.strip():
        return _("Images and what the AI model says of them must have two names; both are {name}.").format(name=name)
    return ""


def describeBone(parameters, live: bool = False) -> str:
    """What the chosen source means, and what the absence of bone does."""
    source, bone = parameters.boneSource, parameters.bone
    if source == BoneSource.ECHOES:
        return _("Bone is looked for in the sweep itself: what is bright with darkness behind it. The docs say how well that works.")
    if source != BoneSource.CT:
        return whyNoBone(parameters, live)
    averaged = _("No bone selected: the scan is averaged, and bone is not enhanced.")
    none = averaged if live else _("Without the bone of a CT the echoes of the sweep tell where bone is, if they show any.")
    if lacksBoneOfCT(parameters):
        named = _(" TotalSegmentator is installed: it names each vertebra.") if hasattr(slicer.modules, "totalsegmentator") else ""
        return none + _(" “Bone from CT” finds that of the CT.") + named
    if bone is None:
        return none
    if bone.IsA("vtkMRMLLabelMapVolumeNode"):
        return _("Every label above 0 is bone.")
    return "" if bone.IsA("vtkMRMLSegmentationNode") else _("Taken for the probability of bone, from 0 to 1.")

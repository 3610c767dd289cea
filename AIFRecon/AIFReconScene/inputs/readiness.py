"""What is chosen by itself, and what is missing before something can be done or contradicts itself, in words for the panel; else empty.

Contradictions are said before any work begins; the library would refuse them too.
"""

import slicer
from slicer.i18n import tr as _

from AIFReconLib.compounding.methods.table import DEFAULT_METHOD_WITH_BONE, DEFAULT_METHOD_WITHOUT_BONE, method_named, registered_methods

from ..panelWords import inPanelWords
from ..sceneNodes import proxiesOf
from ..sweep.sweepStatus import furtherSweeps
from .boneNodes import isLabeled
from .boneSource import BoneSource, hasBone, whyNoBone
from .boxes import isEmpty
from .parameters import PARAMETERS, HoleFilling, Interpolation, LiveSource, Region, fileFrom, methodOf, needsBone

AIR = -500.0
"""HU."""


def chooseDefaults(parameters) -> None:
    """Choose the only sweep and segmentation there are, and the CT that this was drawn on or the only one, where nothing is chosen yet.

    Other modules add empty ones when they are opened; these are nobody's choice.
    """
    # The panel follows once
    with slicer.util.NodeModify(parameters):
        kinds = {
            "sweep": ("vtkMRMLSequenceBrowserNode", lambda node: node.GetNumberOfItems()),
            "bone": ("vtkMRMLSegmentationNode", lambda node: node.GetSegmentation().GetNumberOfSegments()),
        }
        for name, (className, filled) in kinds.items():
            nodes = [node for node in slicer.util.getNodesByClass(className) if filled(node)]
            if getattr(parameters, name) is None and len(nodes) == 1:
                setattr(parameters, name, nodes[0])
        bone = parameters.bone
        if parameters.ctVolume is None and bone is not None and bone.IsA("vtkMRMLSegmentationNode"):
            parameters.ctVolume = bone.GetNodeReference(slicer.vtkMRMLSegmentationNode.GetReferenceImageGeometryReferenceRole())
        if parameters.ctVolume is None:
            found = [node for node in slicer.util.getNodesByClass("vtkMRMLScalarVolumeNode") if _holdsAir(node)]
            parameters.ctVolume = found[0] if len(found) == 1 else None


def _holdsAir(node) -> bool:
    """Whether gray levels go far below zero, as those of a CT do and those of ultrasound, labels and probabilities do not."""
    return node.GetImageData() is not None and node.GetImageData().GetScalarRange()[0] <= AIR


def whyNotLoad(parameters) -> str:
    """What is missing before a recording can be read."""
    recording, configuration = fileFrom(parameters.recordingPath), fileFrom(parameters.configurationPath)
    if recording is None:
        return _("Choose a recording first.")
    if not recording.exists():
        return _("There is no file {path}.").format(path=recording)
    if configuration is not None and not configuration.is_file():
        return _("There is no file {path}.").format(path=configuration)
    return ""


def whyNoImages(parameters, sweep=None) -> str:
    """Why there is no tracked sweep to look at; `sweep` is the `SweepSummary` of the chosen one."""
    if parameters.sweep is None:
        return _("Open a recording, or select a tracked sweep.")
    return inPanelWords(sweep.problem) if sweep is not None and sweep.problem else ""


def whyNotReconstruct(parameters, sweep=None) -> str:
    """What is missing before a volume can be reconstructed, of this `SweepSummary`."""
    return whyNoImages(parameters, sweep) or _whatIsMissing(parameters)


def whyNotLive(parameters) -> str:
    """What is missing before a live scan can begin."""
    if parameters.liveSource == LiveSource.SCENE and parameters.liveImage is None:
        return _("Choose the live image, under “Connection”.")
    if parameters.liveSource == LiveSource.OPENIGTLINK and not parameters.liveHost.strip():
        return _("Press “Find the scanner”, under “Connection”, or enter its server there.")
    return _whatIsMissing(parameters, live=True)


def _whatIsMissing(parameters, live: bool = False) -> str:
    ofMethod, isThere = needsBone(methodOf(parameters)), hasBone(parameters, live)
    if missing := whyNoBone(parameters, live):
        return missing
    if not isThere and (ofMethod or parameters.bestCosine):
        if not ofMethod:
            return _("“Squareness” (in Settings) needs bone: select the CT's segmentation under “Bone of CT”, or uncheck it.")
        wanted = _("{method} needs bone: select the CT's segmentation under “Bone of CT”, or set “Method” (in Settings) to automatic.")
        return wanted.format(method=methodOf(parameters))
    if missing := _whyEmpty(parameters.bone):
        return missing
    if parameters.region == Region.BOX and parameters.roi is None:
        return _("Select or draw the box to reconstruct, or choose another region.")
    if parameters.region == Region.BOX and isEmpty(parameters.roi):
        return _("{name} has no size: select a sweep or a CT for it to lie around, or draw it.").format(name=parameters.roi.GetName())
    if parameters.region == Region.LIKE_VOLUME and parameters.regionVolume is None:
        return _("Select the volume whose voxels are wanted, or choose another region.")
    replayed = [proxy for sweep in (parameters.sweep, *furtherSweeps(parameters)) for proxy in proxiesOf(sweep)]
    inputs = (parameters.ctVolume, parameters.bone, parameters.regionVolume, parameters.liveImage, *replayed)
    if parameters.output is not None and any(parameters.output is node for node in inputs):
        return _("The output would overwrite {name}: select another output volume, or a new one.").format(name=parameters.output.GetName())
    return _contradiction(parameters, isThere)


def whyNotCompare(parameters, sweep=None) -> str:
    """What is missing before the methods can be compared."""
    if parameters.sweep is not None and parameters.boneSource == BoneSource.CT and parameters.bone is None:
        return _("Select bone: the methods differ in what they make of it.")
    return whyNotReconstruct(parameters, sweep) or _comparisonContradiction(parameters)


def whyNotRegister(parameters, sweep=None, isScanning: bool = False) -> str:
    """What is missing before the CT can be placed on the sweep, or on what a scan has shown so far."""
    bone = parameters.bone
    if bone is None:
        return _("Select the bone of the CT: a segmentation, or a labelmap.")
    if not isLabeled(bone):
        return _("{name} is a probability, which has no surface: select a segmentation or a labelmap.").format(name=bone.GetName())
    return _whyEmpty(bone) or ("" if isScanning else whyNoImages(parameters, sweep))


def withoutRepeating(missing: str, sweepText: str) -> str:
    """What is missing, for a place beside what is said of the sweep: a pointer where the same is said there."""
    return _("The sweep cannot be reconstructed: see above.") if missing and missing in sweepText else missing


def _whyEmpty(bone) -> str:
    """Why a node holds no bone; empty where it holds some, and where there is none."""
    if bone is None:
        return ""
    if bone.IsA("vtkMRMLSegmentationNode"):
        holdsSome = bone.GetSegmentation() is not None and bone.GetSegmentation().GetNumberOfSegments() > 0
    else:
        holdsSome = bone.GetImageData() is not None
    if holdsSome:
        return ""
    return _("{name} holds no bone: mark the bone of the CT in Slicer's Segment Editor, or select another.").format(name=bone.GetName())


def _contradiction(parameters, hasBone: bool) -> str:
    """The first contradiction among the parameters, in a sentence; empty where there is none; `hasBone`: where bone is, is told."""
    return (
        _ofMethod(parameters)
        or _ofSpeed(parameters, hasBone)
        or _ofHoles(parameters)
        or _ofFan(parameters)
        or _ofPixels(parameters, hasBone)
    )


def _comparisonContradiction(parameters) -> str:
    """The first choice that only some of the compared methods can do, in a sentence; empty where there is none."""
    if parameters.interpolation == Interpolation.LINEAR:
        return _("Linear interpolation does not go with every method: choose nearest to compare them.")
    if fileFrom(parameters.importanceMaskPath) is not None:
        return _("An importance mask does not go with every method: leave the mask out to compare them.")
    return ""


def _ofMethod(parameters) -> str:
    if parameters.ownMethod and parameters.ownMethod not in registered_methods():
        return _("{method} is not known: import {module} in the Python console, or choose another method.").format(
            method=parameters.ownMethod, module=parameters.ownMethod.partition(":")[0]
        )
    return ""


def _ofSpeed(parameters, hasBone: bool) -> str:
    rule = PARAMETERS["speed_of_sound"]
    if 0 < parameters.speedOfSound < rule["minimum"]:
        return _("The speed of sound must be off, or {low:g} to {high:g} m/s; it is {speed:g}.").format(
            low=rule["minimum"], high=rule["maximum"], speed=parameters.speedOfSound
        )
    if parameters.speedOfSound and hasBone and parameters.boneSource != BoneSource.CT:
        return _("Bone is looked for at the depths that the images show: leave the speed of sound off, or select bone of the CT.")
    return ""


def _ofHoles(parameters) -> str:
    if parameters.holeLimit == 0 and parameters.holes not in (HoleFilling.AUTOMATIC, HoleFilling.OFF):
        return _("Gaps are filled up to 0 mm: set “Fill gaps up to” above 0, or “Fill them by” to automatic.")
    return ""


def _ofFan(parameters) -> str:
    if parameters.fanLastRadius == 0:
        return ""
    if parameters.fanFirstAngle >= parameters.fanLastAngle or parameters.fanFirstRadius >= parameters.fanLastRadius:
        return _("The fan's second angle and radius must be larger than the first. Correct them, or set the last radius to 0.")
    return ""


def _ofPixels(parameters, hasBone: bool) -> str:
    # What a reconstruction would take; a configuration's method is not looked up, which refuses nothing
    method = methodOf(parameters) or (DEFAULT_METHOD_WITH_BONE if hasBone else DEFAULT_METHOD_WITHOUT_BONE)
    chosen = method_named(method)
    if parameters.interpolation == Interpolation.LINEAR and (chosen.spread is None or parameters.bestCosine):
        wish = method if chosen.spread is None else _("the best cosine")
        return _("Linear interpolation does not go with {wish}: choose nearest, or another method.").format(wish=wish)
    mask = fileFrom(parameters.importanceMaskPath)
    if mask is None:
        return ""
    if not mask.is_file():
        return _("There is no file {path}.").format(path=mask)
    if not chosen.weighs_pixels or parameters.bestCosine:
        return _("An importance mask weights an average: choose method average, or no mask.")
    return ""

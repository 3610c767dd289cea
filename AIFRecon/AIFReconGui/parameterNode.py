"""Every choice of the panel, as typed parameters that are saved with the scene."""

import pathlib
from typing import Annotated, Any

import slicer
from AIFReconScene.inputs.boneSource import BoneSource
from AIFReconScene.inputs.parameters import (
    CHOICES,
    PARAMETERS,
    ImageOrientation,
    LiveSource,
    ProbeShape,
    Region,
    RegistrationStart,
    SigmaUnit,
    camelCase,
    defaultOf,
    rangeOf,
)
from slicer import (
    vtkMRMLLabelMapVolumeNode,
    vtkMRMLMarkupsFiducialNode,
    vtkMRMLMarkupsROINode,
    vtkMRMLScalarVolumeNode,
    vtkMRMLSegmentationNode,
    vtkMRMLSequenceBrowserNode,
    vtkMRMLSequenceNode,
)
from slicer.parameterNodeWrapper import Minimum, WithinRange, parameterNodeWrapper

from AIFReconLib.recipe.recipe import LONGEST_GAP
from AIFReconLib.recipe.rules import FLAG, WHOLE
from AIFReconLib.sweep.time_offset import LARGEST_OFFSET

FARTHEST = 100000.0
"""Pixels: as far as a place may lie from the image's corner."""

FORMER_ECHOES = "boneFromSweep"
"""What earlier panels saved where bone was looked for in the sweep, if there was none of a CT."""


def _typeOf(name: str):
    """The type of a setting's parameter, with its range."""
    rule = PARAMETERS[name]
    if name in CHOICES:
        return CHOICES[name]
    if rule["kind"] == FLAG:
        return bool
    least, most = rangeOf(name)
    number, bounds = int if rule["kind"] == WHOLE else float, Minimum(least) if most is None else WithinRange(least, most)
    return Annotated[number, bounds]


_FIELDS = {camelCase(name): (_typeOf(name), defaultOf(name)) for name in PARAMETERS}
_SETTINGS: Any = type(
    "_Settings",
    (),
    {**{name: each[1] for name, each in _FIELDS.items()}, "__annotations__": {name: each[0] for name, each in _FIELDS.items()}},
)
"""A parameter for each setting of the library's recipe that has one field in the panel."""


@parameterNodeWrapper
class AIFReconParameterNode(_SETTINGS):
    """Every choice of the panel, saved with the scene: what is here, and the settings of the library's recipe."""

    sweep: vtkMRMLSequenceBrowserNode | None
    imageSequence: vtkMRMLSequenceNode | None
    otherSweeps: list[vtkMRMLSequenceBrowserNode]
    recordingPath: pathlib.Path
    configurationPath: pathlib.Path
    imageOrientation: ImageOrientation = ImageOrientation.AUTOMATIC
    timeOffset: Annotated[float, WithinRange(-LARGEST_OFFSET, LARGEST_OFFSET)] = 0.0
    longestGap: Annotated[float, WithinRange(0.01, 60.0)] = LONGEST_GAP
    takeOutMotion: bool = True

    ctVolume: vtkMRMLScalarVolumeNode | None
    bone: vtkMRMLSegmentationNode | vtkMRMLLabelMapVolumeNode | vtkMRMLScalarVolumeNode | None
    boneSegments: list[str]
    boneSource: BoneSource = BoneSource.CT
    bonePredictions: vtkMRMLSequenceNode | None
    boneModelPath: pathlib.Path
    boneSigma: Annotated[float, WithinRange(0.1, 100.0)] = 10.0
    boneSigmaUnit: SigmaUnit = SigmaUnit.AUTOMATIC

    registrationStart: RegistrationStart = RegistrationStart.WHERE_IT_IS
    showEchoes: bool = True

    region: Region = Region.AROUND_SWEEP
    roi: vtkMRMLMarkupsROINode | None
    regionVolume: vtkMRMLScalarVolumeNode | None
    output: vtkMRMLScalarVolumeNode | None

    ownMethod: str
    probe: ProbeShape = ProbeShape.AUTOMATIC
    apexColumn: Annotated[float, WithinRange(-FARTHEST, FARTHEST)] = 0.0
    apexRow: Annotated[float, WithinRange(-FARTHEST, FARTHEST)] = 0.0
    clipColumn: Annotated[float, WithinRange(0.0, FARTHEST)] = 0.0
    clipRow: Annotated[float, WithinRange(0.0, FARTHEST)] = 0.0
    clipWidth: Annotated[float, WithinRange(0.0, FARTHEST)] = 0.0
    clipHeight: Annotated[float, WithinRange(0.0, FARTHEST)] = 0.0
    fanFirstAngle: Annotated[float, WithinRange(-89.0, 89.0)] = -30.0
    fanLastAngle: Annotated[float, WithinRange(-89.0, 89.0)] = 30.0
    fanFirstRadius: Annotated[float, WithinRange(0.0, FARTHEST)] = 0.0
    fanLastRadius: Annotated[float, WithinRange(0.0, FARTHEST)] = 0.0
    importanceMaskPath: pathlib.Path

    liveSource: LiveSource = LiveSource.OPENIGTLINK
    liveHost: str = "127.0.0.1"
    livePort: Annotated[int, WithinRange(1, 65535)] = 18944
    liveImageDevice: str
    liveBoneDevice: str
    liveImage: vtkMRMLScalarVolumeNode | None
    liveRecord: bool = True
    liveRecordPath: pathlib.Path
    guidance: bool = False

    pathTarget: str
    pathPoint: vtkMRMLMarkupsFiducialNode | None

    keepScore: bool = False
    keepHits: bool = False
    keepMask: bool = False
    opacity: Annotated[float, WithinRange(0.0, 1.0)] = 1.0
    showBoneOutlines: bool = True
    volumeRendering: bool = False
    showProbe: bool = False
    showOutlines: bool = False
    showMeasured: bool = False
    showRaised: bool = True
    showSpine: bool = True
    probeUp: bool = False
    showLevels: bool = False


def parametersOf(node):
    """The typed parameters of a node; those of a panel that had no choice of the bone's source keep what they asked for."""
    # Each value that is new to the node would have all of them read anew
    with slicer.util.NodeModify(node):
        parameters = AIFReconParameterNode(node)
    if wanted := node.GetParameter(FORMER_ECHOES):
        node.UnsetParameter(FORMER_ECHOES)
        if wanted == "True" and parameters.bone is None:
            parameters.boneSource = BoneSource.ECHOES
    return parameters

"""Every choice of the panel, as typed parameters that are saved with the scene."""

import pathlib
from typing import Annotated

import slicer
from AIFReconScene.inputs.boneSource import BoneSource
from AIFReconScene.inputs.parameters import (
    AUTOMATIC_NUMBER,
    PARAMETERS,
    BoneDirection,
    Engine,
    HoleFilling,
    ImageOrientation,
    Interpolation,
    LiveSource,
    Method,
    OutputType,
    ProbeShape,
    Region,
    RegistrationStart,
    SigmaUnit,
)
from slicer import (
    vtkMRMLLabelMapVolumeNode,
    vtkMRMLMarkupsROINode,
    vtkMRMLScalarVolumeNode,
    vtkMRMLSegmentationNode,
    vtkMRMLSequenceBrowserNode,
    vtkMRMLSequenceNode,
)
from slicer.parameterNodeWrapper import Minimum, WithinRange, parameterNodeWrapper

from AIFReconLib.sweep.pose_tracks import LONGEST_GAP
from AIFReconLib.sweep.time_offset import LARGEST_OFFSET

FARTHEST = 100000.0
"""Pixels: as far as a place may lie from the image's corner."""

SMALLEST_WEIGHT_FLOOR = 0.001
"""The library takes less; the panel shows three digits."""


FORMER_ECHOES = "boneFromSweep"
"""What earlier panels saved where bone was looked for in the sweep, if there was none of a CT."""


def _within(name: str) -> WithinRange:
    """The range that the library gives a parameter."""
    return WithinRange(PARAMETERS[name]["minimum"], PARAMETERS[name]["maximum"])


@parameterNodeWrapper
class AIFReconParameterNode:
    """Every choice of the panel, saved with the scene.

    Ranges and defaults are those of AIFReconLib.settings, but for `SMALLEST_WEIGHT_FLOOR`. Where the library's default is "not given",
    0 or an automatic choice stands for it, and `AUTOMATIC_NUMBER` for a number that it chooses.
    """

    sweep: vtkMRMLSequenceBrowserNode | None
    imageSequence: vtkMRMLSequenceNode | None
    otherSweeps: list[vtkMRMLSequenceBrowserNode]
    recordingPath: pathlib.Path
    configurationPath: pathlib.Path
    imageOrientation: ImageOrientation = ImageOrientation.AUTOMATIC
    timeOffset: Annotated[float, WithinRange(-LARGEST_OFFSET, LARGEST_OFFSET)] = 0.0
    longestGap: Annotated[float, WithinRange(0.01, 60.0)] = LONGEST_GAP

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

    method: Method = Method.AUTOMATIC
    ownMethod: str
    spacing: Annotated[float, _within("spacing")] = PARAMETERS["spacing"]["default"]
    alpha: Annotated[float, _within("alpha")] = PARAMETERS["alpha"]["default"]
    beta: Annotated[float, _within("beta")] = PARAMETERS["beta"]["default"]
    boneDirection: BoneDirection = BoneDirection(PARAMETERS["bone_direction"]["default"])
    holeLimit: Annotated[float, WithinRange(AUTOMATIC_NUMBER, PARAMETERS["hole_limit"]["maximum"])] = AUTOMATIC_NUMBER
    holes: HoleFilling = HoleFilling.AUTOMATIC
    interpolation: Interpolation = Interpolation.AUTOMATIC
    pixelRejection: Annotated[float, Minimum(0.0)] = 0.0
    speedOfSound: Annotated[float, WithinRange(0.0, PARAMETERS["speed_of_sound"]["maximum"])] = 0.0
    scannerSpeedOfSound: Annotated[float, _within("scanner_speed_of_sound")] = PARAMETERS["scanner_speed_of_sound"]["default"]
    intensityMaximum: Annotated[float, Minimum(0.0)] = 0.0
    bestCosine: bool = PARAMETERS["best_cosine"]["default"]
    skip: Annotated[int, WithinRange(0, 1000)] = 0
    engine: Engine = Engine(PARAMETERS["engine"]["default"])
    outputType: OutputType = OutputType.AUTOMATIC
    boneGain: Annotated[float, _within("bone_gain")] = PARAMETERS["bone_gain"]["default"]
    weightFloor: Annotated[float, WithinRange(SMALLEST_WEIGHT_FLOOR, PARAMETERS["weight_floor"]["maximum"])] = PARAMETERS["weight_floor"][
        "default"
    ]
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

    keepScore: bool = False
    keepHits: bool = False
    keepMask: bool = False
    opacity: Annotated[float, WithinRange(0.0, 1.0)] = 0.6
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

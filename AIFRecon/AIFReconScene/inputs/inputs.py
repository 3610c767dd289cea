"""The nodes that a reconstruction starts from, and what the library makes of them."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field, fields
from functools import partial
from pathlib import Path
from typing import Any

from AIFReconLib.bone.widths import voxels_around
from AIFReconLib.errors import SettingsError
from AIFReconLib.progress import part, report
from AIFReconLib.recipe.recipe import RULES, Recipe
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.multi_sweep import joined
from AIFReconLib.workflows.job import BoneSource as GivenBone
from AIFReconLib.workflows.job import ReconstructionJob

from ..sceneNodes import proxiesOf
from ..sweep.sequenceReader import predictionsFromNode, sequenceFromBrowser
from ..sweep.sweepStatus import furtherSweeps
from ..transforms import matrixToWorld
from .boneNodes import isLabeled, labelsFromNode, probabilityFromNode
from .boneSource import BoneSource
from .gridNodes import gridFromROI, gridFromVolume
from .parameters import Region, camelCase, fileFrom, settingsFrom


@dataclass(frozen=True)
class Inputs:
    """Nodes and choices, as the console or the panel give them."""

    sweep: Any  #: vtkMRMLSequenceBrowserNode
    imageSequence: Any = None  #: None: the only sequence of images there is
    otherSweeps: tuple = ()  #: Of the same Reference: they are reconstructed with the first as one
    bone: Any = None  #: vtkMRMLSegmentationNode, vtkMRMLLabelMapVolumeNode, or vtkMRMLScalarVolumeNode of a probability
    ct: Any = None  #: Segments that are surfaces only are brought to its voxels
    boneSegments: tuple = ()  #: IDs; empty: all
    region: Any = None  #: vtkMRMLMarkupsROINode or vtkMRMLScalarVolumeNode; None: around the sweep
    boneFrames: Any = None
    """vtkMRMLSequenceNode of a network's predictions. They, a model, and bone that is looked for in the sweep itself come before `bone`."""
    boneModel: Path | None = None  #: A network in an ONNX file
    recipe: Recipe = field(default_factory=Recipe)

    @classmethod
    def fromParameters(cls, parameters) -> Inputs:
        """What the panel's parameters name."""
        return cls(
            sweep=parameters.sweep,
            imageSequence=parameters.imageSequence,
            otherSweeps=furtherSweeps(parameters),
            bone=parameters.bone,
            ct=parameters.ctVolume,
            boneSegments=tuple(parameters.boneSegments),
            region={Region.BOX: parameters.roi, Region.LIKE_VOLUME: parameters.regionVolume}.get(parameters.region),
            boneFrames=parameters.bonePredictions if parameters.boneSource == BoneSource.PREDICTIONS else None,
            boneModel=fileFrom(parameters.boneModelPath) if parameters.boneSource == BoneSource.MODEL else None,
            recipe=settingsFrom(parameters),
        )

    def nodes(self) -> tuple:
        """The nodes that an output must not overwrite: among them those that the sweep is replayed into."""
        replayed = (proxy for sweep in self.sweeps for proxy in proxiesOf(sweep))
        return tuple(node for node in (self.bone, self.ct, self.region, *replayed) if node is not None)

    @property
    def sweeps(self) -> tuple:
        """The sequence browsers."""
        return self.sweep, *self.otherSweeps

    @property
    def name(self) -> str:
        """What volumes are named for."""
        more = f" +{len(self.otherSweeps)}" if self.otherSweeps else ""
        return f"{self.sweep.GetName()}{more}"

    def sequence(self) -> TrackedSequence:
        """The sweep as the library has it; several as one. An AIFReconError says which cannot be used and what to do."""
        if self.sweep is None:
            raise SettingsError("Input sweep must be a sequence browser; got none. Load a recording or select a sweep.")
        others = (sequenceFromBrowser(sweep) for sweep in self.otherSweeps)
        return joined([sequenceFromBrowser(self.sweep, self.imageSequence), *others])

    def job(self, progress=None) -> ReconstructionJob:
        """What the worker is asked for, of the nodes as they are now. An AIFReconError says which cannot be used and what to do."""
        sequence, grid = self.sequence(), self.grid(self.recipe)
        images: list[Any] = [sweep.images for sweep in sequence.sweeps]
        for number, each in enumerate(images):
            each.shared(part(progress, 0.5 * number / len(images), 0.5 * (number + 1) / len(images)))
        bone = self._givenBone(part(progress, 0.5, 1.0))
        return ReconstructionJob(sequence, self.recipe, bone, grid, search_path=tuple(sys.path))

    def _givenBone(self, progress) -> GivenBone | None:
        if self.boneFrames is not None:
            return GivenBone(predictions=predictionsFromNode(self.boneFrames))
        if self.boneModel is not None:
            return GivenBone(model=self.boneModel)
        if self.bone is None or self.recipe.bone_from_sweep:
            return None
        probability = None if isLabeled(self.bone) else probabilityFromNode(self.bone)
        return GivenBone(self.labels(progress), probability, matrixToWorld(self.bone), name=self.bone.GetName())

    def labels(self, progress=None):
        """The `Volume` of the chosen bone's labels in its own coordinates; None without bone, or where it is a probability."""
        if self.bone is None or not isLabeled(self.bone):
            return None
        report(progress, 0.0, "Reading the CT's bone")
        chosen = list(self.boneSegments) or None
        reach = partial(voxels_around, sigma_voxels=self.recipe.bone_sigma_voxels, sigma_mm=self.recipe.bone_sigma_mm)
        return labelsFromNode(self.bone, chosen, referenceVolumeNode=self.ct, world=False, reach=reach, progress=progress)

    def grid(self, settings):
        """The `VoxelGrid` of the chosen region in RAS, or None for the box around the sweep."""
        if self.region is None:
            return None
        if self.region.IsA("vtkMRMLMarkupsROINode"):
            return gridFromROI(self.region, settings.spacing_xyz())
        return gridFromVolume(self.region)


def settingsAndInputs(choices: dict) -> tuple[dict, dict]:
    """What a script chose by name: settings of the library's `Recipe`, and fields of `Inputs`; a SettingsError for another name.

    Settings may be named as the module names them (``holeLimit``) or as the library does (``hole_limit``).
    """
    settings = {name: known for known in RULES for name in (known, camelCase(known))}
    others = [each.name for each in fields(Inputs) if each.name not in ("sweep", "bone", "recipe")]
    unknown = next((name for name in choices if name not in settings and name not in others), None)
    if unknown is not None:
        names = ", ".join(sorted({camelCase(name) for name in RULES} | set(others)))
        raise SettingsError(f"Input {unknown} is no choice. The choices are: {names}.")
    return {settings[name]: value for name, value in choices.items() if name in settings}, {
        name: value for name, value in choices.items() if name in others
    }

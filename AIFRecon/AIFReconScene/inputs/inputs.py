"""The nodes that a reconstruction starts from, and what the library makes of them."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from AIFReconLib.compounding.methods.average import AVERAGE
from AIFReconLib.compounding.methods.table import method_named
from AIFReconLib.errors import InsufficientMemoryError, SettingsError
from AIFReconLib.progress import part, report
from AIFReconLib.recipe.recipe import RULES, Recipe

from ..background import inBackground
from ..sceneNodes import proxiesOf
from ..sweep.severalSweeps import furtherSweeps
from ..transforms import matrixToWorld
from .boneNodes import named
from .boneSource import BoneSource
from .parameters import Region, camelCase, fileFrom, needsBone, settingsFrom

if TYPE_CHECKING:
    from AIFReconLib import BoneMap, TrackedSequence, Volume
    from AIFReconLib.geometry.volume import VoxelGrid
    from AIFReconLib.inspection.shown_bone import ShownBone
    from AIFReconLib.registration.labeled_bone import LabeledBone


@dataclass(frozen=True)
class Inputs:
    """Nodes and choices, as the console or the panel give them.

    Parameters
    ----------
    sweep : vtkMRMLSequenceBrowserNode
    imageSequence : vtkMRMLSequenceNode or None
        None: the only sequence of images there is.
    otherSweeps : sequence of vtkMRMLSequenceBrowserNode
        Further sweeps of the same Reference, which are reconstructed with the first as one.
    bone : vtkMRMLSegmentationNode, vtkMRMLLabelMapVolumeNode, vtkMRMLScalarVolumeNode or None
    ct : vtkMRMLScalarVolumeNode or None
        Never changed; segments that are surfaces only are brought to its voxels.
    boneSegments : tuple of str
        IDs; empty: all.
    region : vtkMRMLMarkupsROINode, vtkMRMLScalarVolumeNode or None
        None: around the sweep.
    boneFrames : vtkMRMLSequenceNode or None
        A network's predictions for the frames. They, a model, and bone that is looked for in the sweep itself come before `bone`, which
        then only judges the result.
    boneModel : Path or None
        A network in an ONNX file.
    recipe : Recipe
        What says how images are read and how bone becomes a map.
    """

    sweep: Any
    imageSequence: Any = None
    otherSweeps: tuple = ()
    bone: Any = None
    ct: Any = None
    boneSegments: tuple = ()
    region: Any = None
    boneFrames: Any = None
    boneModel: Path | None = None
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
        """The sweep as the library has it; several as one.

        Raises
        ------
        AIFReconError
            With the sweep that cannot be used and what to do.
        """
        from AIFReconLib.sweep.joined import joined

        from ..sweep.sequenceReader import sequenceFromBrowser

        if self.sweep is None:
            raise SettingsError("Input sweep must be a sequence browser; got none. Load a recording or select a sweep.")
        others = (sequenceFromBrowser(sweep) for sweep in self.otherSweeps)
        return joined([sequenceFromBrowser(self.sweep, self.imageSequence), *others])

    def prepared(self, settings, progress=None) -> PreparedInputs:
        """Turn the nodes into the library's inputs, once for any number of reconstructions; nodes that change later change nothing.

        `settings` give the spacing of the voxels.

        Raises
        ------
        AIFReconError
            With the node that cannot be used and what to do.
        """
        sequence, grid = self.sequence(), self.grid(settings)
        if self.seesBone:
            return PreparedInputs(sequence, self._boneOf(sequence, settings, progress), grid, recipe=settings)
        labels = self.labels(part(progress, 0.0, 0.1))
        progress = part(progress, 0.1, 1.0)
        if labels is None:
            return PreparedInputs(sequence, self.boneMap(progress), grid, recipe=settings)
        from AIFReconLib.registration.labeled_bone import LabeledBone

        labeled = LabeledBone(labels, matrixToWorld(self.bone), sequence, settings)
        with named(self.bone):
            inBackground(lambda progress: labeled.map(settings.method_for(True), progress), progress)
        return PreparedInputs(sequence, None, grid, labeled, settings)

    @property
    def seesBone(self) -> bool:
        """Whether the frames themselves say where bone is."""
        return self.recipe.bone_from_sweep or self._asksNetwork

    @property
    def _asksNetwork(self) -> bool:
        return self.boneFrames is not None or self.boneModel is not None

    def labels(self, progress=None):
        """The `Volume` of the chosen bone's labels in its own coordinates; None without bone, or where it is a probability."""
        from AIFReconLib.registration.agreement import LARGEST_WIDTH

        from .boneNodes import isLabeled, ownLabels

        if self.bone is None or not isLabeled(self.bone):
            return None
        report(progress, 0.0, "Reading the CT's bone")
        widest = self.recipe.bone_sigma_mm if self._hasWidth else LARGEST_WIDTH
        chosen = list(self.boneSegments) or None
        width = {"sigmaVoxels": self.recipe.bone_sigma_voxels, "sigmaMm": widest}
        return ownLabels(self.bone, chosen, referenceVolumeNode=self.ct, progress=progress, **width)

    def boneMap(self, progress=None, labels=None, method: str = ""):
        """The `BoneMap` of the chosen bone in RAS, or None without; of its `labels()` where these are there already.

        Before there is a sweep: where no width is chosen, `weighted` gets that of a CT whose agreement is not known.
        """
        from .boneNodes import boneMapFromNode

        if self.bone is None:
            return None
        chosen, sigmaMm = list(self.boneSegments) or None, self._settingsOfMap(method).get("bone_sigma_mm")
        width = {"sigmaVoxels": self.recipe.bone_sigma_voxels, "sigmaMm": sigmaMm}
        return boneMapFromNode(self.bone, chosen, referenceVolumeNode=self.ct, labels=labels, progress=progress, **width)

    def boneSettings(self, method: str) -> dict:
        """How the map of `boneMap` is made, as settings that repeat a reconstruction."""
        from .boneNodes import isLabeled

        return self._settingsOfMap(method) if not self.seesBone and self.bone is not None and isLabeled(self.bone) else {}

    def _settingsOfMap(self, method: str) -> dict:
        from AIFReconLib.registration.labeled_bone import UNKNOWN_WIDTH

        if not self._hasWidth:
            return {"bone_sigma_mm": UNKNOWN_WIDTH} if method and method_named(method).follows_agreement else {}
        return (
            {"bone_sigma_voxels": self.recipe.bone_sigma_voxels}
            if self.recipe.bone_sigma_mm is None
            else {"bone_sigma_mm": self.recipe.bone_sigma_mm}
        )

    @property
    def _hasWidth(self) -> bool:
        return self.recipe.bone_sigma_voxels is not None or self.recipe.bone_sigma_mm is not None

    def _boneOf(self, sequence, recipe, progress):
        from AIFReconLib import bone_from_sweep

        if self._asksNetwork:
            from ..sweep.predictedBone import predictedBone

            return predictedBone(sequence, self.boneFrames, self.boneModel, recipe, progress)
        return inBackground(lambda progress: bone_from_sweep(sequence, recipe=recipe, progress=progress), progress)

    def grid(self, settings):
        """The `VoxelGrid` of the chosen region in RAS, or None for the box around the sweep."""
        from .gridNodes import gridFromROI, gridFromVolume

        if self.region is None:
            return None
        if self.region.IsA("vtkMRMLMarkupsROINode"):
            return gridFromROI(self.region, settings.spacing_xyz())
        return gridFromVolume(self.region)


@dataclass(frozen=True)
class PreparedInputs:
    """The library's inputs; `reconstruct` may be called with any settings that have the same spacing.

    Where bone is labeled, `labeledBone` holds the labels as they were when they were read, and makes the map that a method wants; else it
    is `bone`.
    """

    sequence: TrackedSequence
    bone: BoneMap | None = None
    grid: VoxelGrid | None = None
    labeledBone: LabeledBone | None = None
    recipe: Recipe = field(default_factory=Recipe)

    def comparison(self, progress=None):
        """The `Comparison` of the sweep's own bone with the labels; None without labels."""
        labeled = self.labeledBone
        return None if labeled is None else inBackground(labeled.comparison, progress)

    def widthLines(self, method: str, progress=None) -> list:
        """The width of the bone map that follows from that comparison, where it does: a line or none."""
        if self.labeledBone is None or not self.labeledBone.is_automatic(method):
            return []
        return self.labeledBone.lines(method)[len(self.comparison(progress).lines) :]

    def reconstruct(self, settings, progress=None, beside=()):
        """One call of the library: `settings` to a `Reconstruction` in RAS, whose volumes know how they were made."""

        from AIFReconLib import reconstruct
        from AIFReconLib.provenance.record import with_settings

        def work(progress):
            bone, method = self.bone, settings.method_for(True)
            ofMap = {}
            if self.labeledBone is not None:
                bone = self.labeledBone.map(method, part(progress, 0.0, 0.1))
                ofMap = self.labeledBone.settings(method)
            result = reconstruct(self.sequence, settings, bone, self.grid, beside=beside, progress=part(progress, 0.1, 1.0))
            return with_settings(result, ofMap)

        return inBackground(work, progress)

    def measured(self, settings, result, progress=None) -> Volume:
        """The plain mean of the echoes on the voxels of a result that a method has made, with the same holes filled."""

        from AIFReconLib import reconstruct

        plain = replace(settings, method=AVERAGE.name, best_cosine=False, hole_limit=result.hole_limit or settings.hole_limit)

        def work(progress):
            return reconstruct(self.sequence, plain, None, result.grid, beside=(), progress=progress).intensity

        return inBackground(work, progress)

    def shown(self, result, progress=None) -> ShownBone | None:
        """The bone that a result shows, for 3D; None of one without score and hits."""
        from AIFReconLib.inspection.shown_bone import shown_bone

        if result.score is None or result.hits is None:
            return None
        labeled = (None, None) if self.labeledBone is None else (self.labeledBone.labels, self.labeledBone.labels_to_reference)
        return inBackground(lambda _progress: shown_bone(result, *labeled), progress)

    @property
    def hasBone(self) -> bool:
        """Whether there is any."""
        return self.bone is not None or self.labeledBone is not None


def reconstructed(inputs: Inputs, settings, progress=None, beside=(), wished=()) -> tuple:
    """A `Reconstruction`, the `PreparedInputs` that it was made from, and what was done, a line each.

    The volumes `beside` are made in any case; those that are `wished`, with a method that weights by bone and where memory allows.
    """
    from AIFReconLib.inspection.summary import summary_lines

    from ..panelWords import inPanelWords, remedies

    prepared = inputs.prepared(settings, part(progress, 0.0, 0.1))
    asked = [name for name in beside if name in ("score", "hits")]
    wished = wished if needsBone(settings.method_for(prepared.hasBone)) else ()
    try:
        result = prepared.reconstruct(settings, part(progress, 0.1, 0.95), sorted({*asked, *wished}))
    except InsufficientMemoryError:
        if not wished:
            raise
        result = prepared.reconstruct(settings, part(progress, 0.1, 0.95), asked)
    lines = [
        *summary_lines(result, len(prepared.sequence), words=remedies()),
        *map(inPanelWords, prepared.widthLines(result.method, part(progress, 0.95, 1.0))),
    ]
    return result, prepared, "\n".join(lines)


def settingsAndInputs(choices: dict) -> tuple[dict, dict]:
    """What a script chose by name: settings of the library's `Recipe`, and the fields of `Inputs`.

    Settings may be named as the module names them (``holeLimit``) or as the library does (``hole_limit``).

    Raises
    ------
    SettingsError
        When a name is neither.
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

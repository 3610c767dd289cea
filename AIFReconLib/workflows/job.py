"""What jobs are asked for, and what comes of them: plain values, which need nothing that computes."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ..arrays import Floats, Matrix
from ..compounding.state import BESIDE, Reconstruction
from ..geometry.volume import Volume, VoxelGrid
from ..live.pairing.synchronizer import SynchronizerSettings
from ..live.session.statistics import ALL, Spans
from ..recipe.recipe import Recipe
from ..sweep.configuration import NO_CONFIGURATION, PlusConfiguration
from ..sweep.frames import TrackedSequence

if TYPE_CHECKING:
    from ..bone.map import BoneMap
    from ..inspection.bone_surface import ShownBoneMesh
    from ..inspection.tracking_report import TrackingReport
    from ..motion.motion import PatientMotion
    from ..registration.agreement import Comparison
    from ..registration.labeled_bone import LabeledBone


@dataclass(frozen=True, eq=False)
class BoneSource:
    """Where bone is: labels or a probability of a CT, or what a network says of the frames.

    Parameters
    ----------
    labels, probability : Volume or None
        In coordinates of their own.
    to_reference : (4, 4) array or None, mm
        The place of either; None where it lies in Reference already.
    predictions : TrackedSequence, one for each sweep, or None
        What a network has said of the frames.
    model : Path or None
        A network in an ONNX file.
    device : str or None
        Of a scan: the image device that sends what a network says. That, a model, and echoes come before the
        CT there.
    name : str
        What errors call it.
    """

    labels: Volume | None = None
    probability: Volume | None = None
    to_reference: Matrix | None = None
    predictions: TrackedSequence | Sequence[TrackedSequence] | None = None
    model: Path | None = None
    device: str | None = None
    name: str = ""


@dataclass(frozen=True, eq=False)
class ReconstructionJob:
    """What is to be reconstructed, and of what; fields as the arguments of `reconstruct`.

    Parameters
    ----------
    sequence : TrackedSequence
        One, or several that were joined.
    bone : BoneSource, BoneMap, LabeledBone, Volume of labels, or None
    search_path : tuple of str
        Folders in which a method of the user's own is looked for.
    """

    sequence: TrackedSequence
    recipe: Recipe = field(default_factory=Recipe)
    bone: BoneSource | BoneMap | LabeledBone | Volume | None = None
    grid: VoxelGrid | None = None
    beside: Collection[str] = BESIDE
    memory: int | None = None
    search_path: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class ReconstructionOutput:
    """What became of a job."""

    result: Reconstruction
    labeled: LabeledBone | None = None  #: The CT's bone, where that was given
    sequence: TrackedSequence | None = None  #: The sweep as it went in, without the motion of the patient
    motion: PatientMotion | None = None  #: That was taken out
    tracking: dict[str, TrackingReport] = field(default_factory=dict)  #: Of each sweep, by its name
    lines: tuple[str, ...] = ()  #: For a window: what was done, in its words
    comparison: Comparison | None = None  #: For a window: of CT and sweep
    measured: Volume | None = None  #: For a window: the plain mean of the echoes, on the same voxels
    surface: ShownBoneMesh | None = None  #: For a window: the bone that shows


@dataclass(frozen=True, eq=False)
class ScanJob:
    """A live scan; one that was lost with its worker is begun anew with it.

    Parameters
    ----------
    recipe : Recipe
    server : (str, int) or None
        Host and port that speak OpenIGTLink; None: images are given to `Scan.put`.
    configuration : PlusConfiguration
    grid : VoxelGrid or None
        None: in the configuration's box, else it begins by scouting.
    bone : BoneSource
    synchronizer : SynchronizerSettings
    record : Path or None
        Where every frame is recorded, or beside it where a recording of that name is there.
    frame_limit : int or None
    guidance : bool
        Tell what is met of the labels, else of the bone that frames show, and where to look next.
    unseen : (n, 3) array or None, mm
        Places that it leads to in place of bone; see `FreePaths.unseen`.
    takes_up : bool
        Go on with the recording that was not finished: its frames come first, those of `spans` into the
        volume.
    search_path : tuple of str
        Folders in which a method of the user's own is looked for.
    """

    recipe: Recipe
    server: tuple[str, int] | None = None
    configuration: PlusConfiguration = NO_CONFIGURATION
    grid: VoxelGrid | None = None
    bone: BoneSource = field(default_factory=BoneSource)
    synchronizer: SynchronizerSettings = field(default_factory=SynchronizerSettings)
    record: Path | None = None
    frame_limit: int | None = None
    guidance: bool = False
    unseen: Floats | None = None
    takes_up: bool = False
    spans: Spans = ALL
    search_path: tuple[str, ...] = ()

    @property
    def sees_bone(self) -> bool:
        """Whether the frames themselves say where bone is."""
        return self.recipe.bone_from_sweep or self.bone.device is not None or self.bone.model is not None

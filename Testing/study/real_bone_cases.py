"""The cases of the study on real bone: a recorded sweep of a fibula with its CT, in place and misplaced, and what methods make of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.compounding.methods.table import BONE_METHODS, method_named
from AIFReconLib.compounding.state import Reconstruction
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.visibility import BoneTruth, SweepBeams, bone_truth
from AIFReconLib.geometry.transforms import affine
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.imaging.beams import LINEAR
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.volume.label_files import read_labels
from AIFReconLib.progress import Progress
from AIFReconLib.recipe.recipe import Recipe, ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.sweep.edits import select_frames
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

from .method_cases import OURS, PLAIN, WITHOUT_BONE
from .patients import data_folder, run_tasks
from .real_bone_measures import by_incidence, false_bone, precision, reached_points
from .reference_methods import confidence_weighted, incidence_weighted, largest_contrast

SPACING, HOLE_LIMIT = 0.5, 1.0
SIGMA = 4.0
"""mm; width of the bone map of the paper's methods. `weighted` has the one that follows from how well CT and sweep agree."""

IN_PLACE = "CT in place"
PASS_GAP, PASS_FRAMES = 1.0, 20
"""s without a frame that part two passes, and the fewest frames of one."""

CONTRAST = "largest contrast"
REFERENCES = {"confidence-weighted": confidence_weighted.name, "incidence-weighted": incidence_weighted.name, CONTRAST: PLAIN}
"""Methods of others, by what they are called here, and the method that makes their volumes; the last joins those of single passes."""

WITH_BONE = (*BONE_METHODS, "incidence-weighted")
"""Methods that need a bone map."""

SHIFTS, TURNS = (1.0, 2.0, 4.0, 6.0), (2.0, 5.0)
"""mm and degrees."""


@dataclass(frozen=True)
class Row:
    """One reconstruction and its numbers."""

    condition: str
    method: str
    metrics: dict[str, float]


@dataclass(frozen=True, eq=False)
class Case:
    """A place of the CT, and the methods that are tried with it."""

    condition: str
    methods: tuple[str, ...]
    ct_error: np.ndarray = field(default_factory=lambda: np.eye(4))


class RealBone:
    """The recording, its truth, and the cases; `folder` holds ``fibula-distal.igs.mha`` and ``fibula-labels.nrrd``."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.sequence: TrackedSequence = read_sequence(folder / "fibula-distal.igs.mha")
        self.labels: Volume = read_labels(folder / "fibula-labels.nrrd")

    @classmethod
    def found(cls) -> RealBone:
        """That of `data_folder`."""
        return cls(data_folder("fibula"))

    @cached_property
    def truth(self) -> BoneTruth:
        """The surface from CT, and what the beams of all passes could reach of it."""
        return bone_truth(self.labels, SweepBeams.of_sequence(self.sequence, Recipe(probe=LINEAR)))

    @cached_property
    def reached(self) -> tuple[np.ndarray, np.ndarray]:
        """The points of the surface that beams could reach, and their normals, (m, 3) each."""
        seen = reached_points(self.truth)
        return self.truth.surface.points_reference[seen], self.truth.surface.normals_reference[seen]

    @cached_property
    def passes(self) -> list[TrackedSequence]:
        """The frames of each pass along the bone."""
        times = np.array([record.timestamp for record in self.sequence.records])
        edges = [0, *(np.flatnonzero(np.diff(times) > PASS_GAP) + 1), len(times)]
        return [select_frames(self.sequence, start, stop - 1) for start, stop in pairwise(edges) if stop - start >= PASS_FRAMES]

    def cases(self) -> Iterator[Case]:
        """Everything that is tried."""
        yield Case(IN_PLACE, (*WITHOUT_BONE, *REFERENCES, *BONE_METHODS))
        axes, misplaced = self.axes, (PLAIN, OURS)
        for mm in SHIFTS:
            for name, sign, axis in (("away from the probe", 1, 0), ("toward it", -1, 0), ("to one side", 1, 1), ("to the other", -1, 1)):
                yield Case(f"CT {mm:g} mm {name}", misplaced, affine(np.eye(3), sign * mm * axes[axis]))
        for degrees in TURNS:
            for name, axis in (("across the beams", 1), ("along the beams", 0)):
                yield Case(f"CT {degrees:g} degrees about an axis {name}", misplaced, self._turned(axes[axis], degrees))

    def row(self, case: Case, method: str) -> Row:
        """Reconstruct and measure."""
        result = self.reconstructed(case, method)
        of, right = (result.intensity, self.truth), np.array_equal(case.ct_error, np.eye(4))
        more = by_incidence(*of, result.mask) if right else false_bone(*of, case.ct_error)
        return Row(case.condition, method, {**evaluate(*of, result.mask).to_dict(), **precision(*of), **more})

    def reconstructed(self, case: Case, method: str) -> Reconstruction:
        """The volume of a case by a method; where none of it depends on the CT, that made before."""
        if method in WITH_BONE:
            return self._reconstruct(self.sequence, method, self._placed_map(case, method))
        if method not in self._without_ct:
            self._without_ct[method] = self._joined() if method == CONTRAST else self._reconstruct(self.sequence, method, None)
        return self._without_ct[method]

    def _joined(self) -> Reconstruction:
        """Plain means of the single passes, joined by their contrast."""
        grid = self.reconstructed(Case(IN_PLACE, (PLAIN,)), PLAIN).grid
        return largest_contrast([self._reconstruct(each, PLAIN, None, grid) for each in self.passes])

    @cached_property
    def _without_ct(self) -> dict[str, Reconstruction]:
        return {}

    def _placed_map(self, case: Case, method: str) -> BoneMap:
        """The bone map of a case where its CT lies."""
        if method in BONE_METHODS and method_named(method).follows_agreement:
            return LabeledBone(self.labels, case.ct_error, self.sequence, Recipe(probe=LINEAR)).map(method)
        bone = BoneMap.from_labels(self.labels, sigma_mm=SIGMA)
        inside = bone.inside.placed_by(case.ct_error) if bone.inside else None
        return BoneMap(bone.probability.placed_by(case.ct_error), inside)

    def _reconstruct(self, sequence: TrackedSequence, method: str, bone: BoneMap | None, grid: VoxelGrid | None = None) -> Reconstruction:
        settings = ReconstructionSettings(method=REFERENCES.get(method, method), spacing=SPACING, hole_limit=HOLE_LIMIT)
        return reconstruct(sequence, replace(settings, probe=LINEAR), bone, grid)

    @cached_property
    def axes(self) -> np.ndarray:
        """Unit vectors in Reference as rows: along the mean beam, across the beams and the bone, and along the bone."""
        poses = sweep_poses(self.sequence)
        beam = poses.image_to_reference[poses.usable][:, :3, 1].mean(axis=0)
        points = self.reached[0]
        along = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][0]
        beam = beam - (beam @ along) * along
        beam /= np.linalg.norm(beam)
        return np.stack([beam, np.cross(along, beam), along])

    def _turned(self, axis: np.ndarray, degrees: float) -> np.ndarray:
        """A turn about an axis through the middle of the bone that beams reached."""
        turn, middle = Rotation.from_rotvec(np.radians(degrees) * axis).as_matrix(), self.reached[0].mean(axis=0)
        return affine(turn, middle - turn @ middle)


def real_bone_rows(bone: RealBone, folder: Path, jobs: int = 2, progress: Progress | None = None) -> list[Row]:
    """The rows of all cases, made or, where an earlier run has written them to `folder`, read: one file for each case and method."""
    every = [(case, method) for case in bone.cases() for method in case.methods]
    given = {f"{case.condition}-{method}".replace(" ", "-"): (bone.folder, case, method) for case, method in every}
    return run_tasks(_rows_of, given, Row, folder, jobs, progress, "reconstructions")


def _rows_of(given: tuple[Path, Case, str]) -> list[Row]:
    folder, case, method = given
    return [_opened(folder).row(case, method)]


@cache
def _opened(folder: Path) -> RealBone:
    """Once in a process: it takes seconds."""
    return RealBone(folder)

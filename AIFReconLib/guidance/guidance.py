"""All that guidance has to show, of a recorded sweep or of a scan that goes on: bone in colors, shares, and where to go next."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..arrays import Bytes, Floats, Matrix
from ..geometry.transforms import as_matrix, invert, transform_points
from ..geometry.volume import Volume, VoxelGrid
from ..progress import Progress, part
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import joined
from ..sweep.poses import sweep_poses, time_order
from .bone import GuidedBone
from .bone_coverage import CoverageAccumulator
from .coverage import Coverage, back_of_labels, coverage, covered, followed, share_of
from .mesh import ColoredBone
from .next_move import Move, NextMove, directions
from .passes import labels_under
from .probe import ProbeOnBack, Skin, images_like
from .snapshot import AdvisedMove, GuidanceSnapshot
from .window import NOT_SEEN, window

FAR = "No frame has come near the bone of the CT. Scan over the spine; if you did, place the CT on the sweep first."
NOT_IN_BOX = "The box to be reconstructed holds none of the bone. Move the box, or place the CT, if there is one, on the sweep."


@dataclass(frozen=True, eq=False)
class Guidance:
    """What is known now."""

    colored: ColoredBone | None = None  #: The surface in the labels' own coordinates
    levels: Bytes | None = None  #: (n,). Of its corners; see `AIFReconLib.guidance.mesh`.
    coverage: Coverage | None = None  #: While a scan goes on its `met` goes on changing; its shares do not
    best_cosine: Floats | None = None  #: (n,). Of the points of `coverage.met.bone`, as they were when this was told.
    advice: Advice | None = None  #: None while candidate passes are looked at
    problem: str | None = None  #: Why nothing can be told

    @classmethod
    def before(cls, colored: ColoredBone, bone: GuidedBone, problem: str | None = None) -> Guidance:
        """Bone that nothing has met yet."""
        return cls(colored, colored.levels(np.full(len(bone), np.nan)), problem=problem)

    @classmethod
    def of(cls, colored: ColoredBone, met: CoverageAccumulator, advice: Advice | None = None, notes: tuple[str, ...] = ()) -> Guidance:
        """What was met until now, and the advice if there is one."""
        best = met.best_cosine.copy()
        return cls(colored, colored.levels(best), covered(met, notes), best, advice)

    def seen(self, known: int | None = None) -> GuidanceSnapshot:
        """What is shown of it; `known` is the number of the mesh that who asks has already, and is not told again."""
        mesh = None if self.colored is None else self.colored.mesh
        seen = GuidanceSnapshot(
            self.problem,
            None if mesh is None else mesh.number,
            None if mesh is None or mesh.number == known else mesh,
            self.levels,
        )
        if self.coverage is None:
            return seen
        found, advice = self.coverage, self.advice
        return replace(
            seen,
            all=share_of(found.met, found.met.bone.posterior) if found.by_label else found.all,
            interspinous=found.interspinous,
            by_label=back_of_labels(found.met),
            patient_to_reference=found.met.bone.patient_to_reference,
            is_advised=advice is not None,
            move=None if advice is None else advice.seen,
        )


class Advice(NamedTuple):
    """What to do next."""

    move: Move | None  #: None when nothing is worth its labor any more
    seen: AdvisedMove | None = None  #: What is shown of it, from where the probe is


class Advisor:
    """Moves over bone, as a probe was moved over it, and the way to each.

    The poses so far, (n, 4, 4), tell where the skin is.
    """

    def __init__(self, met: CoverageAccumulator, image_to_reference: Matrix):
        bone, beams = met.bone, met.geometry.beams
        images = images_like(image_to_reference[0], beams.frame_size, beams.probe, beams.region)
        skin = Skin.through(transform_points(invert(bone.patient_to_reference), images.faces(image_to_reference)))
        self._bone, self._probe = bone, ProbeOnBack(images, skin, bone.patient_to_reference)
        self.moves = NextMove(bone, self._probe, bone.aim)

    def to(self, move: Move | None, image_to_reference: Matrix) -> Advice:
        """The way to a move of `moves` from a pose, that which it was advised for or another."""
        if move is None:
            return Advice(None)
        there = move.planned.placements(1)[0]
        way = directions(self._probe.placement(image_to_reference), there, self._bone.is_of_ct)
        adds = None if NOT_SEEN in self._bone.names.values() else move.adds_cm2
        over, probe = labels_under(self._bone, there.z), self._probe.images.shape
        return Advice(move, AdvisedMove(move.image_to_reference, way, over, adds, probe))


def has_come_near(met: CoverageAccumulator) -> bool:
    """Whether any point was in any beam."""
    return bool(met.frames.any() or met.shadowed.any() or met.dark.any())


def holds_bone(grid: VoxelGrid, bone: GuidedBone) -> bool:
    """Whether any of the bone that can be reached lies in a box."""
    ijk = transform_points(grid.reference_to_ijk, bone.surface.points_reference)
    return bool(((ijk >= -0.5) & (ijk <= np.array(grid.size) - 0.5)).all(axis=1).any())


def guidance_of_sweep(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    labels: Volume | None = None,
    labels_to_reference: Matrix | None = None,
    recipe: Recipe | None = None,
    *,
    grid: VoxelGrid | None = None,
    unseen: Floats | None = None,
    progress: Progress | None = None,
) -> Guidance:
    """What recorded sweeps have met, and the next move from where the last one ended.

    Raises AIFReconError as `coverage`.

    Parameters
    ----------
    sequences : TrackedSequence or several in one Reference
    labels : Volume of integers or None
    labels_to_reference : (4, 4) array or None, mm
        Rigid; None where the labels lie in Reference.
    recipe : Recipe or None
        As in `reconstruct`.
    grid : VoxelGrid or None
        The box that is to be reconstructed, if it is known.
    unseen : (n, 3) array, mm in Reference, or None
        Places that the next move leads to in place of bone, as `FreePaths.unseen` has them.
    """
    recipe = recipe or Recipe()
    sequence = joined(sequences, recipe)
    place = np.eye(4) if labels_to_reference is None else as_matrix(labels_to_reference, "labels_to_reference")
    found = coverage(sequence, labels, place, recipe=recipe, progress=part(progress, 0.0, 0.5))
    colored = ColoredBone.of(found.met.bone).placed_by(invert(place))
    problem = None if has_come_near(found.met) else FAR
    if grid is not None and not holds_bone(grid, found.met.bone):
        problem = NOT_IN_BOX
    if problem is not None:
        return Guidance.before(colored, found.met.bone, problem)
    poses = sweep_poses(sequence, recipe.image_to_reference, recipe.reference)
    order = time_order(sequence)
    order = order[np.isin(order, poses.usable)]
    met = found.met if unseen is None or not len(unseen) else followed(window(found.met.bone, unseen), sequence, recipe)
    here = poses.image_to_reference[order]
    advisor = Advisor(met, here)
    move = advisor.moves.advise(met, here[-1], progress=part(progress, 0.5, 1.0))
    return Guidance.of(colored, found.met, advisor.to(move, here[-1]), found.notes)

"""A recorded sweep becomes a volume, in one call: the door for scripts."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Iterable
from dataclasses import replace

from .bone.map import BoneMap
from .compounding.frame_placement import require_kinds
from .compounding.state import BESIDE, Reconstruction
from .errors import DoubtfulInputWarning
from .geometry.volume import Volume, VoxelGrid
from .message import advised
from .progress import Progress
from .recipe.recipe import Recipe
from .registration.comparison import warn_of_disagreement
from .registration.labeled_bone import LabeledBone
from .sweep.frames import TrackedSequence
from .sweep.multi_sweep import joined
from .workflows.job import ReconstructionJob
from .workflows.reconstruct import reconstruct_job


def reconstruct(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    recipe: Recipe | None = None,
    bone: BoneMap | LabeledBone | Volume | None = None,
    grid: VoxelGrid | None = None,
    *,
    beside: Collection[str] = BESIDE,
    memory: int | None = None,
    progress: Progress | None = None,
) -> Reconstruction:
    """Reconstruct a volume from one or more recorded sequences.

    Parameters
    ----------
    sequence : TrackedSequence or several in one Reference
        As `read_sequence` returns it; its configuration gives what the recipe leaves open. Several enter in the order given, each placed by
        its own configuration's transforms; the first one's says how the volume is made.
    recipe : Recipe
        Each of its settings is obeyed, or named in a note where it does not concern the method, or refused: what says how a file is read
        (`orientation`, `time_offset`, `longest_gap`) where that was read otherwise, what says how a bone map is made where there is one.
    bone : BoneMap, LabeledBone, Volume of labels, or None
        Needed by methods that weight by incidence. Of labels (in Reference; `LabeledBone` takes the CT's transform) the map is made here:
        as wide as CT and sweep agree, and a `DisagreementWarning` tells where they do not. Without any it is the sweep's own
        (`bone_from_sweep`) where the recipe asks for that, or where neither it nor a configuration names a method and the images show bone;
        a note says which.
    grid : VoxelGrid or None
        Where to reconstruct; by default the recipe's, else the configuration's box, else the one around the sweep, along Reference's axes.
    beside : names of "score" and "hits"
        Which of these are made beside intensity and mask; none leaves their memory free.
    memory : int or None
        Bytes that the volumes may take, by default three quarters of what is free. A box that needs more is worked in parts, with the same
        voxels; what is made of them must fit.
    progress : Progress or None

    Returns
    -------
    Reconstruction
        Its volumes say in the headers of their files how they were made, by which it can be repeated.

    Warns
    -----
    DoubtfulInputWarning
        For each line of the result's `messages` that is a warning: the volume is made, and probably wrong.

    Raises
    ------
    AIFReconError
        One of its kinds, with a message that says what is wrong, where, and what to do. Inputs are untouched.
    """
    require_kinds(recipe=recipe, grid=grid)
    recipe = recipe or Recipe()
    job = ReconstructionJob(joined(sequence, recipe), recipe, bone, grid, beside, memory)
    output = reconstruct_job(job, progress)
    for line in output.result.messages:
        if line.startswith("WARNING: "):
            warnings.warn(advised(line).removeprefix("WARNING: "), DoubtfulInputWarning, stacklevel=2)
    if output.labeled is None:
        return output.result
    warn_of_disagreement(output.labeled.comparison())
    told = (*output.labeled.labels.notes, *output.labeled.lines(output.result.method))
    return replace(output.result, messages=(*output.result.messages, *told))

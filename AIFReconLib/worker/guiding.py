"""What a recorded sweep has met of the CT's bone, in a form to be shown."""

from __future__ import annotations

from ..arrays import Matrix
from ..geometry.volume import Volume, VoxelGrid
from ..guidance.seen import GuidanceSeen, Share
from ..progress import Progress
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedSequence


def met_of_sweep(
    sequence: TrackedSequence, labels: Volume, labels_to_reference: Matrix, recipe: Recipe, progress: Progress | None = None
) -> dict[str, Share]:
    """How much of what faces the back of each bone was met, by the label's number; see `coverage`."""
    from ..guidance.coverage import back_of_labels, coverage

    return back_of_labels(coverage(sequence, labels, labels_to_reference, recipe, progress=progress).met)


def guidance_in_sweep(
    sequence: TrackedSequence,
    labels: Volume,
    labels_to_reference: Matrix,
    recipe: Recipe,
    grid: VoxelGrid | None = None,
    progress: Progress | None = None,
) -> tuple[GuidanceSeen, dict[str, Share]]:
    """What `guidance_of_sweep` tells, and as `met_of_sweep`; nothing of that where there is a problem."""
    from ..guidance.coverage import back_of_labels
    from ..guidance.guidance import guidance_of_sweep

    found = guidance_of_sweep(sequence, labels, labels_to_reference, recipe, grid=grid, progress=progress)
    return found.seen(), {} if found.coverage is None else back_of_labels(found.coverage.met)

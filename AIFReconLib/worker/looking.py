"""What the images of a sweep show of the probe, for whoever draws it."""

from __future__ import annotations

from ..imaging.beams import ProbeGeometry
from ..imaging.region import ImageRegion
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedSequence


def imaging_of(sequence: TrackedSequence, needs_probe: bool, recipe: Recipe) -> tuple[ProbeGeometry | None, ImageRegion]:
    """Probe and region as a reconstruction would use them; the probe is looked for in the images where it is needed.

    Raises AIFReconError when no frame can be placed, or nothing tells what is needed.
    """
    from ..resolve import resolve_imaging
    from ..sweep.poses import sweep_poses

    poses = sweep_poses(sequence)
    poses.require_usable(sequence.name)
    imaging = resolve_imaging(sequence, poses, needs_probe, recipe)
    return imaging.probe, imaging.region

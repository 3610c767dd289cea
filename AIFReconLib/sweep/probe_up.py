"""A sweep as a scanner shows it: the probe's side up, in the sweep's own planes."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Matrix
from .frames import TrackedSequence
from .poses import sweep_poses

LEAST = 0.3
"""Length of the mean of unit vectors below which they point everywhere: the first frame then tells which way the columns run."""


def probe_up_axes(sequence: TrackedSequence, head: Floats) -> tuple[Matrix, Matrix, Matrix]:
    """Right, up and out of the screen of three views, the columns of (3, 3) matrices in Reference.

    The first lies as the frames do, the second along the sweep with the head on the left, the third across the beams. `head`, (3,), leads
    toward the patient's. Raises AIFReconError when no frame can be placed.
    """
    poses = sweep_poses(sequence)
    placed = poses.image_to_reference[poses.require_usable(sequence.name)][:, :3, :2]
    across, beam = _mean(placed[..., 0]), _mean(placed[..., 1])
    across = across - (across @ beam) * beam
    across /= np.linalg.norm(across)
    along = np.cross(across, beam)
    along = along if along @ head > 0 else -along
    return _view(across, -beam), _view(-along, -beam), _view(np.cross(along, -beam), along)


def _view(right: Floats, up: Floats) -> Matrix:
    return np.column_stack([right, up, np.cross(right, up)])


def _mean(directions: Floats) -> Floats:
    unit = directions / np.linalg.norm(directions, axis=1)[:, None]
    mean = unit.mean(axis=0)
    mean = mean if np.linalg.norm(mean) >= LEAST else unit[0]
    direction: Floats = mean / np.linalg.norm(mean)
    return direction

"""Where a mechanism holds the probe: a chain of axes that shift and turn, from its base to what it carries."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import scipy

from ..arrays import Floats, Matrix

SHIFT, TURN, FIXED = "shift", "turn", "fixed"


@dataclass(frozen=True, eq=False)
class Axis:
    """One axis of a mechanism.

    Parameters
    ----------
    name : str
    kind : "shift", "turn" or "fixed"
    direction : (3,) array, unit vector
        Along which it shifts, or about which it turns, to the right when seen along it.
    point : (3,) array, mm
        On the axis of a turn.
    before : (4, 4) array
        From the frame in which direction and point are given to that of the axis before.
    scale, zero : float
        Where it reads `r`, it has moved by (r - zero) * scale.
    """

    name: str
    kind: str
    direction: Floats
    point: Floats = field(default_factory=lambda: np.zeros(3))
    before: Matrix = field(default_factory=lambda: np.eye(4))
    scale: float = 1.0
    zero: float = 0.0

    def amount(self, reading: float) -> float:
        """How far it has moved, mm or radians, where it reads mm or degrees."""
        moved = (reading - self.zero) * self.scale
        return math.radians(moved) if self.kind == TURN else moved

    def moved(self, amounts: Floats) -> Matrix:
        """Transforms (n, 4, 4), mm, when it has moved by so much (n,), mm or radians."""
        matrices = np.tile(np.eye(4), (len(amounts), 1, 1))
        if self.kind == SHIFT:
            matrices[:, :3, 3] = amounts[:, None] * self.direction
        elif self.kind == TURN:
            # SciPy refuses NaN, which is a pose that is missing
            turns = np.where(np.isfinite(amounts), amounts, 0.0)[:, None] * self.direction
            matrices[:, :3, :3] = scipy.spatial.transform.Rotation.from_rotvec(turns).as_matrix()
            matrices[:, :3, 3] = self.point - matrices[:, :3, :3] @ self.point
            matrices[~np.isfinite(amounts)] = np.nan
        return self.before @ matrices


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Axes in order, from the base to the probe, and where the probe is when all of them are at zero.

    Parameters
    ----------
    axes : tuple of Axis
    home : (4, 4) array, mm
        Probe to the frame of the last axis.

    Notes
    -----
    The pose is the product ``before_1 M_1(q_1) ... before_n M_n(q_n) home`` [1]_. With all axes given in the base, as they lie at zero,
    every `before` is the identity and this is the product of exponentials; as URDF gives joints, `before` is the origin of one.

    References
    ----------
    .. [1] Lynch KM, Park FC (2017), Modern Robotics, section 4.1, Cambridge University Press.
    """

    axes: tuple[Axis, ...]
    home: Matrix = field(default_factory=lambda: np.eye(4))

    @property
    def moving(self) -> tuple[Axis, ...]:
        """Those that take a value."""
        return tuple(axis for axis in self.axes if axis.kind != FIXED)

    def poses(self, amounts: Floats) -> Matrix:
        """Probe to base (n, 4, 4), mm, when those that move have moved by so much (n, axes), mm or radians; NaN where one is missing."""
        matrices = np.tile(np.eye(4), (len(amounts), 1, 1))
        columns = iter(np.asarray(amounts, dtype=np.float64).T)
        for axis in self.axes:
            matrices = matrices @ axis.moved(np.zeros(len(amounts)) if axis.kind == FIXED else next(columns))
        poses: Matrix = matrices @ self.home
        poses[~np.isfinite(poses).all(axis=(1, 2))] = np.nan
        return poses

    def lines(self) -> list[tuple[str, Floats, Floats]]:
        """Name, point and direction of each axis that moves, in the base, mm, with all of them at zero."""
        to_base, found = np.eye(4), []
        for axis in self.axes:
            to_base = to_base @ axis.before
            if axis.kind != FIXED:
                found.append((axis.name, to_base[:3, :3] @ axis.point + to_base[:3, 3], to_base[:3, :3] @ axis.direction))
        return found

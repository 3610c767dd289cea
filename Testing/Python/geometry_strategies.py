"""Random rotations, poses and grids for hypothesis, and nothing that they test."""

from __future__ import annotations

import numpy as np
import sweeps
from hypothesis import strategies as st


def rigid(rotation_vector, translation) -> np.ndarray:
    """The pose (4, 4) that turns about a vector (radians) and then moves by `translation` (mm)."""
    return sweeps.rigid(np.degrees(rotation_vector), translation)


def scaled(x: float, y: float, z: float) -> np.ndarray:
    """Pixels to mm, or voxels to mm, along the axes."""
    return np.diag([x, y, z, 1.0])


IMAGE_TO_PROBE = rigid((0.1, 0.2, -0.3), (5.0, 6.0, 7.0)) @ scaled(0.2, 0.3, 0.25)
PROBE_TO_TRACKER = rigid((1.1, -0.4, 0.2), (100.0, 50.0, -20.0))
REFERENCE_TO_TRACKER = rigid((-0.5, 0.9, 1.4), (-30.0, 10.0, 400.0))


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    """Finite floats between two bounds."""
    return st.floats(low, high, allow_nan=False, allow_subnormal=False)


def triples(low: float, high: float) -> st.SearchStrategy[tuple[float, float, float]]:
    """Three finite floats between two bounds."""
    return st.tuples(numbers(low, high), numbers(low, high), numbers(low, high))


rigid_poses = st.builds(rigid, triples(-3.0, 3.0), triples(-300.0, 300.0))
spacings = triples(0.05, 3.0)

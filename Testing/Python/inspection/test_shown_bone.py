"""The bone that is drawn in 3D follows the score, bridges what no frame has met, and leaves crumbs out."""

from __future__ import annotations

import numpy as np
from sweeps import rigid

from AIFReconLib.compounding.state import Reconstruction
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.inspection.shown_bone import CRUMB, LEVEL, shown_bone

SPACING = 0.5
SIZE = (40, 60, 80)
MATRIX = np.diag([SPACING, SPACING, SPACING, 1.0])
MATRIX[:3, 3] = 5.0, -20.0, 3.0


def reconstruction(bright, weighted, seen=None):
    """Soft tissue everywhere, with bright voxels and voxels of high weight, [k, j, i]; where not seen no pixel entered."""
    seen = np.ones(SIZE, dtype=bool) if seen is None else seen
    hits = np.where(seen, 4, 0).astype(np.uint32)
    intensity = np.where(seen, np.where(bright, 200, 60), 0).astype(np.uint8)
    score = (np.where(weighted, 0.5, 0.02) * hits).astype(np.float32)
    mask = seen.astype(np.uint8)
    volumes = (Volume(array, MATRIX) for array in (intensity, score, hits, mask))
    return Reconstruction(*volumes, None, "weighted", 1, {})


def box(k, j, i):
    """Voxels within three ranges."""
    inside = np.zeros(SIZE, dtype=bool)
    inside[slice(*k), slice(*j), slice(*i)] = True
    return inside


SHEET = box((5, 35), (28, 32), (10, 70))


def inside(shown, i, j, k):
    """Whether a place, in voxels of the reconstruction, is within the surface."""
    at = shown.field.grid.reference_to_ijk @ MATRIX @ [i, j, k, 1.0]
    return bool(shown.field.array[tuple(np.rint(at[:3]).astype(int)[::-1])] > LEVEL)


def test_bone_is_drawn_where_it_lies_and_soft_tissue_is_not():
    shown = shown_bone(reconstruction(SHEET, SHEET))
    assert inside(shown, 40, 30, 20)
    assert not inside(shown, 40, 50, 20)
    assert (shown.pieces, shown.hidden) == (1, 0)


def test_brightness_that_no_weight_stands_behind_is_no_bone():
    other = box((5, 35), (50, 54), (10, 70))
    assert not inside(shown_bone(reconstruction(SHEET | other, SHEET)), 40, 52, 20)


def test_a_gap_between_frames_is_bridged_and_a_wide_one_is_not():
    seen = ~(box((20, 22), (0, 60), (0, 80)))
    assert inside(shown_bone(reconstruction(SHEET, SHEET, seen)), 40, 30, 20)
    seen = ~(box((10, 30), (0, 60), (0, 80)))
    assert not inside(shown_bone(reconstruction(SHEET, SHEET, seen)), 40, 30, 20)


def test_a_crumb_is_hidden_and_counted():
    crumb = box((8, 12), (50, 54), (40, 44))
    assert crumb.sum() * SPACING**3 < CRUMB
    shown = shown_bone(reconstruction(SHEET | crumb, SHEET | crumb))
    assert (shown.pieces, shown.hidden) == (1, 1)
    assert not inside(shown, 42, 52, 10)


def test_distances_are_those_to_the_placed_labels():
    labels = np.zeros((20, 20, 20), dtype=np.uint8)
    labels[:, :10] = 1
    shown = shown_bone(reconstruction(SHEET, SHEET), Volume(labels, np.eye(4)), rigid(translation=(100.0, 0.0, 0.0)))
    # The face lies half a voxel beyond the last labeled center, y = 9.5
    np.testing.assert_allclose(shown.distances(np.array([[110.0, 14.5, 10.0], [110.0, 7.5, 10.0]])), [5.0, 2.0], atol=0.3)


def test_the_ripple_of_weights_is_not_taken_for_bone():
    result = reconstruction(SHEET, np.zeros(SIZE, dtype=bool))
    result.score.array[...] *= 1 + 1e-3 * SHEET
    assert shown_bone(result).pieces == 0

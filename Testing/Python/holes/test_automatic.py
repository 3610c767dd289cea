"""The hole limit that a sweep asks for, where the answer is known: frames at known distances, and voxels that must not stay empty."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweeps import image_pose, rigid

from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.holes.automatic import automatic_limit, distances_between_frames
from AIFReconLib.holes.filling import HoleFilling
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedFrame

SHOWN = np.ones((40, 50), dtype=bool)
SPACING = 0.5
DIAGONAL = SPACING * np.sqrt(3)
GRID = VoxelGrid.from_spacing((-5.0, -5.0, -5.0), (100, 100, 300), SPACING)


def frames_at(*places, turned=(0.0, 0.0, 0.0)) -> np.ndarray:
    """Poses of frames across z at these places, mm; pixels of 0.5 mm."""
    return np.stack([(rigid(turned) @ image_pose((0.5, 0.5), translation=(0.0, 0.0, z)))[:3] for z in places])


def limit_of(*places) -> float:
    return automatic_limit(frames_at(*places), SHOWN, GRID)[0]


EVENLY = {gap: 0.95 * gap / 2 + DIAGONAL / 2 for gap in (1.5, 2.0, 3.0, 5.0)}
PASSES = np.concatenate([np.arange(start, 90.0, 9.0) for start in (0.0, 3.0, 6.0)])


@pytest.mark.parametrize(
    ("places", "limit"),
    [
        *((np.arange(0.0, 60.0, gap), limit) for gap, limit in EVENLY.items()),
        *((places, DIAGONAL) for places in ((0.0,), (0.0, 0.0, 0.0), np.arange(0.0, 10.0, 0.1))),
        (PASSES, EVENLY[3.0]),
    ],
)
def test_frames_are_filled_to_almost_half_their_distance_and_to_a_voxel_s_diagonal_at_least(places, limit):
    assert limit_of(*places) == pytest.approx(limit, abs=0.1)
    coarse = VoxelGrid.from_spacing((-5.0, -5.0, -5.0), (10, 10, 30), 5.0)
    assert automatic_limit(frames_at(*places), SHOWN, coarse)[0] >= np.linalg.norm((5.0, 5.0, 5.0))
    slid = np.stack([image_pose((0.5, 0.5), translation=(z, 0.0, 0.0))[:3] for z in places])
    assert automatic_limit(slid, SHOWN, GRID)[0] == pytest.approx(DIAGONAL, abs=0.1)


def test_the_way_back_to_the_next_pass_asks_for_nothing():
    assert limit_of(*np.arange(0.0, 30.0, 1.5), *np.arange(70.0, 100.0, 1.5)) == limit_of(*np.arange(0.0, 30.0, 1.5))


def test_a_sweep_that_is_turned_with_its_volume_asks_for_the_same():
    turn = (20.0, -35.0, 50.0)
    grid = VoxelGrid(GRID.size, rigid(turn) @ GRID.ijk_to_reference)
    places = np.cumsum(np.random.default_rng(0).uniform(0.2, 4.0, 40))
    assert automatic_limit(frames_at(*places, turned=turn), SHOWN, grid)[0] == limit_of(*places)


def test_distances_are_those_to_the_nearest_frame_of_all():
    places = np.cumsum(np.random.default_rng(1).uniform(0.5, 6.0, 30))
    spread = np.sort(distances_between_frames(frames_at(*places), SHOWN, replace(GRID, size=(100, 100, 1000))))
    along = np.linspace(places[0], places[-1], 20_001)
    expected = np.sort(np.abs(along[:, None] - places).min(axis=1))
    np.testing.assert_allclose(np.quantile(spread, np.linspace(0, 1, 21)), np.quantile(expected, np.linspace(0, 1, 21)), atol=0.05)


def test_where_frames_lie_too_far_apart_it_is_said_how_many_would_do():
    places = np.arange(0.0, 140.0, 14.0)
    _, (_, advice) = automatic_limit(frames_at(*places), SHOWN, GRID)
    assert "14 mm apart" in advice
    wanted = int(advice.split("about ")[1].split()[0])
    assert len(automatic_limit(frames_at(*np.linspace(places[0], places[-1], wanted)), SHOWN, GRID)[1]) == 1
    assert len(automatic_limit(frames_at(*np.linspace(places[0], places[-1], wanted - 4)), SHOWN, GRID)[1]) == 2


# ---- in a reconstruction


def reconstruction(poses, **settings):
    reconstructor = Reconstructor(GRID, ReconstructionSettings(**settings))
    image = np.full(SHOWN.shape, 9, np.uint8)
    reconstructor.insert(TrackedFrame(image, np.vstack([pose, (0, 0, 0, 1)]), number=n) for n, pose in enumerate(poses))
    return reconstructor.reconstruction()


def test_nothing_stays_empty_between_frames_that_lie_close():
    places = np.cumsum(np.random.default_rng(2).uniform(0.5, 4.0, 25))
    mask = reconstruction(frames_at(*places)).mask.array
    first, last = (round((z + 5.0) / SPACING) for z in (places[0], places[-1]))
    between = mask[first : last + 1, 10:49, 10:59]
    assert (between > 0).mean() >= 0.95


def test_the_number_that_is_said_gives_the_same_voxels():
    poses = frames_at(*np.arange(0.0, 40.0, 2.6))
    chosen = reconstruction(poses)
    assert f"up to {chosen.hole_limit:g} mm." in chosen.notes[-1]
    again = reconstruction(poses, hole_limit=chosen.hole_limit)
    np.testing.assert_array_equal(chosen.mask.array, again.mask.array)


@pytest.mark.parametrize("settings", [{}, {"hole_limit": 0.0}])
def test_a_configuration_s_own_way_stays_and_is_named(settings):
    reconstructor = Reconstructor(GRID, ReconstructionSettings(**settings), holes=(HoleFilling("stick", 9),))
    result = reconstructor.reconstruction()
    assert result.notes == ("Gaps are filled as the configuration asks: stick of up to 9 voxels.",)

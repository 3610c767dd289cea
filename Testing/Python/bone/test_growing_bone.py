"""Bone that grows while a scan goes on: each voxel knows what the map of all echoes so far says there."""

from __future__ import annotations

import numpy as np
import pytest
from seen_planes import PlaneSweep, bent
from sweeps import image_pose

from AIFReconLib.bone.echoes.found import SweepEchoes
from AIFReconLib.bone.echoes.surface import surface_of
from AIFReconLib.bone.growing_bone import GrowingBone
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.progress import carry_out

SWEEP = PlaneSweep(count=6)
GRID = VoxelGrid.from_spacing(SWEEP.point - 18.0, (45, 45, 45), 0.8)
OBLIQUE = VoxelGrid((45, 40, 50), image_pose((0.8, 0.8), (20.0, -15.0, 35.0), SWEEP.point - (18.0, 5.0, 25.0)))
OF_FRAMES = SWEEP.echoes()
FAR = SweepEchoes(OF_FRAMES[0].points + 9e5, OF_FRAMES[0].beams, OF_FRAMES[0].scores, OF_FRAMES[0].frames)
SHEET, IN_SHADOW = bent(300), np.arange(300) % 6 == 0
OVER_SHEET = VoxelGrid.from_spacing((-415.0, 85.0, 1018.0), (16, 15, 22), 1.0)


def joined(*numbers: int) -> SweepEchoes:
    return SweepEchoes.joined([OF_FRAMES[number] for number in numbers])


PARTS = {
    "at once": (GRID, [joined(*range(6))], 2e-3),
    "in two": (GRID, [joined(0, 1, 2), joined(3, 4, 5)], 0.03),
    "frame by frame": (GRID, OF_FRAMES, 0.03),
    "into voxels aslant": (OBLIQUE, OF_FRAMES, 0.03),
    "a probe seen far away once": (GRID, [*OF_FRAMES, FAR], 0.03),
    "what was bone lies in the shadow of more": (OVER_SHEET, [SHEET[np.flatnonzero(at)] for at in (IN_SHADOW, ~IN_SHADOW)], 0.1),
}


@pytest.mark.parametrize(("grid", "parts", "atol"), PARTS.values(), ids=PARTS)
def test_what_is_spread_is_what_is_known_and_a_volume_that_begins_anew_is_told_all(grid, parts, atol):
    """All but how much several sides count, which goes by what was told of this volume until then."""
    bone = GrowingBone()
    placed = bone.on_grid(grid)
    assert not placed.probability.any()
    for part in parts:
        bone.learn(part)
        assert carry_out(bone.spread()) == (part is not FAR)
    assert not carry_out(bone.spread())
    expected = surface_of(SweepEchoes.joined([part for part in parts if part is not FAR])).on_grid(grid)
    assert expected.probability.max() > 0.8
    np.testing.assert_allclose(placed.probability, expected.probability, atol=atol)
    sure = expected.probability > 0.3
    assert (np.einsum("vc,vc->v", placed.directions_reference[sure], expected.directions_reference[sure]) > 0.999).all()
    again = bone.on_grid(grid)
    assert carry_out(bone.spread())
    np.testing.assert_allclose(again.probability, expected.probability, atol=2e-3)


def test_hardly_any_echoes_are_no_bone_until_there_are_more():
    bone = GrowingBone(least_a_frame=3.0)
    placed = bone.on_grid(GRID)
    few = OF_FRAMES[0][np.arange(2)]
    for _ in range(2):
        bone.learn(few)
    assert not carry_out(bone.spread())
    assert not placed.probability.any()
    bone.learn(OF_FRAMES[1])
    assert carry_out(bone.spread())
    assert placed.probability.max() > 0.5


def test_what_is_learned_while_the_map_is_drawn_comes_with_the_next_news():
    bone, late = GrowingBone(), [3, 4, 5]
    placed = bone.on_grid(GRID)
    bone.learn(joined(0, 1, 2))

    def meanwhile(fraction, step) -> None:
        if late:
            bone.learn(OF_FRAMES[late.pop()])

    carry_out(bone.spread(), meanwhile)
    assert not late
    assert carry_out(bone.spread())
    np.testing.assert_allclose(placed.probability, surface_of(joined(*range(6))).on_grid(GRID).probability, atol=0.03)

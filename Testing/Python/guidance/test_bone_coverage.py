"""What frames meet of the bone: against a brute-force loop that shares no code, and in made-up scenes whose answer is known."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from sweeps import image_pose, rigid

from AIFReconLib.errors import GeometryError
from AIFReconLib.guidance.bone_coverage import (
    ANGLES_DEG,
    MET,
    MOST,
    SHADOWED,
    SUPPORT,
    CoverageAccumulator,
    FrameGeometry,
)
from AIFReconLib.imaging.beams import LINEAR, SECTOR, ProbeGeometry
from AIFReconLib.imaging.region import Fan, ImageRegion

SIZE, SPACING = (91, 81), (0.9, 0.8)
KINDS = {
    "linear": (ProbeGeometry(LINEAR), ImageRegion()),
    "sector": (ProbeGeometry(SECTOR, (45.0, -4.0)), ImageRegion(fan=Fan((45.0, -4.0), (-40.0, 40.0), (6.0, 84.0)))),
}


def poses(count=6, seed=0):
    """Frames from behind (y = -45), turned at random by up to some 40 degrees."""
    rng = np.random.default_rng(seed)
    middle = np.diag([*SPACING, 1.0, 1.0])
    middle[:3, 3] = (-SPACING[0] * 45, 0.0, 0.0)
    return [
        rigid(translation=(rng.uniform(-10, 10), -45.0, rng.uniform(-25, 25))) @ rigid(rng.uniform(-1, 1, 3) * (40, 90, 25)) @ middle
        for _ in range(count)
    ]


def brute_force(bone, pose, kind, thickness=3.0):
    """{point: (cosine, shadowed)} of a frame, point by point and millimeter by millimeter."""
    x, y = pose[:3, 0] / SPACING[0], pose[:3, 1] / SPACING[1]
    normal = np.cross(x, y)
    array, matrix = bone.distance.array, bone.distance.ijk_to_reference
    found = {}
    for number, (point, out) in enumerate(zip(bone.surface.points_reference, bone.surface.normals_reference)):
        way = point - pose[:3, 3]
        if abs(way @ normal) > thickness / 2:
            continue
        u, v = way @ x, way @ y
        column, row = math.floor(u / SPACING[0] + 0.5), math.floor(v / SPACING[1] + 0.5)
        if not (0 <= column < SIZE[0] and 0 <= row < SIZE[1]):
            continue
        if kind == "linear":
            beam, length = y, v
        else:
            a, b = (column - 45.0) * SPACING[0], (row + 4.0) * SPACING[1]
            radius = math.hypot(a, b) / SPACING[0]
            if not (6.0 <= radius <= 84.0 and abs(math.degrees(math.atan2(a, b))) <= 40.0):
                continue
            a, b = u - 45.0 * SPACING[0], v + 4.0 * SPACING[1]
            length = math.hypot(a, b)
            beam = (a * x + b * y) / length
        cosine = -beam @ out
        if cosine < math.cos(math.radians(85.0)):
            continue
        shadowed, gone = False, 0.0
        while gone < length and not shadowed:
            i, j, k = np.linalg.solve(matrix[:3, :3], point + out - gone * beam - matrix[:3, 3]) + 0.5
            within = 0 <= i < array.shape[2] and 0 <= j < array.shape[1] and 0 <= k < array.shape[0]
            shadowed = within and array[int(k), int(j), int(i)] <= 0
            gone += 1.0
        found[number] = (cosine, shadowed)
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_frames_meet_what_a_brute_force_search_finds(bone, kind):
    geometry = FrameGeometry(bone, SIZE, *KINDS[kind])
    met, best, frames, shadowed, support = CoverageAccumulator(geometry), {}, {}, {}, {}
    for pose in poses():
        for number, (cosine, dark) in brute_force(bone, pose, kind).items():
            if dark:
                shadowed[number] = shadowed.get(number, 0) + 1
            else:
                best[number] = max(best.get(number, -1.0), cosine)
                frames[number] = frames.get(number, 0) + 1
                support[number] = support.get(number, 0.0) + np.interp(math.degrees(math.acos(cosine)), ANGLES_DEG, SUPPORT)
        met.insert(pose)
    assert len(best) > 100
    assert len(shadowed) > 20
    everyone = range(len(bone))
    np.testing.assert_allclose(met.best_cosine, [best.get(n, np.nan) for n in everyone], atol=1e-9)
    np.testing.assert_array_equal(met.frames, [frames.get(n, 0) for n in everyone])
    np.testing.assert_array_equal(met.shadowed, [shadowed.get(n, 0) for n in everyone])
    np.testing.assert_allclose(met.support, [support.get(n, 0.0) for n in everyone], atol=1e-9)
    np.testing.assert_allclose(met.expected, [MOST * (1 - math.exp(-math.sqrt(support.get(n, 0.0)))) for n in everyone], atol=1e-9)


def test_half_an_image_without_contact_leaves_the_other_half_met(bone):
    geometry, pose = FrameGeometry(bone, SIZE, *KINDS["linear"]), image_pose((*SPACING,), translation=(-40.0, -45.0, -20.0))
    image = np.full(SIZE[::-1], 90, np.uint8)
    image[:, : SIZE[0] // 2] = 0
    points, _, status = geometry.view(pose, image)
    columns = (bone.surface.points_reference[points, 0] + 40.0) / SPACING[0]
    np.testing.assert_array_equal(status[status != SHADOWED] == MET, columns[status != SHADOWED] > 45.0)


def test_a_target_goes_by_the_name_of_its_segment_and_by_its_number(bone):
    named = replace(bone, names={1: "L4", 2: "L3"})
    np.testing.assert_array_equal(named.target("L3"), bone.surface.labels == 2)
    np.testing.assert_array_equal(named.target("2"), bone.surface.labels == 2)
    with pytest.raises(GeometryError, match=r"\(L4, L3\)"):
        named.target("L5")

from itertools import pairwise

import numpy as np
import pytest
from sweeps import rigid

from AIFReconLib.errors import OperationCanceled, SettingsError
from AIFReconLib.geometry.transforms import invert, transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.simulation.anatomy import LumbarAnatomy, LumbarPhantom, make_lumbar_phantom
from AIFReconLib.simulation.morphometry import LAMINA_THICKNESS, TYPICAL
from AIFReconLib.simulation.vertebra import DISTANCE_LIMIT

COARSE = 2.0


@pytest.fixture(scope="module")
def regular() -> LumbarPhantom:
    """Three vertebrae of the default sizes, all alike; the middle one is upright in the middle of Reference."""
    return make_lumbar_phantom(LumbarAnatomy(irregularity=0.0), spacing=1.0)


@pytest.fixture(scope="module")
def person() -> LumbarPhantom:
    return make_lumbar_phantom(LumbarAnatomy.from_seed(3), spacing=COARSE)


def values_along(volume: Volume, start, stop, step: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    """Distances from `start` and the nearest voxels' values on the way to `stop`."""
    start, stop = np.asarray(start, dtype=float), np.asarray(stop, dtype=float)
    length = np.linalg.norm(stop - start)
    way = np.arange(0.0, length, step)
    ijk = np.rint(transform_points(volume.grid.reference_to_ijk, start + way[:, None] * (stop - start) / length)).astype(int)
    return way, volume.array[ijk[:, 2], ijk[:, 1], ijk[:, 0]]


def bone_runs(volume: Volume, start, stop) -> list[tuple[float, float]]:
    """Where bone begins and ends along a straight line, mm from its start."""
    way, values = values_along(volume, start, stop)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], (values > 0).astype(int), [0]])))
    return [(way[a], way[min(b, len(way) - 1)]) for a, b in edges.reshape(-1, 2)]


def test_spinous_process_and_gap_are_as_long_and_wide_as_asked(regular):
    tips, roots = regular.spinous_tips(), regular.spinolaminar_junctions()
    first = [bone_runs(regular.labels, (0.0, 2.0, z), (0.0, 70.0, z))[0] for z in np.arange(-8.0, 4.0, 1.0)]
    back, canal_wall = min(a for a, _ in first), max(b for _, b in first)
    assert back + 2.0 == pytest.approx(tips[1][1], abs=1.0)
    assert canal_wall - back == pytest.approx(regular.anatomy.spinous_length + LAMINA_THICKNESS, abs=1.8)
    middles = (tips + roots) / 2
    runs = bone_runs(regular.labels, middles[0], middles[1])
    assert runs[1][0] - runs[0][1] == pytest.approx(regular.anatomy.interspinous_gap, abs=1.2)


SIZES = [
    ("body_width", 0, (-33.0, 33.0), [(0, 0, z) for z in np.arange(-12.0, 13.0)], 2.0),
    ("body_depth", 1, (-18.0, 22.0), [(0, 0, z) for z in np.arange(-11.0, 12.0)], 2.0),
    ("body_height", 2, (-16.0, 16.0), [(0, 12.5, 0)], 2.5),
]
"""What is asked for, along which axis it is measured, from where to where and beside which lines, mm; and how well."""


@pytest.mark.parametrize(("name", "axis", "span", "offsets", "off"), SIZES)
def test_a_vertebral_body_is_as_large_as_asked_before_a_canal_without_bone(regular, name, axis, span, offsets, off):
    vertebra = regular.vertebrae[1]
    middle = vertebra.vertebra_to_reference[:3, 3]
    ends = np.zeros((2, 3))
    ends[:, axis] = span
    runs = [run for at in offsets for run in bone_runs(regular.labels, *(middle + vertebra.body_center + ends + at))]
    assert max(b - a for a, b in runs) == pytest.approx(getattr(regular.anatomy, name), abs=off)
    canal = middle + np.array([0.0, LAMINA_THICKNESS + regular.anatomy.canal_depth / 2, 0.0])
    assert bone_runs(regular.labels, np.add(canal, (0, 0, -35.0)), np.add(canal, (0, 0, 35.0))) == []


def test_lamina_lies_as_deep_under_the_skin_as_asked(regular):
    way, hounsfield = values_along(regular.ct, (0.0, -15.0, 0.0), (0.0, 70.0, 0.0))
    skin = way[np.argmax(hounsfield > -500)]
    # Laminae slope: farthest forward a little above the spinolaminar junction
    canal_wall = max(bone_runs(regular.labels, (0.0, -15.0, z), (0.0, 60.0, z))[0][1] for z in (3.0, 6.0, 9.0))
    assert canal_wall - LAMINA_THICKNESS - skin == pytest.approx(regular.anatomy.skin_to_lamina, abs=1.8)


def test_each_vertebra_has_its_own_label_touches_no_other_and_is_whole(regular):
    labels = regular.labels.array.astype(int)
    assert np.unique(labels).tolist() == [0, 1, 2, 3]
    for axis in range(3):
        a, b = np.moveaxis(labels, axis, 0)[:-1], np.moveaxis(labels, axis, 0)[1:]
        assert not ((a != b) & (a > 0) & (b > 0)).any()
    assert np.count_nonzero(labels[1:-1, 1:-1, 1:-1]) == np.count_nonzero(labels)
    for count in (2, 4):
        phantom = make_lumbar_phantom(LumbarAnatomy(vertebrae=count), spacing=3.0)
        assert phantom.labels.array.max() == len(phantom.vertebrae) == count


@pytest.mark.parametrize("side", [-1, 1])
def test_facets_of_neighbors_lie_across_a_joint_space(regular, side):
    """From the upper vertebra's inferior process outward to the lower one's superior process."""
    lower = regular.vertebrae[1]
    start, joint = np.array([side * 8.0, 2.0, 18.0]), np.array([side * 24.0, 2.0, 18.0])
    way, labels = values_along(regular.labels, *transform_points(lower.vertebra_to_reference, np.array([start, joint])), step=0.05)
    inner, outer = np.flatnonzero(labels == 1), np.flatnonzero(labels == 2)
    assert 1.0 <= way[outer.min()] - way[inner.max()] <= 4.0
    assert way[outer.max()] - way[outer.min()] > 4.0


def test_each_level_is_as_much_larger_as_the_person_s_l3_is():
    person = LumbarAnatomy(pedicle_width=10.8, facet_width=40.7, arch_height=53.9, facet_angle_deg=30.0)
    sizes, usual = person.sizes_of("L5"), TYPICAL["L5"]
    assert sizes.pedicle_width == pytest.approx(1.2 * usual.pedicle_width)
    assert sizes.superior_width / usual.superior_width == pytest.approx(1.1)
    assert sizes.inferior_height / usual.inferior_height == pytest.approx(1.1)
    assert sizes.facet_angle_deg - usual.facet_angle_deg == pytest.approx(6.0)
    assert LumbarAnatomy().sizes_of("L5") == usual
    # A steeper spinous process ends lower
    flat, steep = (LumbarAnatomy(spinous_slope_deg=angle).sizes_of("L3") for angle in (12.0, 22.0))
    drop = pytest.approx(32.0 * (np.tan(np.radians(22.0)) - np.tan(np.radians(12.0))))
    assert (flat.spinous_top - steep.spinous_top, flat.spinous_bottom - steep.spinous_bottom) == (drop, drop)


def test_ct_shows_air_fat_muscle_and_cortical_bone_and_where_the_skin_is(regular, person):
    air, fat = regular.ct.array[:, 0].mean(), values_along(regular.ct, (8.0, 4.0, 0.0), (8.0, 8.0, 0.0))[1].mean()
    muscle = values_along(regular.ct, (12.0, 20.0, -20.0), (12.0, 20.0, 20.0))[1].mean()
    shell = regular.ct.array[np.abs(regular.bone_distance.array + 0.8) < 0.2].mean()
    assert (round(air, -2), round(fat, -2)) == (-1000, -100)
    assert 30 < muscle < 70
    assert 700 < shell < 1100
    skin = person.skin_y(20, 10)
    outside, inside = (values_along(person.ct, (20.0, skin + y, 10.0), (20.0, skin + y + 4, 10.0))[1] for y in (-6, 2))
    assert person.skin_y(0.0, 0.0) == pytest.approx(0.0, abs=1e-9)
    assert outside.max() < -850
    assert inside.min() > -250


def test_bone_distance_grows_by_one_mm_per_mm_near_the_surface_and_is_negative_in_bone(regular):
    distance = regular.bone_distance.array.astype(float)
    assert np.array_equal(distance <= 0, regular.labels.array > 0)
    slope = np.sqrt(sum(g**2 for g in np.gradient(distance, 1.0)))
    near = (distance > 0.5) & (distance < 2.5)
    assert np.median(slope[near]) == pytest.approx(1.0, abs=0.08)
    assert np.abs(distance).max() <= 30
    assert distance.max() == DISTANCE_LIMIT


def test_the_same_seed_gives_the_same_phantom_and_another_seed_another(person):
    again = make_lumbar_phantom(LumbarAnatomy.from_seed(3), spacing=COARSE)
    assert np.array_equal(person.ct.array, again.ct.array)
    assert np.array_equal(person.labels.array, again.labels.array)
    other = LumbarAnatomy.from_seed(4)
    assert other.skin_to_lamina != person.anatomy.skin_to_lamina


def test_people_differ_within_the_published_ranges():
    """Gaps are seen 10 mm before the tips of L2 to L4, where neighbors are nearest."""
    people = [LumbarAnatomy.from_seed(seed) for seed in range(200)]
    depths = [person.skin_to_lamina for person in people]
    assert min(depths) >= 35
    assert max(depths) <= 55
    assert np.std(depths) > 2
    for person in people[:20]:
        radius = person.arc_radius - person.body_depth_from_lamina
        for upper, lower in pairwise(v.sizes for v in person.vertebrae_in_place()):
            pitch = np.radians(person.lordosis_deg) * (radius - (upper.spinous_length + lower.spinous_length) / 2 + 10.0)
            assert 6.0 <= pitch + upper.spinous_bottom - lower.spinous_top <= 14.0


def test_a_ct_in_its_own_frame_shows_the_same_bone(person):
    turned = make_lumbar_phantom(person.anatomy, spacing=COARSE, ct_to_reference=rigid((0.0, 0.0, 8.0), (120.0, -80.0, 1000.0)))
    placed = turned.labels.placed_by(turned.ct_to_reference)
    ijk = np.argwhere(placed.array > 0)[:, ::-1]
    inside = transform_points(person.bone_distance.grid.reference_to_ijk @ placed.ijk_to_reference, ijk)
    i, j, k = np.rint(inside).astype(int).T
    assert person.bone_distance.array[k, j, i].max() < 2.0
    assert np.count_nonzero(placed.array) == pytest.approx(np.count_nonzero(person.labels.array), rel=0.02)
    assert np.allclose(turned.labels.grid.ijk_to_reference[:3, :3], COARSE * np.eye(3))
    assert np.allclose(invert(turned.ct_to_reference) @ placed.ijk_to_reference, turned.labels.ijk_to_reference)


@pytest.mark.parametrize(
    ("error", "make", "words"),
    [
        (SettingsError, lambda: LumbarAnatomy(vertebrae=6), "vertebrae must"),
        (SettingsError, lambda: make_lumbar_phantom(spacing=0.01), "spacing"),
        (OperationCanceled, lambda: make_lumbar_phantom(spacing=3.0, progress=lambda fraction, message: False), ""),
    ],
)
def test_what_no_phantom_has_is_refused_and_making_one_can_be_canceled(error, make, words):
    with pytest.raises(error, match=words or None):
        make()

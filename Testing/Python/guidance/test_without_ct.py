"""Guidance where no CT tells of bone: the surface of echoes, where it may go on, and words for an image, since nobody knows the head."""

from __future__ import annotations

import json

import numpy as np
import pytest
from idle_session import IMAGES, LIT, RECIPE, show, sweep_at
from sweeps import rigid, two_vertebrae
from waiting import until

from AIFReconLib.bone.echoes.found import SweepEchoes
from AIFReconLib.bone.echoes.surface import surface_of
from AIFReconLib.bone.growing_bone import GrowingBone
from AIFReconLib.commands.parser import main
from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.guidance.bone import GuidedBone, bone_of_echoes
from AIFReconLib.guidance.bone_coverage import CoverageAccumulator
from AIFReconLib.guidance.candidates import geometry_of
from AIFReconLib.guidance.coverage import covered, unrefuted
from AIFReconLib.guidance.guidance import Advisor, guidance_of_sweep
from AIFReconLib.guidance.mesh import ASLANT, NOT_MET, SQUARELY, TILE, ColoredBone
from AIFReconLib.guidance.probe import ProbeOnBack, Skin
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.transform.files import write_transform
from AIFReconLib.live.pairing.synchronizer import LiveFrame
from AIFReconLib.live.session.guidance_watch import NOTHING_YET
from AIFReconLib.progress import carry_out
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import plus_configuration_xml
from AIFReconLib.sweep.frames import TrackedSequence

RADIUS, HALF_LENGTH, SHOWN_DEG = 12.0, 20.0, 40.0
"""mm, mm, and degrees to either side of its top: a shaft along z, as far as echoes show it; its axis goes through the origin."""

PLACES = [np.eye(4), rigid((20.0, -35.0, 50.0), (12.0, -40.0, 75.0))]


def shaft(place=PLACES[0], tilts_deg=(-15.0, 0.0, 15.0)) -> SweepEchoes:
    """Echoes of the shaft where beams along +y, turned about z, meet it."""
    along, around = (axis.ravel() for axis in np.meshgrid(np.arange(-HALF_LENGTH, HALF_LENGTH + 0.1, 0.7), np.arange(-40.0, 40.1, 3.0)))
    angle = np.radians(around)
    points = np.stack([RADIUS * np.sin(angle), -RADIUS * np.cos(angle), along], axis=1)
    ways = [(np.sin(np.radians(tilt)), np.cos(np.radians(tilt)), 0.0) for tilt in tilts_deg]
    parts = [
        SweepEchoes(
            transform_points(place, points),
            np.tile(way, (len(points), 1)) @ place[:3, :3].T,
            np.full(len(points), 0.6, np.float32),
            np.full(len(points), number),
        )
        for number, way in enumerate(ways)
    ]
    return SweepEchoes.joined(parts)


def above(place=PLACES[0], x=0.0, z=0.0) -> np.ndarray:
    """image_to_reference of an image that looks along +y at the shaft, (4, 4)."""
    pose = np.diag([*IMAGES.spacing, 0.2, 1.0])
    column, row = IMAGES.face_px
    pose[:3, 3] = np.array([x, -45.0, z]) - pose[:3, :2] @ (column, row)
    return place @ pose


@pytest.fixture(scope="module", params=PLACES, ids=["upright", "oblique"])
def place(request):
    return request.param


@pytest.fixture(scope="module")
def bone(place) -> GuidedBone:
    return bone_of_echoes(surface_of(shaft(place)), np.stack([above(place, z=z) for z in (-5.0, 0.0, 5.0)]))


def in_shaft(bone, place) -> tuple[np.ndarray, np.ndarray]:
    """Points and normals where the shaft lies along z."""
    back = np.linalg.inv(place)
    return transform_points(back, bone.surface.points_reference), bone.surface.normals_reference @ back[:3, :3].T


def test_the_surface_lies_where_the_echoes_do_and_faces_the_beams(bone, place):
    points, normals = in_shaft(bone, place)
    np.testing.assert_allclose(bone.patient_to_reference[:3, :3], place[:3, :3], atol=1e-9)  # as in the first image
    assert not bone.is_of_ct
    assert bone.aim == "posterior"
    known = bone.surface.labels == 1
    radius = np.hypot(points[known, 0], points[known, 1])
    assert np.median(np.abs(radius - RADIUS)) < 0.6
    assert np.abs(radius - RADIUS).max() < 1.8  # beyond the last echo it goes straight on
    out = points[known, :2] / radius[:, None]
    assert np.median((normals[known, :2] * out).sum(axis=1)) > 0.98
    # It ends 3 mm beyond the last echo
    expected = (2 * HALF_LENGTH + 6) * (RADIUS * np.radians(2 * SHOWN_DEG) + 6)
    assert bone.surface.areas[known].sum() == pytest.approx(expected, rel=0.25)


def test_bone_may_go_on_beyond_its_ends_and_around_its_sides(bone, place):
    points, normals = in_shaft(bone, place)
    beyond = bone.surface.labels == 0
    angle = np.degrees(np.arctan2(points[:, 0], -points[:, 1]))
    ahead = np.abs(points[:, 2]) - HALF_LENGTH
    sideways = np.abs(angle) - SHOWN_DEG
    assert (np.maximum(ahead, sideways * np.radians(1) * RADIUS)[beyond] > 0.5).all()
    for side in (points[:, 2] > HALF_LENGTH + 1, points[:, 2] < -HALF_LENGTH - 1, angle > SHOWN_DEG + 5, angle < -SHOWN_DEG - 5):
        assert (beyond & side).sum() > 10
    # Around the sides it goes on as the shaft does, for this is about as round as bone is thought to be
    flanks = beyond & (ahead < -5)
    assert np.abs(np.hypot(points[flanks, 0], points[flanks, 1]) - RADIUS).max() < 3.0
    assert (np.sign(normals[flanks, 0]) == np.sign(angle[flanks])).all()


def met_by(bone, poses) -> CoverageAccumulator:
    met = CoverageAccumulator(geometry_of(bone, ProbeOnBack(IMAGES, Skin.through(np.array([[0.0, 0.0, 0.0]])), bone.patient_to_reference)))
    for pose in poses:
        met.insert(pose)
    return met


def test_places_that_beams_have_met_without_an_echo_are_no_bone(bone, place):
    over_the_end = [above(place, z=HALF_LENGTH + dz) for dz in (1.0, 3.0, 5.0, 7.0)]
    met = met_by(bone, over_the_end)
    left = unrefuted(met)

    def beyond_the_end(of: CoverageAccumulator) -> int:
        points, _ = in_shaft(of.bone, place)
        return int(((of.bone.surface.labels == 0) & (points[:, 2] > HALF_LENGTH + 1)).sum())

    assert beyond_the_end(left) < 0.5 * beyond_the_end(met)
    known = met.bone.surface.labels == 1
    np.testing.assert_array_equal(left.best_cosine[left.bone.surface.labels == 1], met.best_cosine[known])
    np.testing.assert_array_equal(left.support[left.bone.surface.labels == 1], met.support[known])
    np.testing.assert_allclose(met_by(left.bone, over_the_end).support, left.support)


def test_what_was_seen_is_colored_and_what_may_go_on_is_gray(bone, place):
    met = met_by(bone, [above(place, z=z) for z in np.arange(-18.0, 19.0, 3.0)])
    colored = ColoredBone.of(bone)
    levels = colored.levels(met.best_cosine).reshape(-1, 4)
    assert (levels == levels[:, :1]).all()  # a tile has one color
    points, _ = in_shaft(bone, place)
    ends = (bone.surface.labels == 0) & (np.abs(points[:, 2]) > HALF_LENGTH + 4)
    top = (bone.surface.labels == 1) & (np.abs(points[:, 0]) < 4) & (np.abs(points[:, 2]) < 15)
    assert (levels[ends] == NOT_MET).all()
    assert np.isin(levels[top], (SQUARELY, ASLANT)).all()
    mesh = colored.mesh
    corners = mesh.points_reference[mesh.triangles]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.concatenate([bone.surface.normals_reference] * 2)
    assert ((facing * normals).sum(axis=1) > 0).all()  # seen from outside
    assert np.linalg.norm(facing, axis=1).sum() / 2 == pytest.approx(len(bone) * TILE**2)


def test_the_next_move_leads_to_where_bone_may_go_on(bone, place):
    """Seen from above all along but for one end: that is where to go."""
    poses = np.stack([above(place, z=z) for z in np.linspace(-24.0, 8.0, 40)])
    met = unrefuted(met_by(bone, poses))
    advisor = Advisor(met, poses)
    advice = advisor.to(advisor.moves.advise(met, poses[-1]), poses[-1])
    assert advice.move is not None
    assert advice.seen is not None
    assert advice.seen.over == ()
    there = np.linalg.inv(place) @ advice.move.image_to_reference
    points = transform_points(there, np.array([[*IMAGES.face_px, 0.0]]))
    assert points[0, 2] > 0.0
    assert "over the bone, adds" in advice.move.words
    assert not any(word in advice.move.words for word in ("head", "feet", "patient", "sagittal", "transverse"))
    assert covered(met).by_label == {}


def test_no_surface_is_a_sentence():
    known = surface_of(shaft())
    known.probability.array[:] = 0.0
    with pytest.raises(GeometryError, match="Scan the bone longer"):
        bone_of_echoes(known, np.stack([above()]))


# A sweep, and a scan


def echo_image() -> np.ndarray:
    """Gray tissue, a bright line at 30 mm, and darkness behind it."""
    columns, rows = IMAGES.frame_size
    image = np.full((rows, columns), 40.0)
    row = IMAGES.face_px[1]
    depth = (np.arange(rows) - row) * IMAGES.spacing[1]
    line = np.abs(depth - 33.0) < 0.6
    image[line] = 220.0
    image[depth > 33.6] = 2.0
    return image.astype(np.uint8)


@pytest.fixture(scope="module")
def sweep() -> TrackedSequence:
    """A plate that beams from three sides have met."""
    return sweep_at([above(x=x, z=z) for x in (-3.0, 0.0, 3.0) for z in np.arange(-9.0, 10.0, 1.5)], echo_image())


def test_the_command_coverage_without_labels(sweep, tmp_path, capsys):
    recorded, config, report, surface = (tmp_path / name for name in ("sweep.igs.mha", "config.xml", "no-ct.json", "no-ct.vtp"))
    write_sequence(sweep, recorded)
    config.write_text(plus_configuration_xml(PhasedArray()), "utf-8")
    command = ["coverage", str(recorded), "--config", str(config)]
    assert main([*command, "--report", str(report), "--surface", str(surface)]) == 0
    said = capsys.readouterr().out
    assert "Bone was found by" in said
    assert "interspinous" not in said
    written = json.loads(report.read_text("utf-8"))
    assert written["labels"] == {}
    assert 0 < written["all"]["met"] < 1
    assert surface.is_file()
    place = tmp_path / "place.tfm"
    write_transform(np.eye(4), place)
    assert main([*command, "--bone-transform", str(place)]) == 2
    assert "Give --bone-labels or --ct, or no --bone-transform." in capsys.readouterr().err


def test_a_sweep_without_bone_is_a_sentence():
    with pytest.raises(GeometryError, match="too few to tell bone by"):
        guidance_of_sweep(sweep_at([above(z=z) for z in np.arange(-9.0, 10.0, 1.5)]), recipe=RECIPE)


def frames(numbers) -> list[LiveFrame]:
    return [LiveFrame(LIT, above(z=number - 10.0), timestamp=0.1 * number, number=number) for number in numbers]


def known_area(state) -> float:
    surface = state.coverage.met.bone.surface
    return float(surface.areas[surface.labels == 1].sum())


def test_a_scan_tells_of_bone_that_grows_and_where_to_go(watching):
    growing = GrowingBone()
    session, watch = watching(growing)
    assert watch.prepared.is_set()
    show(session, watch, frames(range(3)))
    assert watch.state.problem == NOTHING_YET
    half = shaft()
    growing.learn(half[half.points[:, 2] < 0])
    carry_out(growing.spread())
    show(session, watch, frames(range(3, 12)))
    assert until(lambda: watch.state.coverage is not None)
    first = watch.state
    growing.learn(half[half.points[:, 2] >= 0])
    carry_out(growing.spread())

    def grown() -> bool:
        show(session, watch, frames([session.latest.number + 1]))
        return known_area(watch.state) > 1.5 * known_area(first)

    assert until(grown)
    assert watch.state.colored.mesh.number != first.colored.mesh.number
    assert until(lambda: watch.state.advice is not None)
    levels = watch.state.levels
    assert {SQUARELY, NOT_MET} <= set(levels)


def test_a_ct_that_is_chosen_in_mid_scan_takes_over(watching):
    growing = GrowingBone()
    session, watch = watching(growing)
    growing.learn(shaft())
    carry_out(growing.spread())
    show(session, watch, frames(range(5)))
    assert until(lambda: watch._bone is not None)
    labels: Volume = two_vertebrae()
    watch.place(np.eye(4), labels)
    assert until(lambda: watch._bone is not None and watch._bone.is_of_ct)
    show(session, watch, frames(range(6, 9)))
    assert until(lambda: watch.state.coverage is not None and watch.state.coverage.by_label)

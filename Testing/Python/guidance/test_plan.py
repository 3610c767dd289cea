"""Plans: poses on the skin, passes that add what they say, and the files that carry them."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from sweeps import rigid, two_vertebrae

from AIFReconLib import plan as public_plan
from AIFReconLib.commands.parser import main
from AIFReconLib.evaluation.visibility import SweepBeams, look
from AIFReconLib.geometry.transforms import invert, transform_points
from AIFReconLib.guidance.bone import guided_bone
from AIFReconLib.guidance.bone_coverage import expected_visibility, support_of
from AIFReconLib.guidance.passes import WEARABLE_TILT_DEG, Hand
from AIFReconLib.guidance.plan import WEARABLE, plan_scan
from AIFReconLib.guidance.probe import AIM_DEPTH, FARTHEST, ProbeImages, ProbeOnBack, ProbePlacement, Skin
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import contact_pose
from AIFReconLib.workflows.simulate import planned_path

PLACE = rigid((5.0, -8.0, 12.0), (20.0, 10.0, -5.0))
FRAMES = 40


class Flat:
    """A back whose skin is a plane, for the simulator's own poses."""

    def skin_y(self, x, z):
        return np.full(np.broadcast(x, z).shape, -40.0)


@pytest.fixture(scope="module")
def bone():
    return guided_bone(two_vertebrae(), PLACE)


@pytest.fixture(scope="module")
def plan(bone, probe):
    return plan_scan(bone, probe, "interspinous", FRAMES, hand=None)


@pytest.mark.parametrize("turn_deg", [0.0, 90.0])
def test_poses_are_those_of_the_simulator(turn_deg):
    """Turned over flat skin, a pose is the same turned about the place aimed at."""
    flat = ProbeOnBack(ProbeImages.simulated(), Skin.through(np.array([[0.0, -40.0, 0.0]])), np.eye(4))
    turned = np.eye(4)
    turned[:3, :3] = Rotation.from_euler("y", -turn_deg, degrees=True).as_matrix()
    place = np.array([4.0, 0.0, -9.0])
    turned[:3, 3] = place - turned[:3, :3] @ place
    theirs = turned @ contact_pose(Flat(), 4.0, -9.0, in_plane_tilt_deg=20.0, elevational_tilt_deg=-35.0)
    ours = flat.pose(ProbePlacement(4.0, -9.0, turn_deg, 20.0, -35.0))
    np.testing.assert_allclose(ours, theirs @ PhasedArray().image_to_transducer, atol=1e-3)


@pytest.mark.parametrize("bend", [0.0, 6.0, 60.0, -6.0, -60.0])
@pytest.mark.parametrize("slope", [0.0, 15.0, -45.0])
def test_faces_lie_where_their_beams_first_meet_the_skin_however_steep_it_is(slope, bend):
    skin = Skin(np.array([-30.0, slope, 0.4 * slope, bend, -0.5 * bend, 0.8 * bend]))
    back = ProbeOnBack(ProbeImages.simulated(), skin, np.eye(4))
    placements = [
        ProbePlacement(8.0, z, turn, tilt, across)
        for z in (-20.0, 5.0)
        for turn in (0.0, 90.0)
        for tilt in (-40.0, 25.0)
        for across in (-30.0, 40.0)
    ]
    poses = back.poses(placements)
    faces = back.images.faces(poses)
    targets = np.array([(one.x, float(skin.at(one.x, one.z)) + AIM_DEPTH, one.z) for one in placements])
    ways = np.linalg.norm(targets - faces, axis=1)
    assert (ways <= FARTHEST + 1e-6).all()
    met = ways < FARTHEST - 1e-6
    depths = faces[:, 1] - skin.at(faces[:, 0], faces[:, 2])
    for number, part in enumerate(np.linspace(0.0, 0.999, 1000)):
        along = targets + part * (faces - targets)
        assert (along[:, 1] > skin.at(along[:, 0], along[:, 2])).all(), number
    np.testing.assert_allclose(depths[met], 0.0, atol=1e-6)
    # Skin that goes straight or toward the beam is always met, unless it is too steep
    assert met.all() or bend < 0.0 or slope < 0.0
    assert met.any()


def test_a_placement_is_read_back_from_its_pose(probe):
    given = ProbePlacement(7.0, -12.0, 90.0, 30.0, -20.0)
    found = probe.placement(probe.pose(given))
    angles = (found.turn_deg, found.in_plane_deg, found.across_deg)
    np.testing.assert_allclose(angles, (90.0, 30.0, -20.0), atol=1e-6)
    np.testing.assert_allclose((found.x, found.z), (7.0, -12.0), atol=3.0)


def test_skin_that_was_felt_along_the_midline_goes_straight_on_to_the_sides():
    z = np.linspace(-50.0, 50.0, 21)
    skin = Skin.through(np.stack([0 * z, -30.0 + 0.1 * z, z], axis=1))
    assert float(skin.at(0.0, 20.0)) == pytest.approx(-28.0, abs=0.2)
    assert float(skin.at(30.0, 0.0)) == pytest.approx(-30.0, abs=0.2)


def test_what_a_plan_predicts_is_what_its_beams_reach(plan, bone, probe):
    shown, areas = expected(bone, probe, np.concatenate([one.image_to_reference for one in plan.passes]))
    assert plan.predicted_of_reachable == pytest.approx(areas @ shown / areas.sum(), abs=1e-9)
    assert plan.predicted_visibility == pytest.approx(areas @ shown / areas[shown > 0].sum(), abs=1e-9)
    assert sum(one.adds_cm2 for one in plan.passes) == pytest.approx(areas @ shown / 100, abs=1e-9)


def expected(bone, probe, poses):
    """The chance of each point of the border to show, by another search for what each frame meets, and its area."""
    points, support = np.flatnonzero(bone.border), np.zeros(len(bone))
    for pose in poses:
        beams = SweepBeams(pose[None], probe.images.frame_size, probe.images.geometry, probe.images.region)
        _, best = look(bone.surface.points_reference[points], beams, bone.distance, bone.surface.normals_reference[points])
        support[points] += np.where(np.isfinite(best), support_of(np.nan_to_num(best)), 0.0)
    return expected_visibility(support), np.where(bone.border, bone.surface.areas, 0.0)


def test_what_a_plan_predicts_for_a_hand_is_what_many_such_hands_show(bone, probe):
    plan, rng = plan_scan(bone, probe, "interspinous", FRAMES), np.random.default_rng(5)
    shown = []
    for _ in range(5):
        made = [Hand().follow(one.planned.placements(len(one.image_to_reference)), rng) for one in plan.passes]
        chances, areas = expected(bone, probe, probe.poses([one for each in made for one in each]))
        shown.append(areas @ chances / areas.sum())
    assert plan.predicted_of_reachable == pytest.approx(np.mean(shown), abs=0.12)


def test_a_wearable_device_does_not_slide_and_tilts_no_farther_than_it_can(bone, probe):
    worn = plan_scan(bone, probe, "interspinous", FRAMES, WEARABLE)
    placements = [probe.placement(pose) for one in worn.passes for pose in one.image_to_reference]
    tilts = np.array([(one.in_plane_deg, one.across_deg) for one in placements])
    assert np.abs(tilts).max() <= WEARABLE_TILT_DEG + 1e-6
    faces = transform_points(invert(bone.patient_to_reference), probe.images.faces(worn.passes[0].image_to_reference))
    assert np.ptp(faces[:, 2]) < 2 * AIM_DEPTH


def test_the_command_writes_a_plan_that_the_simulated_probe_can_follow(tmp_path, capsys):
    labels, written = tmp_path / "labels.nrrd", tmp_path / "plan.json"
    two_vertebrae().write(labels)
    assert main(["plan", "--bone-labels", str(labels), "--frames", str(FRAMES), "--output", str(written)]) == 0
    said = capsys.readouterr().out
    document = json.loads(written.read_text("utf-8"))
    assert f"expected to show {document['predicted_visibility']:.0%} of interspinous" in said
    of_all = f"{document['predicted_of_reachable']:.0%}"
    assert f"{of_all} of what can be reached" in said
    assert next(line for line in said.splitlines() if "interspinous borders" in line).endswith(of_all)
    poses = np.array([pose for one in document["passes"] for pose in one["image_to_reference"]])
    assert all(isinstance(one["name"], str) and one["name"] in said for one in document["passes"])
    path = planned_path(written)
    assert (np.diff(path.timestamps) > 0).all()
    np.testing.assert_allclose(path.transducer_to_reference @ PhasedArray().image_to_transducer, poses, atol=1e-9)


def test_one_call_plans_from_labels_as_the_parts_do(bone, probe):
    found = public_plan(two_vertebrae(), PLACE, target="posterior", frames=24)
    same = plan_scan(bone, probe, "posterior", 24)
    assert found.to_dict() == same.to_dict()
    assert repr(found).startswith("<ScanPlan: target posterior, passes ")

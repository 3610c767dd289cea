import numpy as np
import pytest
from scipy import ndimage

from AIFReconLib.errors import OperationCanceled, SettingsError
from AIFReconLib.geometry.transform_graph import TransformName, TransformStatus
from AIFReconLib.geometry.transforms import invert, transform_points, why_not_rigid
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.simulation.anatomy import LumbarAnatomy, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import (
    AIM_DEPTH,
    TrackingErrors,
    contact_pose,
    freehand_sweep,
    multi_angle_sweep,
    plus_configuration_xml,
    random_rigid,
    simulate_sweep,
    single_angle_sweep,
)

PROBE = PhasedArray(columns=320, rows=240, lines=96, samples=300)
TINY = PhasedArray(columns=16, rows=16, lines=16, samples=16)


@pytest.fixture(scope="module")
def phantom():
    return make_lumbar_phantom(LumbarAnatomy.from_seed(2), spacing=1.25)


@pytest.fixture(scope="module")
def path(phantom):
    return multi_angle_sweep(phantom, 36)


@pytest.fixture(scope="module")
def sequence(phantom, path):
    return simulate_sweep(phantom, PROBE, path, seed=4)


def image_to_reference(record, image_to_probe=PROBE.image_to_probe) -> np.ndarray:
    matrices = {str(name): sample.matrix for name, sample in record.transforms.items()}
    return invert(matrices["ReferenceToTracker"]) @ matrices["ProbeToTracker"] @ image_to_probe


def bright_points(image: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """The brightest pixel of every column that shows a strong echo, in Reference."""
    rows, columns = image.argmax(axis=0), np.arange(image.shape[1])
    strong = image.max(axis=0) > 190
    pixels = np.stack([columns, rows, 0 * rows], axis=1)[strong]
    return transform_points(pose, pixels)


def distances_to_bone(phantom, points) -> np.ndarray:
    ijk = transform_points(phantom.bone_distance.grid.reference_to_ijk, points)
    return np.abs(ndimage.map_coordinates(phantom.bone_distance.array, ijk.T[::-1], order=1, cval=6.0))


def test_recorded_poses_put_bright_echoes_of_every_frame_on_the_bone(phantom, sequence):
    points = [bright_points(image, image_to_reference(record)) for image, record in zip(sequence.images, sequence.records)]
    errors = distances_to_bone(phantom, np.concatenate(points))
    assert len(errors) > 500
    assert np.median(errors) < 0.5
    assert np.percentile(errors, 95) < 1.5
    assert min((image > 175).sum() for image in sequence.images) > 20
    names = {str(name): dict(sequence.status_counts(name)) for name in sequence.transform_names()}
    assert names == {name: {TransformStatus.OK: 36} for name in ("ProbeToTracker", "ReferenceToTracker")}


@pytest.mark.parametrize("make", [single_angle_sweep, multi_angle_sweep, freehand_sweep])
def test_poses_are_rigid_and_the_face_stays_on_the_skin(phantom, make):
    poses = make(phantom, 20).transducer_to_reference
    assert [why_not_rigid(pose) for pose in poses] == [None] * 20
    faces = poses[:, :3, 3]
    assert faces[:, 1] == pytest.approx(phantom.skin_y(faces[:, 0], faces[:, 2]), abs=0.05)


@pytest.mark.parametrize(("in_plane", "elevational"), [(30.0, 0.0), (-30.0, 15.0), (0.0, -15.0)])
def test_a_tilted_probe_still_aims_at_its_target(phantom, in_plane, elevational):
    pose = contact_pose(phantom, 2.0, 9.0, in_plane_tilt_deg=in_plane, elevational_tilt_deg=elevational)
    target = np.array([2.0, phantom.skin_y(2.0, 9.0) + AIM_DEPTH, 9.0])
    ahead = target - pose[:3, 3]
    assert pose[:3, 1] == pytest.approx(ahead / np.linalg.norm(ahead), abs=1e-3)
    turned = contact_pose(phantom, 0.0, 0.0, in_plane_tilt_deg=30.0)
    assert turned[:3, 1] == pytest.approx([0.5, np.sqrt(0.75), 0.0], abs=1e-12)


def test_a_multi_angle_sweep_visits_every_pair_of_tilts_over_all_spinous_processes(phantom, path):
    assert len({tuple(np.round(pose[:3, 1], 3)) for pose in path.transducer_to_reference}) == 9
    assert len(multi_angle_sweep(phantom, 31)) == 31
    assert np.diff(path.timestamps).min() == pytest.approx(1 / 20)
    z, tips = path.transducer_to_reference[:, 2, 3], phantom.spinous_tips()[:, 2]
    assert z.min() < tips.min() - 5
    assert z.max() > tips.max() + 5


def test_the_same_seed_gives_the_same_sequence(phantom):
    short = single_angle_sweep(phantom, 3)
    one, same = (simulate_sweep(phantom, PROBE, short, seed=9, errors=TrackingErrors(breathing=1.0)) for _ in range(2))
    assert np.array_equal(one.images, same.images)
    assert np.array_equal(image_to_reference(one.records[2]), image_to_reference(same.records[2]))


def test_a_tracker_that_drifts_or_is_late_records_that_and_leaves_the_images_as_they_are(phantom):
    path = single_angle_sweep(phantom, 9)
    true, drifting, late = (
        simulate_sweep(phantom, TINY, path, errors=errors)
        for errors in (TrackingErrors(), TrackingErrors(drift=2.0), TrackingErrors(time_offset=0.05))
    )
    apart = [image_to_reference(one) - image_to_reference(other) for one, other in zip(drifting.records, true.records, strict=True)]
    assert np.linalg.norm(np.array(apart)[:, :3, 3], axis=1) == pytest.approx(np.linspace(0.0, 2.0, 9), abs=1e-9)
    recorded = image_to_reference(late.records[5], TINY.transducer_to_probe)
    assert recorded == pytest.approx(path.transducer_to_reference[4], abs=1e-6)
    assert np.array_equal(drifting.images, true.images)
    assert np.array_equal(late.images, true.images)


def test_a_random_motion_moves_its_point_and_turns_by_exactly_that_much():
    point = np.array([3.0, 40.0, -8.0])
    motion = random_rigid(2.0, 5.0, np.random.default_rng(7), about=point)
    assert np.linalg.norm(transform_points(motion, point) - point) == pytest.approx(2.0)
    assert np.rad2deg(np.arccos((np.trace(motion[:3, :3]) - 1) / 2)) == pytest.approx(5.0)


def test_the_configuration_is_read_as_the_probe_is(tmp_path):
    (tmp_path / "plus.xml").write_text(plus_configuration_xml(PROBE))
    read = read_plus_configuration(tmp_path / "plus.xml")
    assert read.transforms[TransformName("Image", "Probe")].matrix == pytest.approx(PROBE.image_to_probe, abs=1e-6)
    assert (read.probe.kind, read.probe.apex_px) == (PROBE.geometry.kind, pytest.approx(PROBE.apex_px))
    for name in ("apex_px", "angles_deg", "radii"):
        assert getattr(read.region.fan, name) == pytest.approx(getattr(PROBE.fan, name))


@pytest.mark.parametrize(
    ("error", "make", "said"),
    [
        (SettingsError, lambda phantom: TrackingErrors(step=-1.0), "errors must"),
        (SettingsError, lambda phantom: TrackingErrors(time_offset=float("nan")), "errors must"),
        (SettingsError, lambda phantom: multi_angle_sweep(phantom, 5), "frames must"),
        (
            OperationCanceled,
            lambda phantom: simulate_sweep(phantom, PROBE, multi_angle_sweep(phantom), progress=lambda done, _: done < 0.05),
            None,
        ),
    ],
)
def test_what_cannot_be_is_refused_and_a_sweep_can_be_canceled(phantom, error, make, said):
    with pytest.raises(error, match=said):
        make(phantom)

"""A probe that a mechanism moves, live: what its axes read comes with the images or in messages of its own, and places them."""

from __future__ import annotations

import struct

import numpy as np
import pyigtl
import pytest
from igtl_streams import packed
from sweeps import rigid

from AIFReconLib import LiveSession, Recipe, SynchronizerSettings, VoxelGrid, reconstruct
from AIFReconLib.geometry.mechanism import SHIFT, TURN, Axis, Mechanism
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.live.wire.decoding import decode
from AIFReconLib.live.wire.encoding import encode_message
from AIFReconLib.live.wire.framing import Framer
from AIFReconLib.live.wire.joint_poses import JointPoses
from AIFReconLib.live.wire.messages import ImageMessage, TransformMessage
from AIFReconLib.live.wire.sources import QueueSource
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.frames import TrackedSequence

CALIBRATION = rigid((5.0, 60.0, -4.0), (1.0, -2.0, 3.0)) @ np.diag([0.3, 0.5, 0.4, 1.0])
SLIDE = Axis("Slide", SHIFT, np.array([0.0, 0.6, 0.8]), scale=0.01, zero=500.0)
TILT = Axis("Tilt", TURN, np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -15.0]))
MECHANISM = Mechanism((SLIDE, TILT), rigid((0.0, 10.0, 20.0), (0.0, 5.0, 0.0)))
NAME = TransformName("Probe", "Base")
READINGS = [(500 + 60 * number, 3.0 * number - 9) for number in range(7)]
IMAGES = np.random.default_rng(0).integers(1, 256, (7, 20, 30), np.uint8)


def source_of(*metadata):
    source = QueueSource(in_place=JointPoses(MECHANISM, NAME))
    for number, fields in enumerate(metadata):
        source.put(ImageMessage("Image", 10.0 + 0.05 * number, IMAGES[number], np.eye(4), fields, header_version=2))
    return source


def test_the_pose_of_an_image_comes_before_it_at_its_time():
    source = source_of({"slide": "560", "TILT": "-6"})
    pose, image = source.get(), source.get()
    assert isinstance(pose, TransformMessage)
    assert isinstance(image, ImageMessage)
    assert (pose.device, pose.timestamp, pose.status) == ("ProbeToBase", image.timestamp, TransformStatus.OK)
    np.testing.assert_allclose(pose.matrix, MECHANISM.poses(np.array([[0.6, np.radians(-6)]]))[0])
    assert source.get(0.0) is None


@pytest.mark.parametrize("fields", [{}, {"Slide": "560"}, {"Slide": "560", "Tilt": "fast"}])
def test_an_image_that_does_not_say_what_the_axes_read_has_no_pose(fields):
    assert source_of(fields).get().status is TransformStatus.MISSING


def sensor(device, timestamp, *values):
    return encode_message("SENSOR", device, timestamp, struct.pack(f">BBQ{len(values)}d", len(values), 0, 0, *values), version=2)


def string(device, timestamp, text):
    return packed(pyigtl.StringMessage(text, device_name=device, timestamp=timestamp))


def poses_from(*messages):
    """What a source makes of messages as they come over the wire."""
    source = QueueSource(in_place=JointPoses(MECHANISM, NAME))
    for part in Framer(2**20).feed(b"".join(messages)):
        for held in decode(part):
            source.put(held)
    return [pose for _ in messages if (pose := source.get(0.0)) is not None]


@pytest.mark.parametrize(
    "messages",
    [
        (string("Slide", 10.5, "560"), string("tilt", 10.5, " -6.0 ")),
        (string("Tilt", 10.5, "-6"), string("Gain", 10.5, "40"), string("Slide", 10.5, "560")),
        (string("Probe", 10.5, "560, -6"),),
        (sensor("ProbeToBase", 10.5, 560.0, -6.0),),
        (sensor("Slide", 10.5, 560.0), sensor("Tilt", 10.5, -6.0)),
    ],
)
def test_readings_in_messages_make_the_pose_of_their_moment(messages):
    (pose,) = poses_from(*messages)
    assert (pose.device, pose.status) == ("ProbeToBase", TransformStatus.OK)
    assert pose.timestamp == pytest.approx(10.5, abs=1e-6)
    np.testing.assert_allclose(pose.matrix, MECHANISM.poses(np.array([[0.6, np.radians(-6)]]))[0])


@pytest.mark.parametrize(
    "messages",
    [
        (string("Slide", 10.5, "560"), string("Tilt", 10.6, "-6")),
        (string("Slide", 10.5, "fast"), string("Tilt", 10.5, "-6")),
        (sensor("Probe", 10.5, 560.0, -6.0, 1.0), sensor("Other", 10.5, 560.0, -6.0)),
    ],
)
def test_readings_of_other_moments_or_devices_make_no_pose(messages):
    assert poses_from(*messages) == []


def test_a_reading_that_is_no_number_is_a_missing_pose():
    (pose,) = poses_from(sensor("Probe", 10.5, 560.0, float("nan")))
    assert pose.status is TransformStatus.MISSING


def test_images_between_messages_take_the_pose_of_their_time():
    """Readings come at moments of their own, and images carry none: the poses beside an image place it."""
    source = QueueSource(in_place=JointPoses(MECHANISM, NAME))
    for number, (slide, tilt) in enumerate(READINGS):
        for part in Framer(2**20).feed(sensor("Probe", 10.0 + 0.05 * number, slide, tilt)):
            for held in decode(part):
                source.put(held)
        if number > 0:
            source.put(ImageMessage("Image", 9.975 + 0.05 * number, IMAGES[number], np.eye(4), {}, header_version=2))
    source.stop()
    configuration = PlusConfiguration(transforms={TransformName("Image", "Probe"): TransformSample(CALIBRATION)})
    grid = VoxelGrid.from_spacing((-30.0, -30.0, -30.0), (31, 31, 31), 2.0)
    settings = Recipe(reference="Base", hole_limit=0.0)
    with LiveSession(
        source,
        settings,
        grid=grid,
        configuration=configuration,
        synchronizer=SynchronizerSettings(reference="Base"),
        longest_delay=None,
    ) as session:
        session.start()
        session.finish()
        assert session.statistics.inserted == 6


def test_a_live_scan_by_a_mechanism_gives_the_voxels_of_the_same_poses_offline():
    grid = VoxelGrid.from_spacing((-30.0, -30.0, -30.0), (31, 31, 31), 2.0)
    source = source_of(*({"Slide": str(slide), "Tilt": str(tilt)} for slide, tilt in READINGS))
    configuration = PlusConfiguration(transforms={TransformName("Image", "Probe"): TransformSample(CALIBRATION)})
    settings = Recipe(reference="Base", hole_limit=0.0)
    with LiveSession(
        source, settings, grid=grid, configuration=configuration, synchronizer=SynchronizerSettings(reference="Base"), longest_delay=None
    ) as session:
        session.start()
        live = session.finish().intensity
        assert session.statistics.inserted == 7
    amounts = np.array([(0.01 * (slide - 500), np.radians(tilt)) for slide, tilt in READINGS])
    sweep = TrackedSequence.from_arrays(IMAGES, MECHANISM.poses(amounts) @ CALIBRATION)
    offline = reconstruct(sweep, Recipe(hole_limit=0.0), grid=grid).intensity
    np.testing.assert_array_equal(live.array, offline.array)
    assert live.array.any()

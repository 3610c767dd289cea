"""A probe that a mechanism moves, live: what its axes read comes with the images, and places them."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import rigid

from AIFReconLib import LiveSession, ReconstructionSettings, SynchronizerSettings, VoxelGrid, reconstruct
from AIFReconLib.geometry.mechanism import SHIFT, TURN, Axis, Mechanism
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.live.wire.joint_source import JointSource
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
    source = JointSource(QueueSource(), MECHANISM, NAME)
    for number, fields in enumerate(metadata):
        source._source.put(ImageMessage("Image", 10.0 + 0.05 * number, IMAGES[number], np.eye(4), fields, header_version=2))
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


def test_a_live_scan_by_a_mechanism_gives_the_voxels_of_the_same_poses_offline():
    grid = VoxelGrid.from_spacing((-30.0, -30.0, -30.0), (31, 31, 31), 2.0)
    source = source_of(*({"Slide": str(slide), "Tilt": str(tilt)} for slide, tilt in READINGS))
    configuration = PlusConfiguration(transforms={TransformName("Image", "Probe"): TransformSample(CALIBRATION)})
    settings = ReconstructionSettings(reference="Base", hole_limit=0.0)
    with LiveSession(
        source, settings, grid=grid, configuration=configuration, synchronizer=SynchronizerSettings(reference="Base"), longest_delay=None
    ) as session:
        session.start()
        live = session.finish().intensity
        assert session.statistics.inserted == 7
    amounts = np.array([(0.01 * (slide - 500), np.radians(tilt)) for slide, tilt in READINGS])
    sweep = TrackedSequence.from_arrays(IMAGES, MECHANISM.poses(amounts) @ CALIBRATION)
    offline = reconstruct(sweep, ReconstructionSettings(hole_limit=0.0), grid=grid).intensity
    np.testing.assert_array_equal(live.array, offline.array)
    assert live.array.any()

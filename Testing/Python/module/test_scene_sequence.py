"""Sweeps as sequence browsers and back: the same poses, statuses, times and pixels, in memory and through a saved scene."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from files import COLUMNS, ROWS, calibrated, tracked_sequence
from sweeps import rigid

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")
import tinyScene  # noqa: E402

from AIFReconLib.errors import TransformError  # noqa: E402
from AIFReconLib.geometry.transform_graph import TransformName, TransformStatus  # noqa: E402
from AIFReconLib.holes.filling import HoleFilling  # noqa: E402
from AIFReconLib.imaging.beams import ProbeGeometry  # noqa: E402
from AIFReconLib.imaging.region import ClipRectangle, Fan, FanDetection, ImageRegion  # noqa: E402
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence  # noqa: E402
from AIFReconLib.sweep.poses import sweep_poses  # noqa: E402

CONFIGURED: dict[str, Any] = {
    "image_frame": "Image",
    "reference_frame": "Reference",
    "spacing": (0.9, 0.9, 0.9),
    "region": ImageRegion(ClipRectangle((1.0, 2.0), (15.0, 11.0)), Fan((8.0, -6.0), (-40.0, 40.0), (5.0, 40.0)), FanDetection(25.0, 3)),
    "holes": (HoleFilling("stick", 9, sticks=2), HoleFilling("gaussian", 5, 0.7, 0.4)),
    "probe": ProbeGeometry("sector", (8.0, -6.0)),
    "method": "average",
    "skip": 2,
    "warnings": ("LINEAR is not honored.",),
}


def sweep(frames: int = 7, lost=(2, 3), dtype=np.uint8) -> TrackedSequence:
    """A recording with its calibration, and much else, in its configuration, and a tool that was out of view."""
    images = np.random.default_rng(4).integers(0, 250, (frames, ROWS, COLUMNS)).astype(dtype)
    return calibrated(tracked_sequence(frames, statuses=dict.fromkeys(lost, TransformStatus.OUT_OF_VIEW), images=images), **CONFIGURED)


@pytest.fixture
def converted(scene):
    from AIFReconScene.sweep.sequenceNodes import browserFromSequence

    return browserFromSequence(sweep(), "Sweep")


def back(browser, *arguments) -> TrackedSequence:
    from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

    return sequenceFromBrowser(browser, *arguments)


def proxy(browser, name):
    """The node that a browser replays the sequence of `name` into."""
    nodes = [browser.GetScene().GetNthNode(index) for index in range(browser.GetScene().GetNumberOfNodes())]
    wanted = f"{browser.GetName()}-{name}"
    return next(node for node in nodes if node.GetName() == wanted and browser.IsProxyNodeID(node.GetID()))


# ---- there and back in memory


@pytest.mark.parametrize("dtype", [np.int8, np.int16, np.uint16, np.float32, np.float64])
def test_pixels_of_any_type_come_back(scene, dtype):
    from AIFReconScene.sweep.sequenceNodes import browserFromSequence

    images = back(browserFromSequence(sweep(dtype=dtype), "Sweep")).images
    assert images.dtype == dtype
    assert np.array_equal(np.asarray(images), sweep(dtype=dtype).images)


def test_the_configuration_comes_back_without_the_calibration_that_is_in_the_poses(converted):
    expected = replace(sweep().configuration, transforms={}, image_frame=None, reference_frame=None)
    assert vars(back(converted).configuration) == vars(expected)


def test_what_the_user_should_know_of_the_recording_comes_back(scene):
    from AIFReconScene.sweep.sequenceNodes import browserFromSequence

    told = replace(sweep(), notes=("Images were turned to MF.",))
    assert sweep_poses(back(browserFromSequence(told, "Sweep"))).notes == ("Images were turned to MF.",)


def test_a_transform_that_one_frame_lacks_is_missing_there(scene):
    from AIFReconScene.sweep.sequenceNodes import browserFromSequence

    recording = sweep(lost=())
    del recording.records[4].transforms[TransformName("Probe", "Tracker")]
    assert sweep_poses(back(browserFromSequence(recording, "Sweep"))).usable.tolist() == [0, 1, 2, 3, 5, 6]


# ---- what Slicer shows


@pytest.mark.parametrize("times", [[1.0, 1.0, 2.0], [3.0, 2.0, 1.0], [1.0, None, 2.0], [0.0, 0.0005, 0.001], [0.0, 0.0014, 0.0026]])
def test_times_that_cannot_number_frames_are_kept_beside_frame_numbers(scene, times):
    from AIFReconScene.sweep.sequenceNodes import browserFromSequence

    recording = sweep(len(times), lost=())
    records = [FrameRecord(time, None, r.image_status, r.transforms) for time, r in zip(times, recording.records)]
    browser = browserFromSequence(replace(recording, records=records), "Sweep")
    assert [r.timestamp for r in back(browser).records] == times
    assert [browser.GetMasterSequenceNode().GetNthIndexValue(n) for n in range(len(times))] == ["0", "1", "2"]


def test_replaying_puts_the_image_where_its_pose_says_and_tells_a_frame_out_of_view(converted):
    converted.SetSelectedItemNumber(5)
    image = proxy(converted, "Image")
    assert np.allclose(tinyScene.worldOf(image), sweep_poses(sweep()).image_to_reference[5], atol=1e-9)
    assert np.array_equal(slicer.util.arrayFromVolume(image)[0], sweep().images[5])
    converted.SetSelectedItemNumber(3)
    assert proxy(converted, "ImageToReference").GetAttribute("TransformStatus") == "OUT_OF_VIEW"


# ---- transforms above the sweep


def test_a_corner_pixel_lies_where_slicer_shows_it(scene, converted):
    middle = tinyScene.addTransform("ReferenceToRAS", rigid((30.0, 0.0, 0.0), (-5.0, 0.0, 0.0)), proxy(converted, "ImageToReference"))
    tinyScene.addTransform("Table", rigid((0.0, 0.0, 45.0), (1.0, 2.0, 3.0)), middle)
    corner = np.array([39.0, 29.0, 0.0, 1.0])
    found = sweep_poses(back(converted)).image_to_reference[6] @ corner
    converted.SetSelectedItemNumber(6)
    assert np.allclose(found, tinyScene.worldOf(proxy(converted, "Image")) @ corner, atol=1e-6)


def test_a_transform_that_another_browser_replays_is_refused(scene, converted):
    from AIFReconScene.sweep.sequenceNodes import browserFromSequence

    other = browserFromSequence(sweep(), "Other")
    proxy(converted, "Image").SetAndObserveTransformNodeID(proxy(other, "ImageToReference").GetID())
    with pytest.raises(TransformError, match="replayed by 'Other'"):
        back(converted)


def test_a_pose_that_the_user_changes_counts_although_the_record_has_another(scene, converted):
    poses = converted.GetSequenceNode(proxy(converted, "ImageToReference"))
    moved = rigid((0.0, 0.0, 5.0), (9.0, 9.0, 9.0)) @ np.diag([0.3, 0.5, 0.4, 1.0])
    poses.GetNthDataNode(5).SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(moved))
    assert np.allclose(sweep_poses(back(converted)).image_to_reference[5], moved, atol=1e-12)

"""Messages become frames: which pose an image gets, and when it gets none."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from live_messages import REFERENCE_TO_TRACKER, image, metadata, tracked, transform
from sweeps import image_pose, rigid

from AIFReconLib.errors import SettingsError
from AIFReconLib.geometry.pose_interpolation import interpolate_pose
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.live.pairing.synchronizer import MOST_TRANSFORMS, Synchronizer, SynchronizerSettings
from AIFReconLib.live.wire.messages import StreamEvent
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses
from AIFReconLib.sweep.time_offset import with_time_offset

IMAGE_TO_PROBE = image_pose(rotation_vector_deg=(3, 4, 5), translation=(6, 7, 8))
CALIBRATION = {TransformName("Image", "Probe"): TransformSample(IMAGE_TO_PROBE)}


def configuration(**changes):
    return SimpleNamespace(**{"transforms": CALIBRATION, "image_frame": None, "reference_frame": None, **changes})


def feed(messages, flush=True, calibrated=None, **options):
    synchronizer = Synchronizer(SynchronizerSettings(**options), calibrated)
    frames = [frame for message in messages for frame in synchronizer.feed(message)]
    return frames + (synchronizer.flush() if flush else [])


def statuses(messages, **options):
    return [frame.status for frame in feed(messages, **options)]


def chained(time, probe=True):
    """One frame of a server that sends a bare image and the tools."""
    messages = [image(time, "Image_Image"), transform(time, "ReferenceToTracker", REFERENCE_TO_TRACKER)]
    return [*messages, transform(time, "ProbeToTracker")] if probe else messages


# ---- images that bring their pose


def test_an_image_in_reference_gets_the_matrix_that_came_with_it():
    frame = feed(tracked(1.0))[0]
    assert frame.status == "OK"
    np.testing.assert_array_equal(frame.image_to_reference, image_pose(translation=(1, 2, 3)))


def test_a_frame_comes_out_as_soon_as_its_last_transform_is_there():
    synchronizer = Synchronizer()
    for message in tracked(1.0) + tracked(2.0):
        synchronizer.feed(message)
    decided = [len(synchronizer.feed(message)) for message in tracked(3.0)]
    assert decided == [0, 0, 0, 1]


def test_the_first_image_waits_for_the_next_so_that_all_its_transforms_are_known():
    decided = Synchronizer()
    counts = [len(decided.feed(message)) for message in tracked(1.0) + tracked(2.0)[:1]]
    assert counts == [0, 0, 0, 0, 1]


def test_a_frame_keeps_every_transform_of_its_time():
    frame = feed(tracked(1.0) + tracked(2.0))[1]
    assert {str(name) for name in frame.record.transforms} == {"ImageToReference", "ProbeToTracker", "ReferenceToTracker"}
    np.testing.assert_array_equal(frame.record.transforms[TransformName("Probe", "Tracker")].matrix, transform(2.0, "").matrix)


def test_in_version_1_a_missing_transform_of_the_same_time_tells_that_the_tool_was_not_seen():
    assert statuses(tracked(1.0) + tracked(2.0, probe=False) + tracked(3.0)) == ["OK", "ProbeToTracker MISSING", "OK"]


def test_without_any_transform_the_pose_of_an_image_is_not_confirmed():
    assert all("not confirmed" in status for status in statuses([image(1.0), image(2.0)]))


def test_a_trusted_image_pose_needs_no_transform():
    assert statuses([image(1.0), image(2.0)], trust_image_pose=True, flush=False) == ["OK", "OK"]


def test_the_tools_confirm_where_the_transform_of_the_image_is_not_sent():
    messages = [message for t in (1.0, 2.0, 3.0) for message in tracked(t, probe=t != 2.0) if message.device != "ImageToReference"]
    assert statuses(messages) == ["OK", "ProbeToTracker MISSING", "OK"]


def test_an_identity_in_version_1_is_an_invalid_tool():
    messages = [image(1.0), transform(1.0, "ProbeToTracker", np.eye(4)), transform(1.0, "ImageToReference", np.eye(4))]
    assert statuses([*messages, *tracked(2.0)]) == ["ImageToReference INVALID", "OK"]


def test_an_identity_in_version_2_is_a_pose():
    messages = [image(1.0, "Image_Image", version=2), transform(1.0, "ProbeToReference", np.eye(4), version=2)]
    assert statuses(messages, calibrated=configuration()) == ["OK"]


def test_metadata_of_version_2_name_the_tool_that_was_not_seen():
    told = metadata(ProbeToTracker="OUT_OF_VIEW", ReferenceToTracker="OK", StylusToTracker="OK")
    assert statuses([*tracked(1.0, version=2), image(2.0, metadata=told, version=2)]) == ["OK", "ProbeToTracker OUT_OF_VIEW"]


def test_a_tool_that_does_not_carry_the_image_may_be_invalid():
    told = metadata(ProbeToTracker="OK", ReferenceToTracker="OK", StylusToTracker="INVALID")
    assert statuses([image(1.0, metadata=told, version=2)]) == ["OK"]


def test_where_no_tool_is_called_probe_each_one_counts():
    told = metadata(UsToTracker="OK", ReferenceToTracker="OK", StylusToTracker="INVALID")
    assert statuses([image(1.0, metadata=told, version=2)]) == ["StylusToTracker INVALID"]


def test_a_configuration_tells_which_tools_count():
    told = metadata(UsToTracker="OK", ReferenceToTracker="OK", StylusToTracker="INVALID")
    calibrated = configuration(transforms={TransformName("Image", "Us"): TransformSample(IMAGE_TO_PROBE)})
    assert statuses([image(1.0, metadata=told, version=2)], calibrated=calibrated) == ["OK"]


def test_a_lost_transform_message_does_not_hide_what_the_metadata_confirm():
    told = metadata(ProbeToTracker="OK", ReferenceToTracker="OK")
    messages = [*tracked(1.0, version=2), image(2.0, metadata=told, version=2), *tracked(3.0, version=2)]
    assert statuses(messages) == ["OK", "OK", "OK"]


@pytest.mark.parametrize("bad", [np.full((4, 4), np.nan), np.full((4, 4), np.inf), np.zeros((4, 4))])
def test_an_image_with_an_impossible_matrix_has_no_pose(bad):
    frame = feed(tracked(1.0, pose=bad))[0]
    assert frame.status.startswith("ImageToReference ") or frame.status.startswith("image pose")
    assert frame.image_to_reference is None


def test_an_image_in_another_frame_is_led_on_to_the_reference():
    messages = [image(1.0, "Image_Probe", pose=IMAGE_TO_PROBE), transform(1.0, "ProbeToReference", rigid((1, 2, 3), (4, 5, 6)))]
    np.testing.assert_array_equal(feed(messages)[0].image_to_reference, rigid((1, 2, 3), (4, 5, 6)) @ IMAGE_TO_PROBE)


# ---- what names and quaternions tell


def bare(time, name="Probe", matrix=None, **options):
    return transform(time, name, matrix, **options)


def test_a_tool_s_name_alone_leads_to_the_tracker():
    messages = [[image(t, "Image"), bare(t)] for t in (1.0, 2.0)]
    frame = feed([m for group in messages for m in group], calibrated=configuration(), reference="Tracker")[1]
    np.testing.assert_array_equal(frame.image_to_reference, transform(2.0, "").matrix @ IMAGE_TO_PROBE)


def test_another_frame_of_the_tools_can_be_named():
    messages = [[image(t, "Image"), bare(t)] for t in (1.0, 2.0)]
    options = {"calibrated": configuration(), "tracker_frame": "reference"}
    assert statuses([m for group in messages for m in group], **options) == ["OK", "OK"]


@pytest.mark.parametrize("first", [True, False])
def test_a_whole_name_goes_before_a_tool_s_name_alone(first):
    messages = []
    for t in (1.0, 2.0):
        both = [bare(t, matrix=rigid((0, 0, 0), (99, 0, 0))), transform(t, "ProbeToTracker")]
        messages += [image(t, "Image"), *(both if first else both[::-1])]
    frame = feed(messages, calibrated=configuration(), reference="Tracker")[1]
    np.testing.assert_array_equal(frame.image_to_reference, transform(2.0, "").matrix @ IMAGE_TO_PROBE)


def test_a_whole_matrix_goes_before_a_quaternion():
    messages = []
    for t in (1.0, 2.0):
        turned = replace(transform(t, "ProbeToTracker", rigid((0, 0, 0), (99, 0, 0))), from_quaternion=True)
        messages += [image(t, "Image"), transform(t, "ProbeToTracker"), turned]
    frame = feed(messages, calibrated=configuration(), reference="Tracker")[1]
    np.testing.assert_array_equal(frame.image_to_reference, transform(2.0, "").matrix @ IMAGE_TO_PROBE)


@pytest.mark.parametrize("name", ["ImageToReference", "ReferenceToImage"])
def test_a_quaternion_does_not_place_an_image_for_it_holds_no_size_of_a_pixel(name):
    messages = [[image(t, "Image"), replace(transform(t, name), from_quaternion=True)] for t in (1.0, 2.0)]
    assert set(statuses([m for group in messages for m in group])) == {"nothing says where Image lies in Reference"}


def test_a_transform_that_is_called_as_the_image_is_no_tool():
    messages = [[*chained(t), bare(t, "Image")] for t in (1.0, 2.0)]
    assert statuses([m for group in messages for m in group], calibrated=configuration()) == ["OK", "OK"]


@pytest.mark.parametrize(
    "name",
    [
        "Probe\nElementDataFile = LOCALToTracker",
        "Probe = 1ToTracker",
        "Probe\x85ToTracker",
        "Pro:beToTracker",
        "ProbeToTracker\r",
        "   ",
        "A" * 300 + "ToTracker",
    ],
)
def test_a_name_that_no_recording_can_hold_is_not_used(name):
    messages = [[*tracked(t), transform(t, name)] for t in (1.0, 2.0)]
    frames = feed([m for group in messages for m in group])
    assert {str(name) for frame in frames for name in frame.record.transforms} == {
        "ImageToReference",
        "ProbeToTracker",
        "ReferenceToTracker",
    }


def test_a_name_that_no_recording_can_hold_is_not_taken_from_metadata():
    told = metadata(ProbeToTracker="OK", **{"Pro\nbe = ToTracker": "OK"})
    frame = feed([image(1.0, metadata=told, version=2)])[0]
    assert [str(name) for name in frame.record.transforms] == ["ProbeToTracker", "ImageToReference"]


# ---- images that are placed by a chain


def test_a_bare_image_is_placed_by_calibration_and_tools():
    frame = feed(chained(1.0), calibrated=configuration())[0]
    np.testing.assert_allclose(
        frame.image_to_reference, np.linalg.inv(REFERENCE_TO_TRACKER) @ transform(1.0, "").matrix @ IMAGE_TO_PROBE, atol=1e-9
    )


def test_a_chain_with_a_tool_that_was_not_seen_is_no_pose():
    messages = chained(1.0) + chained(2.0, probe=False) + chained(3.0)
    assert statuses(messages, calibrated=configuration()) == ["OK", "ProbeToTracker MISSING", "OK"]


def test_without_calibration_the_missing_link_is_named():
    synchronizer = Synchronizer()
    for message in chained(1.0):
        synchronizer.feed(message)
    assert [frame.status for frame in synchronizer.flush()] == ["nothing says where Image lies in Reference"]
    assert synchronizer.problem.settings == ("config",)


def repeated(time, moved=0.0, **options):
    """One frame of a server that also sends what it computes of the tools."""
    chain = rigid(translation=(0, 0, moved)) @ np.linalg.inv(REFERENCE_TO_TRACKER) @ transform(time, "").matrix
    return [*chained(time, **options), *([transform(time, "ProbeToReference", chain)] if options.get("probe", True) else [])]


def test_ways_to_the_reference_that_agree_are_one():
    assert statuses([*repeated(1.0), *repeated(2.0)], calibrated=configuration()) == ["OK", "OK"]


def test_ways_to_the_reference_that_disagree_are_not_chosen_from():
    synchronizer = Synchronizer(SynchronizerSettings(), configuration())
    frames = [frame for message in repeated(1.0, moved=3.0) for frame in synchronizer.feed(message)] + synchronizer.flush()
    assert [frame.status for frame in frames] == ["two ways lead from Image to Reference, and disagree"]
    assert "Two paths lead from Image to Reference" in synchronizer.problem


def test_a_chain_that_is_spelled_out_chooses_between_ways():
    calibrated, chain = configuration(), "ImageToProbe,ProbeToReference"
    assert statuses(repeated(1.0, moved=3.0), calibrated=calibrated, image_to_reference=chain) == ["OK"]


def test_a_chain_that_is_spelled_out_goes_before_the_pose_that_an_image_brings():
    messages = [image(1.0), *repeated(1.0)[1:]]
    frame = feed(messages, calibrated=configuration(), image_to_reference="ImageToProbe,ProbeToTracker,ReferenceToTracker")[0]
    expected = np.linalg.inv(REFERENCE_TO_TRACKER) @ transform(1.0, "").matrix @ IMAGE_TO_PROBE
    np.testing.assert_allclose(frame.image_to_reference, expected, atol=1e-9)


def test_a_tool_that_was_not_seen_is_named_among_ways_that_agree():
    messages = [*repeated(1.0), *repeated(2.0, probe=False), *repeated(3.0)]
    assert statuses(messages, calibrated=configuration()) == ["OK", "ProbeToTracker MISSING", "OK"]


@pytest.mark.parametrize("device", ["Image_Reference", "Image"])
def test_a_stylus_that_is_not_seen_costs_no_frame_whatever_is_sent_of_it(device):
    messages = []
    for t, seen in ((1.0, True), (2.0, False)):
        stylus = [
            transform(t, "StylusToTracker"),
            transform(t, "StylusToReference", np.linalg.inv(REFERENCE_TO_TRACKER) @ transform(t, "").matrix),
        ]
        messages += [image(t, device), *repeated(t)[1:], *(stylus if seen else [])]
    assert statuses(messages, calibrated=configuration()) == ["OK", "OK"]


def test_tools_that_are_sent_in_two_ways_confirm_the_pose_of_an_image():
    messages = [[image(t), *repeated(t)[1:]] for t in (1.0, 2.0)]
    assert statuses([message for group in messages for message in group]) == ["OK", "OK"]


@pytest.mark.parametrize(
    "beside",
    [["StylusToStylus"], ["StylusToTracker", "TrackerToStylus"], ["ProbeToTracker", "TrackerToProbe"]],
    ids=lambda names: names[-1],
)
def test_transforms_that_say_nothing_new_cost_no_frame(beside):
    messages = [[*chained(t), *(transform(t, name, np.linalg.inv(transform(t, "").matrix)) for name in beside[1:])] for t in (1.0, 2.0)]
    messages = [[*group, *(transform(t, name) for name in beside[:1])] for t, group in zip((1.0, 2.0), messages, strict=True)]
    assert statuses([message for group in messages for message in group], calibrated=configuration()) == ["OK", "OK"]


def test_where_no_pose_takes_part_the_images_are_not_stacked_in_one_plane():
    synchronizer = Synchronizer(SynchronizerSettings(reference="Probe"), configuration())
    frames = [frame for time in (1.0, 2.0) for message in chained(time) for frame in synchronizer.feed(message)] + synchronizer.flush()
    assert {frame.status for frame in frames} == {"Image is fixed to Probe"}
    assert "all images would lie in one plane" in synchronizer.problem


def test_a_frame_that_moves_is_advised_for_one_that_is_not_sent():
    synchronizer = Synchronizer(SynchronizerSettings(), configuration())
    for time in (1.0, 2.0):
        for message in (image(time, "Image"), transform(time, "ProbeToTracker"), transform(time, "ImageToProbe", IMAGE_TO_PROBE)):
            synchronizer.feed(message)
    synchronizer.flush()
    assert (synchronizer.problem.settings, synchronizer.problem.details) == (("reference",), {"frames": "Tracker"})


def test_metadata_alone_can_place_a_bare_image():
    told = metadata(ProbeToTracker="OK", ReferenceToTracker="OK")
    frame = feed([image(1.0, "Image_Image", metadata=told, version=2)], calibrated=configuration())[0]
    np.testing.assert_allclose(frame.image_to_reference, IMAGE_TO_PROBE, atol=1e-12)


def test_a_named_transform_places_the_image_alone():
    messages = [*chained(1.0), transform(1.0, "ProbeToReference"), transform(1.0, "ImageToTracker", image_pose())]
    frame = feed(messages, calibrated=configuration(), image_to_reference="ImageToTracker")[-1]
    np.testing.assert_array_equal(frame.image_to_reference, image_pose())


# ---- separate streams of images and poses


def separate(image_times, pose_times, **options):
    arrivals = [image(t, "Image_Image") for t in image_times] + [transform(t, "ProbeToReference", **options) for t in pose_times]
    return sorted(arrivals, key=lambda message: message.received)


def test_poses_are_interpolated_at_the_time_of_the_image():
    frame = feed(separate([1.013], [1.0, 1.02, 1.04]), calibrated=configuration())[0]
    expected = interpolate_pose(transform(1.0, "").matrix, transform(1.02, "").matrix, 0.013 / 0.02) @ IMAGE_TO_PROBE
    np.testing.assert_allclose(frame.image_to_reference, expected, atol=1e-9)


def test_an_image_waits_for_the_pose_behind_it():
    synchronizer = Synchronizer(SynchronizerSettings(), configuration())
    decided = [len(synchronizer.feed(message)) for message in separate([1.001, 1.033], [1.0, 1.02, 1.04])]
    assert decided == [0, 0, 0, 1, 1]


def test_a_time_offset_is_added_to_the_times_of_the_images():
    frame = feed(separate([1.113], [1.0, 1.02, 1.04]), calibrated=configuration(), time_offset=-0.1)[0]
    expected = interpolate_pose(transform(1.0, "").matrix, transform(1.02, "").matrix, 0.65) @ IMAGE_TO_PROBE
    np.testing.assert_allclose(frame.image_to_reference, expected, atol=1e-6)


def test_what_metadata_tell_at_another_time_is_no_second_way_beside_what_was_sent():
    told = metadata(ProbeToTracker="OK", ReferenceToTracker="OK")
    messages = [transform(t, "ProbeToReference") for t in (1.0, 1.02, 1.04)]
    messages.insert(2, image(1.113, "Image_Image", metadata=told, version=2))
    assert statuses(messages, calibrated=configuration(), time_offset=-0.1) == ["OK"]


def test_poses_that_lie_too_far_apart_are_stale():
    assert statuses(separate([1.2], [1.0, 1.4]), calibrated=configuration()) == ["ProbeToReference stale"]


def test_a_tracker_that_falls_silent_leaves_images_without_a_pose():
    messages = [*separate([1.01, 1.5, 1.6], [1.0, 1.02]), image(2.0, "Image_Image")]
    assert statuses(messages, calibrated=configuration()) == ["OK", *["ProbeToReference stale"] * 3]


def test_an_image_before_the_first_pose_has_none():
    assert statuses(separate([0.9], [1.0, 1.02]), calibrated=configuration()) == ["ProbeToReference MISSING"]


def test_between_an_invalid_and_a_valid_pose_there_is_none():
    messages = [
        transform(1.0, "ProbeToReference", version=2),
        image(1.01, "Image_Image"),
        transform(1.02, "ProbeToReference", status=TransformStatus.OUT_OF_VIEW, version=2),
    ]
    assert statuses(messages, calibrated=configuration()) == ["ProbeToReference OUT_OF_VIEW"]


def test_nothing_is_interpolated_across_a_jump():
    """At the end of a looped recording the pose jumps from one sample to the next, without a gap in time."""
    messages = [
        transform(1.0, "ProbeToReference", rigid(translation=(0, 0, 1))),
        image(1.01, "Image_Image"),
        transform(1.02, "ProbeToReference", rigid(translation=(0, 80, 1))),
    ]
    assert statuses(messages, calibrated=configuration()) == ["ProbeToReference jumps"]


def test_a_jump_at_a_loop_costs_no_frame_of_a_paired_stream():
    first, second = tracked(1.0), tracked(1.05, pose=image_pose(translation=(500, 0, 0)))
    frames = feed(first + second)
    assert [frame.status for frame in frames] == ["OK", "OK"]
    assert frames[1].image_to_reference[0, 3] == 500


def test_a_pose_that_happens_to_have_an_images_time_does_not_make_the_stream_a_paired_one():
    messages = separate([1.0, 1.05, 1.113], [1.0, 1.01, 1.02, 1.03, 1.04, 1.05, 1.06, 1.1, 1.12])
    assert statuses(messages, calibrated=configuration()) == ["OK", "OK", "OK"]


# ---- time, waiting and the connection


def test_an_image_is_given_up_after_the_patience():
    synchronizer = Synchronizer(SynchronizerSettings(patience=0.25))
    for message in tracked(1.0):
        synchronizer.feed(message)
    synchronizer.feed(image(2.0))
    assert synchronizer.deadline == 2.25
    assert synchronizer.expire(2.24) == []
    assert [frame.status for frame in synchronizer.expire(2.25)] == ["ProbeToTracker MISSING"]


def test_frames_come_out_in_the_order_of_their_images():
    messages = tracked(1.0) + tracked(2.0, probe=False) + tracked(2.05)
    assert [frame.timestamp for frame in feed(messages)] == [1.0, 2.0, 2.05]
    assert [frame.number for frame in feed(messages)] == [0, 1, 2]


def test_old_frames_in_a_burst_get_the_poses_of_their_own_time():
    burst = [message for n in range(40) for message in tracked(1.0 + n / 20, received=3.0, probe=n % 7 != 3)]
    frames = feed(burst)
    assert [frame.status == "OK" for frame in frames] == [n % 7 != 3 for n in range(40)]
    assert all(frame.image_to_reference[0, 3] == frame.timestamp for frame in frames if frame.status == "OK")


def test_images_that_wait_are_bounded():
    synchronizer = Synchronizer(SynchronizerSettings(patience=60.0))
    decided = [frame for n in range(1000) for frame in synchronizer.feed(image(1.0 + n / 100))]
    assert len(decided) >= 1000 - 129


def test_a_recording_that_starts_over_with_its_old_times_uses_no_pose_of_the_first_round():
    again = [image(1.0), image(2.0)]
    assert [frame.status == "OK" for frame in feed(tracked(1.0) + tracked(2.0) + again)] == [True, True, False, False]


def test_images_sent_again_after_a_reconnection_are_not_taken_twice():
    synchronizer = Synchronizer()
    event = StreamEvent("connected", "Connected.", 0.0)
    stream = [event, *tracked(1.0), *tracked(2.0), event, *tracked(2.0), *tracked(3.0)]
    frames = [frame for message in stream for frame in synchronizer.feed(message)] + synchronizer.flush()
    assert [frame.timestamp for frame in frames] == [1.0, 2.0, 3.0]
    assert synchronizer.repeated == 1


def test_a_server_that_stamps_nothing_is_taken_by_time_of_arrival():
    messages = []
    for n in range(20):
        messages.append(transform(0.0, "ProbeToReference", rigid(translation=(n, 0, 1)), received=5 + 0.04 * n))
        messages.append(image(0.0, "Image_Image", received=5 + 0.04 * n + 0.02))
    frames = feed(messages, calibrated=configuration())[5:-1]
    positions = [float(frame.image_to_reference[0, 3] - IMAGE_TO_PROBE[0, 3]) for frame in frames]
    np.testing.assert_allclose(positions, np.arange(5, 19) + 0.5, atol=1e-6)


def test_the_first_image_device_is_taken_and_others_are_counted():
    synchronizer = Synchronizer(SynchronizerSettings(trust_image_pose=True))
    frames = [f for m in (image(1.0), image(1.0, "Other_Reference"), image(2.0)) for f in synchronizer.feed(m)]
    assert len(frames) == 2
    assert synchronizer.other_images == 1


def test_the_image_device_can_be_chosen():
    synchronizer = Synchronizer(SynchronizerSettings(trust_image_pose=True, image_device="Other_Reference"))
    frames = [f for m in (image(1.0), image(1.5, "Other_Reference"), image(2.0)) for f in synchronizer.feed(m)]
    assert [frame.timestamp for frame in frames] == [1.5]


def test_transforms_of_ever_new_names_do_not_fill_the_memory():
    synchronizer = Synchronizer()
    for number in range(3 * MOST_TRANSFORMS):
        synchronizer.feed(transform(1.0, f"Tool{number}ToTracker"))
    assert len(synchronizer._histories) == MOST_TRANSFORMS


@pytest.mark.parametrize("name", ["longest_gap", "patience", "time_offset"])
def test_impossible_times_are_refused(name):
    with pytest.raises(SettingsError, match=name):
        SynchronizerSettings(**{name: float("nan")})


@given(st.permutations(range(4)), st.lists(st.booleans(), min_size=1, max_size=12), st.floats(0.0, 3.0))
@settings(max_examples=60, deadline=None)
def test_no_image_without_its_tool_is_ever_usable(order, seen, delay):
    """Whatever the order within a frame, the arrival and the frames in which the probe is seen."""
    messages = []
    for n, visible in enumerate(seen):
        frame = tracked(1.0 + 0.05 * n, probe=visible, received=4.0 + delay * n)
        messages += [frame[place] for place in order if place < len(frame)]
    frames = feed(messages)
    assert [frame.timestamp for frame in frames] == [1.0 + 0.05 * n for n in range(len(seen))]
    assert [frame.status == "OK" for frame in frames] == seen


def test_a_time_offset_means_what_it_means_offline():
    times = np.arange(1.0, 2.0, 0.05)
    messages = [m for t in times for m in (image(t, "Image_Image"), transform(t, "ProbeToReference"))]
    live = feed(messages, calibrated=configuration(), time_offset=0.02)
    name = TransformName("Probe", "Reference")
    records = [FrameRecord(t, transforms={name: TransformSample(transform(t, "").matrix)}) for t in times]
    sequence = TrackedSequence(np.zeros((len(times), 3, 4), np.uint8), records, configuration=configuration())
    offline = sweep_poses(with_time_offset(sequence, 0.02)).image_to_reference
    for number in range(2, len(times) - 2):
        np.testing.assert_allclose(live[number].image_to_reference, offline[number], atol=1e-6)

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
TO_REFERENCE = np.linalg.inv(REFERENCE_TO_TRACKER)
TWO_WAYS = "two ways lead from Image to Reference, and disagree"
NOTHING_SAYS = "nothing says where Image lies in Reference"
UNCONFIRMED = "pose not confirmed (no transform or status of its tool is sent)"
UNSEEN = ["OK", "ProbeToTracker MISSING", "OK"]


def configuration(source="Probe"):
    transforms = {TransformName("Image", source): TransformSample(IMAGE_TO_PROBE)}
    return SimpleNamespace(transforms=transforms, image_frame=None, reference_frame=None)


CALIBRATED = {"calibrated": configuration()}


def feed(messages, flush=True, calibrated=None, **options):
    synchronizer = Synchronizer(SynchronizerSettings(**options), calibrated)
    frames = [frame for message in messages for frame in synchronizer.feed(message)]
    return frames + (synchronizer.flush() if flush else [])


def seen(time):
    """Where the probe is, in the tracker."""
    return transform(time, "").matrix


def each(make, *times):
    """The messages of a frame at each of the times, one by default."""
    return [message for time in times or (1.0, 2.0) for message in make(time)]


def chained(time, probe=True):
    """One frame of a server that sends a bare image and the tools."""
    messages = [image(time, "Image_Image"), transform(time, "ReferenceToTracker", REFERENCE_TO_TRACKER)]
    return [*messages, transform(time, "ProbeToTracker")] if probe else messages


def repeated(time, moved=0.0, probe=True):
    """One frame of a server that also sends what it computes of the tools."""
    chain = rigid(translation=(0, 0, moved)) @ TO_REFERENCE @ seen(time)
    return [*chained(time, probe), *([transform(time, "ProbeToReference", chain)] if probe else [])]


def separate(image_times, pose_times, **options):
    """Images and poses that come when they were taken."""
    arrivals = [image(t, "Image_Image") for t in image_times] + [transform(t, "ProbeToReference", **options) for t in pose_times]
    return sorted(arrivals, key=lambda message: message.received)


def told(**statuses):
    """An image of version 2 whose metadata tell this of the tools."""
    return image(1.0, metadata=metadata(**statuses), version=2)


def tools_alone(time):
    """A frame without the transform of the image itself."""
    return [message for message in tracked(time, probe=time != 2.0) if message.device != "ImageToReference"]


def beside(*names):
    """Frames with transforms that say nothing new: the first as it is, others inverted."""
    return lambda t: [
        *chained(t),
        *(transform(t, name, np.linalg.inv(seen(t))) for name in names[1:]),
        *(transform(t, name) for name in names[:1]),
    ]


def stylus(device):
    """Frames of a server that computes all it can, of which the second lacks a stylus."""

    def frame(time):
        sent = [transform(time, "StylusToTracker"), transform(time, "StylusToReference", TO_REFERENCE @ seen(time))]
        return [image(time, device), *repeated(time)[1:], *(sent if time == 1.0 else [])]

    return frame


def quaternion(name):
    return lambda t: [image(t, "Image"), replace(transform(t, name), from_quaternion=True)]


BOTH_OK, TOOLS_OK = ["OK", "OK"], {"ProbeToTracker": "OK", "ReferenceToTracker": "OK"}
US = {"UsToTracker": "OK", "ReferenceToTracker": "OK", "StylusToTracker": "INVALID"}
IDENTITY_1 = [image(1.0), transform(1.0, "ProbeToTracker", np.eye(4)), transform(1.0, "ImageToReference", np.eye(4))]
IDENTITY_2 = [image(1.0, "Image_Image", version=2), transform(1.0, "ProbeToReference", np.eye(4), version=2)]
LOST_MESSAGE = [*tracked(1.0, version=2), image(2.0, metadata=metadata(**TOOLS_OK), version=2), *tracked(3.0, version=2)]
UNSEEN_2 = metadata(ProbeToTracker="OUT_OF_VIEW", ReferenceToTracker="OK", StylusToTracker="OK")
AFTER_INVALID = [
    transform(1.0, "ProbeToReference", version=2),
    image(1.01, "Image_Image"),
    transform(1.02, "ProbeToReference", status=TransformStatus.OUT_OF_VIEW, version=2),
]
# At the end of a looped recording the pose jumps from one sample to the next, without a gap in time
JUMP = [
    transform(1.0, "ProbeToReference", rigid(translation=(0, 0, 1))),
    image(1.01, "Image_Image"),
    transform(1.02, "ProbeToReference", rigid(translation=(0, 80, 1))),
]
OTHER_TIME = [
    *(transform(t, "ProbeToReference") for t in (1.0, 1.02)),
    image(1.113, "Image_Image", metadata=metadata(**TOOLS_OK), version=2),
    transform(1.04, "ProbeToReference"),
]

STATUSES = {
    # Images that bring their pose
    "in version 1 a missing transform of the same time tells that the tool was not seen": (
        [*tracked(1.0), *tracked(2.0, probe=False), *tracked(3.0)],
        {},
        UNSEEN,
    ),
    "without any transform the pose is not confirmed": ([image(1.0), image(2.0)], {}, [UNCONFIRMED] * 2),
    "a trusted pose needs no transform": ([image(1.0), image(2.0)], {"trust_image_pose": True, "flush": False}, BOTH_OK),
    "the tools confirm where the image's own transform is not sent": (each(tools_alone, 1.0, 2.0, 3.0), {}, UNSEEN),
    "an identity in version 1 is an invalid tool": ([*IDENTITY_1, *tracked(2.0)], {}, ["ImageToReference INVALID", "OK"]),
    "an identity in version 2 is a pose": (IDENTITY_2, CALIBRATED, ["OK"]),
    "metadata name the tool that was not seen": (
        [*tracked(1.0, version=2), image(2.0, metadata=UNSEEN_2, version=2)],
        {},
        ["OK", "ProbeToTracker OUT_OF_VIEW"],
    ),
    "a tool that does not carry the image may be invalid": ([told(**TOOLS_OK, StylusToTracker="INVALID")], {}, ["OK"]),
    "where no tool is called probe each one counts": ([told(**US)], {}, ["StylusToTracker INVALID"]),
    "a configuration tells which tools count": ([told(**US)], {"calibrated": configuration("Us")}, ["OK"]),
    "a lost message does not hide what metadata confirm": (LOST_MESSAGE, {}, ["OK", "OK", "OK"]),
    "tools that are sent in two ways confirm a pose": (each(lambda t: [image(t), *repeated(t)[1:]]), {}, BOTH_OK),
    # What names and quaternions tell
    "another frame of the tools can be named": (
        each(lambda t: [image(t, "Image"), transform(t, "Probe")]),
        {**CALIBRATED, "tracker_frame": "reference"},
        BOTH_OK,
    ),
    "a quaternion places no image, for it holds no size of a pixel": (each(quaternion("ImageToReference")), {}, [NOTHING_SAYS] * 2),
    "nor does its inverse": (each(quaternion("ReferenceToImage")), {}, [NOTHING_SAYS] * 2),
    "a transform that is called as the image is no tool": (each(lambda t: [*chained(t), transform(t, "Image")]), CALIBRATED, BOTH_OK),
    # Images that are placed by a chain
    "a chain with a tool that was not seen is no pose": (
        [*chained(1.0), *chained(2.0, probe=False), *chained(3.0)],
        CALIBRATED,
        UNSEEN,
    ),
    "ways that agree are one": (each(repeated), CALIBRATED, BOTH_OK),
    "ways that disagree are not chosen from": (repeated(1.0, moved=3.0), CALIBRATED, [TWO_WAYS]),
    "a chain that is spelled out chooses between ways": (
        repeated(1.0, moved=3.0),
        {**CALIBRATED, "image_to_reference": "ImageToProbe,ProbeToReference"},
        ["OK"],
    ),
    "a tool that was not seen is named among ways that agree": (
        [*repeated(1.0), *repeated(2.0, probe=False), *repeated(3.0)],
        CALIBRATED,
        UNSEEN,
    ),
    "a stylus that is not seen costs no frame": (each(stylus("Image_Reference")), CALIBRATED, BOTH_OK),
    "a tool that is sent both ways says nothing new": (each(beside("StylusToTracker", "TrackerToStylus")), CALIBRATED, BOTH_OK),
    # Separate streams of images and poses
    "metadata of another time are no second way": (OTHER_TIME, {**CALIBRATED, "time_offset": -0.1}, ["OK"]),
    "poses that lie too far apart are stale": (separate([1.2], [1.0, 1.4]), CALIBRATED, ["ProbeToReference stale"]),
    "a tracker that falls silent leaves images without a pose": (
        [*separate([1.01, 1.5, 1.6], [1.0, 1.02]), image(2.0, "Image_Image")],
        CALIBRATED,
        ["OK", *["ProbeToReference stale"] * 3],
    ),
    "an image before the first pose has none": (separate([0.9], [1.0, 1.02]), CALIBRATED, ["ProbeToReference MISSING"]),
    "between an invalid and a valid pose there is none": (AFTER_INVALID, CALIBRATED, ["ProbeToReference OUT_OF_VIEW"]),
    "nothing is interpolated across a jump": (JUMP, CALIBRATED, ["ProbeToReference jumps"]),
    "a jump costs no frame of a paired stream": ([*tracked(1.0), *tracked(1.05, pose=image_pose(translation=(500, 0, 0)))], {}, BOTH_OK),
    "a pose that happens to have an image's time does not make a paired stream": (
        separate([1.0, 1.05, 1.113], [1.0, 1.01, 1.02, 1.03, 1.04, 1.05, 1.06, 1.1, 1.12]),
        CALIBRATED,
        ["OK", "OK", "OK"],
    ),
}


@pytest.mark.parametrize(("messages", "options", "expected"), STATUSES.values(), ids=STATUSES)
def test_a_frame_has_the_status_that_its_messages_tell(messages, options, expected):
    assert [frame.status for frame in feed(messages, **options)] == expected


def named_twice(first):
    """A tool under its name alone and under a whole name, in either order."""

    def frame(t):
        both = [transform(t, "Probe", rigid((0, 0, 0), (99, 0, 0))), transform(t, "ProbeToTracker")]
        return [image(t, "Image"), *(both if first else both[::-1])]

    return frame


def turned_too(t):
    turned = replace(transform(t, "ProbeToTracker", rigid((0, 0, 0), (99, 0, 0))), from_quaternion=True)
    return [image(t, "Image"), transform(t, "ProbeToTracker"), turned]


IN_PROBE = [image(1.0, "Image_Probe", pose=IMAGE_TO_PROBE), transform(1.0, "ProbeToReference", rigid((1, 2, 3), (4, 5, 6)))]
NAMED_ALONE = [*chained(1.0), transform(1.0, "ProbeToReference"), transform(1.0, "ImageToTracker", image_pose())]
IN_TRACKER, OF_TRACKER = {**CALIBRATED, "reference": "Tracker"}, seen(2.0) @ IMAGE_TO_PROBE
BETWEEN = [1.0, 1.02, 1.04]
POSES = {
    "the matrix that came with it": (tracked(1.0), {}, image_pose(translation=(1, 2, 3))),
    "led on to the reference": (IN_PROBE, {}, rigid((1, 2, 3), (4, 5, 6)) @ IMAGE_TO_PROBE),
    "a tool's name alone leads to the tracker": (
        each(lambda t: [image(t, "Image"), transform(t, "Probe")]),
        IN_TRACKER,
        OF_TRACKER,
    ),
    "a whole name goes before a tool's name alone": (each(named_twice(True)), IN_TRACKER, OF_TRACKER),
    "a whole matrix goes before a quaternion": (each(turned_too), IN_TRACKER, OF_TRACKER),
    "by calibration and tools": (chained(1.0), CALIBRATED, TO_REFERENCE @ seen(1.0) @ IMAGE_TO_PROBE),
    "a chain that is spelled out goes before the pose of the image": (
        [image(1.0), *repeated(1.0)[1:]],
        {**CALIBRATED, "image_to_reference": "ImageToProbe,ProbeToTracker,ReferenceToTracker"},
        TO_REFERENCE @ seen(1.0) @ IMAGE_TO_PROBE,
    ),
    "metadata alone": ([image(1.0, "Image_Image", metadata=metadata(**TOOLS_OK), version=2)], CALIBRATED, IMAGE_TO_PROBE),
    "a named transform alone": (NAMED_ALONE, {**CALIBRATED, "image_to_reference": "ImageToTracker"}, image_pose()),
    "interpolated": (separate([1.013], BETWEEN), CALIBRATED, interpolate_pose(seen(1.0), seen(1.02), 0.65) @ IMAGE_TO_PROBE),
    "at an offset": (
        separate([1.113], BETWEEN),
        {**CALIBRATED, "time_offset": -0.1},
        interpolate_pose(seen(1.0), seen(1.02), 0.65) @ IMAGE_TO_PROBE,
    ),
}


@pytest.mark.parametrize(("messages", "options", "expected"), POSES.values(), ids=POSES)
def test_an_image_lies_where_its_messages_put_it(messages, options, expected):
    np.testing.assert_allclose(feed(messages, **options)[-1].image_to_reference, expected, atol=1e-6)


@pytest.mark.parametrize("bad", [np.full((4, 4), np.nan), np.full((4, 4), np.inf), np.zeros((4, 4))])
def test_an_image_with_an_impossible_matrix_has_no_pose(bad):
    frame = feed(tracked(1.0, pose=bad))[0]
    assert frame.status.startswith(("ImageToReference ", "image pose"))
    assert frame.image_to_reference is None


# ---- what is told of it

MOVING = each(lambda t: [image(t, "Image"), transform(t, "ProbeToTracker"), transform(t, "ImageToProbe", IMAGE_TO_PROBE)])


UNPLACED = {
    "no calibration": (chained(1.0), {}, "Nothing says where Image lies in Reference", ("config",)),
    "two ways": (repeated(1.0, moved=3.0), CALIBRATED, "Two paths lead from Image to Reference", None),
    "one plane": (each(chained), {**CALIBRATED, "reference": "Probe"}, "all images would lie in one plane", None),
    "another reference": (MOVING, CALIBRATED, "Tracker", ("reference",)),
}


@pytest.mark.parametrize(("messages", "options", "says", "advised"), UNPLACED.values(), ids=UNPLACED)
def test_why_no_image_can_be_placed_is_told_in_full(messages, options, says, advised):
    synchronizer = Synchronizer(SynchronizerSettings(reference=options.get("reference")), options.get("calibrated"))
    for message in messages:
        synchronizer.feed(message)
    synchronizer.flush()
    assert says in f"{synchronizer.problem} {synchronizer.problem.details}"
    assert advised is None or synchronizer.problem.settings == advised


def names_of(frame):
    return {str(name) for name in frame.record.transforms}


ALL_NAMES = {"ImageToReference", "ProbeToTracker", "ReferenceToTracker"}


UNHELD = (
    "Probe\nElementDataFile = LOCALToTracker",
    "Probe = 1ToTracker",
    "Probe\x85ToTracker",
    "Pro:beToTracker",
    "ProbeToTracker\r",
    "   ",
)


@pytest.mark.parametrize("name", UNHELD)
def test_a_frame_keeps_every_transform_of_its_time_but_names_that_no_recording_can_hold(name):
    last = feed(each(lambda t: [*tracked(t), transform(t, name)]))[1]
    assert names_of(last) == ALL_NAMES
    np.testing.assert_array_equal(last.record.transforms[TransformName("Probe", "Tracker")].matrix, seen(2.0))
    of_metadata = feed([image(1.0, metadata=metadata(ProbeToTracker="OK", **{name: "OK"}), version=2)])[0]
    assert names_of(of_metadata) == ALL_NAMES - {"ReferenceToTracker"}


# ---- time, waiting and the connection


@pytest.mark.parametrize(
    ("messages", "options", "counts"),
    [
        # The first image waits for the next, so that all its transforms are known; others for their last transform
        ([*tracked(1.0), *tracked(2.0), *tracked(3.0)], None, [0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1]),
        (separate([1.001, 1.033], BETWEEN), configuration(), [0, 0, 0, 1, 1]),
    ],
    ids=["paired", "separate"],
)
def test_a_frame_comes_out_as_soon_as_what_it_needs_is_there(messages, options, counts):
    synchronizer = Synchronizer(SynchronizerSettings(), options)
    assert [len(synchronizer.feed(message)) for message in messages] == counts


def test_an_image_is_given_up_after_the_patience():
    synchronizer = Synchronizer(SynchronizerSettings(patience=0.25))
    for message in [*tracked(1.0), image(2.0)]:
        synchronizer.feed(message)
    assert synchronizer.deadline == 2.25
    assert synchronizer.expire(2.24) == []
    assert [frame.status for frame in synchronizer.expire(2.25)] == ["ProbeToTracker MISSING"]


def test_old_frames_in_a_burst_get_the_poses_of_their_own_time():
    frames = feed([message for n in range(40) for message in tracked(1.0 + n / 20, received=3.0, probe=n % 7 != 3)])
    assert [frame.status == "OK" for frame in frames] == [n % 7 != 3 for n in range(40)]
    assert all(frame.image_to_reference[0, 3] == frame.timestamp for frame in frames if frame.status == "OK")


def test_images_that_wait_and_transforms_of_ever_new_names_are_bounded():
    synchronizer = Synchronizer(SynchronizerSettings(patience=60.0))
    decided = [frame for n in range(1000) for frame in synchronizer.feed(image(1.0 + n / 100))]
    assert len(decided) >= 1000 - 129
    for number in range(3 * MOST_TRANSFORMS):
        synchronizer.feed(transform(1.0, f"Tool{number}ToTracker"))
    synchronizer.feed(image(99.0))
    assert len(synchronizer.flush()[-1].record.transforms) <= MOST_TRANSFORMS + 1


def test_a_recording_that_starts_over_with_its_old_times_uses_no_pose_of_the_first_round():
    frames = feed([*tracked(1.0), *tracked(2.0), image(1.0), image(2.0)])
    assert [frame.status == "OK" for frame in frames] == [True, True, False, False]


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
    frames = feed(messages, **CALIBRATED)[5:-1]
    positions = [float(frame.image_to_reference[0, 3] - IMAGE_TO_PROBE[0, 3]) for frame in frames]
    np.testing.assert_allclose(positions, np.arange(5, 19) + 0.5, atol=1e-6)


@pytest.mark.parametrize(("device", "times", "others"), [(None, [1.0, 2.0], 1), ("Other_Reference", [1.5], 2)])
def test_the_first_image_device_is_taken_or_the_one_that_was_chosen_and_others_are_counted(device, times, others):
    synchronizer = Synchronizer(SynchronizerSettings(trust_image_pose=True, image_device=device))
    frames = [f for m in (image(1.0), image(1.5, "Other_Reference"), image(2.0)) for f in synchronizer.feed(m)]
    assert ([frame.timestamp for frame in frames], synchronizer.other_images) == (times, others)


FRACTIONS = [1_700_000_000 + number / 20 for number in range(100)]
SECONDS, NONE = [time // 1 for time in FRACTIONS], [0.0] * 100


@pytest.mark.parametrize(
    ("images", "poses", "who"),
    [(SECONDS, FRACTIONS, "images"), (FRACTIONS, SECONDS, "ProbeToTracker"), (FRACTIONS, FRACTIONS, None), (NONE, NONE, None)],
)
def test_time_stamps_in_whole_seconds_are_told_but_not_those_with_fractions_or_none_at_all(images, poses, who):
    synchronizer = Synchronizer()
    for number, (of_image, of_pose) in enumerate(zip(images, poses, strict=True)):
        for message in (image(of_image, "Image"), *[transform(of_pose, "ProbeToTracker")] * 2):
            synchronizer.feed(replace(message, received=number / 20))
    says = synchronizer.note
    assert says is None if who is None else says.startswith(f"The time stamps of {who} are whole seconds")


@pytest.mark.parametrize("name", ["longest_gap", "patience", "time_offset"])
def test_impossible_times_are_refused(name):
    with pytest.raises(SettingsError, match=name):
        SynchronizerSettings(**{name: float("nan")})


@given(st.permutations(range(4)), st.lists(st.booleans(), min_size=1, max_size=12), st.floats(0.0, 3.0))
@settings(max_examples=60, deadline=None)
def test_no_image_without_its_tool_is_ever_usable(order, visible, delay):
    """Whatever the order within a frame, the arrival and the frames in which the probe is seen."""
    messages = []
    for n, probe in enumerate(visible):
        frame = tracked(1.0 + 0.05 * n, probe=probe, received=4.0 + delay * n)
        messages += [frame[place] for place in order if place < len(frame)]
    frames = feed(messages)
    assert [frame.timestamp for frame in frames] == [1.0 + 0.05 * n for n in range(len(visible))]
    assert [frame.status == "OK" for frame in frames] == visible


def test_a_time_offset_means_what_it_means_offline():
    times = np.arange(1.0, 2.0, 0.05)
    live = feed(separate(times, times), **CALIBRATED, time_offset=0.02)
    name = TransformName("Probe", "Reference")
    records = [FrameRecord(t, transforms={name: TransformSample(seen(t))}) for t in times]
    sequence = TrackedSequence(np.zeros((len(times), 3, 4), np.uint8), records, configuration=configuration())
    offline = sweep_poses(with_time_offset(sequence, 0.02)).image_to_reference
    for number in range(2, len(times) - 2):
        np.testing.assert_allclose(live[number].image_to_reference, offline[number], atol=1e-6)

"""Where frames lie and why some cannot be used."""

from __future__ import annotations

import numpy as np
import pytest
from geometry_strategies import rigid, scaled

from AIFReconLib.errors import TransformError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.edits import crop, recalibrate
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import chain_ends, describe_frames, sweep_poses, time_order, tracked_frames

IMAGE_TO_PROBE = rigid((0.1, 0.2, -0.3), (5.0, 6.0, 7.0)) @ scaled(0.2, 0.3, 0.25)
PROBE_TO_TRACKER = rigid((1.1, -0.4, 0.2), (100.0, 50.0, -20.0))
REFERENCE_TO_TRACKER = rigid((-0.5, 0.9, 1.4), (-30.0, 10.0, 400.0))
IMAGE_TO_REFERENCE = np.linalg.inv(REFERENCE_TO_TRACKER) @ PROBE_TO_TRACKER @ IMAGE_TO_PROBE


def samples(transforms: dict) -> dict[TransformName, TransformSample]:
    """Named samples from matrices, or from (matrix, status) pairs."""
    return {
        TransformName.parse(name): TransformSample(*(value if isinstance(value, tuple) else (value,))) for name, value in transforms.items()
    }


def record(changes: dict | None = None, **others) -> FrameRecord:
    """A frame with probe and reference in view, with some transforms changed; None removes one."""
    transforms = {"ProbeToTracker": PROBE_TO_TRACKER, "ReferenceToTracker": REFERENCE_TO_TRACKER} | (changes or {})
    return FrameRecord(transforms=samples({name: value for name, value in transforms.items() if value is not None}), **others)


def configuration(transforms: dict | None = None, **others) -> PlusConfiguration:
    """With what `sweep_poses` reads of one."""
    return PlusConfiguration(transforms=samples({"ImageToProbe": IMAGE_TO_PROBE} if transforms is None else transforms), **others)


def sweep(*records: FrameRecord, calibration=True, **others) -> TrackedSequence:
    """A sequence of black images with these records and, unless told otherwise, a calibration."""
    if calibration:
        others.setdefault("configuration", configuration())
    return TrackedSequence(np.zeros((len(records), 4, 5), np.uint8), list(records), **others)


def only_problem(changes: dict, **others) -> str | None:
    """The problem of the second of three frames, the others being good."""
    poses = sweep_poses(sweep(record(), record(changes, **others), record()))
    assert poses.problems[::2] == (None, None)
    return poses.problems[1]


def test_a_pose_is_the_product_of_the_chain():
    np.testing.assert_allclose(sweep_poses(sweep(record())).image_to_reference[0], IMAGE_TO_REFERENCE, atol=1e-9)


@pytest.mark.parametrize("name", ["ReferenceToTracker", "TrackerToReference"])
def test_what_is_recorded_goes_before_a_configuration_whichever_way_round_that_says_it(name):
    older = configuration({"ImageToProbe": IMAGE_TO_PROBE, name: rigid((0.3, 0.0, 0.0), (1.0, 2.0, 3.0))})
    poses = sweep_poses(sweep(record(), configuration=older))
    np.testing.assert_allclose(poses.image_to_reference[0], IMAGE_TO_REFERENCE, atol=1e-9)
    assert poses.notes == (f"{name} is in the recording and in the configuration; the recording's is used.",)


def test_every_frame_has_its_own_pose():
    moved = rigid((0, 0, 0), (1.0, 2.0, 3.0)) @ PROBE_TO_TRACKER
    poses = sweep_poses(sweep(record(), record({"ProbeToTracker": moved})))
    expected = np.linalg.inv(REFERENCE_TO_TRACKER) @ moved @ IMAGE_TO_PROBE
    np.testing.assert_allclose(poses.image_to_reference[1], expected, atol=1e-9)


@pytest.mark.parametrize("link", ["ProbeToTracker", "ReferenceToTracker"])
@pytest.mark.parametrize(
    ("value", "problem"),
    [
        ((PROBE_TO_TRACKER, TransformStatus.OUT_OF_VIEW), "OUT_OF_VIEW"),
        ((PROBE_TO_TRACKER, TransformStatus.UNKNOWN), "UNKNOWN"),
        ((np.full((4, 4), np.nan), TransformStatus.MISSING), "MISSING"),
        (None, "not recorded"),
        (np.full((4, 4), np.nan), "not finite"),
        (PROBE_TO_TRACKER @ scaled(1.1, 1.1, 1.1), "not rigid (scaled or sheared)"),
        (PROBE_TO_TRACKER @ scaled(1, 1, -1), "not rigid (mirrored)"),
        (np.diag([0.0, 0.0, 0.0, 1.0]), "not rigid (scaled or sheared)"),
        (np.zeros((4, 4)), "not a pose (last row is not 0 0 0 1)"),
        (rigid((0, 0, 0), (-3.697314e28, 0, 0)), "not a pose (numbers too large)"),
    ],
)
def test_a_link_that_cannot_be_used_costs_its_frame_and_no_other(link, value, problem):
    assert only_problem({link: value}) == f"{link} {problem}"


def test_a_frame_without_an_image_is_skipped_whatever_its_pose():
    assert only_problem({}, image_status=TransformStatus.INVALID) == "no image (INVALID)"


def test_a_transform_that_one_frame_holds_the_other_way_round_is_turned():
    inverted = record({"ProbeToTracker": None, "TrackerToProbe": np.linalg.inv(PROBE_TO_TRACKER)})
    poses = sweep_poses(sweep(record(), inverted, record()))
    np.testing.assert_allclose(poses.image_to_reference, np.stack([IMAGE_TO_REFERENCE] * 3), atol=1e-9)


def test_a_recording_may_hold_the_inverse_of_what_is_needed():
    frame = record({"ProbeToTracker": None, "TrackerToProbe": np.linalg.inv(PROBE_TO_TRACKER)})
    np.testing.assert_allclose(sweep_poses(sweep(frame)).image_to_reference[0], IMAGE_TO_REFERENCE, atol=1e-9)


def test_a_transform_of_the_header_holds_for_every_frame():
    sequence = sweep(record({"ReferenceToTracker": None}), record({"ReferenceToTracker": None}))
    sequence = sweep(*sequence.records, transforms=samples({"ReferenceToTracker": REFERENCE_TO_TRACKER}))
    assert sweep_poses(sequence).usable.tolist() == [0, 1]


def test_a_configuration_does_not_stand_in_where_a_frame_lacks_a_recorded_transform():
    given = configuration({"ImageToProbe": IMAGE_TO_PROBE, "ProbeToTracker": np.eye(4)})
    poses = sweep_poses(sweep(record(), record({"ProbeToTracker": None}), configuration=given))
    assert poses.problems == (None, "ProbeToTracker not recorded")


REPEATED = {"ProbeToReference": np.linalg.inv(REFERENCE_TO_TRACKER) @ PROBE_TO_TRACKER}
"""What servers compute of tools that they send too."""


def test_transforms_that_repeat_what_others_say_place_the_image_as_those_do():
    poses = sweep_poses(sweep(record(REPEATED), record(REPEATED)))
    np.testing.assert_allclose(poses.image_to_reference, np.stack([IMAGE_TO_REFERENCE] * 2), atol=1e-9)


def test_a_calibration_beside_a_recorded_image_pose_that_agrees_is_one_way():
    written = np.round(IMAGE_TO_REFERENCE, 4)  # as files round
    assert sweep_poses(sweep(record({"ImageToReference": written}))).problems == (None,)


def test_a_tool_on_either_way_that_is_not_seen_leaves_the_frame_out():
    hidden = {**REPEATED, "ProbeToTracker": (PROBE_TO_TRACKER, TransformStatus.OUT_OF_VIEW)}
    assert sweep_poses(sweep(record(hidden))).problems == ("ProbeToTracker OUT_OF_VIEW",)


STYLUS = {"StylusToTracker": np.eye(4), "StylusToReference": np.linalg.inv(REFERENCE_TO_TRACKER)}


def test_a_tool_that_the_image_can_do_without_may_be_unseen():
    hidden = {name: (np.full((4, 4), np.nan), TransformStatus.INVALID) for name in STYLUS}
    assert sweep_poses(sweep(record(STYLUS), record(hidden))).problems == (None, None)


def test_the_tool_of_the_image_is_named_before_another_one():
    hidden = dict.fromkeys([*STYLUS, "ProbeToTracker"], (np.full((4, 4), np.nan), TransformStatus.INVALID))
    assert sweep_poses(sweep(record(STYLUS), record(hidden))).problems[1] == "ProbeToTracker INVALID"


@pytest.mark.parametrize("beside", [{"ProbeToProbe": np.eye(4)}, {"StylusToTracker": np.eye(4), "TrackerToStylus": 2 * np.eye(4)}])
def test_what_is_on_no_way_to_the_reference_is_not_asked(beside):
    assert sweep_poses(sweep(record(beside))).problems == (None,)


SHIFTED = {"ProbeToReference": rigid((0, 0, 0), (0, 0, 3)) @ REPEATED["ProbeToReference"]}


def test_ways_that_disagree_in_one_frame_are_named_with_it():
    with pytest.raises(TransformError, match=r"Two paths lead from Image to Reference: .* They differ by 3 mm in frame 1") as caught:
        sweep_poses(sweep(record(REPEATED), record(SHIFTED)))
    assert "ImageToProbe > ProbeToTracker > TrackerToReference" in str(caught.value)


@pytest.mark.parametrize(
    ("chain", "moved"), [("ImageToProbe,ProbeToReference", 3.0), ("ImageToProbe, ProbeToTracker, ReferenceToTracker", 0.0)]
)
def test_a_chain_that_is_spelled_out_chooses_between_ways_that_disagree(chain, moved):
    poses = sweep_poses(sweep(record(SHIFTED)), image_to_reference=chain)
    np.testing.assert_allclose(poses.image_to_reference[0], rigid((0, 0, 0), (0, 0, moved)) @ IMAGE_TO_REFERENCE, atol=1e-9)


def test_a_recorded_image_pose_named_explicitly_wins_over_a_second_path():
    shifted = rigid((0, 0, 0), (9, 9, 9)) @ IMAGE_TO_REFERENCE
    poses = sweep_poses(sweep(record({"ImageToReference": shifted})), image_to_reference="ImageToReference")
    np.testing.assert_allclose(poses.image_to_reference[0], shifted)


def test_a_recorded_image_pose_alone_needs_no_calibration():
    frame = FrameRecord(transforms=samples({"ImageToReference": IMAGE_TO_REFERENCE}))
    np.testing.assert_allclose(sweep_poses(sweep(frame, calibration=False)).image_to_reference[0], IMAGE_TO_REFERENCE)


@pytest.mark.parametrize(
    ("matrix", "problem"),
    [
        (IMAGE_TO_REFERENCE @ scaled(0, 1, 1), "image pose singular (a pixel has no size)"),
        (IMAGE_TO_REFERENCE @ np.array([[1, 0.5, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]), "image pose sheared"),
        (np.full((4, 4), np.nan), "ImageToReference not finite"),
        (np.ones((4, 4)), "ImageToReference not a pose (last row"),
    ],
)
def test_a_recorded_image_pose_that_places_no_pixels_says_why(matrix, problem):
    frame = FrameRecord(transforms=samples({"ImageToReference": matrix}))
    assert sweep_poses(sweep(frame, calibration=False)).problems[0].startswith(problem)


def test_the_configuration_names_image_and_reference():
    given = configuration({"PictureToProbe": IMAGE_TO_PROBE}, image_frame="Picture", reference_frame="Tracker")
    poses = sweep_poses(sweep(record(), configuration=given))
    assert [str(name) for name in poses.path] == ["PictureToProbe", "ProbeToTracker"]


def test_a_named_transform_and_a_named_reference_go_together():
    ends, _ = chain_ends(sweep(record()).configuration, "PictureToTracker", "Patient")
    assert str(ends) == "PictureToPatient"


def test_a_recording_without_a_calibration_says_how_to_give_it():
    with pytest.raises(TransformError, match="Nothing says where Image lies in Reference"):
        sweep_poses(sweep(record(), calibration=False))


def test_a_frame_that_the_image_is_fixed_to_is_never_advised():
    constant = {"ProbeToTracker": None, "ReferenceToTracker": None, "ImageToProbe": IMAGE_TO_PROBE}
    with pytest.raises(TransformError, match="No pose of a tool leads on from there"):
        sweep_poses(sweep(record(constant), record(constant), calibration=False))


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ([], "0 frames ()"),
        ([7], "1 frame (7)"),
        ([0, 1], "2 frames (0-1)"),
        ([0, 1, 2, 5, 8, 9], "6 frames (0-2, 5, 8-9)"),
        ([0, 2, 4, 6], "4 frames (0, 2, 4, 6)"),
        ([0, 2, 4, 6, 8], "5 frames (0, 2, 4, 6, ...)"),
    ],
)
def test_frame_numbers_are_described_in_runs(numbers, words):
    assert describe_frames(numbers) == words


@pytest.mark.parametrize(
    ("timestamps", "order"),
    [
        ([1.0, 2.0, 3.0], [0, 1, 2]),
        ([3.0, 1.0, 2.0], [1, 2, 0]),
        ([2.0, 1.0, 2.0, 1.0, 2.0], [1, 3, 0, 2, 4]),
        ([3.0, None, 1.0], [0, 1, 2]),
        ([3.0, np.nan, 1.0], [0, 1, 2]),
        ([np.inf, 1.0], [0, 1]),
        ([float(n % 2) for n in range(60)], [*range(0, 60, 2), *range(1, 60, 2)]),
        ([], []),
    ],
)
def test_frames_go_in_time_order_where_all_times_are_known(timestamps, order):
    assert time_order(sweep(*(record(timestamp=t) for t in timestamps))).tolist() == order


def test_frames_are_handed_out_with_their_number_image_and_pose():
    sequence = sweep(record(), record({"ProbeToTracker": None}), record())
    sequence.images[2] = 7
    poses = sweep_poses(sequence)
    frame = next(iter(tracked_frames(sequence, poses, [2])))
    assert (frame.number, frame.status, int(frame.image.min())) == (2, "OK", 7)


CROP = np.eye(4)
CROP[:2, 3] = -3.0, -7.0


@pytest.mark.parametrize("name", ["ImageToCroppedImage", "CroppedImageToImage"])
@pytest.mark.parametrize("options", [{}, {"image_to_reference": "ImageToReference"}, {"image_to_reference": "CroppedImageToReference"}])
def test_the_first_pixel_of_a_cropped_image_lies_where_it_was_in_the_whole_one(name, options):
    cropped = record({name: CROP if name.startswith("Image") else np.linalg.inv(CROP)})
    found = sweep_poses(sweep(cropped), **options).image_to_reference[0]
    np.testing.assert_allclose(found @ (0, 0, 0, 1), IMAGE_TO_REFERENCE @ (3, 7, 0, 1), atol=1e-9)


def test_a_cropped_image_of_a_recorded_pose_may_be_asked_for_by_its_name():
    recorded = FrameRecord(transforms=samples({"ImageToReference": IMAGE_TO_REFERENCE, "ImageToCroppedImage": CROP}))
    found = sweep_poses(sweep(recorded, calibration=False), "CroppedImageToReference")
    np.testing.assert_allclose(found.image_to_reference[0] @ (0, 0, 0, 1), IMAGE_TO_REFERENCE @ (3, 7, 0, 1), atol=1e-9)


def test_a_frame_that_does_not_say_how_it_was_cropped_is_not_placed_as_the_others():
    poses = sweep_poses(sweep(record({"ImageToCroppedImage": CROP}), record()))
    assert poses.problems == (None, "ImageToCroppedImage not recorded")


def test_a_part_of_a_cropped_image_stays_in_its_place():
    cropped = crop(sweep(record({"ImageToCroppedImage": CROP})), 1, 2, 3, 2)
    found = sweep_poses(cropped).image_to_reference[0]
    np.testing.assert_allclose(found @ (0, 0, 0, 1), IMAGE_TO_REFERENCE @ (4, 9, 0, 1), atol=1e-9)


def test_another_calibration_leaves_the_crop_as_it_is():
    recorded = FrameRecord(transforms=samples({"ImageToReference": IMAGE_TO_REFERENCE, "ImageToCroppedImage": CROP}))
    new = IMAGE_TO_PROBE @ np.diag([2.0, 2.0, 2.0, 1.0])
    changed = recalibrate(sweep(recorded, calibration=False), TransformName("Image", "Probe"), new, IMAGE_TO_PROBE)
    found = sweep_poses(changed, "ImageToReference").image_to_reference[0]
    np.testing.assert_allclose(found @ (0, 0, 0, 1), IMAGE_TO_REFERENCE @ (6, 14, 0, 1), atol=1e-9)


SIZE = (0.25, 0.5)


def notes_on_size(*stated, scales=(1.0,)) -> tuple[str, ...]:
    """Notes on frames that state these sizes, whose poses place pixels of `SIZE`, times `scales`, apart."""
    matrices = [np.diag([SIZE[0] * scale, SIZE[1] * scale, 1.0, 1.0]) for scale in np.resize(scales, len(stated))]
    records = [FrameRecord(transforms=samples({"ImageToReference": matrix}), stated_spacing=size) for matrix, size in zip(matrices, stated)]
    return sweep_poses(sweep(*records, calibration=False)).notes


@pytest.mark.parametrize("size", [None, SIZE, (0.251, 0.495)])
def test_a_stated_size_of_a_pixel_that_poses_agree_with_needs_no_word(size):
    assert notes_on_size(size, size) == ()


@pytest.mark.parametrize("size", [(0.2, 0.5), (0.25, 0.7), (0.5, 0.25)])
def test_a_stated_size_of_a_pixel_that_is_not_that_of_the_poses_is_named(size):
    (note,) = notes_on_size(size, size)
    assert note.startswith("The recording says that a pixel of frame 0 is ")
    assert note.endswith("places pixels 0.25 x 0.5 mm apart, and so they are placed, as in Plus: is the calibration that of another depth?")


def test_rigid_poses_of_images_whose_pixels_have_a_size_are_said_to_lack_it():
    poses = sweep_poses(sweep(FrameRecord(transforms=samples({"ImageToReference": np.eye(4)}), stated_spacing=SIZE), calibration=False))
    assert "is 0.25 x 0.5 mm, but ImageToReference places pixels 1 x 1 mm apart" in poses.notes[0]
    assert poses.notes[0].endswith("it is rigid, so it may lack the size of a pixel, which belongs into the calibration.")
    np.testing.assert_array_equal(poses.image_to_reference[0], np.eye(4))


def test_a_size_that_changes_while_the_poses_stay_is_one_note_with_frame_and_sizes():
    (note,) = notes_on_size(SIZE, SIZE, (0.5, 1.0), (0.5, 1.0))
    assert note.endswith("the size changes in frame 2 from 0.25 x 0.5 to 0.5 x 1 mm, and a calibration holds for one depth.")


def test_poses_that_change_while_the_stated_size_stays_are_named():
    (note,) = notes_on_size(SIZE, SIZE, scales=(1.0, 2.0))
    assert "a pixel of frame 1 is 0.25 x 0.5 mm, but ImageToReference places pixels 0.5 x 1 mm apart" in note


@pytest.mark.parametrize(
    ("scale", "says"),
    [([1e-3, 1e-3], "An image would be 0.02 x 0.015 mm"), ([1, 1e-3], "The sweep spans 0.029 mm"), ([1, 1], "")],
    ids=["all", "places", "none"],
)
def test_poses_in_meters_are_told(scale, says):
    poses = np.tile(np.eye(4), (30, 1, 1))
    poses[:, :3, :3] *= 0.5 * scale[0]
    poses[:, 2, 3] = np.arange(30) * scale[1]
    notes = sweep_poses(TrackedSequence.from_arrays(np.zeros((30, 30, 40), np.uint8), poses)).notes
    assert [says in note for note in notes] == ([True] if says else [])


@pytest.mark.parametrize(("few", "told"), [(1, True), (2, True), (20, False)], ids=["one", "two of a hundred", "another place"])
def test_frames_that_lie_far_off_all_others_are_told(few, told):
    poses = np.tile(np.diag([0.5, 0.5, 0.5, 1.0]), (100, 1, 1))
    poses[:, 2, 3] = np.arange(100)
    poses[40 : 40 + few, 1, 3] = -300.0
    notes = sweep_poses(TrackedSequence.from_arrays(np.zeros((100, 30, 40), np.uint8), poses)).notes
    which = "Frame 40 lies" if few == 1 else "Frames 40, 41 lie"
    assert [f"WARNING: {which} more than 50 mm off all others" in note for note in notes] == [True] * told

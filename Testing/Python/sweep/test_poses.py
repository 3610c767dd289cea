"""Where frames lie and why some cannot be used."""

from __future__ import annotations

import numpy as np
import pytest
from geometry_strategies import IMAGE_TO_PROBE, PROBE_TO_TRACKER, REFERENCE_TO_TRACKER, rigid, scaled

from AIFReconLib.errors import TransformError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.edits import crop, recalibrate
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import chain_ends, describe_frames, sweep_poses, time_order, tracked_frames

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


LOST = np.full((4, 4), np.nan)
UNUSABLE = [
    ((PROBE_TO_TRACKER, TransformStatus.OUT_OF_VIEW), "OUT_OF_VIEW"),
    ((PROBE_TO_TRACKER, TransformStatus.UNKNOWN), "UNKNOWN"),
    ((LOST, TransformStatus.MISSING), "MISSING"),
    (None, "not recorded"),
    (LOST, "not finite"),
    (PROBE_TO_TRACKER @ scaled(1.1, 1.1, 1.1), "not rigid (scaled or sheared)"),
    (np.zeros((4, 4)), "not a pose (last row is not 0 0 0 1)"),
    (rigid((0, 0, 0), (-3.697314e28, 0, 0)), "not a pose (numbers too large)"),
]
REPEATED = {"ProbeToReference": np.linalg.inv(REFERENCE_TO_TRACKER) @ PROBE_TO_TRACKER}
"""What servers compute of tools that they send too."""
STYLUS = {"StylusToTracker": np.eye(4), "StylusToReference": np.linalg.inv(REFERENCE_TO_TRACKER)}
UNSEEN = dict.fromkeys(STYLUS, (LOST, TransformStatus.INVALID))
INVERSE = {"ProbeToTracker": None, "TrackerToProbe": np.linalg.inv(PROBE_TO_TRACKER)}
WRITTEN = {"ImageToReference": np.round(IMAGE_TO_REFERENCE, 4)}  # as files round
CROP = np.eye(4)
CROP[:2, 3] = -3.0, -7.0


@pytest.mark.parametrize(
    ("beside", "changes", "problem"),
    [
        *(({}, {link: value}, f"{link} {why}") for link in ("ProbeToTracker", "ReferenceToTracker") for value, why in UNUSABLE),
        (REPEATED, {"ProbeToTracker": UNUSABLE[0][0]}, "ProbeToTracker OUT_OF_VIEW"),
        (STYLUS, {**UNSEEN, "ProbeToTracker": (LOST, TransformStatus.INVALID)}, "ProbeToTracker INVALID"),
        (STYLUS, UNSEEN, None),
        (STYLUS, {}, None),
        (REPEATED, {}, None),
        ({}, INVERSE, None),
        (INVERSE, {}, None),
        (WRITTEN, {}, None),
        ({}, {"ProbeToProbe": np.eye(4)}, None),
        ({}, {"StylusToTracker": np.eye(4), "TrackerToStylus": 2 * np.eye(4)}, None),
    ],
)
def test_a_link_that_cannot_be_used_costs_its_frame_and_no_other(beside, changes, problem):
    poses = sweep_poses(sweep(record(beside), record({**beside, **changes}), record(beside)))
    assert poses.problems == (None, problem, None)
    expected = np.stack([IMAGE_TO_REFERENCE] * len(poses.usable))
    np.testing.assert_allclose(poses.image_to_reference[poses.usable], expected, atol=1e-4 if beside is WRITTEN else 1e-9)


def test_what_holds_for_every_frame_stands_in_where_a_frame_has_none_but_not_a_configuration():
    sequence = sweep(record({"ReferenceToTracker": None}), transforms=samples({"ReferenceToTracker": REFERENCE_TO_TRACKER}))
    np.testing.assert_allclose(sweep_poses(sequence).image_to_reference, [IMAGE_TO_REFERENCE], atol=1e-9)
    given = configuration({"ImageToProbe": IMAGE_TO_PROBE, "ProbeToTracker": np.eye(4)})
    poses = sweep_poses(sweep(record(), record({"ProbeToTracker": None}), configuration=given))
    assert poses.problems == (None, "ProbeToTracker not recorded")
    assert sweep_poses(sweep(record(image_status=TransformStatus.INVALID))).problems == ("no image (INVALID)",)
    assert sweep_poses(sweep(record({"ImageToCroppedImage": CROP}), record())).problems[1] == "ImageToCroppedImage not recorded"


SHIFTED = {"ProbeToReference": rigid((0, 0, 0), (0, 0, 3)) @ REPEATED["ProbeToReference"]}


def test_ways_that_disagree_in_one_frame_are_named_with_it():
    with pytest.raises(TransformError, match=r"Two paths lead from Image to Reference: .* They differ by 3 mm in frame 1") as caught:
        sweep_poses(sweep(record(REPEATED), record(SHIFTED)))
    assert "ImageToProbe > ProbeToTracker > TrackerToReference" in str(caught.value)


@pytest.mark.parametrize(
    ("chain", "moved"),
    [
        ("ImageToProbe,ProbeToReference", 3.0),
        ("ImageToProbe, ProbeToTracker, ReferenceToTracker", 0.0),
        ("ImageToReference", 9.0),
    ],
)
def test_a_chain_that_is_spelled_out_chooses_between_ways_that_disagree(chain, moved):
    recorded = {**SHIFTED, "ImageToReference": rigid((0, 0, 0), (0, 0, 9)) @ IMAGE_TO_REFERENCE}
    poses = sweep_poses(sweep(record(recorded)), image_to_reference=chain)
    np.testing.assert_allclose(poses.image_to_reference[0], rigid((0, 0, 0), (0, 0, moved)) @ IMAGE_TO_REFERENCE, atol=1e-9)


@pytest.mark.parametrize(
    ("matrix", "problem"),
    [
        (IMAGE_TO_REFERENCE, None),
        (IMAGE_TO_REFERENCE @ scaled(0, 1, 1), "image pose singular (a pixel has no size)"),
        (IMAGE_TO_REFERENCE @ np.array([[1, 0.5, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]), "image pose sheared"),
        (LOST, "ImageToReference not finite"),
        (np.ones((4, 4)), "ImageToReference not a pose (last row"),
    ],
)
def test_a_recorded_image_pose_needs_no_calibration_and_one_that_places_no_pixels_says_why(matrix, problem):
    frame = FrameRecord(transforms=samples({"ImageToReference": matrix}))
    poses = sweep_poses(sweep(frame, calibration=False))
    if problem is None:
        np.testing.assert_allclose(poses.image_to_reference[0], IMAGE_TO_REFERENCE)
    else:
        assert poses.problems[0].startswith(problem)


def test_the_configuration_names_image_and_reference():
    given = configuration({"PictureToProbe": IMAGE_TO_PROBE}, image_frame="Picture", reference_frame="Tracker")
    poses = sweep_poses(sweep(record(), configuration=given))
    assert [str(name) for name in poses.path] == ["PictureToProbe", "ProbeToTracker"]
    ends, _ = chain_ends(sweep(record()).configuration, "PictureToTracker", "Patient")
    assert str(ends) == "PictureToPatient"


def test_a_recording_without_a_calibration_says_how_to_give_it_and_names_no_frame_that_the_image_is_fixed_to():
    with pytest.raises(TransformError, match="Nothing says where Image lies in Reference"):
        sweep_poses(sweep(record(), calibration=False))
    constant = {"ProbeToTracker": None, "ReferenceToTracker": None, "ImageToProbe": IMAGE_TO_PROBE}
    with pytest.raises(TransformError, match="No pose of a tool leads on from there"):
        sweep_poses(sweep(record(constant), record(constant), calibration=False))


RUNS = {
    "0 frames ()": [],
    "1 frame (7)": [7],
    "2 frames (0-1)": [0, 1],
    "6 frames (0-2, 5, 8-9)": [0, 1, 2, 5, 8, 9],
    "4 frames (0, 2, 4, 6)": [0, 2, 4, 6],
    "5 frames (0, 2, 4, 6, ...)": [0, 2, 4, 6, 8],
}


def test_frame_numbers_are_described_in_runs():
    assert [describe_frames(numbers) for numbers in RUNS.values()] == list(RUNS)


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


TWICE = IMAGE_TO_PROBE @ np.diag([2.0, 2.0, 2.0, 1.0])
RECORDED = FrameRecord(transforms=samples({"ImageToReference": IMAGE_TO_REFERENCE, "ImageToCroppedImage": CROP}))


@pytest.mark.parametrize(
    ("cropped", "reference", "pixel"),
    [
        *(
            (sweep(record({name: matrix})), asked, (3, 7))
            for name, matrix in (("ImageToCroppedImage", CROP), ("CroppedImageToImage", np.linalg.inv(CROP)))
            for asked in (None, "ImageToReference", "CroppedImageToReference")
        ),
        (sweep(RECORDED, calibration=False), "CroppedImageToReference", (3, 7)),
        (crop(sweep(record({"ImageToCroppedImage": CROP})), 1, 2, 3, 2), None, (4, 9)),
        (
            recalibrate(sweep(RECORDED, calibration=False), TransformName("Image", "Probe"), TWICE, IMAGE_TO_PROBE),
            "ImageToReference",
            (6, 14),
        ),
    ],
)
def test_the_first_pixel_of_a_cropped_image_lies_where_it_was_in_the_whole_one(cropped, reference, pixel):
    found = sweep_poses(cropped, image_to_reference=reference).image_to_reference[0]
    np.testing.assert_allclose(found @ (0, 0, 0, 1), IMAGE_TO_REFERENCE @ (*pixel, 0, 1), atol=1e-9)


SIZE = (0.25, 0.5)


def notes_on_size(*stated, scales=(1.0,)) -> tuple[str, ...]:
    """Notes on frames that state these sizes, whose poses place pixels of `SIZE`, times `scales`, apart."""
    matrices = [np.diag([SIZE[0] * scale, SIZE[1] * scale, 1.0, 1.0]) for scale in np.resize(scales, len(stated))]
    records = [FrameRecord(transforms=samples({"ImageToReference": matrix}), stated_spacing=size) for matrix, size in zip(matrices, stated)]
    return sweep_poses(sweep(*records, calibration=False)).notes


OTHER_DEPTH = "places pixels 0.25 x 0.5 mm apart, and so they are placed, as in Plus: is the calibration that of another depth?"
CHANGED = "the size changes in frame 2 from 0.25 x 0.5 to 0.5 x 1 mm, and a calibration holds for one depth."
MOVED_ON = "a pixel of frame 1 is 0.25 x 0.5 mm, but ImageToReference places pixels 0.5 x 1 mm apart"


@pytest.mark.parametrize(
    ("sizes", "scales", "said"),
    [
        *(((size, size), (1.0,), None) for size in (None, SIZE, (0.251, 0.495))),
        *(((size, size), (1.0,), OTHER_DEPTH) for size in ((0.2, 0.5), (0.25, 0.7), (0.5, 0.25))),
        ((SIZE, SIZE, (0.5, 1.0), (0.5, 1.0)), (1.0,), CHANGED),
        ((SIZE, SIZE), (1.0, 2.0), MOVED_ON),
    ],
)
def test_a_stated_size_of_a_pixel_that_is_not_that_of_the_poses_is_one_note(sizes, scales, said):
    assert [said in note for note in notes_on_size(*sizes, scales=scales)] == [True] * (said is not None)


def test_rigid_poses_of_images_whose_pixels_have_a_size_are_said_to_lack_it():
    poses = sweep_poses(sweep(FrameRecord(transforms=samples({"ImageToReference": np.eye(4)}), stated_spacing=SIZE), calibration=False))
    assert "is 0.25 x 0.5 mm, but ImageToReference places pixels 1 x 1 mm apart" in poses.notes[0]
    assert poses.notes[0].endswith("it is rigid, so it may lack the size of a pixel, which belongs into the calibration.")
    np.testing.assert_array_equal(poses.image_to_reference[0], np.eye(4))


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

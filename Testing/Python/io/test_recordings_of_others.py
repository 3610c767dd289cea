"""Recordings that other programs wrote: the right images, at the right place and time, and one sentence where that cannot be said."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
import PIL.Image as pil
import pytest
from made_recordings import (
    CALIBRATION,
    COUNT,
    IMAGES,
    POSES,
    PROBE,
    ROWS,
    SPACING,
    START,
    TO_BASE,
    TO_MM,
    Bag,
    acquisition,
    pose,
    three_rows,
)
from rosbags.convert import cli as convert
from scipy.spatial.transform import Rotation

from AIFReconLib import read_sequence
from AIFReconLib.errors import FileFormatError, SequenceFormatError, TransformError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample
from AIFReconLib.io.foreign.openers import open_images
from AIFReconLib.io.sequence.others.unread import UNREAD
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.poses import sweep_poses


def without(base: Path, *patterns: str) -> None:
    """Remove these files of an acquisition."""
    for file in [file for pattern in patterns for file in base.parent.glob(pattern)]:
        file.unlink()


def test_an_acquisition_of_custusx_is_read_by_its_folder_and_by_its_times(tmp_path):
    folder = acquisition(tmp_path / "acquisition")
    for path in (folder, next(folder.glob("*.fts"))):
        sequence = read_sequence(path)
        np.testing.assert_array_equal(np.asarray(sequence.images), IMAGES)
        np.testing.assert_allclose(np.diff(sequence.timestamps), 0.05, atol=1e-6)
        np.testing.assert_allclose(sweep_poses(sequence).image_to_reference, POSES @ TO_MM, atol=1e-9)


def test_without_poses_of_its_frames_those_of_the_tool_are_taken_at_their_times(tmp_path):
    """The image in the tool, by the turns and shifts of `ProbeSector::get_tMu` and `get_uMv`, written out."""
    sequence = read_sequence(acquisition(tmp_path / "a", frame_poses=False, probe=PROBE))
    height = (ROWS - 1) * 0.3
    origin_u = np.array([8 * 0.2, (ROWS - 1 + 3) * 0.3, 0.0])
    turn = np.eye(4)
    turn[:3, :3] = Rotation.from_euler("x", -90, degrees=True).as_matrix() @ Rotation.from_euler("y", 90, degrees=True).as_matrix()
    shift, upside_down, below = np.eye(4), np.eye(4), np.eye(4)
    shift[:3, 3] = -origin_u
    upside_down[:3, :3] = Rotation.from_euler("x", 180, degrees=True).as_matrix()
    below[:3, 3] = 0, -height, 0
    expected = POSES @ turn @ shift @ upside_down @ below @ TO_MM
    np.testing.assert_allclose(sweep_poses(sequence).image_to_reference, expected, atol=1e-6)


def test_frames_that_the_tracker_did_not_see_have_no_pose(tmp_path):
    """CustusX goes on with the last ones."""
    sequence = read_sequence(acquisition(tmp_path / "a", tool_times=[-20.0, -19.0, 0.0, 1.0, 2.5]))
    assert sweep_poses(sequence).usable.tolist() == [0, 1, 2, 3, 4]
    assert "1 frames that the tracker did not see" in sequence.notes[0]


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda base: Path(f"{base}.fts").write_text("1\n2\n"), r"\.fts: there must be a time for each frame; got 2 for 6 frames"),
        (lambda base: Path(f"{base}.fts").write_text("1\nx\n"), r"\.fts: it must hold finite numbers alone; 'x' is not a number"),
        (lambda base: Path(f"{base}.fp").write_text("1 2 3\n"), r"\.fp: poses must have three rows of four numbers; got 3"),
        (lambda base: Path(f"{base}.fp").write_text(three_rows(POSES[:2])), r"\.fp: there must be a pose for each frame; got 2"),
        (lambda base: without(base, "*.fp", "*.tp"), r"\.fp: neither this file nor \.tp and \.tts"),
        (lambda base: without(base, "*.mhd"), r"_0\.mhd and so on must lie beside it"),
        (lambda base: Path(f"{base}-2.fts").write_text(""), "2 acquisitions of CustusX"),
    ],
)
def test_an_acquisition_that_is_not_whole_says_what_is_missing(tmp_path, damage, message):
    folder = acquisition(tmp_path / "a")
    base = folder / "US-Acq_1_20260101T120000_Probe"
    with pytest.raises(SequenceFormatError, match=r"one frame of an acquisition of CustusX\. Give the folder, or US-Acq_1.*\.fts"):
        read_sequence(f"{base}_0.mhd")
    with pytest.raises(FileFormatError, match="this is an acquisition of CustusX, which holds images and their poses"):
        open_images([folder])
    damage(base)
    with pytest.raises(SequenceFormatError, match=message):
        read_sequence(folder)


@pytest.mark.parametrize(("suffixes", "what", "way"), UNREAD)
def test_what_is_known_and_not_read_is_named_with_the_way_that_there_is(tmp_path, suffixes, what, way):
    for suffix in suffixes:
        (tmp_path / f"a{suffix}").write_bytes(b"x")
        with pytest.raises(SequenceFormatError, match=f"this is {re.escape(what)}, which is not read as it is. {re.escape(way)}"):
            read_sequence(tmp_path / f"a{suffix}")


# ---- archives of NumPy


COLORS = np.asfortranarray(np.repeat(IMAGES[..., None], 3, axis=3))


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
@pytest.mark.parametrize("told", [{"image_to_reference": POSES, "spacing": SPACING}, {"image_to_reference": POSES @ TO_MM}])
@pytest.mark.parametrize("images", [IMAGES, COLORS], ids=["gray", "colors in another order"])
def test_an_archive_of_arrays_is_a_recording(tmp_path, save, told, images):
    save(tmp_path / "a.npz", images=images, timestamps=np.arange(COUNT) / 20, **told)
    sequence = read_sequence(tmp_path / "a.npz")
    np.testing.assert_array_equal(np.asarray(sequence.images), IMAGES)
    np.testing.assert_allclose(sweep_poses(sequence).image_to_reference, POSES @ TO_MM)
    np.testing.assert_allclose(sequence.timestamps, np.arange(COUNT) / 20)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"frames": IMAGES}, "must hold the arrays images and image_to_reference; got frames"),
        ({"images": IMAGES, "image_to_reference": POSES[:3]}, r"must have shape \(6, 4, 4\)"),
        ({"images": IMAGES, "image_to_reference": POSES}, "must take pixels to mm"),
        ({"images": IMAGES[0], "image_to_reference": POSES}, r"images must have shape \(frames, rows, columns\)"),
        ({"images": np.array([Path("x")], object), "image_to_reference": POSES}, "cannot be read as an archive of arrays"),
    ],
)
def test_an_archive_that_is_no_recording_says_why(tmp_path, arrays, message):
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(FileFormatError, match=message):
        read_sequence(tmp_path / "a.npz")


# ---- bags of ROS


def bag_of_images(folder: Path, storage: str = "mcap", count: int = COUNT, change=None, **image) -> Bag:
    """A bag of images without poses."""
    bag = Bag(folder / "sweep", storage)
    if change:
        change(bag.writer)
    with bag.writer:
        for number in range(count):
            bag.image(number, **image)
    return bag


@pytest.fixture(params=["bag", "mcap", "sqlite3"])
def tree_bag(request, tmp_path):
    """Images of a probe whose place on a robot moves at a rate of its own, under a base that stands still."""
    bag = Bag(tmp_path / "sweep", request.param)
    with bag.writer:
        bag.tree(0.0, "robot", "base", TO_BASE, "/tf_static")
        for number in range(2 * COUNT + 2):
            bag.tree(0.025 * number - 0.01, "us_probe", "robot", pose((0.025 * number - 0.01) / 0.05))
            if number % 2 == 0 and number < 2 * COUNT:
                bag.image(number // 2)
    return bag.path


def test_the_images_of_a_bag_are_placed_by_its_tree_of_transforms_and_one_that_is_cut_short_is_refused(tree_bag):
    calibration = PlusConfiguration(transforms={TransformName("Image", "UsProbe"): TransformSample(CALIBRATION)})
    sequence = read_sequence(tree_bag, calibration)
    np.testing.assert_array_equal(np.asarray(sequence.images), IMAGES)
    np.testing.assert_array_equal(sequence.images[4], IMAGES[4])
    np.testing.assert_array_equal(sequence.images[1], IMAGES[1])
    np.testing.assert_allclose(sequence.timestamps - START, 0.05 * np.arange(COUNT), atol=1e-6)
    poses = sweep_poses(sequence, reference="Base")
    np.testing.assert_allclose(poses.image_to_reference, TO_BASE @ POSES @ CALIBRATION, atol=0.02)
    assert "of frame UsProbe" in sequence.notes[0]
    file = tree_bag if tree_bag.is_file() else next(file for file in tree_bag.iterdir() if file.suffix in (".mcap", ".db3"))
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    with pytest.raises(FileFormatError, match=r"bag of ROS|cannot be decoded"):
        np.asarray(read_sequence(tree_bag).images)


RED = np.dstack([IMAGES[0], 0 * IMAGES[0], 0 * IMAGES[0]])


@pytest.mark.parametrize(
    ("encoding", "pixels", "expected"),
    [
        ("mono16", IMAGES[0].astype(np.uint16) * 200, IMAGES[0].astype(np.uint16) * 200),
        ("32FC1", IMAGES[0].astype(np.float32) / 7, IMAGES[0].astype(np.float32) / 7),
        ("rgb8", RED, np.rint(0.299 * IMAGES[0]).astype(np.uint8)),
        ("bgr8", RED, np.rint(0.114 * IMAGES[0]).astype(np.uint8)),
        ("yuv422", IMAGES[0], None),
    ],
)
def test_images_of_several_encodings_are_read_or_named(tmp_path, encoding, pixels, expected):
    path = bag_of_images(tmp_path, count=1, encoding=encoding, pixels=pixels).path
    if expected is None:
        with pytest.raises(SequenceFormatError, match="images of the encoding 'yuv422' are not read"):
            read_sequence(path)
    else:
        np.testing.assert_array_equal(read_sequence(path).images[0], expected)


def test_compressed_images_are_read(tmp_path):
    bag = Bag(tmp_path / "sweep", "bag")
    with bag.writer:
        for number, image in enumerate(IMAGES):
            file = io.BytesIO()
            pil.fromarray(image).save(file, "PNG")
            data = np.frombuffer(file.getvalue(), np.uint8)
            header = bag.header(0.05 * number, "us")
            message = bag.make("sensor_msgs/msg/CompressedImage", header=header, format="png", data=data)
            bag.write("/us/compressed", "sensor_msgs/msg/CompressedImage", 0.05 * number, message)
    np.testing.assert_array_equal(np.asarray(read_sequence(bag.path).images), IMAGES)


def test_a_bag_with_images_of_two_topics_asks_for_one(tmp_path, monkeypatch):
    bag = Bag(tmp_path / "sweep", "mcap")
    with bag.writer:
        bag.image(0, "/us/image")
        bag.image(1, "/camera")
        bag.pose(0.0, "tracker", POSES[0])
    with pytest.raises(SequenceFormatError, match=r"images of one topic; got /us/image, /camera\. .* --exclude-topic /camera\.") as asked:
        read_sequence(bag.path)
    words = str(asked.value).split("rosbags-convert ")[1].rstrip(".").split()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", ["rosbags-convert", *words])
    with pytest.raises(SystemExit, match="0"):
        convert.main()
    sequence = read_sequence(tmp_path / "one")
    np.testing.assert_array_equal(np.asarray(sequence.images), IMAGES[:1])
    assert TransformName("Probe", "Tracker") in sequence.records[0].transforms


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
@pytest.mark.parametrize("content", [b"", b"#ROSBAG V2.0\n", b"\x89MCAP0\r\n" + bytes(200), b"SQLite format 3\0" + bytes(200)])
def test_what_is_no_bag_is_refused(tmp_path, suffix, content):
    (tmp_path / f"a{suffix}").write_bytes(content)
    with pytest.raises(FileFormatError, match="it cannot be read as a bag of ROS"):
        read_sequence(tmp_path / f"a{suffix}")


KINDS = {
    "geometry_msgs/msg/PoseStamped": "ProbeToTracker",
    "nav_msgs/msg/Odometry": "NeedleToTracker",
    "geometry_msgs/msg/PoseWithCovarianceStamped": "ProbeToTracker",
    "nav_msgs/msg/Path": None,
}


@pytest.mark.parametrize(("kind", "name"), KINDS.items())
@pytest.mark.parametrize("storage", ["bag", "mcap"])
def test_poses_of_other_messages_are_read_or_named(tmp_path, storage, kind, name):
    bag = Bag(tmp_path / "sweep", storage)
    with bag.writer:
        for number in range(COUNT):
            bag.pose(0.05 * number, "tracker", pose(number), kind)
            bag.image(number)
    # An MCAP is read without its folder, too
    sequence = read_sequence(bag.path if storage == "bag" else next(bag.path.glob("*.mcap")))
    assert [str(each) for each in sequence.transform_names()] == ([] if name is None else [name])
    if name is None:
        assert f"{COUNT} of nav_msgs/msg/Path on /probe/pose" in " ".join(sequence.notes)
        with pytest.raises(TransformError, match=r"no transforms at all: was a tracker connected.$"):
            sweep_poses(sequence)
    else:
        found = [next(iter(record.transforms.values())).matrix for record in sequence.records]
        np.testing.assert_allclose(found, POSES, atol=1e-9)

"""`aifrecon import`: exported frames and poses give the recording they are from, whatever the way they were written."""

from __future__ import annotations

import re

import numpy as np
import pytest
from dicom_samples import write_dicom
from files import IMAGE_TO_PROBE, SPACING, refused, tracked_sequence
from late_sweeps import late_sweep
from made_pictures import write_pictures
from scipy.spatial.transform import Rotation
from sweeps import rigid

from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.transform_graph import TransformName
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.sweep.poses import sweep_poses

SEQUENCE = tracked_sequence()
TIMES = [record.timestamp for record in SEQUENCE.records]


def tracker_pose(record, tool) -> np.ndarray:
    return record.transforms[TransformName(tool, "Tracker")].matrix


PROBE_TO_REFERENCE = [np.linalg.inv(tracker_pose(r, "Reference")) @ tracker_pose(r, "Probe") for r in SEQUENCE.records]
IMAGE_TO_REFERENCE = np.array([pose @ IMAGE_TO_PROBE for pose in PROBE_TO_REFERENCE])
RIGID_IMAGE_TO_REFERENCE = [pose @ np.diag([1 / SPACING[0], 1 / SPACING[1], 1 / 0.45, 1.0]) for pose in IMAGE_TO_REFERENCE]


MATRIX = [f"m{r}{c}" for r in range(4) for c in range(4)]
"""Headings."""


def save(path, rows, header=None):
    lines = [",".join(header)] if header else []
    path.write_text("\n".join([*lines, *(",".join(map(str, row)) for row in rows)]))
    return path


def flat(matrices):
    return [matrix.ravel().tolist() for matrix in matrices]


@pytest.fixture
def frames(tmp_path):
    """The images of the recording as an array file, which needs no other package."""
    np.save(tmp_path / "frames.npy", np.asarray(SEQUENCE.images))
    return tmp_path / "frames.npy"


@pytest.fixture
def calibration(tmp_path):
    (tmp_path / "ImageToProbe.txt").write_text(" ".join(map(repr, IMAGE_TO_PROBE.ravel().tolist())))
    return tmp_path / "ImageToProbe.txt"


def imported(results, *arguments):
    assert main(["import", *map(str, arguments), "--output", str(results / "sweep.igs.mha")]) == 0
    return read_sequence(results / "sweep.igs.mha")


def asked(capsys, results, *arguments) -> str:
    """What an import is refused with."""
    return refused(["import", *arguments, "--output", results / "s.mha"], capsys, results)


IMAGE, SIZE = ["--transform", "ImageToReference"], ["--spacing", *SPACING]
FROM_MIDDLE = [m @ rigid(translation=(20 * SPACING[0], 15 * SPACING[1], 0)) for m in RIGID_IMAGE_TO_REFERENCE]
WAYS = {
    "image to reference, pixels": (flat(IMAGE_TO_REFERENCE), IMAGE),
    "image to reference, mm": (flat(RIGID_IMAGE_TO_REFERENCE), [*IMAGE, *SIZE]),
    "image to reference, from the middle": (flat(FROM_MIDDLE), [*IMAGE, *SIZE, "--image-origin-px", 20, 15]),
    "reference to image": (flat(map(np.linalg.inv, RIGID_IMAGE_TO_REFERENCE)), ["--transform", "ReferenceToImage", *SIZE]),
    "image to reference, meters": (flat(np.diag([1e-3, 1e-3, 1e-3, 1]) @ IMAGE_TO_REFERENCE), [*IMAGE, "--units", "m"]),
    "reference to probe": (flat(map(np.linalg.inv, PROBE_TO_REFERENCE)), ["--transform", "ReferenceToProbe"]),
    "probe, quaternions in meters": (
        [[*np.roll(Rotation.from_matrix(m[:3, :3]).as_quat(), 1), *(m[:3, 3] / 1000)] for m in PROBE_TO_REFERENCE],
        ["--columns", "qw qx qy qz x y z", "--units", "m", "--transform", "ProbeToReference"],
    ),
    "probe, Euler angles": (
        [[*m[:3, 3], *Rotation.from_matrix(m[:3, :3]).as_euler("ZYX")] for m in PROBE_TO_REFERENCE],
        ["--euler-order", "ZYX", "--angle-unit", "rad", "--transform", "ProbeToReference"],
    ),
}
"""The recording's poses in many ways, and the options that say which."""


@pytest.mark.parametrize("how", WAYS)
def test_every_way_to_write_poses_puts_the_pixels_in_the_same_place(tmp_path, results, frames, calibration, how):
    rows, options = WAYS[how]
    more = ["--calibration", calibration] if "probe" in how else []
    sequence = imported(results, frames, "--poses", save(tmp_path / "p.csv", rows), *options, *more)
    found = sweep_poses(sequence).image_to_reference
    for pixel in ((0, 0, 0, 1), (39, 0, 0, 1), (0, 29, 0, 1), (12, 17, 0, 1)):
        np.testing.assert_allclose(found @ pixel, IMAGE_TO_REFERENCE @ pixel, atol=1e-8)


def test_poses_are_paired_by_the_names_of_their_images_and_rows_without_one_are_poses_of_none(tmp_path, results):
    folder = write_pictures(tmp_path / "frames", SEQUENCE.images)
    rows = [[f"somewhere/else/{n}.png", TIMES[n], *flat(IMAGE_TO_REFERENCE)[n]] for n in (5, 0, 3, 1, 2)]
    rows = [["", *rows[0][1:]], *rows, ["", *rows[-1][1:]]]
    poses = save(tmp_path / "p.csv", rows, ["image", "time", *MATRIX])
    found = sweep_poses(imported(results, folder, "--poses", poses, *IMAGE))
    assert found.skipped() == {"ImageToReference MISSING": [4]}
    np.testing.assert_allclose(found.image_to_reference[3], IMAGE_TO_REFERENCE[3], atol=1e-12)


def test_poses_of_another_rate_are_interpolated_at_the_images(tmp_path, results):
    """Images of a DICOM file at 0, 0.04 and 0.08 s, poses every 0.02 s."""
    images = write_dicom(tmp_path / "a.dcm", np.asarray(SEQUENCE.images)[:3], FrameTime=40.0)
    rows = [[0.02 * n + 0.01, *(rigid(translation=(n, 0, 0)) @ np.diag([0.4, 0.5, 1, 1])).ravel().tolist()] for n in range(-1, 5)]
    sequence = imported(results, images, "--poses", save(tmp_path / "p.csv", rows), "--transform", "ImageToReference")
    found = sweep_poses(sequence).image_to_reference[:, 0, 3]
    np.testing.assert_allclose(found, [-0.5, 1.5, 3.5], atol=1e-9)


@pytest.fixture
def zoomed(tmp_path):
    """A folder of two DICOM files of one frame each, of which neither the order nor the one size of a pixel is known."""
    (tmp_path / "zoomed").mkdir()
    for number, size in enumerate((0.2, 0.4)):
        image = np.asarray(SEQUENCE.images)[number]
        write_dicom(tmp_path / "zoomed" / f"{number}.dcm", image, InstanceNumber=1, PixelSpacing=[size, size])
    return tmp_path / "zoomed"


def test_a_size_that_is_given_and_names_of_images_place_what_files_leave_open(tmp_path, results, zoomed, capsys):
    unnamed = save(tmp_path / "unnamed.csv", flat(IMAGE_TO_REFERENCE[:2]))
    said = asked(capsys, results, zoomed, "--poses", unnamed, *IMAGE)
    assert "order of the images is not known: InstanceNumber is missing, or occurs more than once. Name the image of each" in said
    rows = [[*pose.ravel(), name] for pose, name in zip(RIGID_IMAGE_TO_REFERENCE, ("1.dcm", "0.dcm"))]
    poses = save(tmp_path / "p.csv", rows, [*MATRIX, "image"])
    said = asked(capsys, results, zoomed, "--poses", poses, *IMAGE)
    assert "not known: 0.dcm says 0.2 x 0.2 mm, 1.dcm says 0.4 x 0.4 mm. Give --spacing X Y in mm" in said
    found = sweep_poses(imported(results, zoomed, "--poses", poses, *IMAGE, *SIZE)).image_to_reference
    np.testing.assert_allclose(found[:, :3, :2], IMAGE_TO_REFERENCE[[1, 0], :3, :2], atol=1e-6)


@pytest.mark.parametrize(("code", "flip"), [("UF", np.s_[:, :, ::-1]), ("MN", np.s_[:, ::-1]), ("UN", np.s_[:, ::-1, ::-1])])
def test_pictures_stored_mirrored_are_turned(tmp_path, results, code, flip):
    np.save(tmp_path / "frames.npy", np.asarray(SEQUENCE.images)[flip])
    poses = save(tmp_path / "p.csv", flat(IMAGE_TO_REFERENCE))
    sequence = imported(results, tmp_path / "frames.npy", "--poses", poses, *IMAGE, "--orientation", code)
    np.testing.assert_array_equal(sequence.images[3], SEQUENCE.images[3])


@pytest.mark.parametrize(
    ("how", "options", "message"),
    [
        ("image to reference, mm", "ImageToReference", "size of a pixel is not known. Give --spacing X Y"),
        ("image to reference, pixels", "ImageToReference --spacing 1 1", "hold the size of a pixel already"),
        ("image to reference, pixels", "ImageToReference --calibration CAL", "no calibration to apply"),
        ("image to reference, pixels", "ProbeToReference", "Pose 0 must be a rotation and a translation; it is not rigid"),
        ("reference to probe", "Probe", "must be FromToTo"),
        ("reference to probe", "ProbeToTracker --spacing 1 1", "does not say where the image lies in Probe"),
        ("reference to probe", "ProbeToTracker --spacing 0 1", "spacing must be at least 1e-06"),
        ("reference to probe", "ProbeToTracker --rate -5", "rate must be at least 1e-06"),
        ("reference to probe", "ProbeToTracker --orientation up", "orientation must be MF, MN, UF or UN"),
        ("reference to probe", "ProbeToTracker --euler-order abc", "three axes"),
        ("reference to probe", "NeedleToTracker --calibration ImageToProbe=CAL", "must lead from Image to Needle or"),
        ("reference to probe", "ProbeToTracker --calibration CAL --spacing 1 1", "calibration holds the size"),
    ],
)
def test_what_does_not_fit_is_explained(tmp_path, results, frames, calibration, capsys, how, options, message):
    poses = save(tmp_path / "p.csv", WAYS[how][0])
    words = f"--transform {options}".replace("CAL", str(calibration)).split()
    assert re.search(message, asked(capsys, results, frames, "--poses", poses, *words))


def test_pictures_that_are_damaged_or_of_one_name_are_named(tmp_path, results, capsys):
    folders = [write_pictures(tmp_path / name, np.asarray(SEQUENCE.images)[:2]) for name in "ab"]
    rows = [[f"{n}.png", *row] for n, row in enumerate(flat(IMAGE_TO_REFERENCE)[:2])]
    poses = save(tmp_path / "p.csv", rows, ["image", *MATRIX])
    assert "Two of the images are called 0.png" in asked(capsys, results, *folders, "--poses", poses, *IMAGE)
    (folders[0] / "1.png").write_bytes((folders[0] / "1.png").read_bytes()[:200])
    assert "1.png" in asked(capsys, results, folders[0], "--poses", poses, *IMAGE)


COLUMNS = ["time", "x", "y", "z", "qx", "qy", "qz", "qw"]


def moving(count=12, step=0.05, speed=20.0, start=0.0):
    """Rows of a tool that moves along x, in mm and s."""
    return [[f"{start + step * n:.6f}", 10 + speed * step * n, 20, 30, 0, 0, 0, 1] for n in range(count)]


@pytest.fixture
def twelve(tmp_path, monkeypatch):
    """Twelve images, in the current folder."""
    monkeypatch.chdir(tmp_path)
    np.save(tmp_path / "twelve.npy", np.random.default_rng(1).integers(0, 255, (12, 24, 32), np.uint8))
    return tmp_path / "twelve.npy"


NS = "unit of the times .column time. is not known: in seconds, poses would be 50 s apart. Give --time"
TWO_TOOLS = ["time", *(f"{tool}_{name}" for tool in ("probe", "ref") for name in COLUMNS[1:])]


@pytest.mark.parametrize(
    ("header", "rows", "options", "message"),
    [
        (COLUMNS, moving(speed=3000.0), "", "moves at 3 m/s, in the median.*--sure"),
        (COLUMNS, moving(speed=0.001), "", "move by 0.00055 mm in all. If they are in meters, give --units m"),
        (COLUMNS, moving(speed=0.0), "", "never moves: all poses are the same.*--sure"),
        (COLUMNS, moving(step=50.0, speed=0.02), "", NS),
        (["time_s", *COLUMNS[1:]], moving(step=50.0, speed=0.02), "", "Poses are 50 s apart"),
        ([*COLUMNS, "stamp"], [[*row, row[0]] for row in moving()], "", r"the time: time .column 1., stamp .column 9."),
        ([*COLUMNS, "tx"], [[*row, row[1]] for row in moving()], "", r"2 columns mean x: x .column 2., tx .column 9."),
        ([*COLUMNS, "status"], [[*row, "zzz"] for row in moving()], "", 'of a pose is not known: zzz. .*--status-ok "zzz"'),
        (TWO_TOOLS, [[*row, *row[1:]] for row in moving()], "", "poses of 2 tools side by side: probe, ref. .*--tool"),
        (COLUMNS, moving(count=60), "--rate 20 --time-offset auto", "give the calibration with --calibration"),
        (COLUMNS, moving(count=60), "--times two.csv", "as many times as images; got 2 times for 12 images"),
        (COLUMNS, moving(count=60), "--times none.csv", "a column 'time'"),
        (COLUMNS, moving(count=60), "--times empty.csv", "'time'"),
    ],
)
def test_what_no_hand_does_and_what_can_be_two_things_is_asked(results, twelve, capsys, header, rows, options, message):
    for name, text in (("two", "time\n0\n1\n"), ("none", "a,b\n1,2\n"), ("empty", "")):
        twelve.with_name(f"{name}.csv").write_text(text)
    poses = save(twelve.with_name("p.csv"), header=header, rows=rows)
    said = asked(capsys, results, twelve, "--poses", poses, "--transform", "ProbeToTracker", *options.split())
    assert re.search(message, said)
    assert "config=" not in said


def test_who_is_sure_gets_what_he_asks_for_and_poses_that_the_tracker_lost_are_not_judged(tmp_path, results, twelve, capsys):
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(speed=3000.0))
    imported(results, twelve, "--poses", poses, "--transform", "ProbeToTracker", "--sure")
    assert "doubt: The tool moves at 3 m/s" in capsys.readouterr().out
    rows = [[*row, "OK"] if n % 2 else [row[0], *[0] * 7, "MISSING"] for n, row in enumerate(moving())]
    save(poses, header=[*COLUMNS, "status"], rows=rows)
    imported(results, twelve, "--poses", poses, "--transform", "ProbeToTracker")


def places(sequence):
    return np.array([record.transforms[TransformName("Probe", "Tracker")].matrix[0, 3] for record in sequence.records])


PAUSE = "the images last 0.6 s at 20 a second, the poses 3.0 s. If the images paused, give --times FILE instead of --rate."
OTHER_CLOCK = "images and poses count from different moments; the images were taken to begin {} s after the poses"
LATE = 1_700_000_000.0


@pytest.mark.parametrize(
    ("rows", "offset", "said"),
    [
        (moving(step=0.1), 0.0, ""),  # as many poses as images, but frame 2 was taken at the second pose
        (moving(count=60, step=0.01), 0.0, ""),
        (moving(count=60, step=0.02), 0.0, "both count from 0"),
        (moving(count=60), 0.0, PAUSE),
        (moving(count=60), 1.025, ""),
        (moving(start=LATE), 0.0, ""),
        (moving(count=60, start=LATE), 0.0, OTHER_CLOCK.format(0)),
        (moving(count=60, start=LATE), 0.5, OTHER_CLOCK.format(0.5)),
    ],
)
def test_a_rate_pairs_images_with_poses_by_time(tmp_path, results, twelve, capsys, rows, offset, said):
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=rows)
    how = ["--transform", "ProbeToTracker", "--rate", 20, "--time-offset", offset]
    sequence = imported(results, twelve, "--poses", poses, *how)
    np.testing.assert_allclose(places(sequence), 10 + 20 * (offset + 0.05 * np.arange(12)), atol=1e-4)
    np.testing.assert_allclose(np.diff([record.timestamp for record in sequence.records]), 0.05, atol=1e-6)
    assert said in " ".join(capsys.readouterr().out.split())


PAUSED = np.r_[0.0:0.3:0.05, 1.8:2.1:0.05][:12]
"""s of twelve images with a pause amid them."""


@pytest.mark.parametrize(("header", "form"), [(["time"], "{t}"), (["image", "time_ms"], "{n}.png,{ms}"), (None, "{t}")])
def test_images_that_paused_have_the_times_of_a_table(tmp_path, results, twelve, header, form):
    images = write_pictures(tmp_path / "frames", np.load(twelve)) if header and "image" in header else twelve
    rows = [form.format(n=n, t=f"{t:.3f}", ms=f"{1000 * t:.0f}").split(",") for n, t in enumerate(PAUSED)]
    times = save(tmp_path / "times.csv", rows if header is None or len(header) == 1 else rows[::-1], header)
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(count=60, step=0.05))
    sequence = imported(results, images, "--poses", poses, "--transform", "ProbeToTracker", "--times", times)
    np.testing.assert_allclose(places(sequence), 10 + 20 * PAUSED, atol=1e-6)


def test_the_marker_on_the_patient_is_the_reference(tmp_path, results, twelve, calibration, capsys):
    """Probe and patient move together in the tracker: in Reference the probe stands still but for its own 20 mm/s."""
    sway = [rigid((0.0, 2.0 * n, 5.0), (3.0 * n, -n, 0.0)) for n in range(12)]
    probe = [pose @ rigid(translation=(n, 20.0, 30.0)) for n, pose in enumerate(sway)]
    rows = [[0.05 * n, *flat([probe[n]])[0][:12], *flat([sway[n]])[0][:12]] for n in range(12)]
    names = [f"{tool}_m{i}{j}" for tool in ("Probe", "Marker") for i in range(3) for j in range(4)]
    poses = save(tmp_path / "p.csv", rows, ["time", *names])
    options = ["--transform", "ProbeToTracker", "--tool", "Probe", "--reference-tool", "Marker", "--calibration", calibration]
    sequence = imported(results, twelve, "--poses", poses, *options)
    found = sweep_poses(sequence).image_to_reference
    expected = [rigid(translation=(n, 20.0, 30.0)) @ IMAGE_TO_PROBE for n in range(12)]
    np.testing.assert_allclose(found, expected, atol=1e-9)
    assert "--reference" not in capsys.readouterr().out.split("to reconstruct:")[1]


def exported(tmp_path, sweep):
    """Images and poses of a sweep at 20 a second, as files."""
    np.save(tmp_path / "a.npy", np.asarray(sweep.images))
    matrices = [record.transforms[TransformName("Image", "Reference")].matrix for record in sweep.records]
    rows = [[0.05 * n, *matrix.ravel()] for n, matrix in enumerate(matrices)]
    return tmp_path / "a.npy", save(tmp_path / "p.csv", rows, ["time", *MATRIX])


def test_an_offset_that_is_asked_for_is_found_and_applied_in_the_same_run(tmp_path, results, capsys):
    images, poses = exported(tmp_path, late_sweep(late=0.2))
    options = ["--transform", "ImageToTracker", "--spacing", 1, 1, "--rate", 20, "--time-offset"]
    imported(results, images, "--poses", poses, *options, "auto")
    said = capsys.readouterr().out
    assert float(re.search(r"time offset: (\S+) s, found in the images and applied", said)[1]) == pytest.approx(0.2, abs=0.01)
    assert "Images and poses are in step" in said


def test_an_offset_that_a_sweep_does_not_tell_is_told_by_where_tool_and_images_begin(tmp_path, results, capsys):
    images, poses = exported(tmp_path, late_sweep(lambda t: 16.0 * max(t - 2.0, 0.0), late=1.3, seconds=8.0))
    options = ["--transform", "ImageToTracker", "--spacing", 1, 1, "--rate", 20]
    words = ["import", images, "--poses", poses, *options, "--time-offset", "auto", "--output", results / "s.igs.mha"]
    said = refused(words, capsys, results)
    assert float(re.search(r"If that is one movement, give --time-offset (\S+);", said)[1]) == pytest.approx(1.3, abs=0.15)
    imported(results, images, "--poses", poses, *options)
    capsys.readouterr()
    assert main(["info", str(results / "sweep.igs.mha"), "--reference", "Tracker"]) == 0
    assert "after the images begin to change. If that is one movement, give --time-offset 1." in " ".join(capsys.readouterr().out.split())

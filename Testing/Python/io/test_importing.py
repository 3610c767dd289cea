"""`aifrecon import`: exported frames and poses give the volume of the recording they are from, whatever the way they were written."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from files import IMAGE_TO_PROBE, SPACING, refused, tracked_sequence
from late_sweeps import late_sweep
from scipy.spatial.transform import Rotation
from sweeps import rigid

from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.io.foreign.images import ImportedImages
from AIFReconLib.io.foreign.importing import import_sequence
from AIFReconLib.io.foreign.options import ImportOptions
from AIFReconLib.io.foreign.poses.files import read_poses
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.poses import sweep_poses

SEQUENCE = tracked_sequence()
TIMES = [record.timestamp for record in SEQUENCE.records]


def tracker_pose(record, tool) -> np.ndarray:
    return record.transforms[TransformName(tool, "Tracker")].matrix


PROBE_TO_REFERENCE = [np.linalg.inv(tracker_pose(r, "Reference")) @ tracker_pose(r, "Probe") for r in SEQUENCE.records]
IMAGE_TO_REFERENCE = np.array([pose @ IMAGE_TO_PROBE for pose in PROBE_TO_REFERENCE])
RIGID_IMAGE_TO_REFERENCE = [pose @ np.diag([1 / SPACING[0], 1 / SPACING[1], 1 / 0.45, 1.0]) for pose in IMAGE_TO_REFERENCE]


def save(path, rows, header=None):
    lines = [",".join(header)] if header else []
    path.write_text("\n".join([*lines, *(",".join(map(str, row)) for row in rows)]))
    return path


def flat(matrices):
    return [matrix.ravel().tolist() for matrix in matrices]


def quaternions(matrices):
    """w x y z x y z, scalar first."""
    return [[*np.roll(Rotation.from_matrix(m[:3, :3]).as_quat(), 1).tolist(), *m[:3, 3].tolist()] for m in matrices]


@pytest.fixture
def frames(tmp_path):
    """The images of the recording as an array file, which needs no other package."""
    np.save(tmp_path / "frames.npy", np.asarray(SEQUENCE.images))
    return tmp_path / "frames.npy"


@pytest.fixture
def calibration(tmp_path):
    (tmp_path / "ImageToProbe.txt").write_text(" ".join(map(repr, IMAGE_TO_PROBE.ravel().tolist())))
    return tmp_path / "ImageToProbe.txt"


def pictures(folder, images):
    """Images as PNG files, called by their numbers."""
    pil = pytest.importorskip("PIL.Image", reason="Pillow is not installed")
    folder.mkdir()
    for n, image in enumerate(images):
        pil.fromarray(image).save(folder / f"{n}.png")
    return folder


def imported(results, *arguments):
    assert main(["import", *map(str, arguments), "--output", str(results / "sweep.igs.mha")]) == 0
    return read_sequence(results / "sweep.igs.mha")


def expected_volume():
    from dataclasses import replace

    calibrated = replace(SEQUENCE, transforms={TransformName("Image", "Probe"): TransformSample(IMAGE_TO_PROBE)})
    return reconstruct(calibrated, ReconstructionSettings(spacing=1.0)).intensity


def test_exported_pictures_and_poses_give_the_same_volume(tmp_path, results, calibration):
    folder = pictures(tmp_path / "frames", SEQUENCE.images)
    poses = save(tmp_path / "poses.csv", [[t, *row] for t, row in zip(TIMES, flat(PROBE_TO_REFERENCE))])
    sequence = imported(results, folder, "--poses", poses, "--transform", "ProbeToReference", "--calibration", calibration)
    found, expected = reconstruct(sequence, ReconstructionSettings(spacing=1.0)).intensity, expected_volume()
    np.testing.assert_allclose(found.ijk_to_reference, expected.ijk_to_reference, atol=1e-9)
    np.testing.assert_array_equal(found.array, expected.array)


def write_poses(tmp_path, how):
    """A file of the recording's poses in one of many ways, and the options that say which."""
    inverse = [np.linalg.inv(m) for m in PROBE_TO_REFERENCE]
    if how == "image to reference, pixels":
        return save(tmp_path / "p.csv", flat(IMAGE_TO_REFERENCE)), ["--transform", "ImageToReference"]
    if how == "image to reference, mm":
        options = ["--transform", "ImageToReference", "--spacing", *SPACING]
        return save(tmp_path / "p.csv", flat(RIGID_IMAGE_TO_REFERENCE)), options
    if how == "image to reference, mm, from the middle of the image":
        shifted = [m @ rigid(translation=(20 * SPACING[0], 15 * SPACING[1], 0)) for m in RIGID_IMAGE_TO_REFERENCE]
        options = ["--transform", "ImageToReference", "--spacing", *SPACING, "--image-origin-px", 20, 15]
        return save(tmp_path / "p.csv", flat(shifted)), options
    if how == "reference to image, mm":
        options = ["--transform", "ReferenceToImage", "--spacing", *SPACING]
        return save(tmp_path / "p.csv", flat([np.linalg.inv(m) for m in RIGID_IMAGE_TO_REFERENCE])), options
    if how == "image to reference, meters":
        meters = [np.diag([1e-3, 1e-3, 1e-3, 1]) @ m for m in IMAGE_TO_REFERENCE]
        return save(tmp_path / "p.csv", flat(meters)), ["--transform", "ImageToReference", "--units", "m"]
    if how == "reference to probe":
        return save(tmp_path / "p.csv", flat(inverse)), ["--transform", "ReferenceToProbe"]
    if how == "probe, quaternions in meters":
        rows = [[*row[:4], *(v / 1000 for v in row[4:])] for row in quaternions(PROBE_TO_REFERENCE)]
        return save(tmp_path / "p.csv", rows), ["--columns", "qw qx qy qz x y z", "--units", "m", "--transform", "ProbeToReference"]
    if how == "probe, Euler angles":
        rows = [[*m[:3, 3].tolist(), *Rotation.from_matrix(m[:3, :3]).as_euler("ZYX").tolist()] for m in PROBE_TO_REFERENCE]
        options = ["--euler-order", "ZYX", "--angle-unit", "rad", "--transform", "ProbeToReference"]
        return save(tmp_path / "p.txt", rows), options
    (tmp_path / "p.json").write_text(json.dumps({"frames": [{"matrix": m.tolist(), "time": t} for t, m in zip(TIMES, PROBE_TO_REFERENCE)]}))
    return tmp_path / "p.json", ["--transform", "ProbeToReference"]


@pytest.mark.parametrize(
    "how",
    [
        "image to reference, pixels",
        "image to reference, mm",
        "image to reference, mm, from the middle of the image",
        "reference to image, mm",
        "image to reference, meters",
        "reference to probe",
        "probe, quaternions in meters",
        "probe, Euler angles",
        "probe, JSON",
    ],
)
def test_every_way_to_write_poses_puts_the_pixels_in_the_same_place(tmp_path, results, frames, calibration, how):
    poses, options = write_poses(tmp_path, how)
    if "probe" in how:
        options += ["--calibration", calibration]
    sequence = imported(results, frames, "--poses", poses, *options)
    found = sweep_poses(sequence).image_to_reference
    for pixel in ((0, 0, 0, 1), (39, 0, 0, 1), (0, 29, 0, 1), (12, 17, 0, 1)):
        np.testing.assert_allclose(found @ pixel, IMAGE_TO_REFERENCE @ pixel, atol=1e-8)


def test_poses_are_paired_by_the_names_of_their_images(tmp_path, results):
    folder = pictures(tmp_path / "frames", SEQUENCE.images)
    rows = [[f"somewhere/else/{n}.png", TIMES[n], *flat(IMAGE_TO_REFERENCE)[n]] for n in (5, 0, 3, 1, 2)]
    poses = save(tmp_path / "p.csv", rows, ["image", "time", *(f"m{r}{c}" for r in range(4) for c in range(4))])
    sequence = imported(results, folder, "--poses", poses, "--transform", "ImageToReference")
    found = sweep_poses(sequence)
    assert found.skipped() == {"ImageToReference MISSING": [4]}
    np.testing.assert_allclose(found.image_to_reference[3], IMAGE_TO_REFERENCE[3], atol=1e-12)


def test_poses_of_another_rate_are_interpolated_at_the_images(tmp_path, results):
    """Images of a DICOM file at 0, 0.04 and 0.08 s, poses every 0.02 s."""
    dicom = pytest.importorskip("pydicom", reason="pydicom is not installed")
    from dicom_samples import write_dicom

    images = write_dicom(dicom, tmp_path / "a.dcm", np.asarray(SEQUENCE.images)[:3], FrameTime=40.0)
    rows = [[0.02 * n + 0.01, *(rigid(translation=(n, 0, 0)) @ np.diag([0.4, 0.5, 1, 1])).ravel().tolist()] for n in range(-1, 5)]
    sequence = imported(results, images, "--poses", save(tmp_path / "p.csv", rows), "--transform", "ImageToReference")
    found = sweep_poses(sequence).image_to_reference[:, 0, 3]
    np.testing.assert_allclose(found, [-0.5, 1.5, 3.5], atol=1e-9)


@pytest.fixture
def zoomed(tmp_path):
    """A folder of two DICOM files of one frame each, of which neither the order nor the one size of a pixel is known."""
    dicom = pytest.importorskip("pydicom", reason="pydicom is not installed")
    from dicom_samples import write_dicom

    (tmp_path / "zoomed").mkdir()
    for number, size in enumerate((0.2, 0.4)):
        image = np.asarray(SEQUENCE.images)[number]
        write_dicom(dicom, tmp_path / "zoomed" / f"{number}.dcm", image, InstanceNumber=1, PixelSpacing=[size, size])
    return tmp_path / "zoomed"


def named_poses(path, names):
    rows = [[*pose.ravel()[:12].tolist(), name] for pose, name in zip(RIGID_IMAGE_TO_REFERENCE, names)]
    return save(path, rows, [*(f"m{r}{c}" for r in range(3) for c in range(4)), "image"])


def test_files_of_two_sizes_of_a_pixel_are_refused_with_both_and_the_option(tmp_path, results, zoomed, capsys):
    poses = named_poses(tmp_path / "p.csv", ("1.dcm", "0.dcm"))
    arguments = ["import", zoomed, "--poses", poses, "--transform", "ImageToReference", "--output", results / "s.mha"]
    assert "not known: 0.dcm says 0.2 x 0.2 mm, 1.dcm says 0.4 x 0.4 mm. Give --spacing X Y in mm" in refused(arguments, capsys, results)


def test_a_size_that_is_given_and_names_of_images_place_what_files_leave_open(tmp_path, results, zoomed):
    poses = named_poses(tmp_path / "p.csv", ("1.dcm", "0.dcm"))
    sequence = imported(results, zoomed, "--poses", poses, "--transform", "ImageToReference", "--spacing", *SPACING)
    np.testing.assert_allclose(sweep_poses(sequence).image_to_reference[:, :3, :2], IMAGE_TO_REFERENCE[[1, 0], :3, :2], atol=1e-6)


def test_images_whose_order_is_not_known_are_not_paired_in_order(tmp_path, results, zoomed, capsys):
    poses = save(tmp_path / "p.csv", flat(IMAGE_TO_REFERENCE[:2]))
    arguments = ["import", zoomed, "--poses", poses, "--transform", "ImageToReference", "--output", results / "s.mha"]
    said = refused(arguments, capsys, results)
    assert "order of the images is not known: InstanceNumber is missing, or occurs more than once. Name the image of each" in said


def test_pictures_stored_mirrored_are_turned(tmp_path, results):
    np.save(tmp_path / "frames.npy", np.asarray(SEQUENCE.images)[:, :, ::-1])
    poses, options = write_poses(tmp_path, "image to reference, pixels")
    sequence = imported(results, tmp_path / "frames.npy", "--poses", poses, *options, "--orientation", "UF")
    np.testing.assert_array_equal(sequence.images[3], SEQUENCE.images[3])


@pytest.mark.parametrize(
    ("how", "options", "message"),
    [
        ("image to reference, mm", ["--transform", "ImageToReference"], "size of a pixel is not known. Give --spacing X Y"),
        ("image to reference, pixels", ["--transform", "ImageToReference", "--spacing", "1", "1"], "hold the size of a pixel already"),
        ("image to reference, pixels", ["--transform", "ImageToReference", "--calibration", "CAL"], "no calibration to apply"),
        ("image to reference, pixels", ["--transform", "ProbeToReference"], "Pose 0 must be a rotation and a translation; it is not rigid"),
        ("reference to probe", ["--transform", "Probe"], "must be FromToTo"),
        ("reference to probe", ["--transform", "ProbeToTracker", "--spacing", "1", "1"], "does not say where the image lies in Probe"),
        ("reference to probe", ["--transform", "ProbeToTracker", "--spacing", "0", "1"], "spacing must be at least 1e-06"),
        ("reference to probe", ["--transform", "ProbeToTracker", "--rate", "-5"], "rate must be at least 1e-06"),
        ("reference to probe", ["--transform", "ProbeToTracker", "--orientation", "up"], "orientation must be MF, MN, UF or UN"),
        ("reference to probe", ["--transform", "ProbeToTracker", "--euler-order", "abc"], "three axes"),
        (
            "reference to probe",
            ["--transform", "NeedleToTracker", "--calibration", "ImageToProbe=CAL"],
            "must lead from Image to Needle or",
        ),
        (
            "reference to probe",
            ["--transform", "ProbeToTracker", "--calibration", "CAL", "--spacing", "1", "1"],
            "calibration holds the size",
        ),
    ],
)
def test_what_does_not_fit_is_explained(tmp_path, results, frames, calibration, capsys, how, options, message):
    poses, _ = write_poses(tmp_path, how)
    options = [word.replace("CAL", str(calibration)) for word in options]
    said = refused(["import", frames, "--poses", poses, *options, "--output", results / "s.mha"], capsys, results)
    assert re.search(message, said)


def test_a_damaged_picture_leaves_nothing_behind(tmp_path, results, capsys):
    folder = pictures(tmp_path / "frames", SEQUENCE.images)
    (folder / "4.png").write_bytes((folder / "4.png").read_bytes()[:200])
    poses = save(tmp_path / "p.csv", flat(IMAGE_TO_REFERENCE))
    said = refused(["import", folder, "--poses", poses, "--transform", "ImageToReference", "--output", results / "s.mha"], capsys, results)
    assert "4.png" in said


def test_two_images_of_one_name_are_not_given_one_pose(tmp_path, results, capsys):
    folders = [pictures(tmp_path / name, np.asarray(SEQUENCE.images)[:2]) for name in "ab"]
    rows = [[f"{n}.png", *row] for n, row in enumerate(flat(IMAGE_TO_REFERENCE)[:2])]
    poses = save(tmp_path / "p.csv", rows, header=["image", *(f"m{i}{j}" for i in range(4) for j in range(4))])
    words = ["import", *folders, "--poses", poses, "--transform", "ImageToReference", "-o", results / "x.mha"]
    assert "Two of the images are called 0.png" in refused(words, capsys, results)


COLUMNS = ["time", "x", "y", "z", "qx", "qy", "qz", "qw"]


def moving(count=12, step=0.05, speed=20.0, start=0.0):
    """Rows of a tool that moves along x, in mm and s."""
    return [[f"{start + step * n:.6f}", 10 + speed * step * n, 20, 30, 0, 0, 0, 1] for n in range(count)]


@pytest.fixture
def twelve(tmp_path):
    np.save(tmp_path / "twelve.npy", np.random.default_rng(1).integers(0, 255, (12, 24, 32), np.uint8))
    return tmp_path / "twelve.npy"


@pytest.mark.parametrize(
    ("header", "rows", "message"),
    [
        (COLUMNS, moving(speed=3000.0), "moves at 3 m/s, in the median.*--sure"),
        (COLUMNS, moving(speed=0.001), "move by 0.00055 mm in all. If they are in meters, give --units m"),
        (COLUMNS, moving(speed=0.0), "never moves: all poses are the same.*--sure"),
        (
            COLUMNS,
            moving(step=50.0, speed=0.02),
            "unit of the times .column time. is not known: in seconds, poses would be 50 s apart. Give --time",
        ),
        (["time_s", *COLUMNS[1:]], moving(step=50.0, speed=0.02), "Poses are 50 s apart"),
        ([*COLUMNS, "stamp"], [[*row, row[0]] for row in moving()], r"2 columns can be the time: time .column 1., stamp .column 9."),
        ([*COLUMNS, "tx"], [[*row, row[1]] for row in moving()], r"2 columns mean x: x .column 2., tx .column 9."),
        ([*COLUMNS, "status"], [[*row, "zzz"] for row in moving()], 'column status says of a pose is not known: zzz. .*--status-ok "zzz"'),
        ([*COLUMNS, "status"], [[*row, 0] for row in moving()], "not known: 0"),
        (
            ["time", *(f"{tool}_{name}" for tool in ("probe", "ref") for name in COLUMNS[1:])],
            [[*row, *row[1:]] for row in moving()],
            "poses of 2 tools side by side: probe, ref. .*--tool",
        ),
    ],
)
def test_what_no_hand_does_and_what_can_be_two_things_is_asked(tmp_path, results, twelve, capsys, header, rows, message):
    poses = save(tmp_path / "p.csv", header=header, rows=rows)
    said = refused(["import", twelve, "--poses", poses, "--transform", "ProbeToTracker", "-o", results / "s.mha"], capsys, results)
    assert re.search(message, said)


def test_poses_that_the_tracker_lost_are_not_judged(tmp_path, results, twelve):
    rows = [[*row, "OK"] if n % 2 else [row[0], *[0] * 7, "MISSING"] for n, row in enumerate(moving())]
    poses = save(tmp_path / "p.csv", header=[*COLUMNS, "status"], rows=rows)
    imported(results, twelve, "--poses", poses, "--transform", "ProbeToTracker")


def test_who_is_sure_gets_what_he_asks_for_and_the_doubt(tmp_path, results, twelve, capsys):
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(speed=3000.0))
    imported(results, twelve, "--poses", poses, "--transform", "ProbeToTracker", "--sure")
    assert "doubt: The tool moves at 3 m/s" in capsys.readouterr().out


def places(sequence):
    return np.array([record.transforms[TransformName("Probe", "Tracker")].matrix[0, 3] for record in sequence.records])


def test_equal_numbers_do_not_outvote_clocks_that_disagree(tmp_path, results, twelve):
    """12 images at 20 a second, 12 poses at 10 a second: frame 2 was taken at the second pose."""
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(step=0.1))
    sequence = imported(results, twelve, "--poses", poses, "--transform", "ProbeToTracker", "--rate", 20)
    np.testing.assert_allclose(places(sequence), 10 + 20 * 0.05 * np.arange(12), atol=1e-9)
    assert [record.timestamp for record in sequence.records] == pytest.approx([0.05 * n for n in range(12)])


def test_a_rate_pairs_images_with_more_poses_by_time(tmp_path, results, twelve):
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(count=60, step=0.01))
    sequence = imported(results, twelve, "--poses", poses, "--transform", "ProbeToTracker", "--rate", 20)
    np.testing.assert_allclose(places(sequence), 10 + 20 * 0.05 * np.arange(12), atol=1e-9)


PAUSED = np.r_[0.0:0.3:0.05, 1.8:2.1:0.05][:12]
"""s of twelve images with a pause amid them."""


@pytest.mark.parametrize(("header", "form"), [(["time"], "{t}"), (["image", "time_ms"], "{n}.png,{ms}"), (None, "{t}")])
def test_images_that_paused_have_the_times_of_a_table(tmp_path, results, twelve, header, form):
    images = pictures(tmp_path / "frames", np.load(twelve)) if header and "image" in header else twelve
    rows = [form.format(n=n, t=f"{t:.3f}", ms=f"{1000 * t:.0f}").split(",") for n, t in enumerate(PAUSED)]
    times = save(tmp_path / "times.csv", rows if header is None or len(header) == 1 else rows[::-1], header)
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(count=60, step=0.05))
    sequence = imported(results, images, "--poses", poses, "--transform", "ProbeToTracker", "--times", times)
    np.testing.assert_allclose(places(sequence), 10 + 20 * PAUSED, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time\n0\n1\n", "There must be as many times as images; got 2 times for 12 images"),
        ("a,b\n1,2\n", "a column 'time'"),
        ("", "'time'"),
    ],
)
def test_times_that_do_not_fit_are_refused(tmp_path, results, twelve, capsys, text, message):
    (tmp_path / "times.csv").write_text(text)
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(count=60, step=0.05))
    words = ["import", twelve, "--poses", poses, "--transform", "ProbeToTracker", "--times", tmp_path / "times.csv"]
    assert message in refused([*words, "--output", results / "s.mha"], capsys, results)


def test_images_at_a_rate_that_last_less_than_the_poses_are_told(tmp_path, results, twelve, capsys):
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(count=60, step=0.05))
    imported(results, twelve, "--poses", poses, "--transform", "ProbeToTracker", "--rate", 20)
    out = " ".join(capsys.readouterr().out.split())
    assert "the images last 0.6 s at 20 a second, the poses 3.0 s. If the images paused, give --times FILE instead of --rate." in out


def test_rows_without_an_image_are_poses_of_none(tmp_path, results):
    folder = pictures(tmp_path / "frames", SEQUENCE.images)
    of_images = [[f"{n}.png", *row] for n, row in enumerate(flat(IMAGE_TO_REFERENCE))]
    rows = [["", *of_images[0][1:]], *of_images, ["", *of_images[-1][1:]]]
    poses = save(tmp_path / "p.csv", rows, ["image", *(f"m{r}{c}" for r in range(4) for c in range(4))])
    assert len(imported(results, folder, "--poses", poses, "--transform", "ImageToReference")) == len(SEQUENCE)


def test_clocks_that_began_at_other_times_are_in_step(tmp_path, results, twelve):
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(start=1_700_000_000.0))
    sequence = imported(results, twelve, "--poses", poses, "--transform", "ProbeToTracker", "--rate", 20)
    assert sequence.records[1].timestamp == pytest.approx(1_700_000_000.05)


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


def test_images_that_began_later_get_the_poses_of_their_moment(tmp_path, results, twelve):
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(count=60, step=0.05))
    options = ["--transform", "ProbeToTracker", "--rate", 20, "--time-offset", 1.025]
    sequence = imported(results, twelve, "--poses", poses, *options)
    np.testing.assert_allclose(places(sequence), 10 + 20 * (1.025 + 0.05 * np.arange(12)), atol=1e-9)


@pytest.mark.parametrize("offset", [0.0, 0.5])
def test_a_clock_of_another_zero_begins_with_the_images_and_that_is_said(tmp_path, results, twelve, capsys, offset):
    rows = [[1_700_000_000.0 + float(row[0]), *row[1:]] for row in moving(count=60, step=0.05)]
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=rows)
    sequence = imported(results, twelve, "--poses", poses, "--transform", "ProbeToTracker", "--rate", 20, "--time-offset", offset)
    np.testing.assert_allclose(places(sequence), 10 + 20 * (offset + 0.05 * np.arange(12)), atol=1e-4)
    began = f"the images were taken to begin {offset:g} s after the poses"
    assert f"images and poses count from different moments; {began}" in capsys.readouterr().out


def test_images_at_a_rate_and_poses_from_zero_are_told(tmp_path, results, twelve, capsys):
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(count=60, step=0.02))
    imported(results, twelve, "--poses", poses, "--transform", "ProbeToTracker", "--rate", 20)
    assert "both count from 0" in capsys.readouterr().out


def test_a_tool_that_is_not_used_may_be_a_marker_on_the_patient(tmp_path, results, twelve, capsys):
    axes = ("x", "y", "z", "qx", "qy", "qz", "qw")
    columns = ["time", *(f"{tool}_{axis}" for tool in ("Probe", "Back") for axis in axes)]
    poses = save(tmp_path / "p.csv", [[*row, *row[1:]] for row in moving(count=40)], columns)
    options = ["--poses", poses, "--tool", "Probe", "--transform", "ProbeToTracker", "--rate", 20]
    imported(results, twelve, *options)
    assert "If a tool of these is a marker on the patient, give it with --reference-tool." in capsys.readouterr().out
    imported(results, twelve, *options, "--reference-tool", "Back")
    assert "not used" not in capsys.readouterr().out


def exported(tmp_path, sweep):
    """Images and poses of a sweep at 20 a second, as files."""
    np.save(tmp_path / "a.npy", np.asarray(sweep.images))
    matrices = [record.transforms[TransformName("Image", "Reference")].matrix for record in sweep.records]
    rows = [[0.05 * n, *matrix.ravel()] for n, matrix in enumerate(matrices)]
    return tmp_path / "a.npy", save(tmp_path / "p.csv", rows, ["time", *(f"m{i}{j}" for i in range(4) for j in range(4))])


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


def test_an_offset_is_not_sought_without_a_calibration_and_that_is_said_in_options(tmp_path, results, twelve, capsys):
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(count=60, step=0.02))
    words = ["import", twelve, "--poses", poses, "--transform", "ProbeToTracker", "--rate", 20, "--time-offset", "auto"]
    said = refused([*words, "--output", results / "s.igs.mha"], capsys, results)
    assert "give the calibration with --calibration" in said
    assert "config=" not in said


def test_two_clocks_from_zero_are_told(tmp_path, results, capsys):
    dicom = pytest.importorskip("pydicom", reason="pydicom is not installed")
    from dicom_samples import write_dicom

    images = write_dicom(dicom, tmp_path / "a.dcm", np.asarray(SEQUENCE.images)[:3], FrameTime=40.0)
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=moving(count=20, step=0.02))
    imported(results, images, "--poses", poses, "--transform", "ProbeToTracker")
    advice = "If the images began 2 s after the poses, give --time-offset 2; if 2 s before, -2"
    assert f"both count from 0, and were taken to begin at one moment. {advice}" in capsys.readouterr().out


def test_no_pose_is_made_up_where_the_tracker_lost_the_tool(tmp_path):
    rows = "".join(f"{n / 20},{5 * n},0,0,0,0,0,1,{'MISSING' if n == 2 else 'OK'}\n" for n in range(6))
    (tmp_path / "poses.csv").write_text("time,x,y,z,qx,qy,qz,qw,status\n" + rows)
    images = ImportedImages(np.zeros((4, 4, 4), np.uint8), "images", times=np.array([0.02, 0.1, 0.12, 0.22]))
    options = ImportOptions(transform="ProbeToTracker", sure=True)
    sequence, _ = import_sequence(images, read_poses(tmp_path / "poses.csv"), options)
    counts = sequence.status_counts(TransformName("Probe", "Tracker"))
    assert (counts[TransformStatus.OK], counts[TransformStatus.MISSING]) == (2, 2)


def test_when_tool_and_images_begin_to_move_is_told(tmp_path, results, capsys):
    still, shown = [[f"{0.02 * n:.2f}", 10, 20, 30, 0, 0, 0, 1] for n in range(65)], np.random.default_rng(1).integers(0, 255, (40, 24, 32))
    poses = save(tmp_path / "p.csv", header=COLUMNS, rows=[*still, *moving(count=60, step=0.02, speed=100.0, start=1.3)])
    np.save(tmp_path / "a.npy", shown.astype(np.uint8)[np.maximum(np.arange(40) - 6, 0)])
    imported(results, tmp_path / "a.npy", "--poses", poses, "--transform", "ProbeToTracker", "--rate", 20)
    begun = re.search(r"begins to move at (\S+) s, and the images to change at (\S+) s. .* --time-offset (\S+);", capsys.readouterr().out)
    assert [float(each) for each in begun.groups()] == pytest.approx([1.3, 0.35, 0.95], abs=0.03)

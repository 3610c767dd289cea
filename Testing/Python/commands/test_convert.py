"""`aifrecon convert`: nothing is lost, what is cut stays in its place, and a wrong calibration can be mended afterwards."""

from __future__ import annotations

import re
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from files import IMAGE_TO_PROBE, refused, tracked_sequence, write_configuration, write_patient
from late_sweeps import late_sweep
from sequence_samples import assert_same_records
from sweeps import rigid

from AIFReconLib.commands.parser import main
from AIFReconLib.errors import FileFormatError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.inspection.offset_estimate import estimate_time_offset
from AIFReconLib.io.foreign.calibration import read_calibration
from AIFReconLib.io.metafile.metafile import UNFINISHED
from AIFReconLib.io.sequence import file_images
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.transform.files import write_transform
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

IMAGE_TO_PROBE_NAME, IMAGE_TO_REFERENCE = TransformName("Image", "Probe"), TransformName("Image", "Reference")
WRONG = rigid((8.0, 3.0, -6.0), (4.0, 9.0, -3.0)) @ np.diag([0.3, 0.6, 0.45, 1.0])


def add_transform(path, source, target):
    """One more transform, the identity, in a configuration."""
    element = f'<Transform From="{source}" To="{target}" Matrix="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1" />'
    path.write_text(path.read_text().replace("</CoordinateDefinitions>", f"{element}</CoordinateDefinitions>"))


def rich_sequence() -> TrackedSequence:
    """Every kind of field that a recording may hold."""
    sequence = tracked_sequence(statuses={2: TransformStatus.OUT_OF_VIEW})
    records = [
        replace(record, unfiltered_timestamp=(record.timestamp or 0.0) + 1e-3, fields={"FrameNumber": str(100 + n), "Note": "a = b : c"})
        for n, record in enumerate(sequence.records)
    ]
    records[4] = replace(records[4], image_status=TransformStatus.INVALID)
    header = {IMAGE_TO_PROBE_NAME: TransformSample(IMAGE_TO_PROBE)}
    return replace(sequence, records=records, fields={"Operator": "JD"}, transforms=header)


def assert_same(actual: TrackedSequence, expected: TrackedSequence) -> None:
    np.testing.assert_array_equal(np.asarray(actual.images), np.asarray(expected.images))
    assert (actual.images.dtype, actual.fields) == (expected.images.dtype, expected.fields)
    mine, theirs = ([FrameRecord(transforms=each.transforms), *each.records] for each in (actual, expected))
    assert_same_records(mine, theirs)


def convert(source, target, *options) -> TrackedSequence:
    assert main(["convert", str(source), str(target), *map(str, options)]) == 0
    return read_sequence(target)


@pytest.mark.parametrize("dtype", ["u1", "u2", "i2", "f4"])
@pytest.mark.parametrize("compress", ["--compress", "--no-compress"])
@pytest.mark.parametrize("suffixes", [(".mha", ".nrrd"), (".nrrd", ".mhd"), (".mhd", ".mha")])
def test_there_and_back_is_lossless(tmp_path, suffixes, compress, dtype):
    original = rich_sequence()
    original = replace(original, images=(np.asarray(original.images) * (100 if dtype != "u1" else 1)).astype(dtype))
    write_sequence(original, tmp_path / f"a{suffixes[0]}")
    convert(tmp_path / f"a{suffixes[0]}", tmp_path / f"b{suffixes[1]}", compress)
    assert_same(convert(tmp_path / f"b{suffixes[1]}", tmp_path / f"c{suffixes[0]}", compress), original)


def test_frames_are_chosen_by_first_last_and_step(patient, results):
    found = convert(patient.sweep, results / "s.mha", "--frames", 1, 5, "--every", 2)
    np.testing.assert_array_equal(np.asarray(found.images), np.asarray(patient.sequence.images)[1:6:2])
    assert [record.timestamp for record in found.records] == [patient.sequence.records[n].timestamp for n in (1, 3, 5)]


@pytest.mark.parametrize("frame", ["Image", "Video"])
def test_a_cropped_image_stays_in_its_place_whatever_its_frame_is_called(frame, patient, results):
    text = patient.config.read_text()
    patient.config.write_text(text.replace('From="Image"', f'From="{frame}"').replace('"Image" Out', f'"{frame}" Out'))
    original = read_sequence(patient.sweep, config=patient.config)
    convert(patient.sweep, results / "s.mha", "--crop", 7, 4, 20, 15, "--config", patient.config)
    found = read_sequence(results / "s.mha", config=patient.config)
    assert found.frame_size == (20, 15)
    np.testing.assert_array_equal(found.images[3], original.images[3][4:19, 7:27])
    before = sweep_poses(original).image_to_reference[3] @ (9.0, 6.0, 0.0, 1.0)
    np.testing.assert_allclose(sweep_poses(found).image_to_reference[3] @ (2.0, 2.0, 0.0, 1.0), before, atol=1e-9)


def test_an_infinite_pose_is_cropped_without_a_word_of_python(patient, results, capsys):
    write_sequence(tracked_sequence(matrices={2: np.full((4, 4), np.inf)}), patient.sweep)
    convert(patient.sweep, results / "s.mha", "--crop", 7, 4, 20, 15, "--rename", "Probe=Image")
    assert "Warning" not in capsys.readouterr().err


def test_what_a_killed_recording_left_is_complete_when_it_was_converted(tmp_path):
    """The mark of an unfinished recording would keep readers from seeing bytes too many."""
    write_sequence(replace(rich_sequence(), fields={UNFINISHED: "True"}), tmp_path / "a.mha", compress=False)
    assert UNFINISHED not in convert(tmp_path / "a.mha", tmp_path / "b.mha").fields


def test_a_frame_is_renamed_in_every_transform(patient, results):
    found = convert(patient.sweep, results / "s.mha", "--rename", "Tracker=Camera")
    assert list(map(str, found.transform_names())) == ["ProbeToCamera", "ReferenceToCamera"]


def test_two_names_can_be_swapped_through_a_third(patient, results):
    swap = ("--rename", "Probe=Temporary", "--rename", "Reference=Probe", "--rename", "Temporary=Reference")
    found = convert(patient.sweep, results / "s.mha", *swap)
    expected = patient.sequence.records[2].transforms[TransformName("Probe", "Tracker")].matrix
    np.testing.assert_array_equal(found.records[2].transforms[TransformName("Reference", "Tracker")].matrix, expected)


def volume_of(sequence_path, results, *options):
    assert main(["reconstruct", str(sequence_path), *map(str, options), "--spacing", "1", "--output", str(results / "v.nrrd")]) == 0
    return read_volume(results / "v.nrrd")


@pytest.mark.parametrize("kind", ["xml", "tfm", "txt"])
def test_a_wrong_calibration_in_the_recording_is_mended(tmp_path, results, kind):
    patient = write_patient(tmp_path)
    expected = volume_of(patient.sweep, results, "--config", patient.config)
    wrong = replace(patient.sequence, transforms={IMAGE_TO_PROBE_NAME: TransformSample(WRONG)})
    write_sequence(wrong, tmp_path / "wrong.mha")
    right = tmp_path / f"right.{kind}"
    if kind == "xml":
        write_configuration(right)
    elif kind == "tfm":
        write_transform(IMAGE_TO_PROBE, right)
    else:
        right.write_text("\n".join(" ".join(map(repr, row)) for row in IMAGE_TO_PROBE.tolist()))
    convert(tmp_path / "wrong.mha", tmp_path / "mended.mha", "--calibration", right)
    mended = volume_of(tmp_path / "mended.mha", results)
    np.testing.assert_allclose(mended.ijk_to_reference, expected.ijk_to_reference, atol=1e-6)
    assert (mended.array != expected.array).mean() < (1e-4 if kind == "tfm" else 1e-12)


def placed_sequence(calibration) -> TrackedSequence:
    """A recording that holds ImageToReference alone, made with this calibration."""
    sequence = tracked_sequence()
    records = []
    for record in sequence.records:
        probe, reference = (record.transforms[TransformName(frame, "Tracker")].matrix for frame in ("Probe", "Reference"))
        sample = TransformSample(np.linalg.inv(reference) @ probe @ calibration)
        records.append(replace(record, transforms={IMAGE_TO_REFERENCE: sample}))
    return replace(sequence, records=records)


def test_a_wrong_calibration_within_recorded_poses_is_mended(tmp_path):
    write_sequence(placed_sequence(WRONG), tmp_path / "wrong.mha")
    right, wrong = write_configuration(tmp_path / "right.xml"), write_configuration(tmp_path / "wrong.xml", matrix=WRONG)
    options = ("--calibration", right, "--wrong-calibration", wrong)
    mended = convert(tmp_path / "wrong.mha", tmp_path / "mended.mha", *options)
    expected = sweep_poses(placed_sequence(IMAGE_TO_PROBE)).image_to_reference
    np.testing.assert_allclose(sweep_poses(mended).image_to_reference, expected, atol=1e-9)


def test_slicers_sequences_become_one_recording(tmp_path):
    from variant_files import EXPECTED, landmarks_mm, slicer_images, slicer_transforms

    images, transforms = slicer_images(tmp_path / "i.seq.nrrd"), slicer_transforms(tmp_path / "t.seq.mha")
    found = convert(images, tmp_path / "s.igs.mha", "--transform-sequence", f"ImageToReference={transforms}")
    np.testing.assert_allclose(landmarks_mm(found), EXPECTED, atol=1e-9)


def test_poses_with_an_unknown_calibration_in_them_are_not_touched(tmp_path, results, capsys):
    write_sequence(placed_sequence(WRONG), tmp_path / "wrong.mha")
    arguments = ["convert", tmp_path / "wrong.mha", results / "s.mha", "--calibration", write_configuration(tmp_path / "right.xml")]
    assert "its ImageToReference includes the calibration that it was recorded with" in refused(arguments, capsys, results)


def test_of_a_configuration_the_calibration_of_the_image_is_taken_and_of_two_it_is_asked_which(tmp_path):
    path = write_configuration(tmp_path / "c.xml")
    add_transform(path, "Needle", "Probe")
    name, matrix = read_calibration(path)
    assert name == IMAGE_TO_PROBE_NAME
    np.testing.assert_array_equal(matrix, IMAGE_TO_PROBE)
    add_transform(write_configuration(path), "Image", "Needle")
    with pytest.raises(FileFormatError, match="one transform from Image; got ImageToProbe, ImageToNeedle"):
        read_calibration(path)
    np.testing.assert_array_equal(read_calibration(path, TransformName("Image", "Needle"))[1], np.eye(4))


def test_a_long_recording_is_never_in_memory_as_a_whole(tmp_path, monkeypatch):
    monkeypatch.setattr(file_images, "KEPT_BYTES", 2**20)
    count = 400
    images = np.broadcast_to(np.arange(256, dtype=np.uint8).reshape(1, 1, 256), (count, 256, 256))
    write_sequence(TrackedSequence(images, [FrameRecord(timestamp=0.1 * n) for n in range(count)]), tmp_path / "long.mha")
    tracemalloc.start()
    try:
        assert main(["convert", str(tmp_path / "long.mha"), str(tmp_path / "copy.nrrd"), "--every", "2"]) == 0
        assert tracemalloc.get_traced_memory()[1] < 6_000_000  # the recording has 26 MB
    finally:
        tracemalloc.stop()


def test_an_offset_is_found_and_applied_in_one_run(tmp_path, capsys):
    write_sequence(late_sweep(late=0.2), tmp_path / "late.mha")
    assert main(["convert", str(tmp_path / "late.mha"), str(tmp_path / "mended.mha"), "--time-offset", "auto"]) == 0
    assert re.search(r"Poses are those of 0\.(19|20|21)\d* s after each image's time stamp", capsys.readouterr().out)
    mended = read_sequence(tmp_path / "mended.mha")
    assert "in step" in estimate_time_offset(mended, sweep_poses(mended)).to_text()

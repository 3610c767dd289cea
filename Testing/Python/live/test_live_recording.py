"""Recordings of a stream: what is in them, and what is left of them when the program or the disk fails."""

from __future__ import annotations

import contextlib
import errno
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
import SimpleITK as sitk
from live_messages import SMALL, image, metadata, tracked
from sweeps import image_pose

from AIFReconLib.errors import OutputError, SequenceFormatError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.live.pairing.synchronizer import LiveFrame, Synchronizer
from AIFReconLib.live.session import recording
from AIFReconLib.live.session.recording import Recorder
from AIFReconLib.live.session.resumed_recording import unfinished_frames
from AIFReconLib.sweep.configuration import NO_CONFIGURATION
from AIFReconLib.sweep.frames import FrameRecord
from AIFReconLib.sweep.poses import sweep_poses

PROBE_TO_TRACKER = TransformName("Probe", "Tracker")


def frames(count=5, unseen=(), **options):
    messages = [m for n in range(count) for m in tracked(1.0 + 0.1 * n, probe=n not in unseen, pixels=SMALL + n, **options)]
    synchronizer = Synchronizer()
    return [frame for message in messages for frame in synchronizer.feed(message)] + synchronizer.flush()


@pytest.fixture
def record():
    """Records frames; what a test leaves open is closed."""
    recorders = []

    def start(path, stream, takes_up=False):
        recorders.append(Recorder(path, takes_up))
        append_all(recorders[-1], stream)
        return recorders[-1]

    yield start
    for recorder in recorders:
        recorder.close()


def append_all(recorder, stream):
    for frame in stream:
        recorder.append(frame)


@pytest.mark.parametrize("suffix", [".mha", ".mhd", ".nrrd"])
def test_a_finished_recording_holds_every_image(suffix, tmp_path, record):
    recorder = record(tmp_path / f"scan.igs{suffix}", frames())
    assert recorder.finish() == tmp_path / f"scan.igs{suffix}"
    np.testing.assert_array_equal(np.asarray(read_sequence(tmp_path / f"scan.igs{suffix}").images), [SMALL + n for n in range(5)])
    assert (recorder.loss, recorder.failure) == (None, None)
    assert {path.name for path in tmp_path.iterdir()} == {f"scan.igs{suffix}"} | ({"scan.igs.raw"} if suffix == ".mhd" else set())


def test_transforms_and_times_are_recorded_to_the_bit(tmp_path, record):
    stream = frames()
    record(tmp_path / "scan.mha", stream).finish()
    for frame, kept in zip(stream, read_sequence(tmp_path / "scan.mha").records, strict=True):
        assert kept.timestamp == frame.timestamp
        assert kept.transforms.keys() == frame.record.transforms.keys()
        for name, sample in kept.transforms.items():
            np.testing.assert_array_equal(sample.matrix, frame.record.transforms[name].matrix)


@pytest.mark.parametrize("told", [{}, metadata(ProbeToTracker="OUT_OF_VIEW", ReferenceToTracker="OK")])
def test_a_recording_gives_the_poses_and_statuses_that_the_stream_gave(told, tmp_path, record):
    synchronizer = Synchronizer()
    messages = [*tracked(1.0), *tracked(2.0), image(3.0, metadata=told, version=2), *tracked(4.0, probe=False), *tracked(5.0, probe=False)]
    stream = [frame for message in messages for frame in synchronizer.feed(message)] + synchronizer.flush()
    record(tmp_path / "scan.mha", stream).finish()
    poses = sweep_poses(read_sequence(tmp_path / "scan.mha"))
    assert (
        [problem is None for problem in poses.problems] == [frame.status == "OK" for frame in stream] == [True, True, False, False, False]
    )
    for pose, frame in zip(poses.image_to_reference, stream, strict=True):
        if frame.status == "OK":
            np.testing.assert_array_equal(pose, frame.image_to_reference)


def test_a_pose_that_is_not_confirmed_is_not_usable_from_the_recording_either(tmp_path, record):
    synchronizer = Synchronizer()
    stream = [frame for t in (1.0, 2.0) for frame in synchronizer.feed(image(t))] + synchronizer.flush()
    record(tmp_path / "scan.mha", stream).finish()
    assert not sweep_poses(read_sequence(tmp_path / "scan.mha")).usable.size


@pytest.mark.parametrize("name", ["two\nlines", "a = b", "a:b"])
def test_a_field_that_the_header_cannot_hold_ends_the_recording_and_leaves_it_whole(name, tmp_path, record):
    stream = frames(3)
    stream[2] = replace(stream[2], record=replace(stream[2].record, fields={name: "1"}))
    recorder = record(tmp_path / "scan.mhd", stream)
    recorder.finish()
    assert "must be one line" in recorder.failure
    assert len(read_sequence(tmp_path / "scan.mhd")) == 2


def test_a_finished_file_with_bytes_too_many_is_still_refused(tmp_path, record):
    record(tmp_path / "scan.mhd", frames(3)).finish()
    with open(tmp_path / "scan.raw", "ab") as file:
        file.write(b"x")
    with pytest.raises(SequenceFormatError, match="1 bytes more"):
        read_sequence(tmp_path / "scan.mhd")


@pytest.mark.parametrize("moment", range(9))
def test_a_crash_between_any_two_writes_leaves_a_file_that_can_be_read(moment, tmp_path, monkeypatch, record):
    """Every write is a moment: the program dies half way through it, and what others then read is every frame before."""

    class Crash(BaseException):
        pass

    real, steps = Recorder._write, iter(range(1000))

    def write(file, data):
        if next(steps) == moment:
            file.write(memoryview(data).cast("B")[: memoryview(data).nbytes // 2])
            raise Crash
        real(file, data)

    recorder = record(tmp_path / "scan.mha", frames(1))
    monkeypatch.setattr(Recorder, "_write", staticmethod(write))
    with pytest.raises(Crash):
        append_all(recorder, frames(4)[1:])
    images = np.asarray(read_sequence(recorder.header_path).images)
    # The number of frames is the third of four writes
    assert len(images) == 1 + (moment + 2) // 4
    np.testing.assert_array_equal(images, [SMALL + n for n in range(len(images))])
    assert sitk.ReadImage(str(recorder.header_path)).GetSize() == (SMALL.shape[1], SMALL.shape[0], len(images))
    monkeypatch.undo()
    recorder.close()
    again = record(tmp_path / "scan.mha", [], takes_up=True)
    # Of a frame all of which was written, nothing is lost
    assert again.frames == 1 + (moment + 2) // 4
    append_all(again, frames(9)[again.frames :])
    images = np.asarray(read_sequence(again.finish()).images)
    np.testing.assert_array_equal(images, [SMALL + n for n in range(9)])
    assert [path.name for path in tmp_path.iterdir()] == ["scan.mha"]


CHILD = """
import sys, numpy as np
from AIFReconLib.live.session import recording
from AIFReconLib.live.pairing.synchronizer import LiveFrame
recorder = recording.Recorder(sys.argv[1])
number = 0
while True:
    recorder.append(LiveFrame(np.full((64, 64), number % 251, np.uint8), None, record=recording.LiveFrame(None, None).record))
    number += 1
    if number == 20:
        print("going", flush=True)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill -9 here")
@pytest.mark.parametrize("delay_ms", [0, 3, 11, 40])
def test_a_killed_program_leaves_a_recording_that_can_be_read(delay_ms, tmp_path):
    child = subprocess.Popen([sys.executable, "-c", CHILD, str(tmp_path / "scan.mha")], stdout=subprocess.PIPE)
    with child:
        child.stdout.readline()
        time.sleep(delay_ms / 1000)
        child.send_signal(signal.SIGKILL)
    sequence = read_sequence(tmp_path / "scan.recording.mhd")
    assert [int(picture[0, 0]) for picture in sequence.images] == [n % 251 for n in range(len(sequence))]
    assert len(sequence) > 0


def finished(record, path):
    record(path, frames(2)).finish()


def unfinished(record, path):
    record(path, frames(2)).close()


def a_file(record, path):
    path.write_bytes(b"precious")


NOT_FINISHED = "is there, of a recording that is not finished"
TAKEN = [
    ("scan.mha", "scan.mha", finished, "scan.mha is there already"),
    ("scan.igs.mha", "scan.igs.mha", finished, "scan.igs.mha is there already"),
    ("scan.mhd", "scan.mhd", finished, "scan.mhd is there already"),
    ("scan.raw", "scan.mhd", a_file, "scan.raw is there already"),
    ("scan.recording.raw", "scan.mha", a_file, f"scan.recording.raw {NOT_FINISHED}"),
    ("scan.mha", "scan.nrrd", unfinished, f"scan.recording.mhd {NOT_FINISHED}"),
    (
        "scan.mha",
        "scan.mha",
        lambda record, path: record(path, frames(2)),
        "scan.recording.mhd is there, of a recording that is not finished",
    ),
]


# What is unfinished can be taken up
WITH_AND_WITHOUT = [(*case, takes_up) for case in TAKEN for takes_up in (False, True) if not (takes_up and case[2] is unfinished)]


@pytest.mark.parametrize(("there", "asked", "make", "why", "takes_up"), WITH_AND_WITHOUT)
def test_a_recording_whose_name_is_taken_gets_another_and_touches_nothing(there, asked, make, why, takes_up, tmp_path, record, monkeypatch):
    monkeypatch.setattr(recording, "_PATIENCE", 0.0)
    make(record, tmp_path / there)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    other = tmp_path / asked.replace("scan", "scan-2")
    recorder = record(tmp_path / asked, frames(3), takes_up)
    assert recorder.note == f"{why}, so this scan is recorded to {other.name}."
    assert recorder.finish() == other
    assert len(read_sequence(other)) == 3
    assert before == {name: (tmp_path / name).read_bytes() for name in before}


def test_of_two_that_begin_under_one_name_each_records_all_and_removes_nothing_of_the_other(tmp_path, record):
    """The second has begun before the first had a frame, and ends without one: it has nothing to remove."""
    first, second, third = (record(tmp_path / "scan.mha", []) for _ in range(3))
    append_all(first, frames(4))
    assert second.finish() is None
    append_all(third, frames(2))
    assert [len(read_sequence(each.finish())) for each in (first, third)] == [4, 2]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["scan-2.mha", "scan.mha"]
    assert third.note == "scan.recording.mhd is there, of a recording that is not finished, so this scan is recorded to scan-2.mha."


@pytest.mark.parametrize("name", ["scan.mha", "scan.mhd", "scan.raw"])
def test_a_file_that_comes_about_during_the_scan_is_not_replaced(name, tmp_path, record):
    recorder = record(tmp_path / name.replace("raw", "mhd"), frames())
    (tmp_path / name).write_bytes(b"precious")
    assert len(read_sequence(recorder.finish())) == 5
    assert recorder.path.name.startswith("scan-2.")
    assert (tmp_path / name).read_bytes() == b"precious"
    assert f"{name} came about during the scan" in recorder.note


def test_a_recording_is_taken_up_twice_and_all_frames_are_there_poses_or_not(tmp_path, record):
    path, told = tmp_path / "scan.mhd", {}
    stream = [of_size(8, 1.0 + n, seen=n >= 3) for n in range(9)]
    for first in (0, 3, 6):
        recorder = record(path, stream[first : first + 3], takes_up=first > 0)
        told[first] = [frame.timestamp for frame, _ in unfinished_frames(path, NO_CONFIGURATION)]
        recorder.close()
    assert told == {first: [1.0 + n for n in range(first + 3)] for first in told}
    recorder = record(path, [], takes_up=True)
    assert [each.timestamp for each in read_sequence(recorder.finish()).records] == [frame.timestamp for frame in stream]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["scan.mhd", "scan.raw"]


@pytest.mark.parametrize("suffix", [".mha", ".mhd", ".nrrd"])
def test_seconds_that_are_missing_are_said_and_marked_in_the_file_each_time_that_its_program_was_lost(suffix, tmp_path, record):
    path = tmp_path / f"scan.igs{suffix}"
    for begin in (1.0, 1.5, 7.5, 20.0):
        recorder = record(path, [of_size(8, begin + 0.1 * n) for n in range(5)], takes_up=begin > 1.0)
        recorder.close()
    assert recorder.note == "12.1 s of the scan are missing after 7.90 s: the program that recorded was lost."
    gaps = [each.fields.get("AIFRecon_gap") for each in read_sequence(record(path, [], takes_up=True).finish()).records]
    # Half a second may be a pause of the scanner
    assert gaps == [None] * 10 + ["5.600"] + [None] * 4 + ["12.100"] + [None] * 4


@pytest.mark.parametrize("writes", range(4))
def test_a_full_disk_takes_nothing_of_what_is_taken_up(writes, tmp_path, monkeypatch, record):
    record(tmp_path / "scan.mha", frames(4)).close()
    full_after(monkeypatch, writes)
    recorder = record(tmp_path / "scan.mha", frames(6)[4:], takes_up=True)
    recorder.close()
    assert recorder.failure.endswith(f"4 frames are kept in {recorder.header_path}.") == (writes < 2)
    images = np.asarray(read_sequence(recorder.header_path).images)
    assert len(images) >= 4
    np.testing.assert_array_equal(images, [SMALL + n for n in range(len(images))])


def test_what_died_while_it_was_finished_is_left_as_it_is_and_both_can_be_read(tmp_path, monkeypatch, record):
    monkeypatch.setattr(Recorder, "_remove", Recorder.close)
    assert record(tmp_path / "scan.mhd", frames(3)).finish() == tmp_path / "scan.mhd"
    monkeypatch.undo()
    recorder = record(tmp_path / "scan.mhd", frames(5), takes_up=True)
    assert recorder.finish() == tmp_path / "scan-2.mhd"
    assert [len(read_sequence(tmp_path / name)) for name in ("scan.mhd", "scan.recording.mhd", "scan-2.mhd")] == [3, 3, 5]


def test_a_recording_that_cannot_be_read_is_kept_and_not_taken_up(tmp_path, record):
    record(tmp_path / "scan.mha", frames()).close()
    damaged = (tmp_path / "scan.recording.mhd").read_bytes().replace(b"DimSize = ", b"DimSize = x")
    (tmp_path / "scan.recording.mhd").write_bytes(damaged)
    recorder = record(tmp_path / "scan.mha", frames(), takes_up=True)
    assert recorder.finish() == tmp_path / "scan-2.mha"
    assert (tmp_path / "scan.recording.mhd").read_bytes() == damaged


@pytest.mark.skipif(sys.platform == "win32", reason="files that are open cannot be removed there")
def test_a_recording_whose_files_were_removed_says_that_nothing_is_left(tmp_path, record):
    recorder = record(tmp_path / "scan.mha", frames())
    for path in tmp_path.iterdir():
        path.unlink()
    assert recorder.finish() is None
    assert f"Of 5 frames 0 can still be read, in {recorder.header_path}" in recorder.failure


def full_after(monkeypatch, count):
    """The disk takes `count` more writes, and a part of the next one."""
    real, left = Recorder._write, iter(range(count))

    def write(file, data):
        if next(left, None) is None:
            file.write(memoryview(data).cast("B")[: memoryview(data).nbytes // 2])
            raise OSError(errno.ENOSPC, "No space left on device")
        real(file, data)

    monkeypatch.setattr(Recorder, "_write", staticmethod(write))


@pytest.mark.parametrize("suffix", [".mha", ".mhd", ".nrrd"])
@pytest.mark.parametrize("writes", [9, 10])
def test_a_full_disk_stops_the_recording_and_what_was_recorded_before_can_be_read(suffix, writes, tmp_path, monkeypatch, record):
    full_after(monkeypatch, writes)
    recorder = record(tmp_path / f"scan{suffix}", frames())
    assert recorder.failure == f"Recording stopped: the disk is full. 3 frames are kept in {recorder.header_path}."
    recorder.finish()
    assert recorder.failure.endswith(f"3 frames are kept in {recorder.path}.")
    np.testing.assert_array_equal(np.asarray(read_sequence(recorder.path).images), [SMALL, SMALL + 1, SMALL + 2])


@pytest.mark.parametrize("name", ["scan.recording.raw", "scan.recording.mhd"])
def test_a_link_in_the_place_of_a_recorders_file_leads_to_no_other_file(name, tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "precious").write_text("precious", encoding="utf-8")
    os.symlink(tmp_path / "other" / "precious", tmp_path / name)
    with contextlib.suppress(OutputError):
        recorder = Recorder(tmp_path / "scan.mha")
        append_all(recorder, frames())
        recorder.finish()
    assert (tmp_path / "other" / "precious").read_text("utf-8") == "precious"


def test_a_recording_that_cannot_begin_says_why(tmp_path, monkeypatch, record):
    def full(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    recorder = record(tmp_path / "scan.mha", frames())
    assert recorder.failure.startswith("Recording stopped: Cannot write ")
    assert recorder.failure.endswith("the disk is full. Free some space, or choose a folder on another disk. No frame was recorded.")


def test_a_recording_that_cannot_be_copied_stays_where_it_is(tmp_path, monkeypatch, record):
    recorder = record(tmp_path / "scan.mha", frames())

    def full(*_, **__):
        raise OutputError("Cannot write scan.mha: the disk is full.")

    monkeypatch.setattr(recording, "write_sequence", full)
    assert recorder.finish() is None
    assert recorder.failure == f"Recording stopped: Cannot write scan.mha: the disk is full. 5 frames are kept in {recorder.header_path}."
    assert len(read_sequence(recorder.header_path)) == 5


def test_an_mhd_is_finished_where_links_are_not_known(tmp_path, monkeypatch, record):
    def no_links(*_):
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", no_links)
    record(tmp_path / "scan.mhd", frames()).finish()
    assert len(read_sequence(tmp_path / "scan.mhd")) == 5


def test_an_image_of_another_size_is_recorded_as_missing(tmp_path, record):
    stream = [*frames(2), LiveFrame(np.zeros((5, 5), np.uint8), image_pose(), 9.0, record=FrameRecord(9.0)), *frames(1)]
    record(tmp_path / "scan.mha", stream).finish()
    records = read_sequence(tmp_path / "scan.mha").records
    assert [r.image_status is TransformStatus.OK for r in records] == [True, True, False, True]


def test_without_a_frame_there_is_no_file(tmp_path):
    assert Recorder(tmp_path / "scan.mha").finish() is None
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["scan.txt", "scan", "nowhere/scan.mha"])
def test_a_path_that_cannot_be_recorded_to_is_refused_at_once(name, tmp_path):
    with pytest.raises(OutputError):
        Recorder(tmp_path / name)


def of_size(side, seconds, seen=True):
    image_to_reference = TransformName("Image", "Reference")
    sample = TransformSample(image_pose(), TransformStatus.OK if seen else TransformStatus.MISSING)
    image = np.full((side, side), side, np.uint8)
    return LiveFrame(image, image_pose(), seconds, record=FrameRecord(seconds, transforms={image_to_reference: sample}))


def test_images_that_change_before_the_probe_was_seen_are_recorded_and_the_others_counted(tmp_path, record):
    """A scanner that changes its mode just after the start must not cost the scan."""
    recorder = record(tmp_path / "scan.mha", [of_size(4, 1.0, seen=False), of_size(5, 2.0, seen=False), of_size(8, 3.0), of_size(8, 4.0)])
    assert "2 of 4 recorded frames" in str(recorder.loss)
    recorder.finish()
    recorded = read_sequence(tmp_path / "scan.mha")
    assert recorded.frame_size == (8, 8)
    assert [r.image_status is TransformStatus.OK for r in recorded.records] == [False, False, True, True]
    assert [r.timestamp for r in recorded.records] == [1.0, 2.0, 3.0, 4.0]
    assert [int(image.max()) for image in np.asarray(recorded.images)] == [0, 0, 8, 8]
    # Nothing is lost: what was recorded before is there, too
    assert "Those before the change are in scan-2.mha, scan-3.mha." in str(recorder.loss)
    assert [np.asarray(read_sequence(tmp_path / f"scan-{n}.mha").images).max(axis=(1, 2)).tolist() for n in (2, 3)] == [[4], [0, 5]]


def test_images_that_change_in_the_middle_of_a_scan_are_counted(tmp_path, record):
    recorder = record(tmp_path / "scan.mha", [of_size(8, 1.0), of_size(4, 2.0), of_size(8, 3.0, seen=False), of_size(4, 4.0)])
    assert "2 of 4 recorded frames" in str(recorder.loss)
    assert "8 x 8" in str(recorder.loss)
    recorder.finish()
    assert [int(image.max()) for image in np.asarray(read_sequence(tmp_path / "scan.mha").images)] == [8, 0, 8, 0]

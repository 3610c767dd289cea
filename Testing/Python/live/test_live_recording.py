"""Recordings of a stream: what is in them, and what is left of them when the program or the disk fails."""

from __future__ import annotations

import errno
import os
from unittest.mock import Mock

import numpy as np
import pytest
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

SUFFIXES = [".mha", ".mhd", ".nrrd"]


def paired(*messages):
    synchronizer = Synchronizer()
    return [frame for message in messages for frame in synchronizer.feed(message)] + synchronizer.flush()


def frames(count=5):
    return paired(*(message for n in range(count) for message in tracked(1.0 + 0.1 * n, pixels=SMALL + n)))


def of_size(side, seconds, seen=True):
    """A frame whose pixels are all `side`."""
    sample = TransformSample(image_pose(), TransformStatus.OK if seen else TransformStatus.MISSING)
    record = FrameRecord(seconds, transforms={TransformName("Image", "Reference"): sample})
    return LiveFrame(np.full((side, side), side, np.uint8), image_pose(), seconds, record=record)


def images_in(path):
    return np.asarray(read_sequence(path).images)


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


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


# ---- what is in them


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_finished_recording_holds_every_image_transform_and_time_to_the_bit(suffix, tmp_path, record):
    stream, path = frames(), tmp_path / f"scan.igs{suffix}"
    recorder = record(path, stream)
    assert recorder.finish() == path
    np.testing.assert_array_equal(images_in(path), [SMALL + n for n in range(5)])
    assert (recorder.loss, recorder.failure) == (None, None)
    assert names_in(tmp_path) == [path.name, *(["scan.igs.raw"] if suffix == ".mhd" else [])]
    for frame, kept in zip(stream, read_sequence(path).records, strict=True):
        assert kept.timestamp == frame.timestamp
        assert kept.transforms.keys() == frame.record.transforms.keys()
        for name, sample in kept.transforms.items():
            np.testing.assert_array_equal(sample.matrix, frame.record.transforms[name].matrix)


BEGIN, LOST = [*tracked(1.0), *tracked(2.0)], [*tracked(4.0, probe=False), *tracked(5.0, probe=False)]
NOT_SEEN = image(3.0, metadata=metadata(ProbeToTracker="OUT_OF_VIEW", ReferenceToTracker="OK"), version=2)
STREAMS = {
    "missing": ([*BEGIN, image(3.0, version=2), *LOST], [True, True, False, False, False]),
    "metadata": ([*BEGIN, NOT_SEEN, *LOST], [True, True, False, False, False]),
    "not confirmed": ([image(1.0), image(2.0)], [False, False]),
}


@pytest.mark.parametrize(("stream", "usable"), STREAMS.values(), ids=STREAMS)
def test_a_recording_gives_the_poses_and_statuses_that_the_stream_gave(stream, usable, tmp_path, record):
    placed = paired(*stream)
    record(tmp_path / "scan.mha", placed).finish()
    poses = sweep_poses(read_sequence(tmp_path / "scan.mha"))
    assert [problem is None for problem in poses.problems] == [frame.status == "OK" for frame in placed] == usable
    for number in poses.usable:
        np.testing.assert_array_equal(poses.image_to_reference[number], placed[number].image_to_reference)


def test_without_a_frame_there_is_no_file(tmp_path):
    assert Recorder(tmp_path / "scan.mha").finish() is None
    assert names_in(tmp_path) == []


def test_images_that_change_before_the_probe_was_seen_become_recordings_of_their_own(tmp_path, record):
    """A scanner that changes its mode just after the start must not cost the scan."""
    recorder = record(tmp_path / "scan.mha", [of_size(4, 1.0, seen=False), of_size(5, 2.0, seen=False), of_size(8, 3.0), of_size(8, 4.0)])
    recorder.finish()
    assert "those before are in scan-2.mha" in recorder.note
    assert "those before are in scan-3.mha" in recorder.note
    assert recorder.loss is None
    assert [images_in(tmp_path / f"scan{end}.mha").max(axis=(1, 2)).tolist() for end in ("-2", "-3", "")] == [[4], [5], [8, 8]]
    assert [each.timestamp for each in read_sequence(tmp_path / "scan.mha").records] == [3.0, 4.0]


def test_images_that_change_in_the_middle_of_a_scan_are_recorded_as_missing_and_counted(tmp_path, record):
    recorder = record(tmp_path / "scan.mha", [of_size(8, 1.0), of_size(4, 2.0), of_size(8, 3.0, seen=False), of_size(4, 4.0)])
    assert "2 of 4 recorded frames" in str(recorder.loss)
    assert "8 x 8" in str(recorder.loss)
    recorder.finish()
    recorded = read_sequence(tmp_path / "scan.mha")
    assert [int(each.max()) for each in np.asarray(recorded.images)] == [8, 0, 8, 0]
    assert [each.image_status is TransformStatus.OK for each in recorded.records] == [True, False, True, False]


# ---- names that are taken


def finished(record, path):
    record(path, frames(2)).finish()


def unfinished(record, path):
    record(path, frames(2)).close()


def under_way(record, path):
    record(path, frames(2))


def a_file(record, path):
    path.write_bytes(b"precious")


def a_link(record, path):
    a_file(record, path.with_name("other"))
    path.symlink_to("other")


ALREADY, UNFINISHED = "is there already", "is there, of a recording that is not finished"
TAKEN = [
    ("scan.mha", "scan.mha", finished, f"scan.mha {ALREADY}"),
    ("scan.igs.mha", "scan.igs.mha", finished, f"scan.igs.mha {ALREADY}"),
    ("scan.mhd", "scan.mhd", finished, f"scan.mhd {ALREADY}"),
    ("scan.raw", "scan.mhd", a_file, f"scan.raw {ALREADY}"),
    ("scan.recording.raw", "scan.mha", a_file, f"scan.recording.raw {UNFINISHED}"),
    ("scan.recording.raw", "scan.mha", a_link, f"scan.recording.raw {UNFINISHED}"),
    ("scan.mha", "scan.nrrd", unfinished, f"scan.recording.mhd {UNFINISHED}"),
    ("scan.mha", "scan.mha", under_way, f"scan.recording.mhd {UNFINISHED}"),
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
    assert names_in(tmp_path) == ["scan-2.mha", "scan.mha"]


@pytest.mark.parametrize("name", ["scan.mha", "scan.mhd", "scan.raw"])
def test_a_file_that_comes_about_during_the_scan_is_not_replaced(name, tmp_path, record):
    recorder = record(tmp_path / name.replace("raw", "mhd"), frames())
    (tmp_path / name).write_bytes(b"precious")
    assert len(read_sequence(recorder.finish())) == 5
    assert recorder.path.name.startswith("scan-2.")
    assert (tmp_path / name).read_bytes() == b"precious"
    assert f"{name} came about during the scan" in recorder.note


@pytest.mark.parametrize("name", ["scan.txt", "scan", "nowhere/scan.mha"])
def test_a_path_that_cannot_be_recorded_to_is_refused_at_once(name, tmp_path):
    with pytest.raises(OutputError):
        Recorder(tmp_path / name)


# ---- programs that die. `make faults` kills them at random


class Crash(BaseException):
    pass


def failing_after(monkeypatch, count, error):
    """The disk takes `count` more writes, and half of the next one."""
    real, left = Recorder._write, iter(range(count))

    def write(file, data):
        if next(left, None) is None:
            file.write(memoryview(data).cast("B")[: memoryview(data).nbytes // 2])
            raise error
        real(file, data)

    monkeypatch.setattr(Recorder, "_write", staticmethod(write))


@pytest.mark.parametrize("moment", range(5))
def test_a_crash_in_any_write_leaves_a_file_that_can_be_read_and_taken_up(moment, tmp_path, monkeypatch, record):
    recorder = record(tmp_path / "scan.mha", frames(1))
    failing_after(monkeypatch, moment, Crash())
    with pytest.raises(Crash):
        append_all(recorder, frames(4)[1:])
    images = images_in(recorder.header_path)
    # A frame is two writes
    assert len(images) == 1 + moment // 2
    np.testing.assert_array_equal(images, [SMALL + n for n in range(len(images))])
    monkeypatch.undo()
    recorder.close()
    again = record(tmp_path / "scan.mha", [], takes_up=True)
    assert again.frames == len(images)
    append_all(again, frames(9)[again.frames :])
    np.testing.assert_array_equal(images_in(again.finish()), [SMALL + n for n in range(9)])
    assert names_in(tmp_path) == ["scan.mha"]


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


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_seconds_that_are_missing_are_said_and_marked_in_the_file_each_time_that_its_program_was_lost(suffix, tmp_path, record):
    path = tmp_path / f"scan.igs{suffix}"
    for begin in (1.0, 1.5, 7.5, 20.0):
        recorder = record(path, [of_size(8, begin + 0.1 * n) for n in range(5)], takes_up=begin > 1.0)
        recorder.close()
    assert recorder.note == "12.1 s of the scan are missing after 7.90 s: the program that recorded was lost."
    gaps = [each.fields.get("AIFRecon_gap") for each in read_sequence(record(path, [], takes_up=True).finish()).records]
    # Half a second may be a pause of the scanner
    assert gaps == [None] * 10 + ["5.600"] + [None] * 4 + ["12.100"] + [None] * 4


def test_a_recording_that_cannot_be_read_is_kept_and_not_taken_up(tmp_path, record):
    record(tmp_path / "scan.mha", frames()).close()
    damaged = (tmp_path / "scan.recording.mhd").read_bytes().replace(b"DimSize = ", b"DimSize = x")
    (tmp_path / "scan.recording.mhd").write_bytes(damaged)
    assert record(tmp_path / "scan.mha", frames(), takes_up=True).finish() == tmp_path / "scan-2.mha"
    assert (tmp_path / "scan.recording.mhd").read_bytes() == damaged


# ---- disks that fail

FULL = OSError(errno.ENOSPC, "No space left on device")


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(("before", "writes"), [(0, 5), (0, 6), (3, 0), (3, 1)])
def test_a_full_disk_stops_the_recording_and_takes_nothing_of_what_there_was(suffix, before, writes, tmp_path, monkeypatch, record):
    path = tmp_path / f"scan{suffix}"
    record(path, frames(before)).close()
    failing_after(monkeypatch, writes, FULL)
    recorder = record(path, frames(6)[before:], takes_up=before > 0)
    assert recorder.failure == f"Recording stopped: the disk is full. 3 frames are kept in {recorder.header_path}."
    recorder.finish()
    assert recorder.failure.endswith(f"3 frames are kept in {recorder.path}.")
    np.testing.assert_array_equal(images_in(recorder.path), [SMALL, SMALL + 1, SMALL + 2])


def test_a_recording_that_cannot_begin_says_why(tmp_path, monkeypatch, record):
    monkeypatch.setattr(os, "fsync", Mock(side_effect=FULL))
    recorder = record(tmp_path / "scan.mha", frames())
    assert recorder.failure.startswith("Recording stopped: Cannot write ")
    assert recorder.failure.endswith("the disk is full. Free some space, or choose a folder on another disk. No frame was recorded.")


def test_a_recording_that_cannot_be_copied_stays_where_it_is(tmp_path, monkeypatch, record):
    recorder = record(tmp_path / "scan.mha", frames())
    monkeypatch.setattr(recording, "write_sequence", Mock(side_effect=OutputError("Cannot write scan.mha: the disk is full.")))
    assert recorder.finish() is None
    assert recorder.failure == f"Recording stopped: Cannot write scan.mha: the disk is full. 5 frames are kept in {recorder.header_path}."
    assert len(read_sequence(recorder.header_path)) == 5


def test_an_mhd_is_finished_where_links_are_not_known_and_bytes_too_many_are_refused(tmp_path, monkeypatch, record):
    monkeypatch.setattr(os, "link", Mock(side_effect=OSError(errno.EPERM, "Operation not permitted")))
    record(tmp_path / "scan.mhd", frames()).finish()
    assert len(read_sequence(tmp_path / "scan.mhd")) == 5
    with open(tmp_path / "scan.raw", "ab") as file:
        file.write(b"x")
    with pytest.raises(SequenceFormatError, match="1 bytes more"):
        read_sequence(tmp_path / "scan.mhd")

"""Recordings larger than memory: images are read one by one, whether compressed or not, while earlier ones are computed."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from sweeps import image_pose

from AIFReconLib.errors import OperationCanceled, SequenceFormatError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.inspection.diagnosis import diagnose
from AIFReconLib.io.metafile import frame_lines, header
from AIFReconLib.io.sequence import file_images
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.edits import rename, select_frames
from AIFReconLib.sweep.frames import FrameRecord, RecordsOnDemand, TrackedSequence
from AIFReconLib.sweep.multi_sweep import joined

FRAMES, ROWS, COLUMNS = 300, 120, 160
GRID = VoxelGrid.from_spacing((0, 0, 0), (32, 24, 30), 1.0)


def sweep() -> TrackedSequence:
    rng = np.random.default_rng(0)
    images = np.repeat(rng.integers(0, 256, (6, ROWS, COLUMNS), dtype=np.uint8), FRAMES // 6, axis=0)
    name = TransformName("Image", "Reference")
    poses = [image_pose((0.2, 0.2), translation=(0, 0, 0.1 * number)) for number in range(FRAMES)]
    return TrackedSequence(images, [FrameRecord(timestamp=0.1 * n, transforms={name: TransformSample(p)}) for n, p in enumerate(poses)])


@pytest.fixture(scope="module", params=[False, True], ids=["uncompressed", "compressed"])
def recording(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("long") / "sweep.mha"
    write_sequence(sweep(), path, compress=request.param)
    return path


@pytest.mark.parametrize("engine", ["numpy", "auto"])
def test_a_recording_takes_no_more_memory_than_a_few_of_its_images(recording, engine):
    sequence = read_sequence(recording)
    # Filling takes memory by the size of the volume, not of the recording
    settings = ReconstructionSettings(method="average", engine=engine, hole_limit=0.0)
    reconstruct(sequence, replace(settings, clip_px=(0,) * 4), grid=GRID)
    tracemalloc.start()
    try:
        reconstruct(sequence, replace(settings, clip_px=(0,) * 4), grid=GRID)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 0.6 * FRAMES * ROWS * COLUMNS


def test_a_file_gives_the_volume_of_the_images_in_memory(recording):
    settings = ReconstructionSettings(method="average")
    theirs = reconstruct(sweep(), replace(settings, clip_px=(0,) * 4), grid=GRID)
    ours = reconstruct(read_sequence(recording), replace(settings, clip_px=(0,) * 4), grid=GRID)
    np.testing.assert_array_equal(ours.intensity.array, theirs.intensity.array)


def test_canceling_in_the_middle_stops_the_reading(recording):
    sequence = read_sequence(recording)
    read = []

    class Watched:
        shape, dtype = sequence.images.shape, sequence.images.dtype

        def __len__(self):
            return len(sequence.images)

        def __getitem__(self, index):
            read.append(index)
            return sequence.images[index]

    watched = TrackedSequence(Watched(), sequence.records, sequence.fields, sequence.transforms)
    with pytest.raises(OperationCanceled):
        reconstruct(watched, ReconstructionSettings(clip_px=(0,) * 4), grid=GRID, progress=lambda done, _: done < 0.2)
    assert len(read) < FRAMES / 2


def tracked_by_ten_tools(count: int) -> TrackedSequence:
    """Tiny images, each with ten transforms."""
    names = [TransformName(f"Tool{n}", "Tracker") for n in range(10)]

    def record(number: int) -> FrameRecord:
        pose = image_pose((0.2, 0.2), translation=(0, 0, 0.1 * number))
        return FrameRecord(0.1 * number, transforms={name: TransformSample(pose) for name in names}, fields={"Note": str(number)})

    return TrackedSequence(np.zeros((count, 2, 2), np.uint8), RecordsOnDemand(count, record), {"Patient": "P1"})


def peak_of(work) -> int:
    """Bytes that Python holds at most while it works."""
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.fixture(params=[".mha", ".mhd", ".nrrd"])
def many_frames(request, tmp_path, monkeypatch):
    """A header of 600 kB, which counts as long."""
    path = tmp_path / f"long{request.param}"
    write_sequence(tracked_by_ten_tools(300), path)
    monkeypatch.setattr(header, "LONG_HEADER", 2**13)
    monkeypatch.setattr(frame_lines, "_PIECE", 2**12)
    return path


def test_the_fields_of_a_long_header_do_not_stay_in_memory(many_frames):
    assert peak_of(lambda: read_sequence(many_frames)) < 4e5


def test_the_records_of_a_long_header_are_those_that_were_written(many_frames):
    for found, written in zip(read_sequence(many_frames).records, tracked_by_ten_tools(300).records, strict=True):
        assert (found.timestamp, found.fields) == (written.timestamp, written.fields)
        np.testing.assert_array_equal([s.matrix for s in found.transforms.values()], [s.matrix for s in written.transforms.values()])


def test_a_long_header_says_what_holds_for_the_whole_recording(many_frames):
    sequence = read_sequence(many_frames)
    assert sequence.fields["Patient"] == "P1"
    assert len(sequence.transform_names()) == 10


def test_a_diagnosis_reads_each_record_of_a_long_recording_twice_at_most():
    read = []
    sequence = tracked_by_ten_tools(300)
    of_frame = sequence.records
    counted = RecordsOnDemand(300, lambda number: (read.append(number), of_frame[number])[1])
    diagnose(replace(sequence, records=counted), "Tool0ToTracker")
    assert len(read) <= 2 * 300


def test_a_long_header_that_changes_is_not_read_on(many_frames):
    sequence = read_sequence(many_frames)
    many_frames.write_bytes(many_frames.read_bytes().replace(b"Seq_Frame0299", b"Seq_Frame0001"))
    with pytest.raises(SequenceFormatError, match="header has changed"):
        sequence.records[0]


def test_a_frame_number_of_many_digits_counts_in_a_long_header(many_frames):
    many_frames.write_bytes(many_frames.read_bytes().replace(b"Seq_Frame0299_Note", b"Seq_Frame" + b"0" * 20 + b"299_Note"))
    assert read_sequence(many_frames).records[299].fields["Note"] == "299"


@pytest.mark.parametrize(
    "change",
    [
        lambda sequence: select_frames(sequence, 0, 298),
        lambda sequence: rename(sequence, {"Tracker": "Camera"}),
        lambda sequence: joined([sequence, sequence]),
    ],
    ids=["selected", "renamed", "joined"],
)
def test_what_is_made_of_a_long_recording_does_not_keep_its_records(many_frames, change):
    sequence = read_sequence(many_frames)
    assert peak_of(lambda: change(sequence)) < 4e5


def test_long_recordings_that_are_joined_keep_their_records_apart(many_frames):
    sequence = read_sequence(many_frames)
    found = joined([sequence, select_frames(sequence, 5, 299)]).records
    assert [found[number].fields["Note"] for number in (0, 299, 300, 594)] == ["0", "299", "5", "299"]


def test_damage_in_a_long_header_is_found_when_it_is_opened(many_frames):
    data = many_frames.read_bytes()
    at = data.index(b"Seq_Frame0150_Tool3ToTrackerTransform")
    many_frames.write_bytes(data[:at] + data[at:].replace(b"0.2", b"0,2", 1))
    with pytest.raises(SequenceFormatError, match="frame 150"):
        read_sequence(many_frames)


def test_a_long_header_whose_frames_are_not_in_order_is_read_too(many_frames):
    data = many_frames.read_bytes()
    many_frames.write_bytes(
        data.replace(b"Seq_Frame0070_", b"Seq_Frame_____")
        .replace(b"Seq_Frame0160_", b"Seq_Frame0070_")
        .replace(b"Seq_Frame_____", b"Seq_Frame0160_")
    )
    assert read_sequence(many_frames).records[70].fields["Note"] == "160"


def test_a_frame_behind_the_last_image_is_found_in_a_long_header_too(many_frames):
    many_frames.write_bytes(many_frames.read_bytes().replace(b"Seq_Frame0299", b"Seq_Frame2345"))
    with pytest.raises(SequenceFormatError, match="belongs to frame 2345"):
        read_sequence(many_frames)


def test_as_many_frames_are_read_as_a_header_describes(many_frames, monkeypatch):
    monkeypatch.setattr(file_images, "MAXIMUM_FRAMES", 100)
    assert len(read_sequence(many_frames)) == 300


@pytest.mark.parametrize("suffix", [".mha", ".mhd", ".nrrd"])
def test_a_long_recording_is_written_frame_by_frame(tmp_path, suffix):
    sequence = tracked_by_ten_tools(300)
    assert peak_of(lambda: write_sequence(sequence, tmp_path / f"long{suffix}")) < 1e6


def test_a_header_for_which_there_is_no_memory_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "long.mha"
    write_sequence(tracked_by_ten_tools(20), path)
    monkeypatch.setattr(header, "_STEP", 2**10)
    monkeypatch.setattr(header, "available_memory", lambda: 2**12)
    with pytest.raises(SequenceFormatError, match="no memory for a header"):
        read_sequence(path)

"""A live session: the same voxels as offline, every frame accounted for, and nothing lost when something fails."""

from __future__ import annotations

import contextlib
import math
import threading
import time
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from files import tracked_sequence, write_patient
from igtl_streams import recorded
from live_messages import SMALL, image, streamed, tracked
from sweeps import rigid, sphere_bone

from AIFReconLib.compounding.methods.table import METHODS, method_named
from AIFReconLib.compounding.own.method import register_method
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.errors import BeamGeometryError, LiveMessageError, NoUsableFramesError, SettingsError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.beams import LINEAR
from AIFReconLib.imaging.extent import grid_around_sweep
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.live.pairing.synchronizer import LiveFrame, Synchronizer, SynchronizerSettings
from AIFReconLib.live.replay.server import ReplayServer
from AIFReconLib.live.session.insertion import Inserter
from AIFReconLib.live.session.recording import Recorder
from AIFReconLib.live.session.scouting import ScoutedFrames
from AIFReconLib.live.session.session import FRAMES_LOOKED_AT, LiveSession
from AIFReconLib.live.session.statistics import FrameCounters, StreamHealth, tracking_words
from AIFReconLib.live.wire.client import OpenIGTLinkClient
from AIFReconLib.live.wire.decoding import decode
from AIFReconLib.live.wire.framing import Framer
from AIFReconLib.live.wire.messages import StreamEvent, TransformMessage
from AIFReconLib.live.wire.sources import QueueSource
from AIFReconLib.progress import carry_out
from AIFReconLib.provenance.record import settings_of
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.edits import select_frames
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

GRID = VoxelGrid.from_spacing((-9.0, -8.0, -6.0), (19, 17, 13), 1.0)
WHOLE = ImageRegion(ClipRectangle((0.0, 0.0), (39.0, 29.0)))
EVERYWHERE = VoxelGrid.from_spacing((-500.0, -500.0, -500.0), (50, 50, 50), 20.0)
LONG = 60.0


@pytest.fixture
def configuration(tmp_path):
    folder = tmp_path / "calibration"
    folder.mkdir()
    return read_plus_configuration(write_patient(folder).config)


@pytest.fixture
def session_of(configuration):
    """Makes sessions that read from a queue; they are stopped in the end."""
    made = []

    def make(messages=(), settings=None, bone=None, grid=GRID, **options):
        source = QueueSource(limit=100_000)
        for message in messages:
            source.put(message)
        looked = imaging_fields(options.pop("region", None), options.pop("probe", None))
        options = {"configuration": configuration, "longest_delay": None, **options}
        settings = replace(settings or ReconstructionSettings(), **looked)
        made.append(LiveSession(source, settings, bone, grid, **options))
        made[-1].queue = source
        return made[-1]

    yield make
    for session in made:
        session.stop()


def run(session):
    """Everything that is in the queue, to the end."""
    session.start()
    return session.finish()


def wait_for(condition):
    deadline = time.monotonic() + LONG
    while not condition():
        assert time.monotonic() < deadline, "it never happened"
        time.sleep(0.005)


def captured(data: bytes) -> QueueSource:
    """A source of the messages in recorded bytes, as they arrive now."""
    source, framer = QueueSource(limit=100_000, byte_limit=2**31), Framer()
    for start in range(0, len(data), 2**18):
        for raw in framer.feed(data[start : start + 2**18]):
            with contextlib.suppress(LiveMessageError):
                for message in decode(raw, time.monotonic()):
                    source.put(message)
    source.stop()
    return source


# ---- live equals offline


@register_method
def own_method(intensity, cosine, reach):
    """Of the tests."""
    return 0.1 + cosine * reach, intensity


def test_a_volume_made_anew_is_that_of_frames_which_lie_elsewhere(session_of, configuration):
    """Frames that come while it is made go with the last motion, and so do those that follow."""
    sequence = replace(tracked_sequence(), configuration=configuration)
    poses, count = sweep_poses(sequence).image_to_reference, len(sequence)
    motions = np.stack([rigid((0.0, 0.0, 2.0 * n), (0.3 * n, 0.2, -0.1 * n)) for n in range(count // 2)])
    messages = list(streamed(sequence))
    each = len(messages) // count
    session = session_of(messages[: each * (count // 2)], ReconstructionSettings(method="average", motion="auto"))
    session.start()
    wait_for(lambda: session.statistics.inserted == count // 2)
    anew = session.rebuild(session.kept, motions, iter(()), ("Mended.",))
    next(anew)
    for message in messages[each * (count // 2) : each * (count - 1)]:
        session.queue.put(message)
    wait_for(lambda: session.statistics.inserted == count - 1)
    assert carry_out(anew)
    for message in messages[each * (count - 1) :]:
        session.queue.put(message)
    result = session.finish()
    moved = np.array([motion @ pose for motion, pose in zip([*motions, *[motions[-1]] * (count - len(motions))], poses, strict=True)])
    there = TrackedSequence.from_arrays([sequence.images[n] for n in range(count)], moved)
    whole = ImageRegion() if configuration.imaged_region is None else configuration.imaged_region
    expected = reconstruct(there, ReconstructionSettings(method="average", **imaging_fields(whole, None)), grid=GRID)
    assert result.intensity.array.any()
    for name in ("intensity", "hits", "mask"):
        np.testing.assert_array_equal(getattr(result, name).array, getattr(expected, name).array)
    assert "Mended." in result.messages
    assert session.in_place[-1] == pytest.approx(moved[-2])


@pytest.mark.parametrize("method", [*METHODS, own_method.name])
def test_live_gives_the_very_voxels_of_offline(method, session_of, configuration):
    sequence = replace(tracked_sequence(), configuration=configuration)
    settings = ReconstructionSettings(method=method, output_type="float32", hole_limit=2.0)
    bone = sphere_bone(center=(0.0, 0.0, 0.0)) if method_named(method).needs_bone else None
    offline = reconstruct(sequence, settings, bone, GRID)
    live = run(session_of(streamed(sequence), settings, bone))
    for name in ("intensity", "score", "hits", "mask"):
        np.testing.assert_array_equal(getattr(live, name).array, getattr(offline, name).array)


def test_gray_levels_are_those_of_the_first_frames_and_the_header_repeats_them(session_of, configuration):
    """The recording as a whole has others: the later half is brighter."""
    dim = tracked_sequence(FRAMES_LOOKED_AT + 30)
    images = np.asarray(dim.images) // 2
    images[FRAMES_LOOKED_AT:] += 100
    sequence = replace(dim, images=images, configuration=configuration)
    settings, bone = ReconstructionSettings(method="weighted", hole_limit=0.0), sphere_bone(center=(0.0, 0.0, 0.0))
    live = run(session_of(streamed(sequence), settings, bone))
    told = tuple(settings_of(live.intensity)["gray_levels"])
    first = select_frames(sequence, 0, FRAMES_LOOKED_AT - 1)
    assert told == tuple(settings_of(reconstruct(first, settings, bone, GRID).intensity)["gray_levels"])
    assert told != tuple(settings_of(reconstruct(sequence, settings, bone, GRID).intensity)["gray_levels"])
    again = reconstruct(sequence, replace(settings, gray_levels=told), bone, GRID)
    np.testing.assert_array_equal(again.intensity.array, live.intensity.array)


@pytest.mark.parametrize(
    ("options", "skipped"),
    [
        ({}, {"ProbeToTracker OUT_OF_VIEW": [1], "ProbeToTracker MISSING": [4]}),
        ({"skip": 2}, None),
        (
            {
                "method": "average",
                "output_type": "float32",
                "importance_mask": np.linspace(0, 1, 40, dtype=np.float32)[None].repeat(30, axis=0),
            },
            None,
        ),
    ],
    ids=["untracked", "skip", "importance"],
)
def test_the_same_frames_enter_as_offline_and_weigh_as_much(options, skipped, session_of, configuration):
    statuses = {1: TransformStatus.OUT_OF_VIEW, 4: TransformStatus.MISSING} if skipped else {}
    sequence, settings = replace(tracked_sequence(statuses=statuses), configuration=configuration), ReconstructionSettings(**options)
    offline, live = reconstruct(sequence, settings, grid=GRID), run(session_of(streamed(sequence), settings))
    np.testing.assert_array_equal(live.intensity.array, offline.intensity.array)
    if skipped:
        assert live.skipped == offline.skipped == skipped


def test_the_recording_of_a_session_reconstructs_to_its_very_volume(session_of, configuration, tmp_path):
    sequence = tracked_sequence(statuses={2: TransformStatus.OUT_OF_VIEW})
    session = session_of(streamed(sequence), record=tmp_path / "scan.mha")
    live = run(session)
    offline = reconstruct(read_sequence(tmp_path / "scan.mha", config=configuration), grid=GRID)
    np.testing.assert_array_equal(live.intensity.array, offline.intensity.array)
    assert live.skipped == offline.skipped


def test_a_scouted_box_is_that_of_an_offline_sweep_and_what_was_scouted_enters_the_volume(session_of, configuration):
    sequence = replace(tracked_sequence(), configuration=configuration)
    session = session_of(streamed(sequence), ReconstructionSettings(spacing=0.8), grid=None)
    session.start()
    session.queue.put(image(99.0, "Image"))
    wait_for(lambda: session.scouted == 6)
    grid = session.grid_from_scout()
    expected = grid_around_sweep(sweep_poses(sequence).image_to_reference, sequence.frame_size, configuration.scan_region, (0.8, 0.8, 0.8))
    assert grid.size == expected.size
    np.testing.assert_allclose(grid.ijk_to_reference, expected.ijk_to_reference, atol=1e-9)
    small, large = session.grid_from_scout(1.0), session.grid_from_scout(1.0, margin=2.5)
    np.testing.assert_allclose(large.origin, small.origin - 3)
    assert large.size == tuple(n + 6 for n in small.size)
    session.use_grid(GRID)
    np.testing.assert_array_equal(session.finish().intensity.array, reconstruct(sequence, grid=GRID).intensity.array)


def test_without_a_tracked_frame_there_is_no_box(session_of):
    session = session_of(grid=None)
    session.start()
    with pytest.raises(NoUsableFramesError, match="Not one tracked frame"):
        session.grid_from_scout()


def test_the_probe_is_recognized_in_the_first_images(session_of):
    """Without configuration, a lit rectangle in a black surround shows where the ultrasound is."""
    images = np.zeros((30, 60, 80), np.uint8)
    images[:, 10:50, 20:60] = np.random.default_rng(0).integers(60, 250, (30, 40, 40), dtype=np.uint8)
    messages = [m for n in range(30) for m in tracked(1.0 + n / 30, pixels=images[n])]
    grid = VoxelGrid.from_spacing((0, 0, 0), (60, 50, 10), 1.0)
    result = run(session_of(messages, grid=grid, configuration=None))
    assert any("linear probe" in note for note in result.notes)
    assert int(result.hits.array.sum()) <= 30 * 42 * 42


def test_a_probe_that_cannot_be_told_is_reported_and_frames_are_accounted_for(session_of):
    messages = [m for n in range(30) for m in tracked(1.0 + n / 30, pixels=SMALL + n % 2)]
    session = session_of(messages, ReconstructionSettings(method="aif"), sphere_bone(), configuration=None)
    run(session)
    assert isinstance(session.error, BeamGeometryError)
    assert session.statistics.skipped == {"not inserted after an error": 30}


# ---- control


def test_paused_frames_are_counted_and_recorded_and_not_inserted(session_of, tmp_path):
    session = session_of(record=tmp_path / "scan.mha")
    session.start()
    session.pause()
    messages = list(streamed(tracked_sequence()))
    for message in messages[:9]:
        session.queue.put(message)
    wait_for(lambda: session.statistics.frames_received == 3)
    session.resume()
    for message in messages[9:]:
        session.queue.put(message)
    session.stop()
    assert (session.statistics.skipped, session.statistics.inserted) == ({"paused": 3}, 3)
    assert len(read_sequence(tmp_path / "scan.mha")) == 6


def test_after_a_reset_the_volume_grows_anew(session_of, configuration):
    sequence = replace(tracked_sequence(), configuration=configuration)
    session = session_of(streamed(sequence))
    session.start()
    session.queue.put(image(9.0, "Image"))
    wait_for(lambda: session.statistics.inserted == 6)
    session.reset()
    wait_for(lambda: not session.snapshot().hits.array.any())
    assert session.statistics.inserted == 0
    session.queue.put(StreamEvent("connected", "Connected.", 0.0))
    later = replace(sequence, records=[replace(record, timestamp=record.timestamp + 50) for record in sequence.records])
    for message in streamed(later):
        session.queue.put(message)
    np.testing.assert_array_equal(session.finish().intensity.array, reconstruct(sequence, grid=GRID).intensity.array)


def test_a_ct_that_was_placed_anew_weights_the_next_volume_and_not_the_one_that_grows(session_of, configuration):
    sequence = replace(tracked_sequence(), configuration=configuration)
    settings = ReconstructionSettings(method="aif", output_type="float32")
    earlier, placed = sphere_bone(center=(0.0, 0.0, 0.0)), sphere_bone(center=(2.0, 1.0, -1.0))
    recipe = replace(settings, clip_px=(0,) * 4, probe=LINEAR)
    session = session_of(streamed(sequence), recipe, earlier)
    session.prepare(LONG)
    session.use_bone(placed)
    session.start()
    session.queue.put(image(9.0, "Image"))
    wait_for(lambda: session.statistics.inserted == 6)
    np.testing.assert_array_equal(session.snapshot().score.array, reconstruct(sequence, recipe, earlier, GRID).score.array)
    session.reset()
    session.queue.put(StreamEvent("connected", "Connected.", 0.0))
    later = replace(sequence, records=[replace(record, timestamp=record.timestamp + 50) for record in sequence.records])
    for message in streamed(later):
        session.queue.put(message)
    expected = reconstruct(sequence, recipe, placed, GRID).score.array
    np.testing.assert_array_equal(session.finish().score.array, expected)
    assert expected.any()


def test_frames_that_cannot_be_used_wait_for_a_box_without_filling_the_memory():
    """An hour with the probe out of view is 100 000 of them."""
    scouted = ScoutedFrames()
    tracemalloc.start()
    for number in range(20_000):
        record = FrameRecord(transforms={TransformName("Probe", "Tracker"): TransformSample(np.eye(4), TransformStatus.OUT_OF_VIEW)})
        scouted.add(LiveFrame(np.zeros((4, 4)), None, status="ProbeToTracker OUT_OF_VIEW", number=number, record=record))
    size, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert size < 500_000
    assert [frame.number for frame in scouted] == list(range(20_000))


def test_region_and_probe_are_told_to_whoever_looks_at_frames(session_of):
    """Without configuration, as the latest images show them, or with why they do not, and then not again at once."""
    images = np.zeros((90, 60, 80), np.uint8)
    images[30:, 10:50, 20:60] = np.random.default_rng(0).integers(60, 250, (60, 40, 40), dtype=np.uint8)
    session = session_of(grid=None, configuration=None)
    session.start()
    assert session.imaging() is None

    def show(numbers):
        for n in numbers:
            for message in tracked(1.0 + n / 30, pixels=images[n]):
                session.queue.put(message)
        wait_for(lambda: session.latest is not None and session.latest.number >= numbers[-2])

    show(range(30))
    with pytest.raises(BeamGeometryError):
        session.imaging()
    assert session.imaging() is None
    show(range(30, 90))
    assert session.imaging().known_probe().kind == LINEAR


def test_images_of_other_devices_are_told(session_of):
    session = session_of([*streamed(tracked_sequence()), image(99.0, "Second_Reference")])
    run(session)
    assert session.statistics.other_images == 1


def test_frames_of_a_scan_that_never_got_a_box_are_accounted_for(session_of):
    session = session_of(streamed(tracked_sequence(statuses={2: TransformStatus.OUT_OF_VIEW})), grid=None)
    assert run(session) is None
    assert session.statistics.skipped == {"seen while scouting": 5, "ProbeToTracker OUT_OF_VIEW": 1}


def test_a_session_ends_after_the_frames_that_were_asked_for(session_of):
    session = session_of(streamed(tracked_sequence()), frame_limit=4)
    session.start()
    assert session.finished.wait(LONG)
    session.stop()
    assert session.statistics.frames_received == 4


def test_a_session_can_be_prepared_before_it_starts(session_of, configuration):
    sequence = replace(tracked_sequence(), configuration=configuration)
    session = session_of(streamed(sequence))
    assert session.prepare(LONG)
    assert session.snapshot().frames_inserted == 0
    np.testing.assert_array_equal(run(session).intensity.array, reconstruct(sequence, grid=GRID).intensity.array)


def test_stop_may_be_called_twice_and_before_start(session_of):
    session = session_of()
    session.stop()
    session.stop()
    assert session.statistics.phase == "stopped"
    with pytest.raises(RuntimeError, match="Make a new one"):
        session.start()


def test_no_thread_is_left_after_stop(session_of):
    before = threading.active_count()
    session = session_of(streamed(tracked_sequence()))
    session.start()
    session.stop()
    assert threading.active_count() == before


def test_a_method_that_needs_bone_is_refused_at_once(session_of):
    with pytest.raises(SettingsError, match="bone"):
        session_of(settings=ReconstructionSettings(method="aif"))


# ---- what is seen while it runs


def test_a_snapshot_is_the_volume_of_the_frames_so_far(session_of, configuration):
    sequence = replace(tracked_sequence(), configuration=configuration)
    settings = ReconstructionSettings(hole_limit=2.0)
    session = session_of(streamed(sequence), settings)
    session.start()
    session.queue.put(image(99.0, "Image"))
    wait_for(lambda: session.statistics.inserted == 6)
    np.testing.assert_array_equal(session.snapshot().intensity.array, reconstruct(sequence, settings, grid=GRID).intensity.array)


def test_snapshots_while_frames_come_lose_none(session_of, configuration):
    sequence = tracked_sequence(count=60)
    # However long a snapshot takes, an image waits for the transforms that are put after it
    patient = SynchronizerSettings(patience=LONG)
    session = session_of(settings=ReconstructionSettings(hole_limit=3.0), synchronizer=patient)
    session.start()
    for number, message in enumerate(streamed(sequence)):
        session.queue.put(message)
        if number % 15 == 0:
            session.snapshot()
    expected = reconstruct(replace(sequence, configuration=configuration), ReconstructionSettings(hole_limit=3.0), grid=GRID)
    result = session.finish()
    assert result.frames_inserted == expected.frames_inserted
    np.testing.assert_array_equal(result.intensity.array, expected.intensity.array)


def test_every_frame_is_accounted_for(session_of):
    statuses = dict.fromkeys((3, 4), TransformStatus.OUT_OF_VIEW)
    session = session_of(streamed(tracked_sequence(count=20, statuses=statuses)), grid=VoxelGrid.from_spacing((0, 0, 0), (4, 4, 4), 1.0))
    run(session)
    statistics = session.statistics
    assert statistics.frames_received == 20 == statistics.inserted + statistics.frames_skipped
    assert statistics.waiting == 0


def test_latency_and_rate_are_told(session_of):
    session = session_of()
    session.prepare(LONG)
    for message in streamed(tracked_sequence()):
        session.queue.put(message)
    run(session)
    statistics = session.statistics
    assert 0 < statistics.latency_p50 <= statistics.latency_p99
    assert math.isfinite(statistics.frame_rate)


def test_frames_that_waited_for_the_volume_to_be_made_say_nothing_of_latency(session_of):
    session = session_of(streamed(tracked_sequence()))
    run(session)
    assert session.statistics.inserted == 6
    assert math.isnan(session.statistics.latency_p50)


@pytest.mark.parametrize(
    ("status", "words"),
    [
        ("OK", "tracked"),
        ("ReferenceToTracker OUT_OF_VIEW", "Reference not seen by tracker"),
        ("ProbeToTracker MISSING", "Probe not seen by tracker"),
        ("ProbeToReference MISSING", "Probe or Reference not seen by tracker"),
        ("ImageToReference MISSING", "Probe or Reference not seen by tracker"),
        ("ProbeToTracker stale", "ProbeToTracker: too few positions"),
        ("ProbeToTracker not rigid (mirrored)", "ProbeToTracker not rigid (mirrored)"),
        ("pose not confirmed", "pose not confirmed"),
    ],
)
def test_the_tracking_state_names_the_tool(status, words):
    assert tracking_words(status, "Reference") == words


@pytest.mark.parametrize(
    ("imaged", "posed", "stopped"),
    [
        (99.5, 99.5, (None, None)),
        (90.0, 99.5, (10.0, None)),
        (99.5, 90.0, (None, 10.0)),
        (90.0, None, (10.0, None)),
        (None, None, (None, None)),
    ],
)
def test_what_comes_no_more_is_told_with_how_long_ago_it_came(imaged, posed, stopped):
    heard = StreamHealth()
    if posed is not None:
        heard.note(TransformMessage("ProbeToTracker", 1.0, np.eye(4), TransformStatus.OK, received=posed))
    assert heard.stopped(100.0, imaged) == stopped


def test_trouble_of_the_stream_is_told(session_of):
    session = session_of([StreamEvent("stalled", "Nothing has arrived for 2 s.", 0.0)])
    session.start()
    wait_for(lambda: session.statistics.trouble is not None)
    assert "Nothing has arrived" in session.statistics.trouble


# ---- when something fails


def test_an_error_while_inserting_is_kept_and_the_volume_so_far_with_it(session_of, monkeypatch, configuration):
    sequence = replace(tracked_sequence(), configuration=configuration)
    real = Reconstructor.insert

    def insert(self, frame):
        if frame.number == 3:
            raise MemoryError("no more")
        real(self, frame)

    monkeypatch.setattr(Reconstructor, "insert", insert)
    session = session_of(streamed(sequence))
    result = run(session)
    assert isinstance(session.error, MemoryError)
    assert result.frames_inserted == 3
    assert session.statistics.skipped == {"not inserted after an error": 3}


def test_the_recording_goes_on_when_the_reconstruction_fails(session_of, monkeypatch, tmp_path):
    def insert(self, frame):
        raise MemoryError("no more")

    monkeypatch.setattr(Reconstructor, "insert", insert)
    run(session_of(streamed(tracked_sequence()), record=tmp_path / "scan.mha"))
    assert len(read_sequence(tmp_path / "scan.mha")) == 6


def test_the_reconstruction_goes_on_when_the_recording_fails(session_of, monkeypatch, tmp_path):
    def write(file, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Recorder, "_write", staticmethod(write))
    session = session_of(streamed(tracked_sequence()), record=tmp_path / "scan.mha")
    assert run(session).frames_inserted == 6
    assert "the disk is full" in session.recording_failure


def test_an_image_of_another_size_is_skipped_and_the_scan_goes_on(session_of):
    messages = list(streamed(tracked_sequence()))
    messages[3] = replace(messages[3], image=np.zeros((7, 7), np.uint8))
    session = session_of(messages)
    assert run(session).frames_inserted == 5
    assert session.statistics.skipped == {"image of another size or type": 1}


def test_an_error_while_receiving_is_told_and_no_hang(session_of, monkeypatch):
    def feed(self, message):
        raise ValueError("what is this?")

    monkeypatch.setattr(Synchronizer, "feed", feed)
    session = session_of(streamed(tracked_sequence()))
    session.start()
    assert session.finished.wait(LONG)
    assert (str(session.error), session.statistics.phase) == ("what is this?", "failed")


# ---- too slow


def simulate(load, frames=4000, interval=1 / 30):
    """Which frames are admitted when inserting one takes `load` times the interval between two."""
    inserter, backlog, admitted = Inserter(ReconstructionSettings(), None, 0.5, lambda result, _: result), 0.0, []
    inserter._submit = lambda _work, frame, *_: admitted.append(frame.status == "OK")
    inserter._seconds_per_frame = load * interval
    for number in range(frames):
        inserter._waiting_frames, inserter._waiting_bytes = backlog / (load * interval), 0
        inserter.put(LiveFrame(np.zeros((2, 2), np.uint8), np.eye(4), number=number), FrameCounters())
        backlog = max(backlog + admitted[-1] * load * interval - interval, 0.0)
    return admitted


@pytest.mark.parametrize("load", [1.2, 1.5, 2.0, 3.7, 10.0])
def test_when_too_slow_as_many_frames_are_admitted_as_can_be_inserted(load):
    share = np.mean(simulate(load)[1000:])
    assert 0.85 / load < share <= 1.02 / load


@pytest.mark.parametrize("load", [1.5, 2.0, 3.7, 10.0])
def test_when_too_slow_frames_are_left_out_evenly(load):
    gaps = np.diff(np.flatnonzero(simulate(load)[1000:]))
    assert gaps.max() <= 2 * math.ceil(load) + 1


def test_a_session_that_is_too_slow_says_how_many_frames_it_left_out(session_of, monkeypatch):
    real = Reconstructor.insert

    def slow(self, frame):
        time.sleep(0.05)
        real(self, frame)

    monkeypatch.setattr(Reconstructor, "insert", slow)
    session = session_of(longest_delay=0.05)
    session.start()
    messages = list(streamed(tracked_sequence(count=80)))
    for message in messages[:15]:
        session.queue.put(message)
    wait_for(lambda: session.statistics.inserted == 5)
    for message in messages[15:]:
        session.queue.put(message)
    session.stop()
    statistics = session.statistics
    assert statistics.skipped["skipped to keep up"] > 0
    assert statistics.inserted + statistics.skipped["skipped to keep up"] == 80


# ---- over a real socket


@pytest.mark.parametrize("header_version", [1, 2])
def test_over_a_socket_the_recording_reconstructs_to_the_very_volume_of_the_session(header_version, configuration, tmp_path):
    statuses = dict.fromkeys((5, 6, 7), TransformStatus.OUT_OF_VIEW)
    sequence = replace(tracked_sequence(count=16, statuses=statuses), configuration=configuration)
    with ReplayServer(sequence, port=0, rate=100.0, header_version=header_version) as server:
        client = OpenIGTLinkClient(server.host, server.port)
        options = {"configuration": configuration, "record": tmp_path / "scan.mha", "frame_limit": 15, "longest_delay": None}
        with LiveSession(client, grid=GRID, **options) as session:
            assert session.finished.wait(LONG), session.statistics
            live = session.finish()
    offline = reconstruct(
        read_sequence(tmp_path / "scan.mha", config=configuration), ReconstructionSettings(image_to_reference="ImageToReference"), grid=GRID
    )
    assert live.frames_inserted == 12
    np.testing.assert_array_equal(live.intensity.array, offline.intensity.array)


def test_over_a_socket_the_volume_is_that_of_the_file(configuration):
    """The wire holds 32-bit numbers, which here move no pixel into another voxel."""
    sequence = replace(tracked_sequence(count=8), configuration=configuration)
    poses = sweep_poses(sequence).image_to_reference.astype(np.float32).astype(np.float64)
    name = TransformName("Image", "Reference")
    records = [FrameRecord(r.timestamp, transforms={name: TransformSample(pose)}) for r, pose in zip(sequence.records, poses, strict=True)]
    sequence = replace(sequence, records=records, configuration=None)
    with ReplayServer(sequence, port=0, rate=100.0) as server:
        client = OpenIGTLinkClient(server.host, server.port)
        settings = SynchronizerSettings(image_to_reference="ImageToReference")
        session = LiveSession(
            client, ReconstructionSettings(clip_px=(0,) * 4), grid=GRID, synchronizer=settings, frame_limit=7, longest_delay=None
        )
        with session:
            assert session.finished.wait(LONG), session.statistics
            live = session.finish()
    offline = reconstruct(
        replace(sequence, images=sequence.images[:7], records=records[:7]), ReconstructionSettings(clip_px=(0,) * 4), grid=GRID
    )
    np.testing.assert_array_equal(live.intensity.array, offline.intensity.array)


def test_a_server_that_goes_away_leaves_the_volume_and_is_reconstructed_from_again_when_it_is_back(configuration):
    sequence = replace(tracked_sequence(count=50), configuration=configuration)
    server = ReplayServer(sequence, port=0, rate=50.0, loop=True)
    server.start()
    client = OpenIGTLinkClient(server.host, server.port, retry_delays=(0.05,))
    with LiveSession(client, grid=GRID, configuration=configuration) as session:
        wait_for(lambda: session.statistics.inserted > 3)
        server.stop()
        wait_for(lambda: session.statistics.connection != "connected")
        assert session.snapshot().frames_inserted > 3
        before = session.statistics.inserted
        with ReplayServer(sequence, port=server.port, rate=50.0, loop=True):
            wait_for(lambda: session.statistics.inserted > before + 3)


# ---- what real servers sent


@pytest.mark.parametrize(("letter", "images", "usable"), [("A", 36, 36), ("B", 108, 108), ("C", 81, 81), ("J", 54, 42)])
def test_of_a_real_stream_exactly_the_frames_with_a_tracked_tool_are_inserted(letter, images, usable, data_dir):
    everything = ReconstructionSettings(clip_px=(0,) * 4)
    session = LiveSession(captured(recorded(data_dir, letter)), everything, grid=EVERYWHERE, longest_delay=None)
    result = run(session)
    assert (session.statistics.frames_received, result.frames_inserted) == (images, usable)


def test_no_wrong_image_of_a_corrupt_stream_enters_the_volume(data_dir, real_data, tmp_path):
    """Its server begins an image anew in the middle of itself; every image that comes through is one of the recording it shows."""
    originals = {picture.tobytes() for picture in read_sequence(real_data("SpinePhantomFreehand.igs.mha")).images}
    source = captured(recorded(data_dir, "H"))
    run(LiveSession(source, ReconstructionSettings(clip_px=(0,) * 4), grid=EVERYWHERE, record=tmp_path / "scan.mhd"))
    received = read_sequence(tmp_path / "scan.mhd").images
    assert len(received) >= 3
    assert all(picture.tobytes() in originals for picture in received)


def test_a_recipe_that_a_stream_cannot_obey_is_refused():
    grid = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (4, 4, 4), 1.0)
    for settings, says in (
        (ReconstructionSettings(orientation="UF"), "orientation is for files"),
        (ReconstructionSettings(spacing=2.0), "spacing must be that of the grid"),
        (ReconstructionSettings(bone_from_sweep=True), "bone_from_sweep looks at a whole recording"),
    ):
        with pytest.raises(SettingsError, match=says):
            LiveSession(QueueSource(), settings, grid=grid)
    with pytest.raises(SettingsError, match="time_offset must be that of the synchronizer"):
        LiveSession(QueueSource(), ReconstructionSettings(time_offset=0.2), synchronizer=SynchronizerSettings(time_offset=0.1))

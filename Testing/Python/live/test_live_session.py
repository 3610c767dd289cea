"""A live session: the same voxels as offline, every frame accounted for, and nothing lost when something fails."""

from __future__ import annotations

import contextlib
import math
import threading
import time
import tracemalloc
from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest
from files import tracked_sequence, write_patient
from igtl_streams import recorded, wait_for
from live_messages import SMALL, image, streamed, tracked
from sweeps import rigid, sphere_bone

from AIFReconLib.compounding.methods.table import METHODS, method_named
from AIFReconLib.compounding.own.method import register_method
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.errors import BeamGeometryError, LiveMessageError, NoUsableFramesError, SettingsError
from AIFReconLib.geometry.transform_graph import TransformStatus
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.beams import LINEAR
from AIFReconLib.imaging.extent import grid_around_sweep
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.live.pairing.synchronizer import Synchronizer, SynchronizerSettings
from AIFReconLib.live.replay.server import ReplayServer
from AIFReconLib.live.session.recording import Recorder
from AIFReconLib.live.session.session import FRAMES_LOOKED_AT, LiveSession
from AIFReconLib.live.session.statistics import tracking_words
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
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

GRID = VoxelGrid.from_spacing((-9.0, -8.0, -6.0), (19, 17, 13), 1.0)
EVERYWHERE = VoxelGrid.from_spacing((-500.0, -500.0, -500.0), (50, 50, 50), 20.0)
NO_CLIP = ReconstructionSettings(clip_px=(0,) * 4)
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
        put_all(source, messages)
        options = {"configuration": configuration, "longest_delay": None, **options}
        made.append(LiveSession(source, settings or ReconstructionSettings(), bone, grid, **options))
        made[-1].queue = source
        return made[-1]

    yield make
    for session in made:
        session.stop()


def put_all(queue, messages):
    for message in messages:
        queue.put(message)


def run(session):
    """Everything that is in the queue, to the end."""
    session.start()
    return session.finish()


def insert_all(session, count=6):
    """Start; one more image decides the last frame."""
    session.start()
    session.queue.put(image(99.0, "Image"))
    wait_for(lambda: session.statistics.inserted == count)


def scan_again(session, sequence):
    """The same frames, later and over another connection: the server does not send them again."""
    session.queue.put(StreamEvent("connected", "Connected.", 0.0))
    put_all(
        session.queue, streamed(replace(sequence, records=[replace(each, timestamp=each.timestamp + 500) for each in sequence.records]))
    )


def captured(data: bytes) -> QueueSource:
    """A source of the messages in recorded bytes, as they arrive now."""
    source, framer = QueueSource(limit=100_000, byte_limit=2**31), Framer()
    for start in range(0, len(data), 2**18):
        for raw in framer.feed(data[start : start + 2**18]):
            with contextlib.suppress(LiveMessageError):
                put_all(source, decode(raw, time.monotonic()))
    source.stop()
    return source


# ---- live equals offline


@register_method
def own_method(intensity, cosine, reach):
    """Of the tests."""
    return 0.1 + cosine * reach, intensity


UNTRACKED = {1: TransformStatus.OUT_OF_VIEW, 4: TransformStatus.MISSING}
CASES: list[tuple[dict[str, object], dict[int, TransformStatus]]] = [
    *(({"method": method, "output_type": "float32", "hole_limit": 2.0}, {}) for method in (*METHODS, own_method.name)),
    ({}, UNTRACKED),
]


@pytest.mark.parametrize(("options", "statuses"), CASES, ids=[" ".join(case[0]) + str(number) for number, case in enumerate(CASES)])
def test_live_gives_the_very_voxels_of_offline(options, statuses, session_of, configuration):
    sequence, settings = replace(tracked_sequence(statuses=statuses), configuration=configuration), ReconstructionSettings(**options)
    bone = sphere_bone(center=(0.0, 0.0, 0.0)) if options.get("method") and method_named(options["method"]).needs_bone else None
    offline = reconstruct(sequence, settings, bone, GRID)
    live = run(session_of(streamed(sequence), settings, bone))
    for name in ("intensity", "score", "hits", "mask"):
        np.testing.assert_array_equal(getattr(live, name).array, getattr(offline, name).array)
    assert live.skipped == offline.skipped


@pytest.mark.parametrize("statuses", [{}, {2: TransformStatus.OUT_OF_VIEW}])
def test_a_prepared_session_is_empty_its_snapshot_is_the_volume_so_far_and_its_recording_makes_it_again(
    statuses, session_of, configuration, tmp_path
):
    settings = ReconstructionSettings(hole_limit=2.0)
    sequence = tracked_sequence(statuses=statuses)
    session = session_of(streamed(sequence), settings, record=tmp_path / "scan.mha")
    assert session.prepare(LONG)
    assert session.snapshot().frames_inserted == 0
    insert_all(session, 6 - len(statuses))
    snapshot = session.snapshot().intensity.array
    live = session.finish()
    recorded = select_frames(read_sequence(tmp_path / "scan.mha", config=configuration), 0, 5)
    offline = reconstruct(recorded, settings, grid=GRID)
    np.testing.assert_array_equal(live.intensity.array, offline.intensity.array)
    np.testing.assert_array_equal(snapshot, offline.intensity.array)


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
    put_all(session.queue, messages[each * (count // 2) : each * (count - 1)])
    wait_for(lambda: session.statistics.inserted == count - 1)
    assert carry_out(anew)
    put_all(session.queue, messages[each * (count - 1) :])
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


def test_after_a_reset_the_volume_grows_anew_and_is_weighted_by_the_ct_that_was_placed_meanwhile(session_of, configuration):
    """The one that grows keeps its own."""
    sequence = replace(tracked_sequence(), configuration=configuration)
    recipe = ReconstructionSettings(method="aif", output_type="float32", clip_px=(0,) * 4, probe=LINEAR)
    earlier, placed = sphere_bone(center=(0.0, 0.0, 0.0)), sphere_bone(center=(2.0, 1.0, -1.0))
    session = session_of(streamed(sequence), recipe, earlier)
    session.prepare(LONG)
    session.use_bone(placed)
    insert_all(session)
    np.testing.assert_array_equal(session.snapshot().score.array, reconstruct(sequence, recipe, earlier, GRID).score.array)
    session.reset()
    wait_for(lambda: not session.snapshot().hits.array.any())
    assert session.statistics.inserted == 0
    scan_again(session, sequence)
    expected = reconstruct(sequence, recipe, placed, GRID).score.array
    np.testing.assert_array_equal(session.finish().score.array, expected)
    assert expected.any()


# ---- the box, and what images show


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


def test_an_hour_without_the_probe_fills_no_memory_and_gives_no_box(session_of):
    """100 000 frames that cannot be used wait for a box."""
    session = session_of(grid=None, configuration=None)
    session.start()
    tracemalloc.start()
    for number in range(5000):
        put_all(session.queue, tracked(1.0 + number / 30, probe=False, version=2, pixels=np.zeros((100, 100), np.uint8)))
    wait_for(lambda: session.statistics.frames_received >= 4999)
    size, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert size < 5_000_000
    with pytest.raises(NoUsableFramesError, match="Not one tracked frame"):
        session.grid_from_scout()
    assert session.finish() is None
    assert session.statistics.frames_skipped == session.statistics.frames_received == 5000


def test_region_and_probe_are_recognized_in_the_first_images(session_of):
    """A lit rectangle in black images: that is where the ultrasound is."""
    images = np.pad(np.random.default_rng(0).integers(60, 250, (30, 40, 40), dtype=np.uint8), ((0, 0), (10, 10), (20, 20)))
    grid = VoxelGrid.from_spacing((0, 0, 0), (60, 50, 10), 1.0)
    messages = [message for n, pixels in enumerate(images) for message in tracked(1.0 + n / 30, pixels=pixels)]
    result = run(session_of(messages, grid=grid, configuration=None))
    assert any("linear probe" in note for note in result.notes)
    assert int(result.hits.array.sum()) <= 30 * 42 * 42


# ---- every frame is accounted for


def of_another_size():
    messages = list(streamed(tracked_sequence()))
    messages[3] = replace(messages[3], image=np.zeros((7, 7), np.uint8))
    return messages


OUT = TransformStatus.OUT_OF_VIEW
STRANGE = [message for n in range(30) for message in tracked(1.0 + n / 30, pixels=SMALL + n % 2)]
ACCOUNTS = {
    "no box": (streamed(tracked_sequence(statuses={2: OUT})), {"grid": None}, {"seen while scouting": 5, "ProbeToTracker OUT_OF_VIEW": 1}),
    "elsewhere": (
        streamed(tracked_sequence(statuses={2: OUT})),
        {"grid": VoxelGrid.from_spacing((900, 0, 0), (4, 4, 4), 1.0)},
        {"outside the volume": 5, "ProbeToTracker OUT_OF_VIEW": 1},
    ),
    "another size": (of_another_size(), {}, {"image of another size or type": 1}),
    "no probe": (
        STRANGE,
        {"settings": ReconstructionSettings(method="aif"), "bone": sphere_bone(), "configuration": None},
        {"not inserted after an error": 30},
    ),
}


@pytest.mark.parametrize(("messages", "options", "skipped"), ACCOUNTS.values(), ids=ACCOUNTS)
def test_every_frame_is_inserted_or_skipped_with_its_reason(messages, options, skipped, session_of):
    session = session_of(messages, **options)
    run(session)
    statistics = session.statistics
    assert (statistics.skipped, statistics.waiting) == (skipped, 0)
    assert statistics.frames_received == statistics.inserted + statistics.frames_skipped
    assert isinstance(session.error, BeamGeometryError) == ("settings" in options)


def test_where_frames_come_too_fast_some_are_left_out_all_along_and_counted(session_of, monkeypatch):
    real, numbers = Reconstructor.insert, []

    def slow(self, frame):
        time.sleep(0.02)
        real(self, frame)
        numbers.append(frame.number)

    monkeypatch.setattr(Reconstructor, "insert", slow)
    session = session_of(longest_delay=0.1)
    session.prepare(LONG)
    session.start()
    for number in range(200):
        for message in streamed(tracked_sequence(count=1)):
            session.queue.put(replace(message, timestamp=1.0 + 0.05 * number, received=time.monotonic()))
        time.sleep(0.01)
    session.stop()
    statistics = session.statistics
    left_out = statistics.skipped["skipped to keep up"]
    assert statistics.inserted + left_out == statistics.frames_received == 200
    assert left_out > 0
    assert (np.histogram(numbers, 4)[0] > 0).all()


# ---- control, and what is seen while it runs


def test_stop_may_be_called_twice_and_before_start_and_leaves_no_thread(session_of):
    before = threading.active_count()
    session = session_of(streamed(tracked_sequence()))
    session.start()
    session.stop()
    session.stop()
    assert (threading.active_count(), session.statistics.phase) == (before, "stopped")
    never = session_of()
    never.stop()
    with pytest.raises(RuntimeError, match="Make a new one"):
        never.start()


@pytest.mark.parametrize("prepared", [True, False])
def test_rate_is_told_and_latency_but_of_frames_that_waited_for_the_volume_to_be_made(prepared, session_of):
    session = session_of([] if prepared else streamed(tracked_sequence()))
    if prepared:
        session.prepare(LONG)
        put_all(session.queue, streamed(tracked_sequence()))
    run(session)
    statistics = session.statistics
    assert statistics.inserted == 6
    assert math.isfinite(statistics.frame_rate)
    assert 0 < statistics.latency_p50 <= statistics.latency_p99 if prepared else math.isnan(statistics.latency_p50)


WORDS = {
    "OK": "tracked",
    "ReferenceToTracker OUT_OF_VIEW": "Reference not seen by tracker",
    "ProbeToTracker MISSING": "Probe not seen by tracker",
    "ProbeToReference MISSING": "Probe or Reference not seen by tracker",
    "ImageToReference MISSING": "Probe or Reference not seen by tracker",
    "ProbeToTracker stale": "ProbeToTracker: too few positions",
    "pose not confirmed": "pose not confirmed",
}


def test_the_tracking_state_names_the_tool():
    assert {status: tracking_words(status, "Reference") for status in WORDS} == WORDS


@pytest.mark.parametrize(("image_age", "pose_age"), [(0.0, 0.0), (50.0, 0.0), (0.0, 50.0), (50.0, None), (None, None)])
def test_what_comes_no_more_is_told_with_how_long_ago_it_came(image_age, pose_age, session_of):
    now, session = time.monotonic(), session_of(synchronizer=SynchronizerSettings(trust_image_pose=True, patience=0.0))
    if pose_age is not None:
        pose = TransformMessage("ProbeToTracker", 1.0, np.eye(4), TransformStatus.OK, received=now + 1.0 - pose_age)
        session.queue.put(pose)
    if image_age is not None:
        session.queue.put(image(1.0, received=now + 1.0 - image_age))
        session.queue.put(image(2.0, received=now + 1.0 - image_age))
    run(session)
    told = session.statistics
    for stopped, age in ((told.images_stopped, image_age), (told.poses_stopped, pose_age)):
        assert (stopped is None) if not age else stopped == pytest.approx(age, abs=20.0)


def test_trouble_of_the_stream_is_told(session_of):
    session = session_of([StreamEvent("stalled", "Nothing has arrived for 2 s.", 0.0)])
    session.start()
    wait_for(lambda: session.statistics.trouble is not None)
    assert "Nothing has arrived" in session.statistics.trouble


# ---- when something fails


def test_the_reconstruction_goes_on_when_the_recording_fails(session_of, monkeypatch, tmp_path):
    monkeypatch.setattr(Recorder, "_write", Mock(side_effect=OSError(28, "No space left on device")))
    session = session_of(streamed(tracked_sequence()), record=tmp_path / "scan.mha")
    assert run(session).frames_inserted == 6
    assert "the disk is full" in session.recording_failure


def test_an_error_while_receiving_is_told_and_no_hang(session_of, monkeypatch):
    monkeypatch.setattr(Synchronizer, "feed", Mock(side_effect=ValueError("what is this?")))
    session = session_of(streamed(tracked_sequence()))
    session.start()
    assert session.finished.wait(LONG)
    assert (str(session.error), session.statistics.phase) == ("what is this?", "failed")


TINY = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (4, 4, 4), 1.0)


OFFSET = {"synchronizer": SynchronizerSettings(time_offset=0.1)}


@pytest.mark.parametrize(
    ("settings", "options", "says"),
    [
        ({"orientation": "UF"}, {"grid": TINY}, "orientation is for files"),
        ({"spacing": 2.0}, {"grid": TINY}, "spacing must be that of the grid"),
        ({"bone_from_sweep": True}, {"grid": TINY}, "bone_from_sweep looks at a whole recording"),
        ({"time_offset": 0.2}, OFFSET, "time_offset must be that of the synchronizer"),
        ({"method": "aif"}, {}, "bone"),
    ],
)
def test_a_recipe_that_a_stream_cannot_obey_is_refused_at_once(settings, options, says):
    with pytest.raises(SettingsError, match=says):
        LiveSession(QueueSource(), ReconstructionSettings(**settings), **options)


# ---- over a real socket


@pytest.mark.parametrize(("letter", "images", "usable"), [("A", 36, 36), ("B", 108, 108), ("C", 81, 81), ("J", 54, 42)])
def test_of_a_real_stream_exactly_the_frames_with_a_tracked_tool_are_inserted(letter, images, usable, data_dir):
    session = LiveSession(captured(recorded(data_dir, letter)), NO_CLIP, grid=EVERYWHERE, longest_delay=None)
    assert (run(session).frames_inserted, session.statistics.frames_received) == (usable, images)


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

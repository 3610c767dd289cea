"""`aifrecon live` as a user meets it, against a real server on this machine."""

from __future__ import annotations

import io
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from files import tracked_sequence
from igtl_streams import ScriptedServer, image_bytes, transform_bytes
from waiting import PATIENCE, until

from AIFReconLib.commands.parser import main
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.errors import SequenceFormatError
from AIFReconLib.geometry.transform_graph import TransformStatus
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.live.replay.server import ReplayServer
from AIFReconLib.live.session.statistics import LiveStatistics
from AIFReconLib.live.wire.encoding import encode_message
from AIFReconLib.terminal.status_line import StatusLine, status_text

LONG = PATIENCE
GRID = VoxelGrid.from_spacing((-9.0, -8.0, -6.0), (19, 17, 13), 1.0)


@pytest.fixture
def serve(patient):
    """Starts servers of a sequence with the patient's calibration."""
    servers = []

    def start(sequence=None, **options):
        sequence = sequence or tracked_sequence(count=12)
        sequence = replace(sequence, configuration=read_plus_configuration(patient.config))
        servers.append(ReplayServer(sequence, port=0, **{"rate": 60.0, **options}))
        servers[-1].start()
        return servers[-1]

    yield start
    for server in servers:
        server.stop()


@pytest.fixture
def live(patient, tmp_path):
    """The usual command line for a server, up to the output."""
    like = tmp_path / "like.nrrd"
    Volume(np.zeros(GRID.shape, np.uint8), GRID.ijk_to_reference).write(like)

    def arguments(server, *more, grid=True):
        where = ["--grid-like", str(like)] if grid else ["--spacing", "1"]
        return ["live", "--port", str(server.port), "--config", str(patient.config), *where, *map(str, more)]

    return arguments


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have one address for themselves")
def test_a_server_elsewhere_is_found_by_its_host(serve, live, results):
    asked = live(serve(loop=True, host="127.0.0.2"), "--host", "127.0.0.2", "--tracker-frame", "Tracker", "--frames", "3")
    assert main([*asked, "--output", str(results / "v.nrrd")]) == 0


def test_a_recording_that_is_there_is_not_replaced_and_that_is_said_before_and_after(serve, live, results, capsys):
    older, output = results / "scan.igs.mha", results / "v.nrrd"
    older.write_bytes(b"precious")
    assert main(live(serve(loop=True), "--frames", "5", "--output", output, "--record", older)) == 0
    assert older.read_bytes() == b"precious"
    assert len(read_sequence(results / "scan-2.igs.mha")) == 5
    captured = capsys.readouterr()
    note = "scan.igs.mha is there already, so this scan is recorded to scan-2.igs.mha."
    assert captured.err.startswith(note)
    assert f"recorded 5 frames to {results / 'scan-2.igs.mha'}. {note}" in captured.out


def test_a_volume_does_not_replace_the_recording_that_took_another_name(serve, live, results, capsys):
    (results / "scan.nrrd").write_bytes(b"precious")
    assert main(live(serve(loop=True), "--frames", "5", "--output", results / "scan-2.nrrd", "--record", results / "scan.nrrd")) == 2
    assert "scan-2.nrrd would overwrite another output" in capsys.readouterr().err
    assert [path.name for path in results.iterdir()] == ["scan.nrrd"]


def test_scouting_finds_the_box_and_what_was_seen_enters_the_volume(serve, live, results, capsys):
    arguments = live(serve(loop=True), "--frames", "30", "--scout-seconds", "0.2", "--output", results / "v.nrrd", grid=False)
    assert main(arguments) == 0
    captured = capsys.readouterr()
    assert "The box is" in captured.err
    assert "30 of 30 frames" in captured.out


def test_when_nothing_was_inserted_the_reason_is_said_and_the_recording_kept(serve, live, results, capsys):
    sequence = tracked_sequence(count=12, statuses=dict.fromkeys(range(12), TransformStatus.OUT_OF_VIEW))
    record = results / "scan.mha"
    code = main(live(serve(sequence, loop=True), "--frames", "5", "--output", results / "v.nrrd", "--record", record))
    error = capsys.readouterr().err.splitlines()[-1]
    assert code == 2
    assert "Not one of 5 frames" in error
    assert "ProbeToTracker" in error
    assert f"recorded 5 frames to {record}" in error
    assert len(read_sequence(record)) == 5


def test_a_scan_that_looks_for_bone_says_how_all_frames_are_weighted_by_all_of_it(serve, live, results, capsys):
    record, looking = results / "scan.mha", ["--bone-from-sweep", "--method", "weighted", "--probe", "linear"]
    arguments = live(serve(loop=True), "--frames", "10", *looking, "--output", results / "v.nrrd", "--record", record)
    assert main(arguments) == 0
    lines = capsys.readouterr().out.splitlines()
    assert f"  to weight all frames by all that was found: aifrecon reconstruct {record} --bone-from-sweep" in lines
    assert any("Bone is known from" in line for line in lines)


def fail_at_frame(number, monkeypatch):
    real = Reconstructor.insert

    def insert(self, frame):
        if frame.number >= number:
            raise MemoryError("no more memory")
        real(self, frame)

    monkeypatch.setattr(Reconstructor, "insert", insert)


@pytest.mark.parametrize("recorded", [0, 9])
def test_an_error_saves_what_was_there_before_and_a_recording_goes_on(recorded, serve, live, results, capsys, monkeypatch):
    fail_at_frame(5, monkeypatch)
    record = ["--record", results / "scan.mha", "--frames", recorded] if recorded else []
    assert main(live(serve(loop=True), "--output", results / "v.nrrd", *record)) == 2
    assert "stopped early: no more memory" in capsys.readouterr().err
    assert read_volume(results / "v.nrrd").array.any()
    assert not recorded or len(read_sequence(results / "scan.mha")) == recorded


def frames_by_now(recorded) -> int:
    """How many frames a recording holds that is being written; its header and its lines may be read in between."""
    try:
        return len(read_sequence(recorded)) if recorded.exists() else 0
    except SequenceFormatError:
        return 0


@pytest.mark.skipif(sys.platform == "win32", reason="interrupts are sent differently there")
def test_ctrl_c_saves_what_there_is(serve, live, results):
    recorded = results / "scan.recording.mhd"
    arguments = live(serve(loop=True), "--output", results / "v.nrrd", "--record", results / "scan.mhd")
    child = subprocess.Popen(
        [sys.executable, "-m", "AIFReconLib", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ
    )
    try:
        until(lambda: child.poll() is not None or frames_by_now(recorded) >= 5)
        child.send_signal(signal.SIGINT)
        out, error = child.communicate(timeout=LONG)
    finally:
        child.kill()
        child.communicate()
    assert child.returncode == 0, (out, error)
    assert out.endswith("Scan ended, volume saved.\n")
    assert read_volume(results / "v.nrrd").array.any()
    assert len(read_sequence(results / "scan.mhd")) > 0


def told_to_end(number, when):
    """Sends the signal to this process once `when` is true."""

    def wait():
        until(when)
        signal.raise_signal(number)

    threading.Thread(target=wait, daemon=True).start()


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent differently there")
def test_a_program_that_is_told_to_end_saves_the_volume_and_says_by_what(serve, live, results, capsys):
    recording = results / "scan.recording.mhd"
    told_to_end(signal.SIGTERM, recording.exists)
    assert main(live(serve(loop=True), "--output", results / "v.nrrd", "--record", results / "scan.mhd")) == 143
    assert "frames into" in capsys.readouterr().out
    assert read_volume(results / "v.nrrd").array.any()


@pytest.mark.skipif(sys.platform == "win32", reason="interrupts are sent differently there")
def test_ctrl_c_before_a_frame_has_come_is_one_sentence(live, results, capsys, monkeypatch):
    monkeypatch.setattr("AIFReconLib.commands.live._wait_for_images", lambda *_: signal.raise_signal(signal.SIGINT))
    with ScriptedServer() as server:
        threading.Thread(target=server.accept, daemon=True).start()
        assert main(live(server, "--output", results / "v.nrrd")) == 130
    assert capsys.readouterr().err.splitlines()[-1] == (
        "aifrecon: Scan ended, nothing to save. No frame was received, so there is no volume."
    )


# ---- what came and is not used


TRANSFORM, IMAGE = transform_bytes(), image_bytes(device="Image")
SLICES = image_bytes(np.zeros((8, 6, 5), np.uint8), device="Image")
UNSUMMED = TRANSFORM[:50] + bytes(8) + TRANSFORM[58:]


VIDEO = encode_message("VIDEO", "Image", 1.0, bytes(30))
UNUSED = {
    "slices": (lambda _: [TRANSFORM, SLICES], "Every image of Image was refused: IMAGE message of 'Image' holds 5 x 6 x 8 pixels"),
    "video": (lambda _: [TRANSFORM, VIDEO], "Image comes as VIDEO, which is not read: let the server send IMAGE"),
    "checksum": (lambda _: [UNSUMMED], "but were refused: A message (TRANSFORM of ProbeToTracker) has no checksum"),
    "bare": (lambda _: [IMAGE], "No transforms are sent."),
    "unconfirmed": (lambda number: [image_bytes(timestamp=100.0 + number)], "or give --trust-image-pose"),
}


@pytest.mark.parametrize(("messages", "words"), UNUSED.values(), ids=UNUSED)
def test_images_that_came_and_are_not_used_are_named_in_the_last_line(messages, words, live, results, capsys, monkeypatch):
    monkeypatch.setattr("AIFReconLib.commands.live.DEVICE_TIMEOUT", 0.5)

    def send():
        server.accept()
        with suppress(OSError):
            for number in range(200):
                for message in messages(number):
                    server.send(message)
                time.sleep(0.01)

    with ScriptedServer() as server:
        thread = threading.Thread(target=send, daemon=True)
        thread.start()
        code = main(live(server, "--frames", "5", "--output", results / "v.nrrd"))
        thread.join(LONG)
    line = capsys.readouterr().err.splitlines()[-1]
    assert (code, words in line) == (2, True), line


# ---- the status line


class Shown:
    """What a status line asks of a session."""

    scouted = 0
    statistics = LiveStatistics("reconstructing", "connected", "tracked", 40, 31, 0, {"x": 9}, 29.9, 0.012, 0.05)


def test_the_status_tells_tracking_rate_latency_and_counts():
    text = status_text(Shown.statistics)
    for word in ("29.9 frames/s", "tracked", "31 inserted", "12 ms", "9 skipped"):
        assert word in text


def test_trouble_is_said_once_in_a_line_of_its_own():
    class Troubled(Shown):
        statistics = replace(Shown.statistics, trouble="Nothing has arrived for 2 s.")

    clock = iter(np.arange(0, 20, 0.5))
    stream = io.StringIO()
    stream.isatty = lambda: True
    line = StatusLine(stream, lambda: next(clock))
    for _ in range(40):
        line.show(Troubled)
    assert stream.getvalue().count("Nothing has arrived for 2 s.\n") == 1

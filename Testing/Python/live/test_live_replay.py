"""The replay server: what it sends for a recording, to whom, and when; and its command."""

from __future__ import annotations

import signal
import socket
import struct
import subprocess
import sys
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from files import refused, tracked_sequence, write_patient
from igtl_streams import DEADLINE, Inbox, wait_for

from AIFReconLib.errors import LiveConnectionError, SequenceFormatError, SettingsError, TransformError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.live.pairing.synchronizer import Synchronizer
from AIFReconLib.live.replay import server as replay
from AIFReconLib.live.replay.frames import ReplayFrames
from AIFReconLib.live.replay.server import ReplayServer
from AIFReconLib.live.wire.client import OpenIGTLinkClient
from AIFReconLib.live.wire.decoding import decode
from AIFReconLib.live.wire.encoding import encode_status_request
from AIFReconLib.live.wire.framing import Framer, RawMessage
from AIFReconLib.live.wire.messages import ImageMessage, TransformMessage
from AIFReconLib.sweep.frames import CROPPED, FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

TEMPLATES = sorted((Path(__file__).resolve().parents[3] / "Resources" / "PlusConfiguration").glob("*.xml"))
PROBE_TO_TRACKER = TransformName("Probe", "Tracker")
QUICKLY = {"port": 0, "rate": 200.0}


@pytest.fixture(autouse=True)
def _quick_end(monkeypatch):
    monkeypatch.setattr(replay, "END_INTERVAL", 0.02)


@pytest.fixture(scope="module")
def patient(tmp_path_factory):
    """The made-up patient, once for all tests here, which change nothing."""
    return write_patient(tmp_path_factory.mktemp("inputs"))


@pytest.fixture(scope="module")
def sequence(patient) -> TrackedSequence:
    """Six tracked frames with the calibration of their configuration."""
    return read_sequence(patient.sweep, config=patient.config)


@pytest.fixture
def serve():
    """Starts servers and clients, and stops them all at the end."""
    with ExitStack() as stack:

        def start(sequence, **options):
            server = stack.enter_context(ReplayServer(sequence, **{**QUICKLY, **options}))
            server.connect = lambda: Inbox(stack.enter_context(OpenIGTLinkClient("127.0.0.1", server.port, retry_delays=(0.02,))))
            return server

        yield start


def changed(sequence: TrackedSequence, number: int, **changes) -> TrackedSequence:
    """The sequence with another record of one frame."""
    records = list(sequence.records)
    records[number] = replace(records[number], **changes)
    return replace(sequence, records=records)


def losing_the_probe(sequence: TrackedSequence, number: int) -> TrackedSequence:
    """The sequence with the probe out of view in one frame."""
    transforms = dict(sequence.records[number].transforms)
    transforms[PROBE_TO_TRACKER] = TransformSample(transforms[PROBE_TO_TRACKER].matrix, TransformStatus.OUT_OF_VIEW)
    return changed(sequence, number, transforms=transforms)


def of_one_time(inbox: Inbox) -> dict[float, list]:
    """Images and transforms by their time."""
    groups: dict[float, list] = {}
    for message in inbox.messages:
        if isinstance(message, ImageMessage | TransformMessage):
            groups.setdefault(message.timestamp, []).append(message)
    return groups


def at_the_end(inbox: Inbox) -> bool:
    """Whether the statuses that follow the last frame have begun; the first answers the client's request."""
    is_over = inbox.client.statistics.count("STATUS") > 1
    while is_over and (message := inbox.client.get(0)) is not None:
        inbox.messages.append(message)
    return is_over


# ---- what is sent


def test_every_image_arrives_in_order_and_in_its_place_with_all_transforms_of_its_time(serve, sequence):
    inbox = serve(sequence).connect().until(at_the_end)
    assert len(inbox.images()) == len(sequence)
    assert all(np.array_equal(message.image, sequence.images[n]) for n, message in enumerate(inbox.images()))
    assert {message.device for message in inbox.images()} == {"Image_Reference"}
    expected = sweep_poses(sequence).image_to_reference
    assert np.allclose([message.image_to_sender for message in inbox.images()], expected, atol=2e-4)
    # Those of a frame share their time to the last bit
    names = {tuple(message.device for message in group) for group in of_one_time(inbox).values()}
    assert names == {("Image_Reference", "ProbeToTracker", "ReferenceToTracker", "ImageToReference")}
    text = inbox.images()[3].metadata["ProbeToTrackerTransform"]
    assert np.array_equal(np.array(text.split(), float).reshape(4, 4), sequence.records[3].transforms[PROBE_TO_TRACKER].matrix)


@pytest.mark.parametrize(("options", "interval"), [({"rate": None}, 0.05), ({"loop": True}, 1 / 200)])
def test_frames_are_as_far_apart_as_recorded_or_asked_for_and_a_loop_goes_on_without_a_gap(options, interval, serve, sequence):
    inbox = serve(sequence, **options).connect().until(lambda inbox: len(inbox.images()) >= (20 if "loop" in options else 6))
    assert np.allclose(np.diff([message.timestamp for message in inbox.images()]), interval, atol=1e-5)
    assert all(np.array_equal(message.image, sequence.images[number % 6]) for number, message in enumerate(inbox.images()))


def test_a_transform_can_be_derived_on_request(serve, sequence):
    inbox = serve(sequence, transforms=["ProbeToReference"]).connect().until(at_the_end)
    assert {message.device for message in inbox.transforms()} == {"ProbeToReference"}
    samples = {name: sample.matrix for name, sample in sequence.records[0].transforms.items()}
    expected = np.linalg.inv(samples[TransformName("Reference", "Tracker")]) @ samples[PROBE_TO_TRACKER]
    assert np.allclose(inbox.transforms()[0].matrix, expected, atol=2e-4)


def test_a_recording_without_calibration_is_sent_without_a_pose(serve, patient):
    inbox = serve(read_sequence(patient.sweep)).connect().until(at_the_end)
    assert {message.device for message in inbox.images()} == {"Image"}
    assert np.array_equal(inbox.images()[0].image_to_sender, np.eye(4))


# ---- validity


@pytest.mark.parametrize("valid_only", [True, False])
def test_an_invalid_transform_is_left_out_or_sent_as_identity_and_its_image_with_the_recorded_pose(valid_only, serve, sequence):
    inbox = serve(losing_the_probe(sequence, 2), valid_only=valid_only).connect().until(at_the_end)
    image, *transforms = list(of_one_time(inbox).values())[2]
    assert np.allclose(image.image_to_sender, sweep_poses(sequence).image_to_reference[2], atol=2e-4)
    assert image.metadata["ProbeToTrackerTransformStatus"] == "OUT_OF_VIEW"
    sent = {message.device: message for message in transforms}
    assert set(sent) == {"ReferenceToTracker"} | (set() if valid_only else {"ProbeToTracker", "ImageToReference"})
    if not valid_only:
        probe = sent["ProbeToTracker"]
        assert np.array_equal(probe.matrix, np.eye(4))
        assert (probe.status, probe.metadata["TransformValid"]) == (TransformStatus.OUT_OF_VIEW, "0")


def test_a_frame_without_image_sends_its_transforms_only(serve, sequence):
    inbox = serve(changed(sequence, 1, image_status=TransformStatus.INVALID)).connect().until(at_the_end)
    assert (len(inbox.images()), len(inbox.transforms("ProbeToTracker"))) == (5, 6)


def test_a_missing_transform_is_not_taken_from_the_configuration(sequence):
    reference_only = {name: sample for name, sample in sequence.records[0].transforms.items() if name != PROBE_TO_TRACKER}
    frames = ReplayFrames(changed(sequence, 0, transforms=reference_only))
    devices = [part.device for part in Framer().feed(frames.messages(0, 1.0, 1))]
    assert devices == ["Image_Reference", "ReferenceToTracker"]


@pytest.mark.parametrize("version", [1, 2])
def test_a_cropped_recording_is_placed_by_its_receiver_as_by_a_reader(sequence, version):
    cropped = TransformSample(np.array([[1.0, 0, 0, -5], [0, 1, 0, -7], [0, 0, 1, 0], [0, 0, 0, 1]]))
    sequence = changed(sequence, 0, transforms={**sequence.records[0].transforms, CROPPED: cropped})
    synchronizer, parts = Synchronizer(), Framer().feed(ReplayFrames(sequence).messages(0, 1.0, version))
    placed = [frame for part in parts for message in decode(part) for frame in synchronizer.feed(message)] + synchronizer.flush()
    expected = sweep_poses(sequence).image_to_reference[0]
    np.testing.assert_allclose(placed[0].image_to_reference, expected, atol=1e-3)


# ---- header versions


def raw(server: ReplayServer, request: bytes = b"", count: int = 3) -> list[RawMessage]:
    """The first messages that a client receives which sends `request`."""
    framer = Framer()
    parts: list[RawMessage] = []
    with socket.create_connection(("127.0.0.1", server.port), timeout=DEADLINE) as connection:
        connection.sendall(request)
        while len(parts) < count:
            parts += framer.feed(connection.recv(2**16))
    return parts[:count]


@pytest.mark.parametrize(("kept", "asked", "sent"), [(None, False, 1), (None, True, 2), (1, True, 1), (2, False, 2)])
def test_the_header_version_is_the_one_that_the_client_asks_for_or_that_is_kept(serve, sequence, kept, asked, sent):
    parts = raw(serve(sequence, header_version=kept), encode_status_request() if asked else b"", count=4)
    assert {part.version for part in parts} == {sent}


# ---- the end, and the beginning


def test_waiting_ends_when_the_recording_has_been_sent_and_statuses_of_time_0_follow(serve, sequence):
    server = serve(sequence)
    assert not server.wait(0.0)
    *_, last = raw(server, count=4 * 6 + 3)
    assert server.wait(DEADLINE)
    assert (server.sent, last.kind, last.device, last.timestamp) == (6, "STATUS", "", 0.0)


@pytest.mark.parametrize(
    ("rate", "enough"), [(200.0, at_the_end), (25.0, lambda inbox: len(inbox.images()) >= 2)], ids=["at the end", "half way"]
)
def test_the_recording_begins_again_once_every_client_has_left(serve, sequence, rate, enough):
    server = serve(sequence, rate=rate)
    server.connect().until(enough).client.stop()
    wait_for(lambda: server.clients == 0, "the client's leave")
    second = server.connect().until(at_the_end)
    assert np.array_equal(second.images()[0].image, sequence.images[0])
    assert len(second.images()) == 6


# ---- clients that misbehave


def test_a_slow_client_misses_whole_frames_and_stalls_no_other(serve, monkeypatch):
    monkeypatch.setattr(replay, "QUEUE_BYTES", 2**21)
    server = serve(tracked_sequence(images=np.zeros((6, 500, 500), np.uint8)), loop=True)
    with socket.create_connection(("127.0.0.1", server.port), timeout=DEADLINE) as slow:
        inbox = server.connect().until(lambda inbox: len(inbox.images()) >= 60)
        wait_for(lambda: server.dropped > 5, "frames that are missed")
        framer, parts = Framer(), []
        while len({part.timestamp for part in parts}) < 20:
            parts += framer.feed(slow.recv(2**20))
    assert (framer.problem, {part.problem for part in parts}) == (None, {None})
    assert inbox.client.statistics.damaged == 0


# ---- starting and stopping


def test_a_port_in_use_is_refused_in_plain_words_by_the_command_too(serve, sequence, patient, results, capsys):
    port = serve(sequence).port
    with pytest.raises(LiveConnectionError, match=f"Port {port} is in use by another program, perhaps a PlusServer"):
        ReplayServer(sequence, port).start()
    assert f"Port {port} is in use" in refused(["replay", patient.sweep, "--port", port], capsys, results)


def test_an_address_of_another_machine_is_refused(sequence):
    with pytest.raises(LiveConnectionError, match=r"192\.0\.2\.1 is no address of this machine"):
        ReplayServer(sequence, 0, "192.0.2.1").start()


def test_damage_in_the_recording_ends_the_replay_with_its_error(serve, tmp_path):
    patient = write_patient(tmp_path, compress=False)
    sequence = read_sequence(patient.sweep, config=patient.config)
    patient.sweep.write_bytes(patient.sweep.read_bytes()[:-100])
    server = serve(sequence)
    server.connect()
    with pytest.raises(SequenceFormatError, match=r"sweep\.igs\.mha: "):
        server.wait(DEADLINE)


# ---- settings


def of_pixels(dtype, columns, frames=1):
    return TrackedSequence(np.zeros((frames, 1, columns), dtype), [FrameRecord(timestamp=1.0)] * frames)


@pytest.mark.parametrize(
    ("options", "kind", "why"),
    [
        ({"header_version": 3}, SettingsError, "Input header_version must be 1 or 2; got 3"),
        *(({"port": port}, SettingsError, "Input port must be a whole number from 0 to 65535") for port in (-1, 65536, "18944")),
        *(({"rate": rate}, SettingsError, "Input rate must be above 0 and at most 1000 frames/s") for rate in (0, -1, np.nan, np.inf, 1e6)),
        ({"transforms": ["NeedleToReference"]}, TransformError, "Nothing says where Needle lies in Reference"),
        ({"image_to_reference": "ImageToNeedle"}, TransformError, "Nothing says where Image lies in Needle"),
        ({"sequence": of_pixels(np.uint8, 2, frames=0)}, SettingsError, "has no frames to replay"),
        *(
            ({"sequence": of_pixels(*like)}, SettingsError, "cannot be sent over OpenIGTLink")
            for like in ((np.int64, 2), (np.float16, 2), (np.uint8, 70_000))
        ),
    ],
)
def test_what_cannot_be_served_is_refused_in_a_sentence(options, kind, why, sequence):
    with pytest.raises(kind, match=why):
        ReplayServer(**{"sequence": sequence, **options})


@pytest.mark.parametrize("time", [None, float("nan"), 3.0])
def test_a_recording_without_times_needs_a_rate(time):
    without = TrackedSequence(np.zeros((2, 2, 2), np.uint8), [FrameRecord(timestamp=time)] * 2)
    with pytest.raises(SettingsError, match=r"no recorded times to follow\. Give the rate"):
        ReplayFrames(without)
    assert ReplayFrames(without, rate=10.0).offsets.tolist() == [0.0, 0.1]


def test_equal_times_are_moved_apart_so_that_no_two_frames_are_mixed_up():
    records = [FrameRecord(timestamp=time) for time in (1.0, 1.0, 2.0)]
    frames = ReplayFrames(TrackedSequence(np.zeros((3, 2, 2), np.uint8), records))
    assert (np.diff(frames.offsets) > 0).all()


# ---- configurations of Plus


@pytest.mark.parametrize("path", TEMPLATES, ids=lambda path: path.name)
def test_a_template_can_be_read_and_sends_what_a_live_reconstruction_needs(path):
    configuration = read_plus_configuration(path)
    assert (configuration.warnings, list(map(str, configuration.transforms))) == ((), ["ImageToProbe"])
    root = ElementTree.parse(path).getroot()
    server = root.find("PlusOpenIGTLinkServer")
    assert {"ProbeToTracker", "ReferenceToTracker"} <= {element.get("Name") for element in server.iter("Transform")}
    assert server.find(".//Image").attrib == {"Name": "Image", "EmbeddedTransformToFrame": "Reference"}
    offered = {channel.get("Id") for channel in root.iter("OutputChannel")}
    assert {channel.get("Id") for channel in root.iter("InputChannel")} | {server.get("OutputChannelId")} <= offered


# ---- the command


@contextmanager
def command(sweep, config, *options):
    """The command at work: its process, and the port that it tells."""
    words = [sys.executable, "-m", "AIFReconLib", "replay", str(sweep), "--config", str(config), "--port", "0", "--rate", "200", *options]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        yield process, int(process.stdout.readline().rstrip(".\n").split()[-1])
        process.kill()


@pytest.mark.skipif(sys.platform == "win32", reason="an interrupt cannot be sent to one process there")
def test_the_command_says_what_it_serves_serves_it_and_ends_well_on_an_interrupt(patient):
    with command(patient.sweep, patient.config) as (process, port):
        sends = process.stdout.readline()
        with OpenIGTLinkClient("127.0.0.1", port) as client:
            Inbox(client).until(at_the_end)
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=DEADLINE)
    assert sends.startswith("Sends 6 frames at 200 frames/s: image Image_Reference (with its pose); transforms ProbeToTracker,")
    assert output.endswith("Stopped. Sent 6 frames to 1 client.\n")
    assert (process.returncode, errors) == (0, "")


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have one address for themselves")
def test_the_command_serves_where_and_as_it_is_told(tmp_path):
    lost = write_patient(tmp_path, tracked_sequence(statuses={3: TransformStatus.OUT_OF_VIEW}))
    with command(lost.sweep, lost.config, "--host", "127.0.0.2", "--header-version", "2", "--send-invalid") as (_, port):
        with OpenIGTLinkClient("127.0.0.2", port) as client:
            assert len(Inbox(client).until(at_the_end).transforms("ProbeToTracker")) == 6
        with socket.create_connection(("127.0.0.2", port), DEADLINE) as connection:
            assert connection.recv(2) == struct.pack(">H", 2)

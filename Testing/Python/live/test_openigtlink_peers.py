"""Our client and server against programs of the OpenIGTLink C++ library: its examples, compiled where Debian's packages are installed.

The packages: openigtlink-examples (sources and images), libopenigtlink-dev, g++.
"""

from __future__ import annotations

import shutil
import socket
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from files import IMAGE_TO_PROBE, tracked_sequence
from igtl_streams import DEADLINE, Inbox, wait_for

from AIFReconLib.geometry.transform_graph import TransformName, TransformSample
from AIFReconLib.live.replay.server import ReplayServer
from AIFReconLib.live.wire.client import OpenIGTLinkClient

EXAMPLES = Path("/usr/share/doc/openigtlink-examples/examples")
HEADERS = Path("/usr/include/openigtlink")


@pytest.fixture(scope="session")
def program(tmp_path_factory) -> Callable[[str], Path]:
    """Compiles an example of the C++ library by its name, ``Imager/ImagerServer``, with every checksum verified."""
    compiler = shutil.which("g++") or shutil.which("c++")
    if compiler is None or not HEADERS.is_dir() or not EXAMPLES.is_dir():
        pytest.skip("the Debian packages openigtlink-examples, libopenigtlink-dev and g++ are not all installed")
    folder = tmp_path_factory.mktemp("peers")

    def compiled(name: str) -> Path:
        built, copy = folder / Path(name).name, folder / f"{Path(name).name}.cxx"
        if not built.is_file():
            source = EXAMPLES / f"{name}.cxx"
            if not source.is_file():
                pytest.skip(f"{source} is not there")
            # The examples skip the checksum; with 1 they verify it
            copy.write_text(source.read_text("utf-8", "replace").replace("->Unpack()", "->Unpack(1)"), "utf-8")
            command = [compiler, "-w", f"-I{HEADERS}", str(copy), "-lOpenIGTLink", "-lpthread", "-o", str(built)]
            outcome = subprocess.run(command, capture_output=True, text=True, timeout=120)
            if outcome.returncode:
                pytest.skip(f"{name} cannot be compiled here: {outcome.stderr.splitlines()[0]}")
        return built

    return compiled


@contextmanager
def running(*command, **streams) -> Iterator[None]:
    """A program that goes on until what is within has ended."""
    process = subprocess.Popen([*map(str, command)], **streams)
    try:
        yield
    finally:
        process.kill()
        process.wait()


def test_images_of_the_cpp_library_arrive_pixel_for_pixel_and_their_center_lies_where_it_puts_it(program):
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    server = program("Imager/ImagerServer"), port, "50", EXAMPLES / "Imager" / "img"
    with running(*server, stdout=subprocess.DEVNULL), OpenIGTLinkClient("127.0.0.1", port, retry_delays=(0.05,)) as client:
        inbox = Inbox(client).until(lambda inbox: len(inbox.images()) >= 5)
    stored = [np.fromfile(EXAMPLES / "Imager" / "img" / f"igtlTestImage{n}.raw", np.uint8).reshape(256, 256) for n in range(1, 6)]
    assert all(np.array_equal(message.image, expected) for message, expected in zip(inbox.images(), stored, strict=False))
    # The example: axes (1, -1, 1), spacing (1, 1, 5), position 0
    matrix = inbox.images()[0].image_to_sender
    assert np.allclose(matrix @ (127.5, 127.5, 0, 1), (0, 0, 0, 1))
    assert np.allclose(matrix[:3, :3], np.diag([1.0, -1.0, 5.0]))
    assert inbox.client.statistics.damaged == 0


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_the_cpp_library_receives_a_replay_checksums_verified(program, tmp_path, dtype):
    tracked = tracked_sequence(images=np.full((6, 30, 40), 7, dtype))
    for record in tracked.records:
        record.transforms[TransformName("Image", "Probe")] = TransformSample(IMAGE_TO_PROBE)
    log, server = tmp_path / "log", ReplayServer(tracked, port=0, rate=50.0)
    with server, log.open("w") as file, running(program("Receiver/ReceiveClient"), "127.0.0.1", server.port, stdout=file, stderr=file):
        assert server.wait(DEADLINE)
        wait_for(lambda: "STATUS data type" in log.read_text(), "a status in the log")
    text = log.read_text()
    # A body is printed only when its checksum was right
    assert text.count("Device Name           : Image_Reference") == 6
    assert text.count("Dimensions            : (40, 30, 1)") == 6
    assert text.count("Receiving TRANSFORM data type.") == 6 * 4

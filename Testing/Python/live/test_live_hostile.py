"""Peers that mean no good: a live session can always be stopped and holds little; the replay server serves the others."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from igtl_streams import wait_for
from soak import hostile

REPOSITORY = Path(__file__).resolve().parents[3]
PATIENCE = 60.0
"""s. Nobody waits that long for a thread that is stopped, however slow the machine; one that hangs takes longer."""

MOST_MIB = 500.0
"""What the bounded queues of a client hold in the worst case, and then some."""


@pytest.mark.parametrize("behavior", hostile.SERVERS.values(), ids=hostile.SERVERS)
def test_a_session_with_a_hostile_server_stops_at_once_and_holds_little(behavior):
    cost = hostile.endure_server(behavior, 1.0)
    assert (cost.stopped_after < PATIENCE, cost.peak_mib < MOST_MIB, cost.threads_left) == (True, True, 0), cost


@pytest.mark.skipif(sys.platform == "win32", reason="no Ctrl-C can be sent to one process alone on Windows")
@pytest.mark.parametrize("name", ["silent", "garbage", "closes at once"])
def test_ctrl_c_ends_the_command_whatever_the_server_does(name, tmp_path):
    with hostile.hostile_server(hostile.SERVERS[name]) as port:
        command = [sys.executable, "-m", "AIFReconLib", "live", "--port", str(port), "--output", str(tmp_path / "volume.nrrd")]
        environment = {**os.environ, "PYTHONPATH": str(REPOSITORY)}
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment) as process:
            connections = Path(f"/proc/{process.pid}/task")
            wait_for(lambda: not connections.is_dir() or len(list(connections.iterdir())) > 1, "the threads of the command")
            time.sleep(1.0)
            process.send_signal(signal.SIGINT)
            _, told = process.communicate(timeout=60.0)
    # Ended by the interrupt itself, or, where there is no volume to save, with one line that says so
    assert (process.returncode in (-signal.SIGINT, 130, 2), "Traceback" in told) == (True, False), told


@pytest.mark.parametrize(("behavior", "count"), [(hostile.never_reads, 20), (hostile.sends_garbage, 20), (hostile.says_nothing, 100)])
def test_hostile_clients_take_nothing_from_an_honest_one(behavior, count):
    cost = hostile.endure_clients(behavior, count, 1.0)
    assert cost.frames > 0
    assert (cost.peak_mib < MOST_MIB, cost.threads_left) == (True, 0), cost

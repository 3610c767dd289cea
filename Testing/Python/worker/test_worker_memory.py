"""Arrays between program and worker: the same to the bit, one copy for both, and gone when both have dropped them."""

from __future__ import annotations

import os
import subprocess
import sys
from multiprocessing import Pipe
from pathlib import Path

import numpy as np
import pytest
import worker_tasks as tasks
from waiting import until

from AIFReconLib.worker.calls import VALUE, Message
from AIFReconLib.worker.channel import LARGE, Channel, shared_array

linux = pytest.mark.skipif(sys.platform != "linux", reason="asks /proc")
MILLION = 1_000_000


def arrays():
    """Of all kinds, below and above what crosses in shared memory."""
    random = np.random.default_rng(0)
    large = random.random((40, 50, 60))
    pairs = np.zeros(20_000, [("place", "<f4", (3,)), ("number", "<i8")])
    pairs["place"] = random.random((20_000, 3))
    frozen = random.random(20_000)
    frozen.flags.writeable = False
    shared = shared_array((40, 50, 60), np.float64)
    shared[:] = large
    yield from (np.zeros(0), np.zeros((0, 3)), np.array(3.5), np.arange(5))
    yield from (np.frombuffer(b"x" * (LARGE - 1), np.uint8), np.zeros(LARGE, np.uint8), large > 0.5, large.astype(">f4"))
    yield from (large, np.asfortranarray(large), large[::2], large[:, ::-1], large.T, large.transpose(1, 0, 2))
    yield from (pairs, pairs["place"], frozen, np.array([None, "two", 3.0], object), np.array(["ä"] * 40_000))
    yield from (shared, shared[7:], shared[:, 3], shared[1, 2, 3:], shared.T)
    yield from (np.ma.masked_less(large, 0.5), np.array([np.nan, -0.0, np.inf] * 9_000))


def bits(array: np.ndarray) -> object:
    return array.tolist() if array.dtype == object else array.tobytes()


def test_arrays_of_all_kinds_come_back_the_same_to_the_bit(worker):
    for array in arrays():
        came = worker.call(tasks.returned, array)
        assert (came.dtype, came.shape, came.flags.writeable) == (array.dtype, array.shape, array.flags.writeable)
        assert bits(came) == bits(array)
        assert type(came) is type(array)
    together = list(arrays())
    for came, array in zip(worker.call(tasks.returned, together), together, strict=True):
        assert bits(came) == bits(array)


def test_order_and_write_protection_are_those_of_the_sender(worker):
    array = np.asfortranarray(np.ones((300, 400)))
    assert worker.call(tasks.total, array) == (120_000.0, True, True)
    array.flags.writeable = False
    assert worker.call(tasks.total, array, twice=True) == (240_000.0, False, True)


def test_shared_memory_is_not_copied_when_it_is_sent(worker):
    shared = shared_array((MILLION,), np.float64)
    worker.call(tasks.add_one, shared)
    worker.call(tasks.add_one, shared[10:])
    assert shared.sum() == 2 * MILLION - 10
    private = np.zeros(MILLION)
    worker.call(tasks.add_one, private)
    assert not private.any()


def test_ends_of_memory_are_those_of_the_array():
    here, there = (Channel(end) for end in Pipe())
    small, first, second = np.ones(LARGE, np.uint8), np.full(MILLION, 2.0), np.full(MILLION, 3.0)
    here.send(Message(0, VALUE, [first, small, second]))
    came = there.receive().content
    assert [array[-1] for array in came] == [2.0, 1, 3.0]
    here.close()
    there.close()


# ---- what is left of it


def names() -> set[str]:
    """Of shared memory that this process sees, and that a program which were killed now would leave."""
    lines = Path("/proc/self/maps").read_text("utf-8").splitlines()
    return {line.split()[-1] for line in lines if "/dev/shm/psm_" in line and "(deleted)" not in line}


def shared_bytes(pid: int | str = "self") -> int:
    """Bytes of shared memory that a process has before it, its own share (PSS)."""
    sizes = [0]
    ours = False
    for line in Path(f"/proc/{pid}/smaps").read_text("utf-8").splitlines():
        if "-" in line.split(" ")[0]:
            ours = "/dev/shm/psm_" in line
        elif ours and line.startswith("Pss:"):
            sizes.append(1024 * int(line.split()[1]))
    return sum(sizes)


def descriptors(pid: int | str = "self") -> int:
    return len(os.listdir(f"/proc/{pid}/fd"))


@linux
def test_one_copy_serves_both_and_is_freed_when_both_have_dropped_it(worker):
    # Python's process that frees memory has its descriptors
    worker.call(tasks.returned, worker.call(tasks.filled, MILLION))
    assert until(lambda: shared_bytes(worker.pid) == 0)
    before = descriptors(), descriptors(worker.pid)
    size, others, of_others = 8 * MILLION, shared_bytes(), names()
    for _round in range(3):
        result = worker.call(tasks.filled, MILLION)
        np.testing.assert_array_equal(result, np.arange(MILLION))
        assert until(lambda: 0.9 * size < shared_bytes() - others + shared_bytes(worker.pid) < 1.1 * size)
        assert until(lambda: names() == of_others)  # no program that is killed now leaves it
        del result
        assert until(lambda: shared_bytes() - others + shared_bytes(worker.pid) <= 0)
        assert until(lambda: (descriptors(), descriptors(worker.pid)) == before)


@linux
def test_a_small_array_does_not_keep_the_large_one_that_came_with_it(worker):
    others = shared_bytes()
    _large, small = worker.call(tasks.returned, (np.zeros(MILLION), np.ones(LARGE, np.uint8)))
    del _large
    assert until(lambda: shared_bytes() - others < 3 * LARGE)
    assert small.all()


@linux
def test_a_program_that_is_started_meanwhile_inherits_no_memory_and_no_connection(worker):
    kept = worker.call(tasks.filled, MILLION)
    sleeper = subprocess.Popen(
        [sys.executable, "-c", "import time; print(flush=True); time.sleep(100)"], stdout=subprocess.PIPE, close_fds=False
    )
    try:
        sleeper.stdout.readline()
        held = [os.readlink(f"/proc/{sleeper.pid}/fd/{each}") for each in os.listdir(f"/proc/{sleeper.pid}/fd")]
        assert not [each for each in held if "psm_" in each or "socket" in each]
    finally:
        sleeper.kill()
        sleeper.communicate()
    assert kept.size == MILLION


# ---- where there is none


NONE = "import os\ndef none(*_): raise OSError(28, 'No space left on device')\nos.posix_fallocate = none"


@linux
def test_where_there_is_no_shared_memory_arrays_cross_all_the_same(worker, monkeypatch):
    """As in a container, whose /dev/shm is small: written to, it would end the process."""

    def none(*_):
        raise OSError(28, "No space left on device")

    worker.call(exec, NONE)
    monkeypatch.setattr(os, "posix_fallocate", none)
    others = names()
    array = shared_array((MILLION,), np.float64)
    array[:] = np.arange(MILLION)
    np.testing.assert_array_equal(worker.call(tasks.returned, array), array)
    assert names() == others


TOO_LITTLE_TO_RECEIVE = """
import resource
import worker_tasks as tasks
from AIFReconLib.errors import InsufficientMemoryError
from AIFReconLib.worker.worker import Worker

worker = Worker()
worker.call(tasks.returned, 0)
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 30_000_000, resource.RLIM_INFINITY))
for _round in range(3):
    try:
        worker.call(tasks.filled, 10_000_000)
    except InsufficientMemoryError as error:
        print(error)
print(worker.call(tasks.returned, "goes on"))
worker.close()
"""


@linux
def test_an_answer_for_which_there_is_no_room_here_is_an_error_and_the_next_is_heard():
    folder = Path(tasks.__file__).parent
    paths = os.pathsep.join([str(folder), str(folder.parents[1])])
    done = subprocess.run(
        [sys.executable, "-c", TOO_LITTLE_TO_RECEIVE], env={**os.environ, "PYTHONPATH": paths}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert [line.split("(")[0].strip() for line in done.stdout.splitlines()] == [
        "There is no memory for 80.0 MB that two processes share"
    ] * 3 + ["goes on"]

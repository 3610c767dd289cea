"""Arrays between program and worker: the same to the bit, one copy for both, and gone when both have dropped them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import worker_tasks as tasks
from waiting import until

from AIFReconLib.errors import InsufficientMemoryError
from AIFReconLib.worker.calls import Returned
from AIFReconLib.worker.channel import LARGE, Channel, connected, shared_array

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


def test_shared_memory_is_not_copied_on_any_way(worker):
    shared = shared_array((MILLION,), np.float64)
    worker.call(tasks.add_one, shared)
    assert shared.sum() == MILLION
    back = worker.call(tasks.returned, shared[10:])
    assert back.size == MILLION - 10
    back[0] = 7.0
    worker.call(tasks.add_one, back)
    assert (back[0], shared[10]) == (8.0, 8.0)
    private = np.zeros(MILLION)
    worker.call(tasks.add_one, private)
    assert not private.any()


def test_ends_of_memory_are_those_of_the_array():
    here, there = (Channel(end) for end in connected())
    small, first, second = np.ones(LARGE, np.uint8), np.full(MILLION, 2.0), np.full(MILLION, 3.0)
    here.send(Returned(0, [first, small, second]))
    came = there.receive().value
    assert [array[-1] for array in came] == [2.0, 1, 3.0]
    here.close()
    there.close()


# ---- what is left of it


def shared_bytes(pid: int | str = "self") -> int:
    """Bytes of shared memory that a process has before it, its own share (PSS)."""
    sizes = [0]
    ours = False
    for line in Path(f"/proc/{pid}/smaps").read_text("utf-8").splitlines():
        if "-" in line.split(" ")[0]:
            ours = "memfd:aifrecon" in line
        elif ours and line.startswith("Pss:"):
            sizes.append(1024 * int(line.split()[1]))
    return sum(sizes)


def descriptors(pid: int | str = "self") -> int:
    return len(os.listdir(f"/proc/{pid}/fd"))


@linux
def test_one_copy_serves_both_and_is_freed_when_both_have_dropped_it(worker):
    worker.call(tasks.returned, 0)
    before = descriptors(), descriptors(worker.pid)
    size, others = 8 * MILLION, shared_bytes()
    for _round in range(3):
        result = worker.call(tasks.filled, MILLION)
        back = worker.call(tasks.returned, result)
        np.testing.assert_array_equal(back, np.arange(MILLION))
        assert until(lambda: 0.9 * size < shared_bytes() - others + shared_bytes(worker.pid) < 1.1 * size)
        del result
        assert back[-1] == MILLION - 1
        del back
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
        assert not [each for each in held if "aifrecon" in each or "socket" in each]
    finally:
        sleeper.kill()
        sleeper.communicate()
    assert kept.size == MILLION


# ---- where there is none


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX")
def test_memory_that_cannot_be_had_is_an_error_on_either_side_and_no_crash(worker):
    resource = pytest.importorskip("resource")
    worker.call(tasks.returned, 0)
    before = descriptors() if sys.platform == "linux" else 0
    worker.call(tasks.limit_memory, 1_000_000)
    with pytest.raises(InsufficientMemoryError, match=r"no memory for 8\.0 MB"):
        worker.call(tasks.filled, MILLION)
    assert worker.call(tasks.total, np.ones(MILLION))[0] == MILLION
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000, hard))
    try:
        with pytest.raises(InsufficientMemoryError, match=r"no memory for 8\.0 MB"):
            worker.call(tasks.total, np.ones(MILLION))
        with pytest.raises(InsufficientMemoryError):
            shared_array((MILLION,), np.float64)
        assert worker.call(tasks.total, np.ones(1000))[0] == 1000
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert sys.platform != "linux" or descriptors() == before


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

"""Arrays between program and worker: the same to the bit, and an error where there is no room for them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import worker_tasks as tasks

from AIFReconLib.worker.channel import LARGE

linux = pytest.mark.skipif(sys.platform != "linux", reason="asks /proc")
MILLION = 1_000_000


def arrays():
    """Of all kinds, below and above what crosses by itself."""
    random = np.random.default_rng(0)
    large = random.random((40, 50, 60))
    pairs = np.zeros(20_000, [("place", "<f4", (3,)), ("number", "<i8")])
    pairs["place"] = random.random((20_000, 3))
    frozen = random.random(20_000)
    frozen.flags.writeable = False
    yield from (np.zeros(0), np.zeros((0, 3)), np.array(3.5), np.arange(5))
    yield from (np.frombuffer(b"x" * (LARGE - 1), np.uint8), np.zeros(LARGE, np.uint8), large > 0.5, large.astype(">f4"))
    yield from (large, np.asfortranarray(large), large[::2], large[:, ::-1], large.T, large.transpose(1, 0, 2))
    yield from (pairs, pairs["place"], frozen, np.array([None, "two", 3.0], object), np.array(["ä"] * 40_000))
    yield from (large[7:], large[:, 3], large[1, 2, 3:])
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


def test_what_the_worker_does_to_an_array_is_not_done_to_ours(worker):
    private = np.zeros(MILLION)
    worker.call(tasks.add_one, private)
    assert not private.any()


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
    assert done.stdout.splitlines() == ["There is no memory for 80.0 MB that another process has sent."] * 3 + ["goes on"]

"""Work in parts, and reading ahead: everything once, in order, and no thread left behind."""

from __future__ import annotations

import threading
import time

import pytest
from waiting import until

from AIFReconLib.errors import OperationCanceled
from AIFReconLib.machine.read_ahead import read_ahead
from AIFReconLib.machine.threads import in_parts


@pytest.mark.parametrize("threads", [1, 2, 7])
@pytest.mark.parametrize("parts", [0, 1, 20])
def test_every_part_is_done_once(parts, threads):
    done = []
    in_parts(done.append, parts, threads)
    assert sorted(done) == list(range(parts))


def test_work_in_parts_is_canceled_between_two_of_them():
    done, before = [], threading.active_count()
    with pytest.raises(OperationCanceled):
        in_parts(done.append, 1000, 1, lambda fraction, _step: fraction < 0.1, "Working")
    assert done == list(range(100))
    assert threading.active_count() == before


def test_a_part_that_takes_long_is_canceled_between_its_steps():
    done = []

    def work(part):
        for step in range(1000):
            done.append((part, step))
            yield

    heard = iter([True] * 4)
    with pytest.raises(OperationCanceled):
        in_parts(work, 3, 1, lambda *_: next(heard, False), "Working")
    # Once before the part, and after each of its steps
    assert done == [(0, 0), (0, 1), (0, 2), (0, 3)]


def test_an_error_stops_the_parts_of_other_threads_between_their_steps():
    done = []

    def work(part):
        if part == 0:
            while not done:
                time.sleep(0.001)
            raise ValueError("part 0")
        while True:  # until it is stopped
            done.append(part)
            time.sleep(0.001)
            yield

    before = threading.active_count()
    with pytest.raises(ValueError, match="part 0"):
        in_parts(work, 2, 2)
    assert threading.active_count() == before


def test_the_next_items_are_read_while_one_is_worked_on():
    read = []

    def items():
        for number in range(4):
            read.append(number)
            yield number

    with read_ahead(items(), ahead=2) as ours:
        next(ours)
        assert until(lambda: len(read) >= 3)


def test_an_error_of_the_reader_comes_where_its_item_would_have():
    def items():
        yield 1
        raise OSError("cut short")

    taken = []
    with read_ahead(items()) as ours, pytest.raises(OSError, match="cut short"):
        taken.extend(ours)
    assert taken == [1]


@pytest.mark.parametrize("ahead", [1, 3, 100])
@pytest.mark.parametrize("taken", [0, 1, 5])
def test_items_come_in_their_order_and_no_thread_stays_when_the_caller_leaves_early(taken, ahead):
    before = threading.active_count()
    with read_ahead(range(50), ahead) as items:
        assert list(items) == list(range(50))

    def leave_early():
        with read_ahead(iter(range(10_000)), ahead) as ours:
            for _ in range(taken):
                next(ours)
            raise KeyError

    with pytest.raises(KeyError):
        leave_early()
    assert threading.active_count() == before

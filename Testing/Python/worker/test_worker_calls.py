"""Calls of the worker: values, errors, progress, cancel, and what is kept there."""

from __future__ import annotations

import logging
import time

import pytest
import worker_tasks as tasks
from waiting import until

from AIFReconLib.errors import GeometryError, OperationCanceled, WorkerDiedError
from AIFReconLib.message import message_of

# ---- values and errors


def test_arguments_and_results_cross_by_value(worker):
    given = {"one": [1, 2.5, None], "two": ("text", b"bytes", {3})}
    came = worker.call(tasks.answered, given, 7, named="ü", twice=given)
    assert came == ((given, 7), {"named": "ü", "twice": given})
    assert came[0][0] is not given


def test_an_error_is_the_one_that_was_raised_with_its_remedy_and_where(worker):
    with pytest.raises(GeometryError) as caught:
        worker.call(tasks.refuse, "ours")
    sentence = message_of(caught.value)
    assert (sentence, sentence.settings) == ("The grid has no voxels.", ("clip_px",))
    assert "(1, 2, 3, 4)" in str(caught.value)
    assert 'in refuse\n    raise GeometryError("The grid' in str(caught.value.__cause__)
    with pytest.raises(FileNotFoundError, match=r"No such file: 'sweep\.mha'"):
        worker.call(tasks.refuse, "file")


STAY = {
    "cannot be pickled": "LocalError: of a class that nobody finds",
    "two arguments": "TwoArguments: one and two",
    "exit": "SystemExit: 3",
    "answer": "lambda",
    "memory": "Unable to allocate|array is too big",
}


@pytest.mark.parametrize(("kind", "words"), STAY.items())
def test_what_cannot_cross_is_an_error_in_its_words_and_the_worker_goes_on(worker, kind, words):
    with pytest.raises(Exception, match=words) as caught:
        worker.call(tasks.refuse, kind)
    assert isinstance(caught.value, Exception)
    before = worker.pid
    assert worker.call(tasks.returned, 1) == 1
    assert worker.pid == before


def test_a_call_that_cannot_be_sent_or_understood_is_refused_and_kept_objects_stay(worker, tmp_path, monkeypatch):
    counter = worker.keep(tasks.Counter, str(tmp_path / "end"))
    with pytest.raises(Exception, match="pickle"):
        worker.call(lambda: None)
    module = type(tasks)("known_here_alone")
    exec("def function(): pass", vars(module))
    monkeypatch.setitem(__import__("sys").modules, "known_here_alone", module)
    with pytest.raises(ModuleNotFoundError, match="known_here_alone"):
        worker.call(module.function)
    assert worker.call("add", counter, 2) == 2
    assert worker.call("all", counter) == [0, 2]


def test_what_the_library_logs_there_is_logged_here(worker, caplog):
    worker.call(tasks.note, "something")
    assert [(each.name, each.levelno, each.getMessage()) for each in caplog.records] == [
        ("AIFReconLib.noted", logging.WARNING, "something is noted")
    ]


# ---- progress and cancel


def test_progress_rises_and_is_told_every_20_ms_whatever_the_work_does(worker):
    told = []
    worker.call(tasks.reporting, 0.4, progress=lambda fraction, step: told.append((fraction, step)))
    assert [fraction for fraction, _step in told] == sorted(fraction for fraction, _step in told)
    assert told[-1][1] == "counting"
    calls = []
    worker.call(tasks.silent, 0.4, progress=lambda *_: calls.append(time.monotonic()))
    assert len(calls) > 5


def test_a_cancel_ends_the_work_at_its_next_report(worker, tmp_path):
    file = tmp_path / "noted"
    with pytest.raises(OperationCanceled, match="counting"):
        worker.call(tasks.reporting, 1000.0, str(file), progress=lambda _, step: step != "counting")
    assert until(file.exists)


@pytest.mark.parametrize("error", [None, ZeroDivisionError])
def test_who_cancels_does_not_wait_for_work_that_never_reports(worker, error):
    def progress(_fraction, _step):
        if error is not None:
            raise error
        return False

    worker.call(tasks.returned, 0)
    begun = time.monotonic()
    with pytest.raises(error or OperationCanceled):
        worker.call(tasks.silent, 3.0, progress=progress)
    assert worker.call(tasks.returned, 1) == 1
    assert time.monotonic() - begun < 3.0


def test_two_calls_go_on_at_once_each_hears_its_own_and_one_is_answered_within_the_progress_of_another(worker):
    inner = []

    def progress(_fraction, step):
        if step == "counting" and not inner:
            inner.append(worker.call(tasks.returned, "inner"))

    slow = worker.begin(tasks.reporting, 0.5)
    assert worker.call(tasks.returned, "quick") == "quick"
    assert not slow.is_done
    assert slow.result(progress) > 5
    assert (slow.latest[1], inner) == ("counting", ["inner"])


# ---- what is kept


def test_a_kept_object_stays_until_it_is_forgotten(worker, tmp_path):
    file = tmp_path / "end"
    counter = worker.keep(tasks.Counter, str(file))
    assert [worker.call("add", counter, 3), worker.call(tasks.Counter.add, counter, number=4)] == [3, 7]
    worker.forget(counter)
    assert until(file.exists)
    assert until(lambda: file.read_text("utf-8") == "closed at 7")
    with pytest.raises(WorkerDiedError, match="lost with the process"):
        worker.call("add", counter, 1)


def test_short_calls_of_a_kept_object_are_made_in_their_order(worker, tmp_path):
    counter = worker.keep(tasks.Counter, str(tmp_path / "end"))
    for number in range(1, 500):
        worker.begin("add", counter, number)
    assert worker.call("all", counter) == list(range(500))


@pytest.mark.parametrize("forgotten", [True, False])
def test_kept_objects_finish_when_the_worker_is_closed_and_calls_are_heard_while_a_forgotten_one_does(worker, tmp_path, forgotten):
    file = tmp_path / "end"
    kept = worker.keep(tasks.Counter, str(file), 1.0)
    worker.begin(tasks.reporting, 1000.0)
    if forgotten:
        worker.forget(kept)
        assert worker.call(tasks.returned, 1) == 1
        assert not file.exists()
    worker.close()
    assert file.read_text("utf-8") == "closed at 0"


@pytest.mark.parametrize("wait", [0.0, 0.3])
def test_what_is_kept_of_a_canceled_call_is_let_go(worker, tmp_path, wait):
    file = tmp_path / "end"
    task = worker.begin(tasks.slowly_kept, str(file), 0.15, keep=True)
    time.sleep(wait)
    task.cancel()
    assert until(file.exists)

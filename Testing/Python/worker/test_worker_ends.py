"""However worker or program end: one sentence, the next call is answered, and no process and no memory are left."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import worker_tasks as tasks
from waiting import until

from AIFReconLib.errors import WorkerDiedError
from AIFReconLib.machine import processes
from AIFReconLib.machine.processes import python_program
from AIFReconLib.worker import worker as program_side
from AIFReconLib.worker.worker import Worker

FOLDER = Path(tasks.__file__).parent
posix = pytest.mark.skipif(sys.platform == "win32", reason="signals")
linux = pytest.mark.skipif(sys.platform != "linux", reason="asks /proc")


def is_there(pid: int) -> bool:
    """Whether a process of that number runs (one that nobody has waited for does not)."""
    try:
        return Path(f"/proc/{pid}/stat").read_text("utf-8").rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


# ---- the worker ends


@posix
@pytest.mark.parametrize("kind", [signal.SIGKILL, signal.SIGSEGV, signal.SIGTERM])
def test_a_worker_that_dies_in_a_call_is_one_sentence_and_the_next_call_is_answered(worker, kind, capfd):
    child = worker.call(tasks.started)
    others = [worker.begin(tasks.silent, 1000.0), worker.begin(tasks.reporting, 1000.0)]
    with pytest.raises(WorkerDiedError) as caught:
        worker.call(tasks.refuse, str(int(kind)))
    assert str(caught.value) == (
        f"The process that computes was ended by signal {int(kind)}, perhaps for want of memory. Nothing was changed; try again."
    )
    for task in others:
        assert task.is_done
        with pytest.raises(WorkerDiedError):
            task.result()
    assert worker.pid is None
    assert worker.call(tasks.returned, 1) == 1
    # What it has started has ended with it
    assert until(lambda: not is_there(child))
    capfd.readouterr()


@posix
def test_a_worker_that_is_killed_at_any_moment_loses_no_more_than_the_call(worker):
    """Before it has started, while it is sent or sends large answers, and between."""
    large = np.arange(2_000_000, dtype=np.float64)

    for number in range(8):
        task = worker.begin(tasks.returned, (large, ["text" * 10] * 50_000))
        time.sleep(0.01 * number if number % 2 else 0.3 + 0.008 * number)
        os.kill(worker.pid, signal.SIGKILL)
        with contextlib.suppress(WorkerDiedError):  # killed before it had answered
            np.testing.assert_array_equal(task.result()[0], large)
        assert worker.call(tasks.returned, number) == number


@posix
def test_a_worker_that_is_stopped_is_ended_when_it_takes_nothing_any_more(worker, monkeypatch):
    monkeypatch.setattr(program_side, "LONGEST_SILENCE", 0.3)
    worker.call(tasks.returned, 0)
    waiting = worker.begin(tasks.silent, 1000.0)
    stopped = worker.pid
    os.kill(stopped, signal.SIGSTOP)
    while worker.pid == stopped:
        worker.begin(tasks.returned, b"x" * 60_000)
    with pytest.raises(WorkerDiedError, match="did not answer and was ended"):
        waiting.result()
    assert until(lambda: not is_there(stopped))
    assert worker.call(tasks.returned, 1) == 1


# ---- the worker does not begin


@pytest.mark.parametrize("program", ["nowhere/python", "false", "empty"])
def test_a_worker_that_does_not_start_is_one_sentence(worker, monkeypatch, tmp_path, program):
    if program == "empty":
        # A Python without the library
        monkeypatch.setattr(
            sys, "path", [each for each in sys.path if "site-packages" not in each and Path(each or ".").resolve() != FOLDER.parents[1]]
        )
    else:
        monkeypatch.setattr(processes, "python_program", lambda: program)
    with pytest.raises(WorkerDiedError, match=r"^The process that computes could not be started.*try again\.$"):
        worker.call(tasks.returned, 1)
    monkeypatch.undo()
    assert worker.call(tasks.returned, 1) == 1


@posix
def test_within_slicer_its_own_python_is_the_program_and_never_slicer_itself(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "executable", "/opt/Slicer/bin/SlicerApp-real")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(WorkerDiedError, match=r"could not be started \(PythonSlicer, .*\)\. Nothing was changed"):
        Worker().call(tasks.returned, 1)
    brought = tmp_path / "PythonSlicer"
    brought.write_text("", "utf-8")
    brought.chmod(0o755)
    assert python_program() == str(brought)
    monkeypatch.setattr(sys, "executable", "/usr/bin/python3")
    assert python_program() == "/usr/bin/python3"
    monkeypatch.setenv("SLICER_HOME", "/opt/Slicer")
    assert python_program() == str(brought)


PROGRAM = """
import os, sys, time
print("the program runs", flush=True)
import numpy as np
import worker_tasks as tasks
from AIFReconLib.worker.worker import Worker

worker = Worker()
{body}
"""


def program(tmp_path: Path, body: str) -> subprocess.Popen:
    """A program in a file of its own, with a space in its path, that is no module: nothing there asks for its name."""
    folder = tmp_path / "a folder"
    folder.mkdir()
    file = folder / "a program.py"
    file.write_text(PROGRAM.format(body=body), "utf-8")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(FOLDER), str(FOLDER.parents[1])])}
    return subprocess.Popen(
        [sys.executable, str(file)], cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


@pytest.mark.parametrize("before", ["", "import shutil; shutil.rmtree(os.getcwd())"], ids=["", "without its folder"])
def test_the_file_of_the_program_is_not_run_again_and_no_process_outlives_it(tmp_path, before):
    out, err = program(tmp_path, f"{before}\nprint(worker.call(tasks.returned, 7), worker.pid)").communicate()
    assert out.splitlines()[0] == "the program runs"
    seven, pid = out.splitlines()[1].split()
    assert (len(out.splitlines()), seven, err) == (2, "7", "")
    assert sys.platform != "linux" or until(lambda: not is_there(int(pid)))


def test_a_program_that_ends_lets_what_is_kept_finish(tmp_path):
    done = tmp_path / "done"
    program(tmp_path, f"worker.keep(tasks.Counter, {str(done)!r}, 0.5); worker.begin(tasks.silent, 1000.0)").communicate()
    assert until(done.exists)


DOING = (
    "worker.call(tasks.returned, 1)",
    "worker.begin(tasks.silent, 1000.0)",
    "worker.begin(tasks.computing, 1000.0)",
    "while True: worker.call(tasks.returned, np.ones(3_000_000))",
)


@linux
@pytest.mark.parametrize("doing", DOING)
def test_a_program_that_is_killed_leaves_no_process(tmp_path, doing):
    body = f"""
worker.keep(tasks.Counter, {str(tmp_path / "done")!r})
held = worker.call(tasks.filled, 1_000_000)
print(worker.pid, flush=True)
{doing}
time.sleep(1000)
"""
    run = program(tmp_path, body)
    assert run.stdout is not None
    lines = [run.stdout.readline(), run.stdout.readline()]
    pid = int(lines[1])
    family = [int(child) for child in Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text("utf-8").split()]
    assert pid in family
    time.sleep(0.5)
    run.kill()
    run.communicate()
    assert until(lambda: not any(map(is_there, family)))
    assert (tmp_path / "done").exists()


def test_a_worker_that_is_closed_can_be_used_again():
    worker = Worker()
    task = worker.begin(tasks.silent, 1000.0)
    worker.close()
    with pytest.raises(WorkerDiedError, match="closed"):
        task.result()
    assert worker.call(tasks.returned, 1) == 1
    worker.close()
    worker.close()

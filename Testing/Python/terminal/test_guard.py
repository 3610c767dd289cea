"""The guard at the door: whatever ends the process that works is one sentence, with the exit code that says so."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from hdf5_samples import OLDER_HDF5
from waiting import until

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals")

PROGRAM = [sys.executable, "-m", "AIFReconLib"]
FORK = Path("/proc/self/task").is_dir()


def command(patient, results, *more: str) -> list[str]:
    return [*PROGRAM, *patient.reconstruct, "--engine", "numpy", "--spacing", "2", "--output", str(results / "v.nrrd"), *more]


def end_of(run: subprocess.Popen) -> tuple[int, list[str]]:
    _out, error = run.communicate(timeout=300)
    return run.returncode, error.splitlines()


def started(words: list[str], **how) -> subprocess.Popen:
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **how)


def workers_of(run: subprocess.Popen) -> list[int]:
    return [int(pid) for pid in Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text("utf-8").split()]


def has_opened(run: subprocess.Popen, package: str) -> bool:
    """Whether the process that works has loaded this, which takes it a while."""
    return any(package in Path(f"/proc/{pid}/maps").read_text("utf-8") for pid in workers_of(run))


ENDLESS = """
import itertools, pathlib
from AIFReconLib import register_method

@register_method
def endless(intensity):
    pathlib.Path("begun").touch()
    sum(itertools.repeat(0))
"""
"""A method that never leaves compiled code, which hears no signal."""


def test_a_crash_in_a_compiled_library_is_a_sentence_that_names_the_file(patient, results, tmp_path):
    crashing = tmp_path / "move.h5"
    crashing.write_bytes(OLDER_HDF5[:13522] + b"\xff" + OLDER_HDF5[13523:])
    bone = ["--bone-labels", str(patient.labels), "--bone-transform", str(crashing)]
    code, said = end_of(started(command(patient, results, *bone)))
    assert code == 2
    assert said == [
        f"aifrecon: The process that did the work was ended by signal 11: a library that it uses has crashed. The last file that "
        f"it opened is {crashing}. No file is left half-written. Check that file, or save it again from the program that made it."
    ]
    assert list(results.iterdir()) == []


@pytest.mark.skipif(not FORK, reason="asks /proc")
def test_work_without_end_in_compiled_code_ends_by_ctrl_c(patient, results, tmp_path):
    (tmp_path / "forever.py").write_text(ENDLESS)
    run = started(command(patient, results, "--method", "forever:endless"), cwd=tmp_path)
    assert until((tmp_path / "begun").exists)
    run.send_signal(signal.SIGINT)
    code, (said,) = end_of(run)
    assert (code, said.startswith("aifrecon: Interrupted. No file is left half-written.")) == (130, True)
    assert list(results.iterdir()) == []


@pytest.mark.skipif(not FORK, reason="asks /proc")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("is_terminal", [False, True])
def test_a_signal_to_end_reaches_the_work_whether_it_comes_to_one_process_or_to_both(patient, results, number, is_terminal):
    run = started(command(patient, results), start_new_session=True)
    assert until(lambda: workers_of(run))
    if is_terminal:
        os.killpg(run.pid, number)
    else:
        run.send_signal(number)
    code, said = end_of(run)
    assert (code, said) == (128 + number, ["aifrecon: Interrupted. No file is left half-written."])
    assert list(results.iterdir()) == []


@pytest.mark.skipif(not FORK, reason="asks /proc")
def test_the_work_ends_with_a_guard_that_is_killed(patient):
    run = started([*PROGRAM, "replay", str(patient.sweep), "--config", str(patient.config), "--port", "0", "--loop"])
    assert until(lambda: has_opened(run, "numpy"))
    (worker,) = workers_of(run)
    run.kill()
    run.communicate()
    assert until(lambda: not Path(f"/proc/{worker}").exists())


@pytest.mark.parametrize(
    ("words", "guards"),
    [(["--help"], False), (["info", "--help"], False), (["live", "--nonsense"], False), (["info", "--nonsense"], True)],
)
def test_a_question_and_a_recording_start_no_process(words, guards):
    heard = "sys.addaudithook(lambda event, _: event == 'subprocess.Popen' and print('a process starts'))"
    program = f"import sys; {heard}; from AIFReconLib.__main__ import main; sys.exit(main())"
    done = subprocess.run([sys.executable, "-c", program, *words], capture_output=True, text=True, check=False)
    assert ("a process starts" in done.stdout) == guards

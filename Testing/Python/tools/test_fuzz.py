"""What `make fuzz` checks, for a few seconds: every input is refused in one sentence or gives a well-formed result."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest
from fuzz import __main__ as program
from fuzz import targets
from fuzz.damage import LARGEST, damaged
from fuzz.targets import LONGEST_MESSAGE, TARGETS, Target, check
from hypothesis import HealthCheck, given, settings

from AIFReconLib.errors import FileFormatError
from AIFReconLib.io.sequence.files import KINDS


@pytest.mark.parametrize("target", TARGETS.values(), ids=TARGETS)
def test_good_inputs_are_accepted_and_damaged_ones_accepted_or_refused(target, tmp_path):
    inputs = target.inputs(tmp_path)
    # Otherwise nothing behind the first refusal would ever be reached
    assert sum(check(target, data, tmp_path) for data in inputs) >= len(inputs) / 2

    @settings(max_examples=30, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
    @given(damaged(inputs))
    def read(data):
        assert len(data) <= LARGEST
        check(target, data, tmp_path)

    read()


def test_every_kind_of_recording_is_fuzzed():
    assert all({Path(target.file).suffix for target in TARGETS.values()} & set(kind.suffixes) for kind in KINDS)


# ---- the check can fail


def planted(read) -> Target:
    return Target("planted", "input.bin", read, plain)


def plain(folder):
    return [b"12 34\n"]


class Unclean(FileFormatError):
    """Says just what it is given, which errors of the library do not."""

    def __init__(self, text):
        super().__init__(text)
        self.text = text

    def __str__(self):
        return self.text


@pytest.mark.parametrize(
    ("error", "found"),
    [
        (KeyError("size"), "size"),
        (Unclean("two\nlines"), "not for one line"),
        (Unclean("\x1b[2J"), "not for one line"),
        (Unclean(""), "without words"),
        (Unclean("long " * LONGEST_MESSAGE), "long"),
    ],
)
def test_what_is_no_refusal_in_one_line_is_found(tmp_path, error, found):
    def read(path):
        raise error

    with pytest.raises((KeyError, AssertionError), match=found):
        check(planted(read), b"", tmp_path)


def test_what_takes_too_long_is_found(tmp_path, monkeypatch):
    monkeypatch.setattr(targets, "SLOWEST", 0.01)

    def work(path):
        end = time.process_time() + 0.05
        while time.process_time() < end:
            pass

    with pytest.raises(AssertionError, match="it takes 0"):
        check(planted(work), b"", tmp_path)


def test_what_takes_too_much_memory_is_found(tmp_path, monkeypatch):
    monkeypatch.setattr(targets, "LARGEST_GROWTH", -1)
    with pytest.raises(AssertionError, match="MB"):
        check(planted(lambda path: None), b"", tmp_path)


# ---- and so can the program


def raises(path):
    assert b"12" in path.read_bytes()


def crashes(path):
    if b"12" not in path.read_bytes():
        os.kill(os.getpid(), signal.SIGKILL)


def hangs(path):
    while b"12" not in path.read_bytes():
        time.sleep(1)


@pytest.mark.parametrize(("read", "findings"), [(raises, 1), (crashes, 1), (hangs, 1), (Path.stat, 0)])
def test_a_planted_fault_is_found_and_lies_in_its_folder(read, findings, capsys, monkeypatch):
    monkeypatch.setattr(program, "HANG", 2.0 if read is hangs else 300.0)
    assert program.fuzz([planted(read)], 6.0) == findings
    said = capsys.readouterr().out
    assert said.startswith("FINDING planted" if findings else "planted")
    if read is raises:
        assert "AssertionError" in (Path(said.split()[-1]) / "finding.txt").read_text()

"""What `make fuzz` checks, for a few seconds: every input is refused in one sentence or gives a well-formed result."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest
from fuzz import __main__ as program
from fuzz.damage import LARGEST, damaged
from fuzz.targets import TARGETS, Target, check
from hypothesis import HealthCheck, given, settings

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


def planted(read) -> Target:
    return Target("planted", "input.bin", read, plain)


def plain(folder):
    return [b"12 34\n"]


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

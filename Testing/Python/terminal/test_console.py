"""What a terminal shows."""

from __future__ import annotations

import io
import shutil
import sys
from pathlib import Path

import pytest

from AIFReconLib.message import columns
from AIFReconLib.terminal import console
from AIFReconLib.terminal.console import ProgressBar, program


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_terminal_shows_a_bar_with_the_share_and_the_stage():
    stream = Terminal()
    with ProgressBar(stream) as progress:
        progress(1.0, "Reconstructing")
        assert f"[{'#' * console.BAR_WIDTH}] 100%  Reconstructing" in stream.getvalue()


def test_a_bar_is_gone_when_the_work_is_done():
    stream = Terminal()
    with ProgressBar(stream) as progress:
        progress(1.0, "Writing")
    assert stream.getvalue().split("\r")[-2].strip() == ""


def test_a_bar_is_not_drawn_more_often_than_an_eye_can_follow():
    stream = Terminal()
    with ProgressBar(stream) as progress:
        for step in range(1000):
            progress(step / 2000, "Reconstructing")
    assert stream.getvalue().count("Reconstructing") < 20


def test_nothing_is_drawn_where_there_is_no_terminal():
    stream = io.StringIO()
    with ProgressBar(stream) as progress:
        assert progress(1.0, "Reconstructing") is True
    assert stream.getvalue() == ""


def test_columns_are_aligned():
    assert columns([("a", "long"), ("longer", "b")]) == "  a       long\n  longer  b"


def test_no_rows_are_no_lines():
    assert columns([]) == ""


def test_a_program_on_the_path_is_called_by_its_name(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["/somewhere/bin/aifrecon"])
    monkeypatch.setattr(shutil, "which", lambda name: "/somewhere/bin/" + name)
    assert program() == "aifrecon"


def test_a_program_elsewhere_is_called_as_it_was(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(tmp_path / ".venv" / "bin" / "aifrecon")])
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert program() == str(Path(".venv") / "bin" / "aifrecon")


def test_a_module_is_called_with_the_python_that_runs_it(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(Path(console.__file__).parents[1] / "__main__.py"), "demo"])
    monkeypatch.setattr(sys, "executable", str(tmp_path / ".venv" / "bin" / "python"))
    assert program() == f"{Path('.venv') / 'bin' / 'python'} -m AIFReconLib"


@pytest.mark.skipif(sys.platform == "win32", reason="quotes of another kind there")
def test_a_path_with_spaces_is_quoted(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["/my programs/aifrecon"])
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert program() == "'/my programs/aifrecon'"

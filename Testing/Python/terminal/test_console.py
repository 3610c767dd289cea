"""What a terminal shows."""

from __future__ import annotations

import io
import shutil
import sys

import pytest

from AIFReconLib.terminal import console
from AIFReconLib.terminal.console import ProgressBar, _PlainStream, program


@pytest.mark.parametrize("is_terminal", [True, False])
def test_a_terminal_shows_a_bar_until_the_work_is_done_and_nothing_is_drawn_elsewhere(is_terminal):
    stream = io.StringIO()
    stream.isatty = lambda: is_terminal
    with ProgressBar(stream) as progress:
        assert progress(1.0, "Reconstructing") is True
        assert (f"[{'#' * console.BAR_WIDTH}] 100%  Reconstructing" in stream.getvalue()) == is_terminal
    assert stream.getvalue().split("\r")[-2:][0].strip() == ""


def test_a_program_on_the_path_is_called_by_its_name(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["/somewhere/bin/aifrecon"])
    monkeypatch.setattr(shutil, "which", lambda name: "/somewhere/bin/" + name)
    assert program() == "aifrecon"


# ---- what a terminal would obey


@pytest.mark.parametrize("name", ["\x1b[2J", "\x9b31m", "\x07", "\u202egpj", "a\rb", "\x08", "\x7f"], ids=ascii)
def test_what_a_terminal_would_obey_is_shown(name):
    stream = io.StringIO()
    print("label", name, "was met", file=_PlainStream(stream))
    assert stream.getvalue().startswith("label ")
    assert "?" in stream.getvalue()
    assert stream.getvalue()[:-1].isprintable()


def test_lines_may_still_be_drawn_anew_and_hold_every_letter():
    stream = io.StringIO()
    for text in ("\rinserted \xe9\u0394\u4e2d\n", "\r   \r", "a\tb\n"):
        _PlainStream(stream).write(text)
    assert stream.getvalue() == "\rinserted \xe9\u0394\u4e2d\n\r   \ra\tb\n"


def test_a_log_holds_nothing_that_a_terminal_would_obey(tmp_path, capsys):
    from AIFReconLib.commands.parser import main

    main(["info", str(tmp_path / "\x1b[31m.mha"), "--log", str(tmp_path / "log.txt")])
    assert "\x1b" not in (tmp_path / "log.txt").read_text()

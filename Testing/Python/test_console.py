"""What a terminal shows."""

from __future__ import annotations

import io

from AIFReconLib import console
from AIFReconLib.console import ProgressBar, columns


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

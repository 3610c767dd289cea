"""A header and its data file in the place of older ones: whatever fails in between, the header names data that fit it."""

from __future__ import annotations

import contextlib
import os
from unittest.mock import Mock

import pytest

from AIFReconLib.errors import OutputError
from AIFReconLib.io.disk.atomic import atomic_outputs, named_data_file

STEPS = 8
"""More renames, links and removals than a replacement takes."""


def write_pair(folder, version: str) -> None:
    """A header that tells its version, and data that tell it too."""
    with atomic_outputs(folder / "a.raw", folder / "a.mhd") as (data, header):
        data.write_text(version, encoding="utf-8")
        header.write_text(f"Version = {version}\nElementDataFile = {data.name}\n", encoding="utf-8")


def read_pair(folder) -> tuple[str, str]:
    """The version in the header, and the version in the data file that the header names."""
    header = (folder / "a.mhd").read_text("utf-8")
    return header.split("Version = ")[1].split("\n")[0], (folder / named_data_file(folder / "a.mhd")).read_text("utf-8")


@pytest.fixture
def older(tmp_path):
    write_pair(tmp_path, "old")
    return tmp_path


def at_step(monkeypatch, step: int, then, before: bool) -> None:
    """Call `then` before the rename, link or removal with this number and each that follows; or once, after that one is done."""
    done = 0

    def watched(function):
        def call(*arguments, **options):
            nonlocal done
            done += 1
            number = done
            if before and number > step:
                then()
            answer = function(*arguments, **options)
            if not before and number == step + 1:
                then()
            return answer

        return call

    for name in ("replace", "link", "unlink"):
        monkeypatch.setattr(os, name, watched(getattr(os, name)))


@pytest.mark.parametrize("before", [True, False], ids=["not done", "done although it fails"])
@pytest.mark.parametrize("exception", [KeyboardInterrupt(), OSError(5, "no answer")], ids=["Ctrl-C", "a failing disk"])
@pytest.mark.parametrize("step", range(STEPS))
def test_wherever_it_ends_the_header_names_data_of_its_own_version_and_the_next_write_leaves_nothing(older, step, exception, before):
    with pytest.MonkeyPatch.context() as patched:
        at_step(patched, step, Mock(side_effect=exception), before)
        with contextlib.suppress(KeyboardInterrupt, OutputError):
            write_pair(older, "new")
    assert read_pair(older) in (("old", "old"), ("new", "new"))
    for version in ("newer", "newest"):
        write_pair(older, version)
        assert read_pair(older) == (version, version)
    assert {path.name for path in older.iterdir()} <= {"a.mhd", "a.raw", named_data_file(older / "a.mhd")}


@pytest.mark.parametrize("first", [True, False], ids=["a first pair", "over an older pair"])
@pytest.mark.parametrize("step", range(STEPS))
def test_of_two_writers_of_one_pair_one_wins_whole(tmp_path, step, first):
    if not first:
        write_pair(tmp_path, "old")
    with pytest.MonkeyPatch.context() as patched:
        at_step(patched, step, lambda: write_pair(tmp_path, "other"), before=False)
        write_pair(tmp_path, "new")
    assert read_pair(tmp_path) in (("other", "other"), ("new", "new"))


@pytest.mark.parametrize(
    ("header", "text", "data"),
    [
        ("a.nhdr", "NRRD0004\ndata file: a.raw\n", "a.raw"),  # as ITK and Slicer call them, too
        ("a.mhd", "NDims = 3\nElementDataFile = b/a.raw\n", "b/a.raw"),
        ("a.mhd", "NDims = 3\nElementDataFile = \\1 ä%s.raw\n", "\\1 ä%s.raw"),
    ],
)
def test_the_data_of_another_header_or_place_are_not_replaced(tmp_path, header, text, data):
    (tmp_path / "b").mkdir()
    (tmp_path / header).write_text(text, encoding="utf-8")
    (tmp_path / data).write_text("theirs", encoding="utf-8")
    assert header == "a.nhdr" or named_data_file(tmp_path / header) == data
    write_pair(tmp_path, "new")
    assert read_pair(tmp_path) == ("new", "new")
    assert (tmp_path / data).read_text("utf-8") == "theirs"

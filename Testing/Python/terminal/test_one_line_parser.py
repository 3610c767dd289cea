"""Help that fits a screen, and words in whatever order they are typed."""

from __future__ import annotations

from pathlib import Path

import pytest

from AIFReconLib.commands.parser import COMMANDS, main, options_of, parser_of
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.recipe.rules import explained
from AIFReconLib.terminal.arguments import Options


def help_of(capsys, monkeypatch, *words) -> str:
    monkeypatch.setenv("COLUMNS", "80")
    assert main(list(words)) == 0
    said = capsys.readouterr()
    assert said.err == ""
    return said.out


def options_in(text: str) -> set[str]:
    return {word for line in text.splitlines() if line.startswith("  -") for word in line.split() if word.startswith("--")}


SHORT = ["register", "plan", "calibrate", "paths", "coverage"]


@pytest.mark.parametrize("command", SHORT)
def test_help_is_as_short_as_that_of_reconstruct_and_begins_with_what_is_needed(command, capsys, monkeypatch):
    lines = help_of(capsys, monkeypatch, command, "--help").splitlines()
    assert len(lines) <= len(help_of(capsys, monkeypatch, "reconstruct", "--help").splitlines())
    assert lines[0].startswith(f"usage: aifrecon {command} ")
    assert lines[0].endswith("[options]")
    assert "  --help-all" in "\n".join(lines)


@pytest.mark.parametrize("command", ["reconstruct", "live", *SHORT])
def test_the_whole_help_has_every_option(command, capsys, monkeypatch):
    text = help_of(capsys, monkeypatch, command, "--help-all")
    assert {word for word in parser_of(command).spelled if word.startswith("--")} - options_in(text.replace(",", " ")) == set()


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_is_explained(command):
    assert [name for name, each in parser_of(command).declared.items() if not each.words["help"]] == []
    explained_ones = {name for group in options_of(command).__mro__ if issubclass(group, Options) for name in explained(group).parameters}
    assert explained_ones - set(parser_of(command).declared) == set()


@pytest.mark.parametrize("spacing", [["1"], ["1", "1", "1"]])
@pytest.mark.parametrize("option", ["--spacing", "--spac"])
def test_the_file_may_follow_the_spacing(spacing, option, patient, results):
    output = results / "v.nrrd"
    words = [option, *spacing, str(patient.sweep), "--config", str(patient.config), "-o", str(output), "-q"]
    assert main(["reconstruct", *words]) == 0
    assert read_volume(output).grid.spacing == pytest.approx((1, 1, 1))


def test_all_words_behind_two_dashes_are_files():
    assert parser_of("convert").parse(["--mirror", "--", "-in.mha", "-out.mha"]).output == Path("-out.mha")


def test_a_file_may_be_called_like_a_short_option():
    assert parser_of("convert").parse(["q", "o"]).sequence == Path("q")


def test_the_last_file_behind_labels_is_the_one_that_must_be_given():
    asked = parser_of("register").parse(["-o", "t.tfm", "--bone-labels", "a.nrrd", "b.nrrd"])
    assert (asked.bone_labels, asked.sequences) == ([Path("a.nrrd")], (Path("b.nrrd"),))

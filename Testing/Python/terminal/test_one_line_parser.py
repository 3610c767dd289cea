"""Help that fits a screen, and words in whatever order they are typed."""

from __future__ import annotations

import pytest

from AIFReconLib.commands.parser import build_parser, main
from AIFReconLib.io.volume.files import read_volume


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
    parser = build_parser()._subparsers._group_actions[0].choices[command]
    assert {word for word in parser._option_string_actions if word.startswith("--")} - options_in(text.replace(",", " ")) == set()


@pytest.mark.parametrize("spacing", [["1"], ["1", "1", "1"]])
@pytest.mark.parametrize("option", ["--spacing", "--spac"])
def test_the_file_may_follow_the_spacing(spacing, option, patient, results):
    output = results / "v.nrrd"
    words = [option, *spacing, str(patient.sweep), "--config", str(patient.config), "-o", str(output), "-q"]
    assert main(["reconstruct", *words]) == 0
    assert read_volume(output).grid.spacing == pytest.approx((1, 1, 1))


def test_options_may_stand_between_files(patient, capsys):
    words = ["info", str(patient.sweep), "--config", str(patient.config), str(patient.sweep)]
    assert main(words) == 0
    assert capsys.readouterr().out.count("To do so:") == 2


def test_a_word_too_many_is_refused(patient, results, capsys):
    assert main(["bone-map", str(patient.labels), "b.nrrd", "-o", str(results / "p.nrrd")]) == 2
    assert "unrecognized arguments: b.nrrd" in capsys.readouterr().err


def test_quiet_still_says_what_is_wrong(patient, results, capsys):
    assert main([*patient.reconstruct, "-q", "--reference", "Nowhere", "-o", str(results / "v.nrrd")]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("aifrecon: ")
    assert said.err.count("\n") == 1

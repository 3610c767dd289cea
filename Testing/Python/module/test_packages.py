"""Python packages that Slicer does not bring along: versions count, numba is offered once, nothing is installed while Slicer runs tests."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

pytest_plugins = ["host_fixture"]

REPOSITORY = Path(__file__).resolve().parents[3]
PROJECT = (REPOSITORY / "pyproject.toml").read_text("utf-8")


@pytest.fixture
def packages(host, monkeypatch):
    """The module's file, where Slicer has no `slicer.packaging`, as 5.10 has none."""
    monkeypatch.syspath_prepend(REPOSITORY / "AIFRecon")
    monkeypatch.setitem(sys.modules, "slicer.packaging", None)
    from AIFReconGui import packages

    yield packages
    host._application.testing = False


def install(folder: Path, name: str, version: str) -> None:
    """What pip leaves of a package by which its version is known."""
    record = folder / f"{name}-{version}.dist-info"
    record.mkdir()
    (record / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n", "utf-8")


def test_a_package_of_an_older_version_is_missing(packages, tmp_path, monkeypatch):
    install(tmp_path, "pyigtl", "0.1.0")
    monkeypatch.syspath_prepend(tmp_path)
    assert packages.missingLivePackages() == ["pyigtl>=0.3.1"]


def test_faster_reconstruction_is_offered_once_and_says_what_it_gains(packages, host, monkeypatch):
    monkeypatch.setattr(packages, "isInstalled", lambda requirement: False)
    packages.offerSpeed()
    packages.offerSpeed()
    [question] = host.dialogs.messages()
    assert "several times faster" in question
    assert "same result" in question


def test_a_yes_installs_and_a_failure_keeps_nobody_from_working(packages, host, qt, monkeypatch, caplog):
    """The host installs nothing, which is a failure."""
    monkeypatch.setattr(packages, "isInstalled", lambda requirement: False)
    host.dialogs.answers.append(qt.QMessageBox.Yes)
    with caplog.at_level("INFO"):
        packages.offerSpeed()
    assert "does not install packages: ['numba" in caplog.text


@pytest.mark.parametrize(("answer", "told"), [("Cancel", "is not installed, and"), ("Ok", "was not .* needs it: .*not install")])
def test_a_network_in_a_file_asks_for_what_runs_it_and_a_no_or_a_failure_is_told(packages, host, qt, monkeypatch, answer, told):
    """The host installs nothing, which is a failure."""
    monkeypatch.setattr(packages, "isInstalled", lambda requirement: False)
    host.dialogs.answers.append(getattr(qt.QMessageBox, answer))
    with pytest.raises(packages.PackageMissingError, match=f"onnxruntime.* {told}"):
        packages.ensureModelPackages()
    [question] = host.dialogs.messages()
    assert "onnxruntime" in question


def test_the_versions_are_those_of_the_library(packages):
    assert f'fast = ["{packages.FAST}"]' in PROJECT
    assert f'ai = ["{packages.MODEL}"]' in PROJECT
    assert f'"{packages.PAGE}"' in PROJECT
    lines = [line for line in packages.REQUIREMENTS.read_text("utf-8").splitlines() if not line.startswith("#")]
    assert lines == list(dict.fromkeys(re.findall(r'"((?:pyigtl|pandas)[<=>][^"]*)"', PROJECT.partition("test = [")[0])))

"""Releases, Slicer's extension index and the workflows, as far as they can be tested where the repository has no address."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from release import extension_index, notes

REPOSITORY = Path(__file__).resolve().parents[3]

HOMEPAGE = "https://github.com/somebody/SlicerAIFRecon"
PROJECT = (REPOSITORY / "pyproject.toml").read_text("utf-8")
CMAKE = (REPOSITORY / "CMakeLists.txt").read_text("utf-8")
WORKFLOWS = sorted((REPOSITORY / ".github" / "workflows").glob("*.yml"))


@pytest.fixture(scope="module")
def published(tmp_path_factory):
    """A copy of what the script reads, with an address."""
    folder = tmp_path_factory.mktemp("published") / "SlicerAIFRecon"
    for name in [*extension_index.EDITS, "LICENSE", extension_index.ICON]:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(REPOSITORY / name, folder / name)
    shutil.copytree(REPOSITORY / "Resources" / "Screenshots", folder / "Resources" / "Screenshots")
    try:
        subprocess.run(["git", "init", "--quiet"], cwd=folder, check=True)
    except OSError:
        pytest.skip("git is not installed")
    assert extension_index.main(["--homepage", HOMEPAGE], folder) == 0
    return folder


def extras() -> dict[str, str]:
    """What pyproject.toml lists under each extra."""
    table = re.search(r"^\[project\.optional-dependencies\]\n(.*?)^\[", PROJECT, re.DOTALL | re.MULTILINE)
    assert table
    return dict(re.findall(r"^(\w+) = \[(.*?)\]$", table.group(1), re.DOTALL | re.MULTILINE))


# ---- the notes of a release


def test_the_notes_of_a_version_end_where_those_of_the_one_before_begin():
    new = "## 1.1.0 (2026-01-01)\n\n- [some](docs/some.md) and [far](https://a.b)\n\n"
    changelog = f"# Changelog\n\n## Unreleased\n\n- newer\n\n{new}## 1.0.0\n\n- first\n"
    assert notes.notes_of(changelog, "1.1.0") == "- some and [far](https://a.b)"


@pytest.mark.parametrize("heading", ["1.2.0", "1.1", "Unreleased"])
def test_a_version_without_notes_is_refused(heading):
    with pytest.raises(LookupError, match="Unreleased"):
        notes.notes_of("## Unreleased\n\n## 1.1.0\n\n- new\n", heading)


def test_a_tag_that_is_not_the_version_is_refused(capsys):
    assert notes.main(["v99.0.0"]) == 1
    assert "v99.0.0 is not that of this version" in capsys.readouterr().err


# ---- the extension index


def test_nothing_that_the_index_asks_is_wrong_here():
    assert [rule.asks for rule in extension_index.rules(extension_index.extension_of(CMAKE)) if rule.met is False] == []


def test_one_address_is_all_that_publishing_needs(published):
    extension = extension_index.extension_of((published / "CMakeLists.txt").read_text("utf-8"))
    assert [rule.asks for rule in extension_index.rules(extension, published) if not rule.met] == []


def test_the_addresses_of_pictures_lead_to_files_of_the_repository(published):
    extension = extension_index.extension_of((published / "CMakeLists.txt").read_text("utf-8"))
    raw = "https://raw.githubusercontent.com/somebody/SlicerAIFRecon/main/"
    addresses = [extension["EXTENSION_ICONURL"], *extension["EXTENSION_SCREENSHOTURLS"].split()]
    assert [address for address in addresses if not (REPOSITORY / address.removeprefix(raw)).is_file()] == []


@pytest.mark.parametrize("name", ["pyproject.toml", "CITATION.cff"])
def test_the_address_is_written_once_however_often_it_is_given(published, name):
    edit, once = extension_index.EDITS[name], (published / name).read_text("utf-8")
    assert HOMEPAGE in once
    assert edit(once, HOMEPAGE) == once


# ---- extras


def test_all_extras_that_users_want_are_in_all():
    for_developers = {"all", "test", "fuzz", "lint", "docs", "release"}
    [listed] = re.findall(r'"aifrecon\[([\w,]+)\]"', extras()["all"])
    assert set(listed.split(",")) == set(extras()) - for_developers


# ---- workflows


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_a_workflow_may_only_read_unless_a_job_asks_for_more(path):
    assert re.search(r"^permissions:\n  contents: read\n", path.read_text("utf-8"), re.MULTILINE)


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_what_a_workflow_calls_exists(path):
    text = path.read_text("utf-8")
    targets = set(re.findall(r"^([a-z][\w-]*):", (REPOSITORY / "Makefile").read_text("utf-8"), re.MULTILINE))
    assert set(re.findall(r"\bmake ([a-z-]+)", text)) - targets == set()
    assert [name for name in re.findall(r"(?:Testing|docs)/[\w/.-]+\.\w+", text) if not (REPOSITORY / name).exists()] == []
    assert set(re.findall(r"\.\[(\w+)\]", text)) - set(extras()) == set()


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_an_action_is_a_commit_and_what_is_downloaded_has_a_sum(path):
    text = path.read_text("utf-8")
    used = re.findall(r"uses: (.*)", text)
    assert [each for each in used if not re.fullmatch(r"[\w./-]+@[0-9a-f]{40} # v[0-9.]+", each)] == []
    # One command that fetches, and the next that compares
    fetched = re.findall(r"(?:curl|wget)\b.*\n(.*)", text)
    assert [each for each in fetched if "sum --check" not in each] == []

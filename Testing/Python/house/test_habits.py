"""What is written in one place and read in others: the version, and what is checked before a commit."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from AIFReconLib import __version__

REPOSITORY = Path(__file__).resolve().parents[3]
PROJECT = (REPOSITORY / "pyproject.toml").read_text("utf-8")


def test_the_package_has_the_version_of_the_library():
    table = re.search(r"^\[project\]\n(.*?)^\[", PROJECT, re.DOTALL | re.MULTILINE).group(1)
    assert re.search(r'^dynamic = \["version"\]$', table, re.MULTILINE)
    assert not re.search(r"^version\b", table, re.MULTILINE)
    assert re.search(r'^version = \{ attr = "AIFReconLib\.__version__" \}$', PROJECT, re.MULTILINE)


def test_the_version_can_be_read_without_importing_the_library():
    """A package is built where numpy is not installed."""
    tree = ast.parse((REPOSITORY / "AIFReconLib" / "__init__.py").read_text("utf-8"))
    [value] = [node.value for node in tree.body if isinstance(node, ast.Assign) and node.targets[0].id == "__version__"]
    assert ast.literal_eval(value) == __version__


def test_the_citation_has_the_version_of_the_library():
    cited = re.search(r"^version: (.+)$", (REPOSITORY / "CITATION.cff").read_text("utf-8"), re.MULTILINE)
    assert cited.group(1) == __version__


@pytest.mark.parametrize(("key", "values"), [("repo", {"local"}), ("entry", {"make lint"})])
def test_before_a_commit_runs_what_make_lint_runs_and_nothing_from_elsewhere(key, values):
    found = re.findall(rf"^[\s-]*{key}: (.+)$", (REPOSITORY / ".pre-commit-config.yaml").read_text("utf-8"), re.MULTILINE)
    assert set(found) == values

"""What ruff cannot say: sizes, places, optional features of calls, and what is written in one place and read in others."""

from __future__ import annotations

import ast
import re
import subprocess
import sys

import pytest
import weight
from doc_pages import REPOSITORY, name_of
from release.notes import version_of

import AIFReconLib

LIBRARY = REPOSITORY / "AIFReconLib"
FILES = [path for folder in ("AIFReconLib", "AIFRecon") for path in sorted((REPOSITORY / folder).rglob("*.py"))]
LONGEST_NAME = 150
"""Of 260 characters of a path on Windows, what this repository may take; the folder that it lies in has the rest."""


def tracked_names() -> list[str]:
    """What git holds or would take; the test is skipped where there is no git."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    try:
        listed = subprocess.run(command, cwd=REPOSITORY, capture_output=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a git checkout")
    return [name for name in listed.stdout.decode().split("\0") if name]


def trusting(tree: ast.AST) -> list[str]:
    """Calls that would unpickle, start a shell or guess a format unless an argument says no."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            name, told = ast.unparse(node.func), {word.arg: ast.unparse(word.value) for word in node.keywords}
            unpickles = name in ("np.load", "numpy.load", "np.save", "numpy.save", "np.savez") and told.get("allow_pickle") != "False"
            guesses = name.endswith(".open") and "image" in name.lower() and "formats" not in told
            if unpickles or guesses or told.get("shell", "False") != "False" or name in ("__import__", "input", "os.popen"):
                found.append(f"{node.lineno}: {name}")
    return found


@pytest.mark.parametrize("house", weight.HOUSES)
def test_every_room_stays_within_its_budget(house):
    """But for what a small change takes: a method, a setting."""
    today, budget = weight.weighed(house).budgets(), weight.budgets()[house]
    slack = dict.fromkeys(("names twice", "wide functions"), 0)
    over = {name: (number, budget.get(name, 0)) for name, number in today.items() if number > budget.get(name, 0) + slack.get(name, 25)}
    assert over == {}


def test_nothing_unpickles_starts_a_shell_or_guesses_a_format():
    assert {name_of(path): found for path in FILES if (found := trusting(ast.parse(path.read_text("utf-8"))))} == {}
    calls = ["np.load(path)", "np.load(path, allow_pickle=True)", "run(['a'], shell=True)", "image_module.open(path)"]
    assert [call for call in calls if not trusting(ast.parse(call))] == []
    assert trusting(ast.parse("np.load(path, allow_pickle=False); run(['a'], shell=False)")) == []


def test_no_file_names_a_place_on_somebody_s_machine():
    places = rb"|".join([b"home", b"Users", b"root", b"work", b"mnt", b"media"])
    pattern = re.compile(rb"(?<![\w.:/-])/(?:" + places + rb")/\w|[A-Z]:\\\\?Users\\")
    paths = [REPOSITORY / name for name in tracked_names()]
    assert [name_of(path) for path in paths if path.is_file() and pattern.search(path.read_bytes())] == []


def test_this_repository_can_be_checked_out_anywhere():
    """No two names that differ in capitals alone, none that Windows reserves or cannot spell, none too long."""
    names = tracked_names()
    assert len({name.casefold() for name in names}) == len(names)
    reserved = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\.|$)", re.IGNORECASE)
    bad = [name for name in names if any(reserved.match(part) or re.search(r'[<>:"|?*\\]|[ .]$', part) for part in name.split("/"))]
    assert bad == []
    assert max(map(len, names)) <= LONGEST_NAME


def test_every_public_name_can_be_had_and_type_checkers_see_where_it_comes_from():
    assert [name for name in AIFReconLib.__all__ if getattr(AIFReconLib, name) is None] == []
    # Importing a submodule binds its name in the package, over a function of that name
    assert {path.stem for path in LIBRARY.glob("*.py")} & set(AIFReconLib._PUBLIC) == set()
    assert (LIBRARY / "py.typed").exists()


def test_types_cost_no_package_at_import():
    heavy = ["scipy", "SimpleITK", "numba", "matplotlib", "pyigtl", "numpy.typing", "mypy"]
    code = f"import sys, AIFReconLib; sys.exit(', '.join(name for name in {heavy!r} if name in sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], cwd=REPOSITORY, capture_output=True, text=True, check=False)
    assert done.stderr.strip() == ""


def test_the_version_can_be_read_without_importing_the_library_and_is_cited():
    """A package is built where numpy is not installed."""
    assert version_of((LIBRARY / "__init__.py").read_text("utf-8")) == AIFReconLib.__version__
    cited = re.search(r"^version: (.+)$", (REPOSITORY / "CITATION.cff").read_text("utf-8"), re.MULTILINE)
    assert cited
    assert cited[1] == AIFReconLib.__version__


def test_before_a_commit_runs_what_make_lint_runs_and_nothing_from_elsewhere():
    text = (REPOSITORY / ".pre-commit-config.yaml").read_text("utf-8")
    assert set(re.findall(r"^[\s-]*repo: (.+)$", text, re.MULTILINE)) == {"local"}
    assert set(re.findall(r"^[\s-]*entry: (.+)$", text, re.MULTILINE)) == {"make lint"}

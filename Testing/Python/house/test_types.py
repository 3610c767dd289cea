"""What editors and type checkers see of the library. `make lint` runs mypy; here is what it is told, and what it does not ask for."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import AIFReconLib

LIBRARY = Path(AIFReconLib.__file__).parent
FILES = sorted(LIBRARY.rglob("*.py"))
PROJECT = (LIBRARY.parent / "pyproject.toml").read_text("utf-8")
OPEN_ENDED = {
    ("__init__.py", "__getattr__"): "a public name of any kind",
    ("geometry/volume.py", "Volume.to_sitk"): "an image of SimpleITK, which is known in io/ alone",
    ("terminal/one_line_parser.py", "OneLineParser.__init__"): "hands everything on to argparse",
}
"""Public functions that may take or return Any, and why."""


def name_of(path: Path) -> str:
    """The path within the library, for a test's name."""
    return path.relative_to(LIBRARY).as_posix()


def is_public(name: str) -> bool:
    return not name.startswith("_") or (name.startswith("__") and name.endswith("__"))


def public_annotations(body: list[ast.stmt], prefix: str = "") -> Iterator[tuple[str, ast.expr]]:
    """Name and annotation of every parameter, result and field that others than the file itself may use."""
    for node in body:
        if isinstance(node, ast.FunctionDef) and is_public(node.name):
            arguments = node.args
            for argument in (*arguments.posonlyargs, *arguments.args, arguments.vararg, *arguments.kwonlyargs, arguments.kwarg):
                if argument is not None and argument.annotation is not None:
                    yield prefix + node.name, argument.annotation
            if node.returns is not None:
                yield prefix + node.name, node.returns
        elif isinstance(node, ast.ClassDef) and is_public(node.name):
            yield from public_annotations(node.body, f"{node.name}.")
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and is_public(node.target.id):
            yield prefix + node.target.id, node.annotation


def open_ended(tree: ast.Module) -> set[str]:
    """Where an annotation says Any, or an array without what it holds."""
    found = set()
    for name, annotation in public_annotations(tree.body):
        words = {node.id for node in ast.walk(annotation) if isinstance(node, ast.Name)}
        words |= {node.attr for node in ast.walk(annotation) if isinstance(node, ast.Attribute)}
        if words & {"Any", "ndarray"}:
            found.add(name)
    return found


def imports_for_checkers() -> dict[str, str]:
    """Name and module, with dots, of what the package imports for type checkers alone."""
    tree = ast.parse((LIBRARY / "__init__.py").read_text("utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING")
    imports = [node for node in block.body if isinstance(node, ast.ImportFrom)]
    return {alias.asname or alias.name: node.module or "" for node in imports for alias in node.names}


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_no_public_name_takes_or_returns_just_anything(path):
    allowed = {name for file, name in OPEN_ENDED if file == name_of(path)}
    assert open_ended(ast.parse(path.read_text("utf-8"))) == allowed


def test_type_checkers_see_every_public_name_where_it_comes_from():
    assert imports_for_checkers() == AIFReconLib._PUBLIC


def test_all_public_names_are_listed_in_order():
    assert sorted(AIFReconLib._PUBLIC) == AIFReconLib.__all__


@pytest.mark.parametrize("name", AIFReconLib.__all__)
def test_every_public_name_can_be_had(name):
    assert getattr(AIFReconLib, name) is not None


def test_the_package_says_that_it_is_typed():
    assert (LIBRARY / "py.typed").read_bytes() == b""
    assert 'AIFReconLib = ["py.typed"]' in PROJECT


def test_the_library_is_checked_for_all_that_mypy_calls_strict():
    """Listed one by one, because `strict` itself cannot be said of a part of what is checked."""
    pytest.importorskip("mypy", reason="mypy is not installed")
    told = subprocess.run([sys.executable, "-m", "mypy", "--help"], capture_output=True, text=True, check=True).stdout
    # Lines break within the flags
    listed = re.search(r"Strictmode;enablesthefollowingflags:((?:--[a-z-]+?,)+--[a-z-]+?)--disable-error-code", re.sub(r"\s", "", told))
    flags = [flag.removeprefix("--") for flag in listed[1].split(",")]
    wanted = {f"{flag[3:]} = false" if flag.startswith("no-") else f"{flag} = true" for flag in flags}
    everywhere, of_library = (
        set(re.search(heading + r"\n(.*?)^\[", PROJECT, re.DOTALL | re.MULTILINE)[1].splitlines())
        for heading in (r"^\[tool\.mypy\]", r'^module = "AIFReconLib\.\*"')
    )
    assert {setting.replace("-", "_") for setting in wanted} <= everywhere | of_library
    assert of_library - {""} <= {setting.replace("-", "_") for setting in wanted}


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_a_checker_is_silenced_for_one_kind_of_error_and_a_reason(path):
    silenced = [line for line in path.read_text("utf-8").splitlines() if "type: ignore" in line]
    # type: ignore[kind]  # reason
    assert [line for line in silenced if "ignore[" not in line or "#" not in line.split("ignore[", 1)[1]] == []


def test_types_cost_no_package_at_import():
    heavy = ["scipy", "SimpleITK", "numba", "matplotlib", "pyigtl", "numpy.typing", "mypy"]
    code = f"import sys, AIFReconLib; sys.exit(', '.join(name for name in {heavy!r} if name in sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], cwd=LIBRARY.parent, capture_output=True, text=True, check=False)
    assert done.stderr.strip() == ""


# ---- the checks themselves can fail


@pytest.mark.parametrize(
    "source",
    [
        "def f(a: Any): ...",
        "def f(*, a: dict[str, Any]): ...",
        "def f(*a: typing.Any): ...",
        "def f() -> np.ndarray | None: ...",
        "class A:\n    def f(self) -> Any: ...",
        "class A:\n    a: np.ndarray",
    ],
)
def test_an_open_end_is_seen(source):
    assert len(open_ended(ast.parse(source))) == 1


@pytest.mark.parametrize("source", ["def _f(a: Any): ...", "class _A:\n    a: Any", "def f(a: NDArray[np.uint8]): ..."])
def test_what_is_private_or_told_is_no_open_end(source):
    assert open_ended(ast.parse(source)) == set()

"""The rules that a reviewer would otherwise have to check by hand: imports, sizes, docstrings, paths."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]
LIBRARY = REPOSITORY / "AIFReconLib"
LIBRARY_FILES = sorted(LIBRARY.rglob("*.py"))
PYTHON_FILES = [
    path for path in sorted(REPOSITORY.rglob("*.py")) if not {".venv", "build", "dist"} & set(path.relative_to(REPOSITORY).parts)
]
EVERYWHERE = {"numpy", "scipy", "AIFReconLib"}
IN_ROOMS = {
    "batch": {"cryptography", "dask", "distributed", "pyarrow"},
    "bone": {"onnxruntime"},
    "evaluation": {"matplotlib", "vtk"},
    "io": {"SimpleITK", "vtkmodules", "PIL", "pydicom", "imageio_ffmpeg"},
    "live": {"pyigtl"},
}
LONGEST_FILE = 400


def name_of(path: Path) -> str:
    """The path within the repository, for a test's name."""
    return path.relative_to(REPOSITORY).as_posix()


def imports_of(tree: ast.AST) -> set[str]:
    """Every top-level package that is imported anywhere in a file, inside functions too."""
    packages = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            packages |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            packages.add((node.module or "").split(".")[0])
        elif isinstance(node, ast.Call) and ast.unparse(node.func) in (
            "importlib.import_module",
            "import_module",
            "__import__",
            "library",
            "require",
        ):
            # A name that is put together at run time, as the lazy names of __init__ are, cannot be judged here
            packages |= {str(word.value).split(".")[0] for word in node.args[:1] if isinstance(word, ast.Constant)}
    return packages - {""}


def allowed_in(path: Path) -> set[str]:
    """What a file of the library may import besides the standard library."""
    parts = path.relative_to(LIBRARY).parts
    allowed = EVERYWHERE | (IN_ROOMS.get(parts[0], set()) if len(parts) > 1 else set())
    return allowed | {"numba"} if path.name.startswith("numba_") else allowed


def undocumented(tree: ast.Module) -> list[str]:
    """Public functions, classes and their methods that have no docstring."""
    missing = []

    def look(body, prefix=""):
        for node in body:
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) and not node.name.startswith("_"):
                if ast.get_docstring(node) is None:
                    missing.append(prefix + node.name)
                if isinstance(node, ast.ClassDef):
                    look(node.body, f"{node.name}.")

    look(tree.body)
    return missing


def tracked_files() -> list[Path]:
    """What git holds or would take; the test is skipped where there is no git."""
    try:
        listed = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=REPOSITORY, capture_output=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a git checkout")
    return [path for name in listed.stdout.decode().split("\0") if name and (path := REPOSITORY / name).is_file()]


@pytest.mark.parametrize("path", LIBRARY_FILES, ids=name_of)
def test_a_file_imports_only_what_belongs_into_its_room(path):
    assert imports_of(ast.parse(path.read_text("utf-8"))) - set(sys.stdlib_module_names) - allowed_in(path) == set()


@pytest.mark.parametrize("path", LIBRARY_FILES, ids=name_of)
def test_a_library_file_stays_under_400_lines(path):
    assert len(path.read_text("utf-8").splitlines()) < LONGEST_FILE


@pytest.mark.parametrize("path", LIBRARY_FILES, ids=name_of)
def test_everything_public_has_a_docstring(path):
    assert undocumented(ast.parse(path.read_text("utf-8"))) == []


@pytest.mark.parametrize("path", LIBRARY_FILES, ids=name_of)
def test_a_library_file_says_what_it_is_for(path):
    text = path.read_text("utf-8")
    assert not text.strip() or ast.get_docstring(ast.parse(text))


@pytest.mark.parametrize("path", PYTHON_FILES, ids=name_of)
def test_a_file_parses_as_python_3_10(path):
    assert ast.parse(path.read_text("utf-8"), filename=str(path), feature_version=(3, 10))


@pytest.mark.parametrize("path", LIBRARY_FILES, ids=name_of)
def test_input_is_never_checked_by_assert(path):
    assert [node.lineno for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.Assert)] == []


def test_nothing_is_left_to_be_done():
    # Spelled in parts, so that this line is no finding
    pattern = re.compile(r"\b(" + "|".join(["TO" + "DO", "FIX" + "ME", "XX" + "X", "HA" + "CK"]) + r")\b")
    found = [
        f"{name_of(path)}:{n}"
        for path in PYTHON_FILES
        for n, line in enumerate(path.read_text("utf-8").splitlines(), 1)
        if pattern.search(line)
    ]
    assert found == []


def test_no_file_names_a_place_on_somebody_s_machine():
    pattern = re.compile(
        rb"(?<![\w.:/-])/(?:" + rb"|".join([b"home", b"Users", b"root", b"work", b"mnt", b"media"]) + rb")/\w|[A-Z]:\\\\?Users\\"
    )
    found = [name_of(path) for path in tracked_files() if pattern.search(path.read_bytes())]
    assert found == []


def test_no_file_shadows_a_public_name():
    """Importing a submodule binds its name in the package, over a function of that name."""
    from AIFReconLib import _PUBLIC

    assert {path.stem for path in LIBRARY.glob("*.py")} & set(_PUBLIC) == set()


# ---- the checks themselves can fail


def test_an_import_inside_a_function_is_seen():
    assert imports_of(ast.parse("def f():\n    import SimpleITK.extra as sitk\n")) == {"SimpleITK"}


def test_an_import_by_name_is_seen():
    assert imports_of(ast.parse("import importlib\nimportlib.import_module('vtk.util')")) == {"importlib", "vtk"}


def test_an_optional_package_is_seen():
    assert imports_of(ast.parse("library('PIL.Image', 'Pictures')")) == {"PIL"}


def test_a_relative_import_is_no_package():
    assert imports_of(ast.parse("from .io import volume_files\nfrom .. import errors")) == set()


@pytest.mark.parametrize(
    ("path", "package", "allowed"),
    [
        ("io/volume/files.py", "SimpleITK", True),
        ("io/foreign/pictures.py", "PIL", True),
        ("sweep/frames.py", "PIL", False),
        ("bone/map.py", "SimpleITK", False),
        ("bone/model.py", "onnxruntime", True),
        ("io.py", "SimpleITK", False),
        ("live/wire/client.py", "pyigtl", True),
        ("live/wire/client.py", "SimpleITK", False),
        ("compounding/compiled/numba_engine.py", "numba", True),
        ("compounding/numpy_engine.py", "numba", False),
        ("evaluation/figures.py", "matplotlib", True),
        ("commands/parser.py", "matplotlib", False),
        ("batch/engine.py", "distributed", True),
        ("commands/batch.py", "distributed", False),
        ("commands/parser.py", "slicer", False),
    ],
)
def test_a_room_admits_its_own_packages(path, package, allowed):
    assert (package in allowed_in(LIBRARY / path)) == allowed


def test_a_public_method_without_a_docstring_is_seen():
    tree = ast.parse('class A:\n    """A."""\n    def b(self): ...\n    def _c(self): ...\ndef d(): ...\n')
    assert undocumented(tree) == ["A.b", "d"]

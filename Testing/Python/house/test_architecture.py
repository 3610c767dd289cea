"""The rooms of the project stand in one order, that of the drawing in docs/developers.md, and imports run down it."""

from __future__ import annotations

import ast
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

from doc_pages import REPOSITORY, name_of

LIBRARY = REPOSITORY / "AIFReconLib"
MODULE = REPOSITORY / "AIFRecon"
DRAWING = ElementTree.parse(REPOSITORY / "docs" / "images" / "architecture.svg").getroot()

EVERYWHERE = {"numpy", "scipy", "AIFReconLib"}
PACKAGES = {
    "batch": {"distributed", "jinja2", "pandas", "psutil", "pyarrow"},
    "bone": {"onnxruntime"},
    "evaluation": {"jinja2", "matplotlib", "vtk"},
    "geometry": {"vtkmodules"},
    "inspection": {"vtkmodules"},
    "io": {
        "SimpleITK",
        "pandas",
        "vtkmodules",
        "PIL",
        "pydicom",
        "imageio_ffmpeg",
        "rosbags",
        "tifffile",
        "lz4",
        "backports",
        "compression",
    },
    "live": {"pyigtl"},
}
"""What a folder of the library may import of others' besides that."""

FILES = sorted([*LIBRARY.rglob("*.py"), *MODULE.rglob("*.py")])
SPLIT_ROOMS = ("io", "live")
"""Rooms whose own rooms stand in the order too."""

LOW_ROOMS = (("compounding", "methods"),)
"""Rooms that stand far below the one in which they lie: the recipe asks the table of methods for its names."""


def room_of(path: Path) -> str | None:
    """The room that a file belongs to; None for what only hands on: the public names, and a split room's own page."""
    if path.is_relative_to(MODULE):
        parts = path.relative_to(MODULE).parts
        return "/".join(parts[:2]) if len(parts) > 2 else parts[0]
    parts = path.relative_to(LIBRARY).with_suffix("").parts
    if parts == ("__main__",):
        return "commands"
    if parts[:2] in LOW_ROOMS:
        return "/".join(parts[:2])
    if parts[0] in SPLIT_ROOMS:
        return "/".join(parts[:2]) if len(parts) > 2 else None
    return None if parts == ("__init__",) else parts[0]


def module_at(path: Path) -> Path | None:
    """The file of a module by its path without suffix; None where there is none."""
    return next((file for file in (path.with_suffix(".py"), path / "__init__.py") if file.is_file()), None)


def imported(path: Path, tree: ast.AST | None = None) -> Iterator[Path]:
    """Files of this repository that a file imports anywhere, in functions and for type checkers too."""
    for node in ast.walk(tree or ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom):
            start = (
                path.parents[node.level - 1].joinpath(*(node.module.split(".") if node.module else ()))
                if node.level
                else _absolute(node.module or "")
            )
            targets = [start / alias.name for alias in node.names] if start else []
            yield from {file for target in targets if (file := module_at(target) or module_at(target.parent))}
        elif isinstance(node, ast.Import):
            yield from (file for alias in node.names if (named := _absolute(alias.name)) and (file := module_at(named)))


def _absolute(name: str) -> Path | None:
    parts = name.split(".")
    if parts[0] == "AIFReconLib":
        return REPOSITORY.joinpath(*parts)
    return MODULE.joinpath(*parts) if module_at(MODULE / parts[0]) else None


@cache
def graph() -> dict[Path, set[Path]]:
    """What each file imports, but for itself and the table of public names, which imports nothing."""
    return {file: set(imported(file)) - {file, LIBRARY / "__init__.py"} for file in FILES}


def circle(edges: dict[Path, set[Path]]) -> list[str]:
    """Files of which each imports the next, the last one the first; empty where there are none."""
    try:
        TopologicalSorter(edges).prepare()
    except CycleError as error:
        return [name_of(file) for file in error.args[1]]
    return []


def drawn() -> dict[str, float]:
    """Every room of the drawing, and how far down its box begins."""
    boxes = [element for element in DRAWING.iter() if element.get("data-room")]
    return {box.attrib["data-room"]: float(next(part for part in box if part.tag.endswith("rect")).attrib["y"]) for box in boxes}


def upward(edges: dict[Path, set[Path]]) -> set[tuple[str, str]]:
    """Pairs of files of which the first imports the second although its room is not drawn above."""
    heights, pairs = drawn(), set()
    for file, others in edges.items():
        for other in others:
            here, there = room_of(file), room_of(other)
            if here is not None and there is not None and here != there and heights[here] >= heights[there]:
                pairs.add((name_of(file), name_of(other)))
    return pairs


def test_every_room_is_drawn():
    assert {room for file in FILES if (room := room_of(file))} == set(drawn())


def test_every_room_is_drawn_above_all_that_it_imports():
    assert upward(graph()) == set()


def test_no_files_import_each_other_in_a_circle():
    assert circle(graph()) == []


def packages_of(tree: ast.AST) -> set[str]:
    """Every top-level package that is imported anywhere in a file, inside functions and by name too."""
    packages = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            packages |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            packages.add((node.module or "").split(".")[0])
        elif isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] in ("import_module", "library", "require"):
            packages |= {str(word.value).split(".")[0] for word in node.args[:1] if isinstance(word, ast.Constant)}
    return packages - {""}


def test_a_file_imports_only_packages_that_belong_into_its_room():
    found = {}
    for path in LIBRARY.rglob("*.py"):
        folder = path.relative_to(LIBRARY).parts[0]
        allowed = EVERYWHERE | PACKAGES.get(folder, set()) | ({"numba"} if path.name.startswith("numba_") else set())
        if more := packages_of(ast.parse(path.read_text("utf-8"))) - sys.stdlib_module_names - allowed:
            found[name_of(path)] = more
    assert found == {}
    seen = packages_of(ast.parse("def f():\n    import vtk.util\nimport_module('numba')\nlibrary('PIL.Image', '')\nfrom .io import x"))
    assert seen == {"vtk", "numba", "PIL"}


def test_at_the_root_of_the_library_lie_only_what_all_rooms_share_and_the_way_in():
    assert {file.stem for file in LIBRARY.glob("*.py")} == {
        *("__init__", "__main__", "reconstruction", "effective_settings"),
        *("progress", "errors", "message", "remedies", "arrays"),
    }


def test_an_import_in_a_function_one_that_runs_up_and_a_circle_are_seen():
    file = LIBRARY / "live" / "wire" / "client.py"
    tree = ast.parse("def f():\n    from ...sweep.frames import TrackedFrame\n    from . import framing\n")
    assert {name_of(other) for other in imported(file, tree)} == {"AIFReconLib/sweep/frames.py", "AIFReconLib/live/wire/framing.py"}
    edges = {LIBRARY / "geometry" / "volume.py": {LIBRARY / "sweep" / "frames.py"}}
    assert upward(edges) == {("AIFReconLib/geometry/volume.py", "AIFReconLib/sweep/frames.py")}
    a, b, c, d = (REPOSITORY / f"{letter}.py" for letter in "abcd")
    assert set(circle({a: {b}, b: {c}, c: {a}, d: {a}})) == {"a.py", "b.py", "c.py"}

"""Writes the pages of the API reference: one for each room of the library, and one that lists what is imported from AIFReconLib itself."""

from __future__ import annotations

import ast
import re
from itertools import pairwise
from pathlib import Path

ROOMS = (
    *("reconstruction", "recipe", "errors", "message", "remedies", "progress", "arrays", "effective_settings"),
    *(
        "sweep",
        "geometry",
        "imaging",
        "bone",
        "compounding",
        "holes",
        "io",
        "registration",
        "motion",
        "calibration",
        "guidance",
        "paths",
        "inspection",
        "evaluation",
    ),
    *("provenance", "simulation", "live", "batch", "machine", "commands", "worker", "terminal", "workflows"),
)
"""In the order in which somebody who writes Python meets them; a test of the site compares with what is there."""


def docstring(path: Path) -> str:
    """The first sentence of a file's docstring."""
    text = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split())


def public_names(library: Path) -> dict[str, str]:
    """What AIFReconLib hands out, and the module that each name lies in."""
    names = re.findall(r"from \.(\S+) import (\w+)", (library / "__init__.pyi").read_text("utf-8"))
    return {name: file for file, name in sorted(names, key=lambda pair: pair[1].lower())}


def modules_of(library: Path, room: str) -> list[Path]:
    """The files of a room that hold something, its own rooms' too."""
    if (library / f"{room}.py").is_file():
        return [library / f"{room}.py"]
    return [path for path in sorted((library / room).rglob("*.py")) if path.name != "__init__.py"]


def aliases_of(path: Path) -> dict[str, str]:
    """Names of types that a file gives, such as those of arrays, and what they stand for."""
    body = ast.parse(path.read_text("utf-8")).body
    found = {}
    for node, after in pairwise(body):
        target = node.targets[0] if isinstance(node, ast.Assign) else getattr(node, "target", None)
        said = after.value if isinstance(after, ast.Expr) else None
        name = target.id if isinstance(target, ast.Name) else ""
        is_type = (
            isinstance(getattr(node, "value", None), ast.Subscript | ast.BinOp | ast.Name)
            and name.lstrip("_") == name
            and not name.isupper()
        )
        if is_type and name[:1].isupper() and isinstance(said, ast.Constant) and isinstance(said.value, str):
            found[name] = " ".join(said.value.split())
    return found


def room_page(library: Path, room: str) -> str:
    """A page with every module of a room."""
    home = library / room / "__init__.py"
    lines = [f"{room}\n{'=' * len(room)}\n", docstring(home) if home.is_file() else ""]
    for path in modules_of(library, room):
        name = ".".join(("AIFReconLib", *path.relative_to(library).with_suffix("").parts))
        short = name.removeprefix(f"AIFReconLib.{room}.") if home.is_file() else name
        if home.is_file():
            lines += ["", short, "-" * len(short)]
        lines += ["", f".. automodule:: {name}", ""]
        for alias, text in aliases_of(path).items():
            lines += ["", f".. py:data:: {name}.{alias}", "", f"   {text}", ""]
    return "\n".join(lines) + "\n"


def first_line(path: Path, name: str) -> str:
    """The first sentence of what a file says of a name of its own: a class, a function, or a value with its words behind it."""
    body = ast.parse(path.read_text("utf-8")).body
    for node, after in pairwise([*body, ast.Pass()]):
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name == name:
            said = ast.get_docstring(node) or ""
        elif isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == name and isinstance(after, ast.Expr):
            said = str(getattr(after.value, "value", ""))
        else:
            continue
        line = " ".join(said.split("\n\n")[0].split())
        if line:
            return line
    raise LookupError(f"{path} says nothing of {name}")


def index_page(library: Path) -> str:
    """The names that programs import, and the rooms."""
    rows = []
    for name, module in public_names(library).items():
        room, path = module.split(".")[0], library / Path(*module.split("."))
        line = first_line(path.with_suffix(".py") if path.with_suffix(".py").is_file() else path / "__init__.py", name)
        rows.append(f"   * - :py:obj:`{name} <AIFReconLib.{module}.{name}>`\n     - {line}\n     - :doc:`{room}`")
    rooms = []
    for room in ROOMS:
        home = library / room / "__init__.py"
        rooms.append(f"   * - :doc:`{room}`\n     - {docstring(home if home.is_file() else library / f'{room}.py')}")
    return "\n".join(
        [
            "API reference\n=============\n",
            "What most programs need is imported from ``AIFReconLib`` itself::\n",
            "    from AIFReconLib import BoneMap, Recipe, read_labels, read_sequence, reconstruct\n",
            ".. list-table::\n   :header-rows: 1\n\n   * - Name\n     - What it is\n     - Room",
            *rows,
            "\nEvery public name lies in one of these rooms. Matrices are ``a_to_b`` on column vectors in mm, arrays are [k, j, i];",
            "what is not in the table above may change between versions.\n",
            ".. list-table::\n   :header-rows: 1\n\n   * - Room\n     - What lives there",
            *rooms,
            "\n.. toctree::\n   :hidden:\n",
            *(f"   {room}" for room in ROOMS),
            "",
        ]
    )


def write(repository: Path, folder: Path) -> None:
    """Write all pages that have changed."""
    library = repository / "AIFReconLib"
    pages = {"index": index_page(library), **{room: room_page(library, room) for room in ROOMS}}
    folder.mkdir(exist_ok=True)
    for name, text in pages.items():
        path = folder / f"{name}.rst"
        if not path.is_file() or path.read_text("utf-8") != text:
            path.write_text(text, "utf-8")

"""The drawing in docs/developers.md shows what the code does: its rooms are the packages, its arrows the imports between them."""

from __future__ import annotations

import ast
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
LIBRARY = REPOSITORY / "AIFReconLib"
MODULE = REPOSITORY / "AIFRecon"
DRAWING = ElementTree.parse(REPOSITORY / "docs" / "images" / "architecture.svg").getroot()
CORE = "core"
"""The files that lie in AIFReconLib itself, but for the command line's."""


def room_of(path: Path) -> str | None:
    """The room that a file belongs to; None for the list of public names, which only hands on."""
    if path.is_relative_to(MODULE):
        return path.relative_to(MODULE).parts[0]
    first = path.relative_to(LIBRARY).parts[0]
    if path == LIBRARY / "__init__.py":
        return None
    if (LIBRARY / first).is_dir():
        return first
    return "commands" if first in ("cli.py", "__main__.py") else CORE


def imported(path: Path) -> Iterator[Path]:
    """Files and packages of this repository that a file imports anywhere, as paths that may lack the suffix."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom):
            names = [node.module] if node.module else [alias.name for alias in node.names]
            above = path.parents[node.level - 1] if node.level else None
        elif isinstance(node, ast.Import):
            names, above = [alias.name for alias in node.names], None
        else:
            continue
        for name in names:
            parts = name.split(".")
            if above is not None:
                yield above.joinpath(*parts)
            elif parts[0] == "AIFReconLib":
                yield REPOSITORY.joinpath(*parts) if len(parts) > 1 else LIBRARY / "a_public_name"
            elif (MODULE / parts[0]).is_dir():
                yield MODULE.joinpath(*parts)


def imports() -> set[tuple[str, str]]:
    """Pairs of rooms, of which the first imports the second."""
    pairs = set()
    for path in [*LIBRARY.rglob("*.py"), *MODULE.rglob("*.py")]:
        room = room_of(path)
        if room is not None:
            pairs |= {(room, other) for target in imported(path) if (other := room_of(target)) not in (room, None)}
    return pairs


def drawn() -> set[tuple[str, str]]:
    """The arrows, each from and to every room that it names."""
    arrows = [element for element in DRAWING.iter() if element.get("data-from")]
    return {(one, other) for arrow in arrows for one in arrow.get("data-from").split() for other in arrow.get("data-to").split()}


def test_every_room_is_drawn():
    rooms = {room for path in [*LIBRARY.rglob("*.py"), *MODULE.rglob("*.py")] if (room := room_of(path))}
    assert {element.get("data-room") for element in DRAWING.iter() if element.get("data-room")} == rooms


def test_every_import_between_rooms_is_drawn():
    assert imports() - drawn() == set()


def test_every_arrow_is_an_import():
    assert drawn() - imports() == set()


def test_an_import_within_a_function_counts(tmp_path):
    file = tmp_path / "file.py"
    file.write_text("def f():\n    from AIFReconLib.live.session.session import LiveSession\n    from .other import x\n")
    assert [path.name for path in imported(file)] == ["session", "other"]

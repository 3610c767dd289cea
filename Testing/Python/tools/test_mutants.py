"""The mistakes of `Testing/mutants.py`: programs that run, one place changed, no text and no type hint."""

from __future__ import annotations

import ast
from pathlib import Path

import mutants


def test_every_mistake_compiles_and_changes_no_text_and_no_type_hint(tmp_path, monkeypatch):
    monkeypatch.setattr(mutants, "REPOSITORY", tmp_path)
    source = '''"""Says é 1."""
def f(é: "1 + 1" = 1, *, b: int = -2) -> "3":
    """One 1."""
    g(f"{é + 1}")
    if é < b * 2:
        raise ValueError("4", 1 + 1)
    return not (é + b)
'''
    (tmp_path / "f.py").write_text(source, "utf-8")
    made = [*mutants.mutants_of(Path("f.py"))]
    found = [(each.line, each.changed()) for each in made]
    assert sorted(found) == [
        (2, "number: 1 -> 2"),
        (2, "number: 2 -> 3"),
        (2, "sign: -2 -> (2)"),
        (4, 'call left out: g(f"{é + 1}") -> pass'),
        (5, "limit: é < b * 2 -> é <= b * 2"),
        (5, "number: 2 -> 3"),
        (5, "sign: b * 2 -> b / 2"),
        (7, "nothing returned: return not (é + b) -> return None"),
        (7, "sign: not (é + b) -> (é + b)"),
        (7, "sign: é + b -> é - b"),
    ]
    for each in made:
        assert ast.dump(ast.parse(each.source())) != ast.dump(ast.parse(source))

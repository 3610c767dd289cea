"""How heavy the house is: code lines of every room, public classes, and what is wider than it should be.

    python Testing/weight.py            say it
    python Testing/weight.py --lower    make what it weighs today the budget, where that is less

Code lines are lines without docstrings, comments, blanks and imports. `budgets.json` beside this file says how many a room may have; a
test holds them. They only go down: who needs more takes an idea out of the room first, or says in a decision why it is heavier.
"""

from __future__ import annotations

import ast
import json
import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
BUDGETS = Path(__file__).with_name("budgets.json")
HOUSES = ("AIFReconLib", "AIFRecon", "Testing")
LONGEST_LINE, MOST_PARAMETERS = 110, 7


@dataclass
class Weight:
    """What one house weighs: code lines by room, public classes by name, and what is too wide."""

    lines: Counter[str] = field(default_factory=Counter)
    classes: Counter[str] = field(default_factory=Counter)
    long_lines: int = 0
    wide: list[str] = field(default_factory=list)
    """Public functions of more than `MOST_PARAMETERS` parameters."""

    def budgets(self) -> dict[str, int]:
        """The numbers that have a budget."""
        totals = {"all": self.lines.total(), "public classes": self.classes.total(), f"lines over {LONGEST_LINE}": self.long_lines}
        return {**totals, "wide functions": len(self.wide), "names twice": len(self.twice()), **dict(sorted(self.lines.items()))}

    def twice(self) -> list[str]:
        """Names of public classes that are given more than once."""
        return [name for name, number in self.classes.items() if number > 1]


def weighed(house: str) -> Weight:
    """The weight of a folder of this repository."""
    weight = Weight()
    top = REPOSITORY / house
    for path in sorted(top.rglob("*.py")):
        text = path.read_text("utf-8")
        nodes = list(ast.walk(ast.parse(text)))
        inside = path.relative_to(top)
        room = inside.parts[0] if len(inside.parts) > 1 else "."
        weight.lines[room] += len(_code_lines(nodes, text))
        weight.long_lines += sum(len(line) > LONGEST_LINE for line in text.splitlines())
        for node in nodes:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                weight.classes[node.name] += 1
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and not node.name.startswith("_"):
                names = [each.arg for each in (*node.args.args, *node.args.kwonlyargs)]
                if len(names) - (names[:1] in (["self"], ["cls"])) > MOST_PARAMETERS:
                    weight.wide.append(f"{path.relative_to(REPOSITORY).as_posix()}:{node.lineno} {node.name}")
    return weight


def _code_lines(nodes: list[ast.AST], text: str) -> set[int]:
    """Numbers of the lines that are code."""
    code = {n for n, line in enumerate(text.splitlines(), 1) if line.strip() and not line.lstrip().startswith("#")}
    for node in nodes:
        if isinstance(node, ast.Import | ast.ImportFrom):
            code -= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
        body = getattr(node, "body", None)
        for child in body if isinstance(body, list) else []:
            if isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant) and isinstance(child.value.value, str):
                code -= set(range(child.lineno, (child.end_lineno or child.lineno) + 1))
    return code


def budgets() -> dict[str, dict[str, int]]:
    """What each house may weigh."""
    held: dict[str, dict[str, int]] = json.loads(BUDGETS.read_text("utf-8"))
    return held


def main() -> None:
    """Say what the houses weigh, and lower their budgets where that is asked for."""
    held = budgets() if BUDGETS.exists() else {}
    for house in HOUSES:
        weight = weighed(house)
        today, allowed = weight.budgets(), held.get(house, {})
        print(f"{house}: " + ", ".join(f"{name} {number}/{allowed.get(name, 0)}" for name, number in today.items()))
        for words in (*weight.twice(), *weight.wide):
            print(f"  {words}")
        held[house] = {name: min(number, allowed.get(name, number)) for name, number in today.items()}
    if "--lower" in sys.argv:
        BUDGETS.write_text(json.dumps(held, indent=2) + "\n", "utf-8")


if __name__ == "__main__":
    main()

"""Would the tests notice a mistake? Breaks single lines of AIFReconLib at random, and runs the tests of their rooms.

    python Testing/mutants.py --seed 1 --count 40 --rooms geometry holes

prints a table of what was broken and whether a test failed. Every mistake is made in a copy of the repository, alone.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
LONGEST = 1200
"""Seconds that the tests of a room may take: a mistake that makes them hang is noticed, too."""

LEFT_OUT = shutil.ignore_patterns(".*", "__pycache__", "*-output", "build", "dist", "node_modules")
OTHER_SIGN = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
OTHER_LIMIT = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
UNCHANGED = ("annotation", "returns", "decorator_list", "op", "ops")
"""Fields of a node in which nothing is broken: type hints, above all."""


@dataclass(frozen=True)
class Mutant:
    """One mistake: the code from `start` to `end`, bytes of the file, becomes `new`."""

    file: Path
    line: int
    kind: str
    start: int
    end: int
    new: str

    @property
    def room(self) -> str:
        """The folder of AIFReconLib that the file is in; "" for the library's own."""
        inside = self.file.relative_to("AIFReconLib")
        return inside.parts[0] if len(inside.parts) > 1 else ""

    def changed(self) -> str:
        """What was changed, for the table."""
        old = (REPOSITORY / self.file).read_bytes()[self.start : self.end].decode()
        return f"{self.kind}: {' '.join(old.split())} -> {self.new}"[:100]

    def source(self) -> bytes:
        """The file with the mistake."""
        whole = (REPOSITORY / self.file).read_bytes()
        return whole[: self.start] + self.new.encode() + whole[self.end :]


def broken(node: ast.AST) -> tuple[str, str] | None:
    """The kind of mistake that can be made here, and the code with it."""
    match node:
        case ast.BinOp(left, op, right) if type(op) in OTHER_SIGN:
            return "sign", ast.unparse(ast.BinOp(left, OTHER_SIGN[type(op)](), right))
        case ast.UnaryOp(ast.USub() | ast.Not(), operand):
            return "sign", f"({ast.unparse(operand)})"
        case ast.Compare(left, [op], [right]) if type(op) in OTHER_LIMIT:
            return "limit", ast.unparse(ast.Compare(left, [OTHER_LIMIT[type(op)]()], [right]))
        case ast.Constant(bool(value)):
            return "default", str(not value)
        case ast.Constant(int(value)):
            return "number", str(value + 1)
        case ast.Constant(float(value)):
            return "number", str(2 * value + 1)
        case ast.Expr(ast.Call()):
            return "call left out", "pass"
        case ast.Return(ast.expr()):
            return "nothing returned", "return None"
    return None


def nodes_of(node: ast.AST) -> Iterator[ast.AST]:
    """The parts of a program in which a mistake can be made: no type hints, no messages."""
    yield node
    for name, value in ast.iter_fields(node):
        for child in value if isinstance(value, list) else [value]:
            if name not in UNCHANGED and isinstance(child, ast.AST) and not isinstance(child, ast.JoinedStr | ast.Raise):
                yield from nodes_of(child)


def mutants_of(file: Path) -> Iterator[Mutant]:
    """All mistakes that can be made in a file of the repository."""
    text = (REPOSITORY / file).read_bytes()
    begins = [0]
    for line in text.splitlines(keepends=True):
        begins.append(begins[-1] + len(line))
    for node in nodes_of(ast.parse(text)):
        if isinstance(node, ast.expr | ast.stmt) and (found := broken(node)) is not None:
            start, end = (
                begins[line - 1] + column
                for line, column in ((node.lineno, node.col_offset), (node.end_lineno or 0, node.end_col_offset or 0))
            )
            yield Mutant(file, node.lineno, found[0], start, end, found[1])


def tests_of(room: str) -> list[str]:
    """The tests that should notice a mistake in a room."""
    folder = f"Testing/Python/{room}"
    return [folder] if room and (REPOSITORY / folder).is_dir() else ["Testing/Python/test_reconstruct.py", "Testing/Python/commands"]


def passes(copy: Path, room: str) -> bool:
    """Whether the tests of a room pass in a copy of the repository."""
    data = os.environ.get("AIFRECON_DATA_DIR") or str(REPOSITORY.parent / "shared" / "data")
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests_of(room)]
    surroundings = {**os.environ, "PYTHONPATH": str(copy), "AIFRECON_DATA_DIR": data}
    try:
        return subprocess.run(command, cwd=copy, env=surroundings, capture_output=True, timeout=LONGEST, check=False).returncode == 0
    except subprocess.TimeoutExpired:
        return False


def main(words: list[str] | None = None) -> int:
    """Break, test and print; the answer is 2 where the tests fail without any mistake."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=0, help="another one chooses other mistakes (default: %(default)s)")
    parser.add_argument("--count", type=int, default=20, metavar="N", help="how many mistakes (default: %(default)s)")
    parser.add_argument("--rooms", nargs="+", metavar="ROOM", help="only in these folders of AIFReconLib (default: anywhere)")
    given = parser.parse_args(words)
    files = sorted(path.relative_to(REPOSITORY) for path in (REPOSITORY / "AIFReconLib").rglob("*.py"))
    every = [mutant for file in files for mutant in mutants_of(file) if not given.rooms or mutant.room in given.rooms]
    chosen = random.Random(given.seed).sample(every, min(given.count, len(every)))
    noticed = 0
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / REPOSITORY.name
        shutil.copytree(REPOSITORY, copy, ignore=LEFT_OUT)
        for room in sorted({mutant.room for mutant in chosen}):
            if not passes(copy, room):
                print(f"mutants: the tests of {room or 'AIFReconLib'} fail without any mistake", file=sys.stderr)
                return 2
        print("| File | Line | Changed | Noticed |\n|---|---|---|---|")
        for mutant in chosen:
            (copy / mutant.file).write_bytes(mutant.source())
            seen = not passes(copy, mutant.room)
            shutil.copy2(REPOSITORY / mutant.file, copy / mutant.file)
            noticed += seen
            print(f"| {mutant.file} | {mutant.line} | `{mutant.changed()}` | {'yes' if seen else 'no'} |", flush=True)
    print(f"\n{noticed} of {len(chosen)} noticed ({noticed / max(len(chosen), 1):.0%})")
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""What README.md and docs/ promise: code blocks, commands, options, links and paths, taken out of the Markdown for the tests."""

from __future__ import annotations

import ast
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PAGES = [REPOSITORY / "README.md", REPOSITORY / "CONTRIBUTING.md", *sorted((REPOSITORY / "docs").rglob("*.md"))]
PROGRAMS = ("aifrecon", "make", "python", ".venv/bin/python", "pip", "sudo", "cmake", "git", "cd")
"""What a command of a page may begin with; a line that begins otherwise is no command."""

SOURCES = [path for folder in ("AIFReconLib", "AIFRecon", "docs/examples") for path in sorted((REPOSITORY / folder).rglob("*.py"))]
"""What is documented in docstrings: the site's API reference and its gallery, and the module."""

ROOTS = tuple(REPOSITORY / name for name in (".", "AIFReconLib", "AIFRecon", "Testing"))
"""What the paths of running text are relative to."""


@dataclass(frozen=True)
class Block:
    """A fenced block: its page, the number of its first line, its language ("" where none is named) and its text."""

    page: Path
    line: int
    language: str
    text: str

    @property
    def name(self) -> str:
        """Page and line, for a test's name."""
        return f"{name_of(self.page)}:{self.line}"

    def commands(self) -> list[list[str]]:
        """The commands as words; none where the block is something else, such as what a command prints."""
        if self.language not in ("", "sh"):
            return []
        joined = re.sub(r"\\\n\s*", " ", self.text)
        lines = [line for line in joined.splitlines() if line.split() and line.split()[0] in PROGRAMS]
        return [shlex.split(line, comments=True) for line in lines]


def name_of(path: Path) -> str:
    """The path within the repository, for a test's name."""
    return path.relative_to(REPOSITORY).as_posix()


def text_of(page: Path) -> str:
    """The Markdown of a page; the docstrings of a Python file, and the comments of one of the gallery, which are its text."""
    text = page.read_text("utf-8")
    if page.suffix != ".py":
        return text
    holders = ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef
    parts = [ast.get_docstring(node) or "" for node in ast.walk(ast.parse(text)) if isinstance(node, holders)]
    if page.parent.name == "examples":
        parts += re.findall(r"^# (.*)$", text, flags=re.MULTILINE)
    return "\n\n".join(parts).replace("``", "`")


def blocks(page: Path) -> Iterator[Block]:
    """The fenced blocks of a page."""
    pattern = re.compile(r"^([ \t]*)```([\w-]*)[^\n]*\n(.*?)^[ \t]*```[ \t]*$", re.DOTALL | re.MULTILINE)
    for found in pattern.finditer(text_of(page)):
        line = text_of(page)[: found.start()].count("\n") + 2
        yield Block(page, line, found.group(2), found.group(3))


def prose(page: Path) -> str:
    """The page without its fenced blocks."""
    return re.sub(r"^[ \t]*```.*?^[ \t]*```[ \t]*$", "", text_of(page), flags=re.DOTALL | re.MULTILINE)


def code_spans(page: Path) -> list[str]:
    """Inline code, outside of fenced blocks."""
    return [" ".join(span.split()) for span in re.findall(r"`([^`]+)`", prose(page))]


def emphasized(page: Path) -> list[str]:
    """What is written in italics within a sentence; whole sentences in italics, as under pictures, are left out."""
    text = re.sub(r"`[^`]*`", "", prose(page))
    found = [" ".join(words.split()) for words in re.findall(r"(?<!\*)\*([^*\n][^*]*?)\*(?!\*)", text)]
    return [words for words in found if not words.endswith(".")]


def paths(page: Path) -> list[str]:
    """Inline code that is a path into one of the repository's folders."""
    folders = {path.name for root in ROOTS for path in root.iterdir() if path.is_dir()}
    return [span for span in code_spans(page) if re.fullmatch(r"[\w.-]+/[\w./-]*", span) and span.split("/")[0] in folders]


def links(page: Path) -> list[str]:
    """Where links and images lead, as written."""
    text = re.sub(r"`[^`]*`", "", prose(page))
    inline = re.findall(r"\]\(([^)\s]+)\)", text)
    named = re.findall(r"^\[[^\]]+\]:\s*(\S+)", text, flags=re.MULTILINE)
    return [*inline, *named, *re.findall(r"(?:src|href|srcset)=\"([^\"]+)\"", text)]


def anchors(page: Path) -> set[str]:
    """The anchors that GitHub gives to the headings of a page."""
    headings = re.findall(r"^#+\s+(.*)$", prose(page), flags=re.MULTILINE)
    plain = [re.sub(r"[`*]|\[([^\]]*)\]\([^)]*\)", r"\1", heading) for heading in headings]
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in plain}


def first_column(page: Path, header: str) -> list[str]:
    """Code spans in the first column of the table whose head begins with this word."""
    table = re.search(rf"^\|\s*{re.escape(header)}\s*\|[^\n]*\n\|[-| :]+\|\n((?:\|[^\n]*\n)+)", text_of(page), flags=re.MULTILINE)
    if table is None:
        raise LookupError(f"{page} has no table that begins with {header}")
    return [span for row in table.group(1).splitlines() for span in re.findall(r"`([^`]+)`", row.split("|")[1])]

"""How long the pages are: words, mean and longest sentence, rows of tables. Printed to be read, never a gate.

    python Testing/figures/words.py            all pages
    python Testing/figures/words.py README.md docs/method.md

Sentences are those of running text and lists, and end with a stop: a colon or a semicolon ends none. Code blocks, tables and headings have
none, but their words count.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
AIM = 35
"""Words of the longest sentence."""


def sentences(markdown: str) -> list[str]:
    """The sentences of running text and lists, without marks."""
    text = re.sub(r"^[ \t]*```.*?^[ \t]*```[ \t]*$", "", markdown, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"^\$\$.*?\$\$", "", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"^(\||#|<img|!\[|\[[^\]]+\]:).*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"`[^`]+`|\$[^$]+\$", lambda found: re.sub(r"[\s.!?:]+", "_", found.group()), text)
    found: list[str] = []
    for paragraph in re.split(r"\n\s*\n|^\s*(?:[-*]|\d+\.)\s+", text, flags=re.MULTILINE):
        plain = re.sub(r"[*_]{1,2}(?=\S)|(?<=\S)[*_]{1,2}", "", " ".join(paragraph.split()))
        found += [one for one in re.split(r"(?<=[.!?])\)?\s+", plain) if re.search(r"[A-Za-z]{2}", one)]
    return found


def table_rows(markdown: str) -> int:
    """Rows of tables, heads not counted."""
    lines = re.findall(r"^\|.*$", markdown, flags=re.MULTILINE)
    heads = sum(re.fullmatch(r"\|[-| :]+\|", line) is not None for line in lines)
    return len(lines) - 2 * heads


def row_of(path: Path) -> tuple[str, int, float, int, int, int]:
    """Name, all words, mean and longest sentence, sentences above the aim, rows of tables."""
    markdown = path.read_text("utf-8")
    lengths = [len(one.split()) for one in sentences(markdown)] or [0]
    words = len(markdown.split())
    above = sum(length > AIM for length in lengths)
    return path.relative_to(REPOSITORY).as_posix(), words, sum(lengths) / len(lengths), max(lengths), above, table_rows(markdown)


def main(names: list[str]) -> int:
    """Print the table; with -v also the sentences that are too long."""
    verbose = "-v" in names
    pages = [REPOSITORY / name for name in names if name != "-v"]
    pages = pages or [REPOSITORY / "README.md", REPOSITORY / "CHANGELOG.md", *sorted((REPOSITORY / "docs").rglob("*.md"))]
    print("| Page | words | mean sentence | longest | above 35 | rows |\n|---|---|---|---|---|---|")
    for page in pages:
        if "measured" not in page.parts:
            name, words, mean, longest, above, rows = row_of(page)
            print(f"| {name} | {words} | {mean:.1f} | {longest} | {above} | {rows} |")
            for one in sentences(page.read_text("utf-8")) if verbose else ():
                if len(one.split()) > AIM:
                    print(f"  {len(one.split())}: {one}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

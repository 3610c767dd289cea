"""Numbers that a machine made, in the pages: each is a file of docs/measured, and stands in every page that marks a place for it.

    <!-- measured: speed -->
    the text of docs/measured/speed.md
    <!-- end -->

`make bench`, `make study` and `make real-bone` write these files by `keep`, which renews the pages too. After a change by hand:

    python Testing/measured.py
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from datetime import date
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
FOLDER = REPOSITORY / "docs" / "measured"
PLACE = re.compile(r"<!-- measured: ([\w-]+) -->([ \n]).*?<!-- end -->", re.DOTALL)


def table(head: Sequence[str], rows: Iterable[Iterable[str]]) -> str:
    """A table in Markdown."""
    first, *others = (f"| {' | '.join(cells)} |" for cells in (head, *rows))
    return "\n".join([first, "|---" * len(head) + "|", *others])


def shown(number: float, form: str, unknown: str = "-") -> str:
    """A number of a table, NaN as it is said to be."""
    return unknown if number != number else format(number, form)


def pages() -> list[Path]:
    """All that may mark a place."""
    return [REPOSITORY / "README.md", *sorted((REPOSITORY / "docs").glob("*.md"))]


def renewed(page: str) -> str:
    """The Markdown of a page with what is measured today in its places; a place within a line holds a sentence."""

    def filled(found: re.Match[str]) -> str:
        name, blank = found.groups()
        text = (FOLDER / f"{name}.md").read_text("utf-8").strip()
        return f"<!-- measured: {name} -->{blank}{text}{blank}<!-- end -->"

    return PLACE.sub(filled, page)


def keep(measured: dict[str, str], command: str, machine: str = "") -> list[Path]:
    """Write files of docs/measured, and renew the pages; the answer is what was written.

    Parameters
    ----------
    measured : dict of str to str
        Markdown by the name of its file.
    command : str
        What measured it: ``make study``.
    machine : str
        Where; "" where it does not matter.
    """
    made = f"*`{command}`, {date.today().isoformat()}{', ' + machine if machine else ''}.*"
    written = []
    for name, text in measured.items():
        sentence = "\n" not in text.strip()
        written.append(FOLDER / f"{name}.md")
        written[-1].write_text(text.strip() + ("\n" if sentence else f"\n\n{made}\n"), "utf-8")
    for page in pages():
        before = page.read_text("utf-8")
        if (after := renewed(before)) != before:
            page.write_text(after, "utf-8")
            written.append(page)
    return written


if __name__ == "__main__":
    keep({}, "")

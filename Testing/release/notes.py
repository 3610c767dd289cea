"""What is new in a version, from CHANGELOG.md, for the page of its release.

python Testing/release/notes.py v0.1.0    the notes of that version; refused where tag, library and CHANGELOG do not name the same one
python Testing/release/notes.py           what has not been released yet
"""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]


def version_of(source: str) -> str:
    """`__version__` of a Python source, which is not run: where a release is made nothing is installed."""
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and node.targets[0].id == "__version__":
            return str(ast.literal_eval(node.value))
    raise LookupError("there is no __version__ in AIFReconLib/__init__.py")


def notes_of(changelog: str, heading: str) -> str:
    """The part of a changelog below the heading of a version, links within the repository as plain text.

    Raises
    ------
    LookupError
        When there is no such heading, or nothing below it.
    """
    found = re.search(rf"^## {re.escape(heading)}(?![\w.])[^\n]*\n(.*?)(?=^## |\Z)", changelog, re.DOTALL | re.MULTILINE)
    if found is None or not found.group(1).strip():
        raise LookupError(f'CHANGELOG.md has nothing under "## {heading}". Give "Unreleased" that name, and the day.')
    return re.sub(r"\[([^\]]+)\]\((?!https?:)[^)]+\)", r"\1", found.group(1)).strip()


def main(arguments: list[str]) -> int:
    """0 and the notes, or 1 and what is wrong."""
    changelog = (REPOSITORY / "CHANGELOG.md").read_text("utf-8")
    version = version_of((REPOSITORY / "AIFReconLib" / "__init__.py").read_text("utf-8"))
    try:
        if arguments and arguments[0] != f"v{version}":
            raise LookupError(f"The tag {arguments[0]} is not that of this version, which is v{version}.")
        print(notes_of(changelog, version if arguments else "Unreleased"))
    except LookupError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""Which straight lines look free that bone blocks? Fixed and planned scans, a registered CT, a wrong one and none.

    python Testing/study paths --output study-output/paths

writes paths.md and free-paths.png. Some four minutes per patient and core; an interrupted study goes on where it stopped. Needs
shared/data/lumbar-shape.
"""

from __future__ import annotations

from pathlib import Path

from measured import REPOSITORY

from .command import carry_out, page_writer, parsed, study_parser
from .paths_cases import Row, patient_rows
from .paths_figure import paths_figure
from .paths_page import paths_page

FIGURE = "free-paths.png"


def main(words: list[str]) -> int:
    """Run what is missing, then write the page and the picture; the answer is the exit status."""
    arguments = parsed(study_parser("paths", __doc__), words)
    write_page = page_writer(arguments, "paths", paths_page)

    def write(rows: list[Row]) -> list[Path]:
        pictures = [arguments.output / FIGURE, *([REPOSITORY / "docs" / "images" / FIGURE] if arguments.pages else [])]
        for path in pictures:
            paths_figure(path, rows)
        return [*write_page(rows), *pictures]

    return carry_out(arguments, patient_rows, Row, write, "volumes")

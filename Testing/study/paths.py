"""Which straight lines does the product call free that bone blocks? Fixed and planned scans, a registered CT, a wrong one and none.

    python Testing/study paths --output study-output/paths

writes paths.md and paths.png. An interrupted study goes on where it stopped. Needs shared/data/lumbar-shape.
"""

from __future__ import annotations

from .command import carry_out, page_writer, parsed, study_parser
from .paths_cases import Row, patient_rows


def main(words: list[str]) -> int:
    """Run what is missing, then write the page; the answer is the exit status."""
    arguments = parsed(study_parser("paths", __doc__), words)
    return carry_out(arguments, patient_rows, Row, page_writer(arguments, "paths", page_of), "volumes")


def page_of(rows: list[Row]) -> str:
    return str(len(rows))

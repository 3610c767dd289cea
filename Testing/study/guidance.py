"""Does guidance lead to scans that show the bone? Scans by plan and by `next`, with an operator's errors, on simulated patients.

    python Testing/study guidance --output study-output/guidance

writes guidance.md. Some five minutes per patient and core; an interrupted study goes on where it stopped.
"""

from __future__ import annotations

from .command import carry_out, page_writer, parsed, study_parser
from .guidance_cases import Row, patient_rows
from .patients import Spread

COLUMNS = (
    ("interspinous %", "interspinous", 100),
    ("predicted %", "predicted", 100),
    ("expected %", "expected", 100),
    ("below 45 deg %", "below_45", 100),
    ("best %", "best", 100),
    ("coverage %", "coverage", 100),
    ("reached cm2", "reached_cm2", 1),
    ("CNR", "cnr", 1),
)


def main(words: list[str]) -> int:
    """Run what is missing, then write the page; the answer is the exit status."""
    arguments = parsed(study_parser("guidance", __doc__), words)
    return carry_out(arguments, patient_rows, Row, page_writer(arguments.output / "guidance.md", page_of), "scans")


def page_of(rows: list[Row]) -> str:
    """A table: medians with quartiles, a line per way of scanning and number of frames."""
    names = [name for name, _, _ in COLUMNS]
    lines = ["| | frames | " + " | ".join(names) + " |", "|---" * (len(names) + 2) + "|"]
    for scan, frames in dict.fromkeys((row.scan, row.frames) for row in rows):
        these = [row for row in rows if (row.scan, row.frames) == (scan, frames)]
        spreads = [(Spread.of(getattr(row, name) for row in these), scale) for _, name, scale in COLUMNS]
        lines.append(f"| {scan} | {frames} | " + " | ".join(_cell(spread, scale) for spread, scale in spreads) + " |")
    return "\n".join(lines) + "\n"


def _cell(spread: Spread, scale: float) -> str:
    if spread.median != spread.median:
        return ""
    digits = 0 if scale > 1 or spread.median > 20 else 2
    return f"{scale * spread.median:.{digits}f} [{scale * spread.low:.{digits}f}, {scale * spread.high:.{digits}f}]"

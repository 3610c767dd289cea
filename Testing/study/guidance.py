"""Does guidance lead to scans that show the bone? Scans by plan and by `next`, with an operator's errors, on simulated patients.

    python Testing/study guidance --output study-output/guidance

writes guidance.md. Some five minutes per patient and core; an interrupted study goes on where it stopped.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from AIFReconLib.errors import AIFReconError
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.terminal.console import ProgressBar

from .guidance_cases import Row, patient_rows
from .patients import Spread, run_study

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
    parser = argparse.ArgumentParser(prog="python Testing/study guidance", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, metavar="DIR", help="folder to keep the results in; made if it is not there")
    parser.add_argument("--patients", type=int, default=10, metavar="N", help="how many (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="patients at a time (default: %(default)s)")
    arguments = parser.parse_args(words)
    if arguments.patients < 1 or arguments.jobs < 1:
        parser.error("a study takes at least 1 patient and 1 job")
    try:
        arguments.output.mkdir(parents=True, exist_ok=True)
        with ProgressBar() as progress:
            rows = run_study(patient_rows, Row, arguments.output, range(arguments.patients), arguments.jobs, progress)
        page = arguments.output / "guidance.md"
        write_text(page, page_of(rows))
    except (AIFReconError, OSError) as error:
        print(f"study: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("study: interrupted; the same command goes on where it stopped", file=sys.stderr)
        return 130
    print(f"{len(rows)} scans of {arguments.patients} simulated patients\n  wrote {page}")
    return 0


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

"""Does guidance lead to scans that show the bone? Scans by plan and by `next`, with an operator's errors, on simulated patients.

    python Testing/study guidance --output study-output/guidance

writes guidance.md. Some three minutes per patient and core; an interrupted study goes on where it stopped.
"""

from __future__ import annotations

from collections.abc import Iterable

from .command import Study
from .guidance_cases import Row, patient_rows
from .patients import Spread, table_head, table_line

COLUMNS = (
    ("passes", "passes", "{:.0f}"),
    ("interspinous", "interspinous", "{:.0%}"),
    ("predicted", "predicted", "{:.0%}"),
    ("expected", "expected", "{:.0%}"),
    ("interspinous, of all", "of_reachable", "{:.0%}"),
    ("predicted, of all", "predicted_of_reachable", "{:.0%}"),
    ("coverage", "coverage", "{:.0%}"),
    ("reached cm2", "reached_cm2", "{:.0f}"),
    ("CNR", "cnr", "{:.2f}"),
)


NEAR = 7
"""Points by which a prediction may be off."""


def page_of(rows: list[Row]) -> str:
    """A table: medians with quartiles, a line per way of scanning and number of frames; then how far predictions are off."""
    lines = table_head(["patients", "frames", *(name for name, _, _ in COLUMNS)])
    off = []
    for scan, frames in sorted({(row.scan, row.frames) for row in rows}):
        these = [row for row in rows if (row.scan, row.frames) == (scan, frames)]
        cells = (_cell((getattr(row, name) for row in these), form) for _, name, form in COLUMNS)
        lines.append(table_line(scan, [str(len(these)), str(frames), *cells]))
        for said in ("predicted", "expected"):
            points = [100 * (getattr(row, said) - row.interspinous) for row in these if getattr(row, said) == getattr(row, said)]
            if points:
                mean = sum(points) / len(points)
                told = f"{mean:+.0f} | {min(points):+.0f} to {max(points):+.0f} | {sum(abs(p) <= NEAR for p in points)} of {len(points)}"
                off.append(f"| {scan}, {frames} frames, {said} | {told} |")
    head = f"| points above what came | mean | range | within {NEAR} |"
    return "\n".join([*lines, "", head, "|---|---|---|---|", *off]) + "\n"


def _cell(numbers: Iterable[float], form: str) -> str:
    spread = Spread.of(numbers)
    if spread.median != spread.median:
        return ""
    return f"{form.format(spread.median)} [{form.format(spread.low)}, {form.format(spread.high)}]"


STUDY = Study(patient_rows, Row, "scans", lambda rows: {"guidance": page_of(rows)})

"""Does guidance lead to scans that show the bone? Scans by plan and by `next`, with an operator's errors, on simulated patients.

    python Testing/study guidance --output study-output/guidance

writes guidance.md. Some three minutes per patient and core; an interrupted study goes on where it stopped.
"""

from __future__ import annotations

import pandas as pd
from measured import shown, table

from .command import Study
from .guidance_cases import Row, patient_rows

COLUMNS = (
    ("passes", "passes", ".0f"),
    ("interspinous", "interspinous", ".0%"),
    ("predicted", "predicted", ".0%"),
    ("expected", "expected", ".0%"),
    ("interspinous, of all", "of_reachable", ".0%"),
    ("predicted, of all", "predicted_of_reachable", ".0%"),
    ("coverage", "coverage", ".0%"),
    ("reached cm2", "reached_cm2", ".0f"),
    ("CNR", "cnr", ".2f"),
)


NEAR = 7
"""Points by which a prediction may be off."""


def page_of(rows: list[Row]) -> str:
    """A table: medians with quartiles, a line per way of scanning and number of frames; then how far predictions are off."""
    lines, off = [], []
    for (scan, frames), of in pd.DataFrame(rows).groupby(["scan", "frames"]):
        lines.append([scan, f"{len(of)}", f"{frames}", *(_cell(of[name], form) for _, name, form in COLUMNS)])
        for said in ("predicted", "expected"):
            points = (100 * (of[said] - of.interspinous)).dropna()
            if len(points):
                told = f"{points.min():+.0f} to {points.max():+.0f}", f"{(points.abs() <= NEAR).sum()} of {len(points)}"
                off.append([f"{scan}, {frames} frames, {said}", f"{points.mean():+.0f}", *told])
    scans = table(["", "patients", "frames", *(name for name, _, _ in COLUMNS)], lines)
    return f"{scans}\n\n{table(('points above what came', 'mean', 'range', f'within {NEAR}'), off)}\n"


def _cell(numbers: pd.Series, form: str) -> str:
    low, median, high = (shown(number, form, "") for number in numbers.quantile([0.25, 0.5, 0.75]))
    return median and f"{median} [{low}, {high}]"


STUDY = Study(patient_rows, Row, "scans", lambda rows: {"guidance": page_of(rows)})

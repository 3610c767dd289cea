"""Does a CT find its place on the sweep, and does it say so when it does not? Starts, wrong CTs, posture, tracker noise, sparse sweeps.

    python Testing/study registration --output study-output/registration

writes registration.md. About four minutes per patient and core; an interrupted study goes on where it stopped.
"""

from __future__ import annotations

import numpy as np

from .command import Study
from .patients import table_line
from .registration_cases import Row, patient_rows

CHOSEN_ON = (0, 1)
"""Patients on which constants were chosen: they have no say in the table of docs/registration.md."""


def page_of(rows: list[Row]) -> str:
    """A table: a line per condition."""
    lines = [
        "| Condition | n | accepted | error, mm: median | 95% | within 1 mm | within 2 mm | wrongly accepted | agreement | median, mm |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for condition in dict.fromkeys(row.condition for row in rows):
        these = [row for row in rows if row.condition == condition]
        errors = sorted(row.error for row in these if row.error == row.error)
        accepted = sum(row.accepted for row in these) / len(these)
        middle = sorted(row.agreement for row in these)
        medians = sorted(row.median_distance for row in these)
        cells = [str(len(these)), f"{accepted:.0%}"]
        if errors:
            wrong = sum(row.accepted and row.error > 2.0 for row in these)
            cells += [f"{np.median(errors):.2f}", f"{np.percentile(errors, 95):.2f}"]
            cells += [f"{sum(e <= limit for e in errors) / len(errors):.0%}" for limit in (1.0, 2.0)] + [str(wrong)]
        else:
            cells += ["", "", "", "", ""]
        cells += [f"{middle[0]:.2f} to {middle[-1]:.2f}", f"{medians[0]:.2f} to {medians[-1]:.2f}"]
        lines.append(table_line(condition, cells))
    return "\n".join(lines + _kept(rows)) + "\n"


def _kept(rows: list[Row]) -> list[str]:
    """A table of what `weighted` shows with the registrations that were found, as shares of what it shows with the exact one."""
    lines = ["", "| Condition | n | CNR kept: median | least | coverage kept: median | least |", "|---|---|---|---|---|---|"]
    rows = [row for row in rows if row.cnr_kept == row.cnr_kept]
    for condition in dict.fromkeys(row.condition for row in rows):
        cells = [str(len([row for row in rows if row.condition == condition]))]
        for name in ("cnr_kept", "coverage_kept"):
            shares = [getattr(row, name) for row in rows if row.condition == condition]
            cells += [f"{np.median(shares):.1%}", f"{min(shares):.1%}"]
        lines.append(table_line(condition, cells))
    return lines


STUDY = Study(
    patient_rows,
    Row,
    "registrations",
    lambda rows: {"registration": page_of(rows)},
    shown=lambda rows: {"registration": page_of([row for row in rows if row.patient not in CHOSEN_ON])},
)

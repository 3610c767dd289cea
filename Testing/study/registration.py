"""Does a CT find its place on the sweep, and does it say so when it does not? Starts, wrong CTs, posture, tracker noise, sparse sweeps.

    python Testing/study registration --output study-output/registration

writes registration.md. About four minutes per patient and core; an interrupted study goes on where it stopped.
"""

from __future__ import annotations

import pandas as pd
from measured import table

from .command import Study
from .registration_cases import Row, patient_rows

CHOSEN_ON = (0, 1)
"""Patients on which constants were chosen: they have no say in the table of docs/registration.md."""


HEAD = (
    "Condition",
    "n",
    "accepted",
    "error, mm: median",
    "95%",
    "within 1 mm",
    "within 2 mm",
    "wrongly accepted",
    "agreement",
    "median, mm",
)


def page_of(rows: list[Row]) -> str:
    """A line per condition; then what `weighted` shows with the registrations found, as shares of what it shows with the exact one."""
    lines, kept = [], []
    for condition, of in pd.DataFrame(rows).groupby("condition", sort=False):
        errors, cells = of.error.dropna(), [""] * 5
        if len(errors):
            within = (f"{(errors <= limit).mean():.0%}" for limit in (1.0, 2.0))
            cells = [f"{errors.median():.2f}", f"{errors.quantile(0.95):.2f}", *within, f"{(of.accepted & (of.error > 2.0)).sum()}"]
        ranges = (f"{each.min():.2f} to {each.max():.2f}" for each in (of.agreement, of.median_distance))
        lines.append([condition, f"{len(of)}", f"{of.accepted.mean():.0%}", *cells, *ranges])
        if of.cnr_kept.any():
            shares = (f"{one:.1%}" for each in (of.cnr_kept, of.coverage_kept) for one in (each.median(), each.min()))
            kept.append([condition, f"{of.cnr_kept.count()}", *shares])
    shown = table(("Condition", "n", "CNR kept: median", "least", "coverage kept: median", "least"), kept)
    return f"{table(HEAD, lines)}\n\n{shown}\n"


STUDY = Study(
    patient_rows,
    Row,
    "registrations",
    lambda rows: {"registration": page_of(rows)},
    shown=lambda rows: {"registration": page_of([row for row in rows if row.patient not in CHOSEN_ON])},
)

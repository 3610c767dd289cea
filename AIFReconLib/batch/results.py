"""The results of all cases as one flat table, a row per case and method: CSV for people, Parquet for programs."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ..evaluation.quantities import spreadsheet_cell
from ..io.disk.atomic import atomic_output, write_text
from .engine import require
from .records import DONE, Record, Row
from .table import Case

CSV, PARQUET = "results.csv", "results.parquet"

FIRST = ("case", "method", "state", "message", "seconds")
"""Columns that every table has, in front."""

LAST = ("notes",)


def flat_rows(cases: Iterable[Case], records: dict[str, Record]) -> list[Row]:
    """A row per case and method, in the order of the table; cases of which nothing is known are left out."""
    rows: list[Row] = []
    for case in cases:
        record = records.get(case.name)
        if record is None:
            continue
        of_case: Row = {"case": case.name, "state": record.state, "message": said_of(record), "seconds": record.seconds}
        asked: list[Row] = [{"method": method or ""} for method in case.methods]
        done = record.results if record.state == DONE else asked
        rows += [{**result, **of_case} for result in done]
    names = list(dict.fromkeys([*FIRST, *(name for row in rows for name in row if name not in LAST), *LAST]))
    return [{name: row.get(name) for name in names} for row in rows]


def said_of(record: Record) -> str:
    """What went wrong, or nearly, in words."""
    if record.state == DONE and record.attempts > 1:
        return f"Done at try {record.attempts}: its process was ended in the one before."
    return record.message


def write_tables(output: Path, rows: list[Row]) -> list[Path]:
    """Write both tables; the answer names them.

    Raises OutputError when they cannot be written.
    """
    write_text(output / CSV, _csv(rows))
    with atomic_output(output / PARQUET) as temporary:
        require("pyarrow.parquet").write_table(_arrow(rows), temporary)
    return [output / CSV, output / PARQUET]


def _csv(rows: list[Row]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([spreadsheet_cell(name) for name in (rows[0] if rows else FIRST)])
    writer.writerows([spreadsheet_cell(value) for value in row.values()] for row in rows)
    return text.getvalue()


def _arrow(rows: list[Row]) -> Any:
    """The rows as an Arrow table: a column is of numbers where all that is in it is."""
    arrow = require("pyarrow")
    names = list(rows[0]) if rows else list(FIRST)
    columns = {}
    for name in names:
        values = [row[name] for row in rows]
        known = [value for value in values if value is not None]
        number = bool(known) and all(isinstance(value, int | float) for value in known)
        columns[name] = arrow.array(
            [value if value is None or number else str(value) for value in values], arrow.float64() if number else arrow.string()
        )
    return arrow.table(columns)

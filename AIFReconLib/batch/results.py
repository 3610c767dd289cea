"""The results of all cases as one table, a row per case and method: CSV for people, Parquet for programs."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from ..evaluation.quantities import spreadsheet_cell
from ..io.disk.atomic import atomic_output, write_text
from .engine import require
from .records import DONE, Record, Row
from .table import Case

if TYPE_CHECKING:
    from pandas import DataFrame

CSV, PARQUET = "results.csv", "results.parquet"

FIRST = ("case", "method", "state", "message", "seconds")
"""Columns that every table has, in front."""

LAST = "notes"


def results_table(cases: Iterable[Case], records: dict[str, Record]) -> DataFrame:
    """A row per case and method, in the order of the table; cases of which nothing is known are left out."""
    rows: list[Row] = []
    for case in cases:
        if (record := records.get(case.name)) is not None:
            asked: list[Row] = [{"method": method or ""} for method in case.methods]
            of_case: Row = {"case": case.name, "state": record.state, "message": record.message, "seconds": record.seconds}
            rows += [{**each, **of_case} for each in (record.results if record.state == DONE else asked)]
    table: DataFrame = require("pandas").DataFrame(rows, dtype=object)
    others = table.columns.difference([*FIRST, LAST], sort=False)
    return table.reindex(columns=[*FIRST, *others, LAST])


def write_tables(output: Path, table: DataFrame) -> list[Path]:
    """Write it in both kinds; the answer names the files.

    Raises OutputError when they cannot be written.
    """
    cells = table.map(lambda value: str(spreadsheet_cell(value)), na_action="ignore")
    write_text(output / CSV, cells.to_csv(index=False, lineterminator="\n"))
    typed = table.infer_objects()
    with atomic_output(output / PARQUET) as temporary:
        typed.astype(dict.fromkeys(typed.select_dtypes("number"), float)).to_parquet(temporary, index=False)
    return [output / CSV, output / PARQUET]

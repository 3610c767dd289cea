"""One page for all cases: what failed and why, how the numbers are distributed, and a table that sorts, with pictures.

It needs nothing from elsewhere; pictures are the files beside it.
"""

from __future__ import annotations

import json
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import __version__
from ..evaluation.quantities import HEADINGS, QUANTITIES
from ..evaluation.report import STYLE
from .engine import require
from .records import DONE, FAILED, LOST

if TYPE_CHECKING:
    from pandas import DataFrame

PAGE = "index.html"

OF_BONE = (
    *("bone_cnr", "oblique_cnr", "bone_coverage", "oblique_coverage", "interspinous_coverage"),
    *("bone_thickness", "bone_localization_error"),
)

NUMBERS: dict[str, tuple[str, str, str]] = {
    **{name: (HEADINGS[name], QUANTITIES[name].form, QUANTITIES[name].definition) for name in OF_BONE},
    **json.loads(Path(__file__).with_name("numbers.json").read_text("utf-8")),
}
"""What the page shows of a row, with its heading, format and definition; all numbers are in the tables beside it."""

MEANS = {
    "oblique_": "of bone that beams hit at more than 45\N{DEGREE SIGN} at best",
    "interspinous_": "of the borders of the gaps between spinous processes",
}
"""What the parts of the bone are, by how the names of numbers begin; else it is all bone that beams met."""

FEWEST_DRAWN = 3
"""Cases from which a distribution is drawn: a dot or two are read from the table."""

NOT_DRAWN = ("frames", "seconds")

WIDTH, SIDE = 320.0, 3.0
"""Of the drawing of a distribution, and left and right of its outermost marks, in its own units."""

OF_CASE = ("sweep_", "registration_")
"""How the names of numbers begin that all methods of a case share."""

WARNING = "WARNING"
"""In the notes of a case that is done and doubtful."""

TEMPLATE = Path(__file__).with_name("page.html")


def page(title: str, table: DataFrame) -> str:
    """The page of a table as `results_table` returns it, as text; whatever that says is escaped."""
    environment = require("jinja2").Environment(autoescape=True, trim_blocks=True)
    environment.filters["as"] = _shown
    of_cases = table.drop_duplicates("case")
    states = {state: int((of_cases["state"] == state).sum()) for state in (DONE, FAILED, LOST)}
    numbers = [_described(name) for name in NUMBERS if name in table and table[name].notna().any()]
    plots = [(number, _plot(table, number["name"])) for number in numbers if number["name"] not in NOT_DRAWN]
    text: str = environment.from_string(TEMPLATE.read_text("utf-8")).render(
        title=title,
        style=STYLE,
        counts={state: count for state, count in states.items() if count or state == DONE},
        failures=of_cases[of_cases["message"] != ""].to_dict("records"),
        doubts=table[[WARNING in str(notes) for notes in table["notes"]]].drop_duplicates("case").to_dict("records"),
        drawn=[(number, plot) for number, plot in plots if plot["rows"]],
        rows=table.astype(object).where(table.notna(), None).to_dict("records"),
        numbers=numbers,
        version=__version__,
        date=f"{datetime.now():%Y-%m-%d %H:%M}",
    )
    return text


def _described(name: str) -> dict[str, str]:
    """What a number of the page is."""
    heading, form, definition = NUMBERS[name]
    part = next((f", {words}" for begin, words in MEANS.items() if name.startswith(begin)), "")
    return {"name": name, "heading": heading, "form": form, "part": part, "definition": definition}


def _plot(table: DataFrame, name: str) -> dict[str, Any]:
    """Where the marks of a number lie along its axis: of each method, or of all where methods share it."""
    shared = name.startswith(OF_CASE)
    grouped = {"all methods": table.drop_duplicates("case")} if shared else dict(iter(table.groupby("method", sort=False)))
    values = {method: require("pandas").to_numeric(each[name], errors="coerce").dropna() for method, each in grouped.items()}
    values = {method: each for method, each in values.items() if len(each) >= FEWEST_DRAWN}
    low = min((each.min() for each in values.values()), default=0.0)
    high = max((each.max() for each in values.values()), default=0.0)
    low, high = (low, high) if low < high else (low - 1.0, high + 1.0)
    rows = []
    for method, each in values.items():
        along = (SIDE + (WIDTH - 2 * SIDE) * (each - low) / (high - low)).round(1)
        rows.append({"method": method, "median": each.median(), "cases": list(along), "spread": list(along.quantile([0.25, 0.5, 0.75]))})
    return {"rows": rows, "low": low, "high": high}


def _shown(value: object, form: str) -> str:
    return format(value, form).replace("-", "\N{MINUS SIGN}") if isinstance(value, int | float) else "\N{EN DASH}"

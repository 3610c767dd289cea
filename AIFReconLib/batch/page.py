"""One page for all cases: what failed and why, how the numbers are distributed, and a table that sorts, with pictures.

It needs nothing from elsewhere; pictures are the files beside it.
"""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime
from html import escape
from pathlib import Path
from urllib.parse import quote

from .. import __version__
from ..evaluation.quantities import HEADINGS, QUANTITIES
from ..evaluation.report import STYLE
from ..io.disk.atomic import write_text
from .distributions import strip_plot
from .records import DONE, FAILED, LOST, Row

PAGE = "index.html"

OF_BONE = (
    *("bone_cnr", "oblique_cnr", "bone_coverage", "oblique_coverage", "interspinous_coverage"),
    *("bone_thickness", "bone_localization_error"),
)

NUMBERS = {
    **{name: (HEADINGS[name], QUANTITIES[name].form) for name in OF_BONE},
    "sweep_met": ("bone hit", ".0%"),
    "sweep_interspinous_met": ("gaps hit", ".0%"),
    "registration_agreement": ("CT agrees", ".0%"),
    "registration_median_distance_mm": ("CT off by mm", ".2f"),
    "frames": ("frames", ".0f"),
    "seconds": ("seconds", ".1f"),
}
"""What the page shows of a row, with its heading and format; all numbers are in the tables beside it."""

MEANS = {
    "oblique_": "of bone that beams hit at more than 45\N{DEGREE SIGN} at best",
    "interspinous_": "of the borders of the gaps between spinous processes",
}
"""What the parts of the bone are, by how the names of numbers begin; else it is all bone that beams could reach."""

DEFINITIONS = {
    "sweep_met": "Share of the bone within reach that a beam hit, as aifrecon coverage tells.",
    "sweep_interspinous_met": "The same of the borders of the gaps between spinous processes.",
    "registration_agreement": "Share of the sweep's bone echoes that lie within 2 mm of the CT's bone.",
    "registration_median_distance_mm": "Median distance of these echoes from the CT's bone.",
    "frames": "Frames that entered the volume.",
    "seconds": "What the case took.",
}
"""Of what is no number of `BoneMetrics`."""

FEWEST_DRAWN = 3
"""Cases from which a distribution is drawn: a dot or two are read from the table."""

DRAWN = tuple(name for name in NUMBERS if name not in ("frames", "seconds"))

MOST_DRAWN = 1e100
"""What is not below it, or no number, has no place on an axis."""

OF_CASE = ("sweep_", "registration_")
"""How the names of numbers begin that all methods of a case share."""

OWN_STYLE = Path(__file__).with_name("page.css").read_text("utf-8")

SCRIPT = Path(__file__).with_name("page.js").read_text("utf-8")


def write_page(output: Path, title: str, rows: list[Row]) -> Path:
    """Write the page into the folder of all results, of rows as `flat_rows` returns them; the answer is its path.

    Raises OutputError when it cannot be written.
    """
    write_text(output / PAGE, page(title, rows))
    return output / PAGE


def page(title: str, rows: list[Row]) -> str:
    """The page as text."""
    shown = [name for name in NUMBERS if any(row.get(name) is not None for row in rows)]
    parts = [
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(title)}</title><style>{STYLE}{OWN_STYLE}</style></head><body>",
        f"<header><h1>{escape(title)}</h1>{_counts(rows)}</header>",
        *_failures(rows),
        *_plots(rows, [name for name in DRAWN if name in shown]),
        *_table(rows, shown),
        *_definitions(shown),
        f'<p class="notes">AIFRecon {__version__}, {datetime.now():%Y-%m-%d %H:%M}. All numbers, settings and notes: '
        '<a href="results.csv">results.csv</a>, <a href="results.parquet">results.parquet</a>.</p>',
        f"<script>{SCRIPT}</script></body></html>",
    ]
    return "\n".join(parts) + "\n"


def _counts(rows: list[Row]) -> str:
    states = {row["case"]: _text(row, "state") for row in rows}
    counts = [(state, sum(each == state for each in states.values())) for state in (DONE, FAILED, LOST)]
    items = (f'<li class="{_css(state)}"><b>{count}</b>{state}</li>' for state, count in counts if count or state == DONE)
    return f'<ul class="counts">{"".join(items)}</ul>'


def _css(state: str) -> str:
    return state.replace(" ", "-")


def _failures(rows: list[Row]) -> Iterable[str]:
    said = {_text(row, "case"): (_text(row, "state"), _text(row, "message")) for row in rows if row["message"]}
    if not said:
        return
    yield '<section><h2>What went wrong</h2><ul class="failures">'
    for case, (state, message) in said.items():
        yield f'<li><b>{case}</b><span class="{_css(state)}">{state}</span><p>{message}</p></li>'
    yield "</ul></section>"


def _plots(rows: list[Row], names: list[str]) -> Iterable[str]:
    drawn = {name: values for name in names if (values := _enough(_values(rows, name)))}
    if not drawn:
        return
    yield '<section><h2>Distributions</h2><p class="notes">A dot is a case; below, the quartiles, and the median with its number.</p>'
    yield '<div class="plots">'
    for name, values in drawn.items():
        heading, form = NUMBERS[name]
        yield f"<figure><h3>{escape(_sentence(heading))}</h3>{strip_plot(values, form)}</figure>"
    yield "</div></section>"


def _enough(values: dict[str, list[float]]) -> dict[str, list[float]]:
    """Those methods of which there are cases enough to draw."""
    return {method: each for method, each in values.items() if len(each) >= FEWEST_DRAWN}


def _definitions(shown: list[str]) -> Iterable[str]:
    """What each number of the page is, a line each."""
    if not shown:
        return
    yield '<section><h2>What the numbers are</h2><ul class="notes">'
    for name in shown:
        part = next((words for begin, words in MEANS.items() if name.startswith(begin)), "")
        said = DEFINITIONS.get(name) or QUANTITIES[name].definition
        yield f"<li><strong>{escape(_sentence(NUMBERS[name][0]))}</strong>{', ' + part if part else ''}. {escape(said)}</li>"
    yield "</ul></section>"


def _values(rows: list[Row], name: str) -> dict[str, list[float]]:
    """A number by method, or once for each case where methods share it."""
    values: dict[str, dict[str, float]] = {}
    for row in rows:
        number = row.get(name)
        if isinstance(number, int | float) and abs(number) < MOST_DRAWN:
            method = "all methods" if name.startswith(OF_CASE) else str(row.get("method") or "")
            values.setdefault(method, {})[_text(row, "case")] = number
    return {method: list(of_cases.values()) for method, of_cases in values.items()}


def _text(row: Row, name: str) -> str:
    """What a row says, as the page may show it; the only way from a row's words to the page."""
    return escape(str(row.get(name) or ""))


def _sentence(heading: str) -> str:
    return heading[:1].upper() + heading[1:]


def _table(rows: list[Row], shown: list[str]) -> Iterable[str]:
    heads = ["case", "", "method", "state", *(str(NUMBERS[name][0]) for name in shown)]
    cells = "".join(f'<th scope="col"><button type="button">{escape(head)}</button></th>' if head else "<td></td>" for head in heads)
    yield '<section><h2>Cases</h2><div class="wide"><table class="cases-table"><thead>'
    yield f"<tr>{cells}</tr></thead><tbody>"
    for row in rows:
        numbers = "".join(_number(row.get(name), NUMBERS[name][1]) for name in shown)
        case, method, state = (_text(row, name) for name in ("case", "method", "state"))
        yield (
            f'<tr><th scope="row">{case}</th><td>{_picture(row)}</td><td>{method}</td><td class="{_css(state)}">{state}</td>{numbers}</tr>'
        )
    yield "</tbody></table></div></section>"


def _number(value: float | str | None, form: str) -> str:
    if not isinstance(value, int | float):
        return '<td data-n="">\N{EN DASH}</td>'
    shown = format(value, form).replace("-", "\N{MINUS SIGN}")
    return f'<td data-n="{value:.6g}">{shown}</td>'


def _picture(row: Row) -> str:
    if not row.get("preview"):
        return ""
    # A file beside the page; two slashes in front would name another computer
    path = quote(str(row["preview"]).lstrip("/"))
    what = f"{_text(row, 'case')}, {_text(row, 'method')}"
    return f'<a href="{path}" title="{_text(row, "volume")}"><img loading="lazy" src="{path}" alt="{what}"></a>'

"""One HTML page that shows what was measured and where it comes from, and needs nothing but itself."""

from __future__ import annotations

import base64
import platform
from collections.abc import Iterable
from dataclasses import dataclass, field, fields
from html import escape
from pathlib import Path

import numpy
import scipy

from .. import __version__
from ..io.disk.atomic import write_text
from ..recipe.recipe import Recipe
from .metrics import OBLIQUE_DEG
from .quantities import NOT_KNOWN, OF_SURFACE, OF_VOLUME, PARTS, QUANTITIES, BoneMetrics, achieved, best_of, cell, what_counted
from .visibility import GRAZING_DEG

DASH = "\N{EN DASH}"

STYLE = """
:root { color-scheme: light dark; --page: #fff; --ink: #1b1f24; --soft: #5b6570; --line: #d9dee4; --best: #e2f1e6; --best-ink: #0f5c2e; }
@media screen and (prefers-color-scheme: dark) {
  :root { --page: #14171b; --ink: #e4e7eb; --soft: #98a2ae; --line: #323941; --best: #1d3a29; --best-ink: #9fe0b5; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 66rem; padding: 1.5rem 1.25rem 3rem; background: var(--page); color: var(--ink);
  font: 1rem/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0; overflow-wrap: anywhere; }
h2 { font-size: 1.2rem; line-height: 1.3; margin: 2.25rem 0 0.25rem; }
h3 { font-size: 1rem; margin: 1.5rem 0 0.4rem; }
p { margin: 0.3rem 0 0.8rem; }
.achieved { font-size: 1.125rem; }
header p, figcaption, .unit, dt { color: var(--soft); }
figure { margin: 1rem 0 0; }
figcaption { font-size: 0.875rem; margin-top: 0.4rem; }
img { display: block; width: 100%; min-width: 46rem; border-radius: 6px; }
.wide { overflow-x: auto; }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(17rem, 100%), 1fr)); gap: 0 1rem; align-items: end; }
.pictures img { min-width: 0; }
.named td, .named th { white-space: nowrap; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 0.9375rem; }
.metrics { table-layout: fixed; width: 100%; min-width: calc(14.75rem + var(--volumes) * 6.75rem); }
.metrics thead td { width: 14.75rem; }
th, td { padding: 0.25rem 0.6rem; text-align: right; border-bottom: 1px solid var(--line); }
th { font-weight: 600; }
thead th { vertical-align: bottom; font-size: 0.875rem; line-height: 1.3; overflow-wrap: anywhere; }
tbody th { font-weight: 400; text-align: left; white-space: nowrap; }
th:first-child, thead td { position: sticky; left: 0; background: var(--page); padding-left: 0; }
.group th { font-weight: 600; padding-top: 1rem; }
.unit { font-size: 0.8125rem; white-space: nowrap; }
sup { font-size: 0.6875rem; line-height: 0; }
sup a { color: var(--soft); text-decoration: none; padding-left: 0.15rem; }
.best { background: var(--best); color: var(--best-ink); }
.notes { font-size: 0.875rem; }
ol.notes { padding-left: 1.4rem; columns: 2 22rem; column-gap: 2.5rem; }
ol.notes li { break-inside: avoid; margin-bottom: 0.3rem; }
li:target { background: var(--best); }
.facts { display: grid; grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); gap: 0.6rem 2rem; margin: 0.75rem 0 0; }
dt { font-size: 0.8125rem; }
dd { margin: 0; overflow-wrap: anywhere; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(20rem, 100%), 1fr)); gap: 0 2.5rem; align-items: start; }
.plain { table-layout: fixed; width: 100%; font-size: 0.875rem; overflow-wrap: anywhere; }
.plain td:first-child { text-align: left; padding-left: 0; width: 60%; }
@media screen and (max-width: 40rem) {
  body { padding: 1rem 0.9rem 2rem; }
  h1 { font-size: 1.35rem; }
  th, td { padding: 0.25rem 0.4rem; }
  img { min-width: 0; }
  .metrics { min-width: calc(6rem + var(--volumes) * 2.6rem); font-size: 0.7rem; }
  .metrics thead td { width: 6rem; }
  .metrics thead th { writing-mode: vertical-rl; text-align: right; white-space: nowrap; font-size: 0.7rem; }
  .metrics th, .metrics td { padding: 0.3rem 0.15rem; }
  .metrics .unit { font-size: 0.65rem; }
  tbody th { white-space: normal; line-height: 1.3; }
}
@media print {
  @page { margin: 14mm; }
  html { font-size: 12px; }
  body { max-width: none; padding: 0; }
  .wide { overflow: visible; }
  .metrics { min-width: 0; }
  .metrics thead td { width: 13rem; }
  thead th { font-size: 0.8125rem; padding-left: 0; }
  img { min-width: 0; }
  th, td { padding: 0.15rem 0.4rem; }
  .best { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  th:first-child, thead td { position: static; background: none; }
  figure, tbody, h2, h3, .facts { break-inside: avoid; }
  h2, h3 { break-after: avoid; }
  thead { display: table-header-group; }
}
"""


@dataclass(frozen=True)
class Section:
    """A part of a page in its author's words.

    Parameters
    ----------
    rows : tuple of (str, str)
        Names and values.
    said : tuple of str
        Sentences.
    table : tuple of tuple of str
        The first row holds the headings, the first column names.
    pictures : tuple of (str, bytes)
        Captions, and PNG files.
    """

    title: str
    rows: tuple[tuple[str, str], ...] = ()
    said: tuple[str, ...] = ()
    table: tuple[tuple[str, ...], ...] = ()
    pictures: tuple[tuple[str, bytes], ...] = ()


@dataclass(frozen=True)
class Report:
    """All that a page shows.

    Parameters
    ----------
    metrics : dict of str to BoneMetrics
        By the name of the volume or method; none: the page does not judge them.
    frames : int or None
        Of the sweep that decides which bone counts; None: no sweep is known.
    inputs : iterable of (name, bytes)
        Files; names only, for a folder says nothing to a reader elsewhere.
    facts : dict of str to str
        Seeds, sweep and whatever else a reader needs to repeat it.
    settings : dict of str to Recipe
        By method; empty where they are not known.
    versions : dict of str to str
        Of the software, see `software_versions`.
    sections : tuple of Section
        Between the figure and the metrics.
    language : str
        Of what the author says, as HTML names it.
    summary : str
        What was achieved, in a sentence or two; "": what the metrics say.
    """

    title: str
    date: str
    metrics: dict[str, BoneMetrics]
    frames: int | None
    inputs: tuple[tuple[str, int], ...] = ()
    facts: dict[str, str] = field(default_factory=dict)
    settings: dict[str, Recipe] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    figure_png: bytes | None = None
    figure_caption: str = ""
    sections: tuple[Section, ...] = ()
    language: str = "en"
    summary: str = ""


def software_versions() -> dict[str, str]:
    """Versions of what computes the numbers."""
    return {"aifrecon": __version__, "Python": platform.python_version(), "numpy": numpy.__version__, "scipy": scipy.__version__}


def file_sizes(paths: Iterable[Path | None]) -> tuple[tuple[str, int], ...]:
    """Names and sizes (bytes) of files, for `Report.inputs`; None is passed over."""
    return tuple((path.name, path.stat().st_size) for path in paths if path is not None)


def write_report(path: str | Path, report: Report) -> None:
    """Write the page, completely or not at all; an OutputError where it cannot be written."""
    write_text(path, report_html(report))


def report_html(report: Report) -> str:
    """One self-contained HTML page: figure, table, definitions, provenance. The same report gives the same page."""
    title = escape(report.title)
    summary = report.summary or (achieved(report.metrics, report.frames) if report.metrics else "")
    lines = [
        f"""<!DOCTYPE html>
<html lang="{escape(report.language)}">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>{title}</title>
<style>{STYLE}</style>
</head>
<body>
<header>
<h1>{title}</h1>
<p>{escape(report.date)}. Made by AIFRecon, which is research software: not a medical device, not for diagnosis or treatment.</p>
</header>
<main>""",
        *([f'<p class="achieved">{escape(summary)}</p>'] if summary else []),
        *([] if report.figure_png is None else [_picture(report.figure_caption, report.figure_png, wide=True)]),
        *(line for section in report.sections for line in _section(section)),
        *(_judged(report) if report.metrics else ()),
        *_provenance(report),
        "</main>\n</body>\n</html>\n",
    ]
    return "\n".join(lines)


def _section(section: Section) -> list[str]:
    lines = ["<section>", f"<h2>{escape(section.title)}</h2>"]
    if section.pictures:
        lines += ['<div class="pictures">', *(_picture(caption, data) for caption, data in section.pictures), "</div>"]
    if section.rows:
        lines += _facts(section.rows)
    if section.table:
        headings, *rows = section.table
        lines += ['<div class="wide"><table class="named">', f"<thead><tr>{_cells('th', headings)}</tr></thead><tbody>"]
        lines += [f'<tr><th scope="row">{escape(name)}</th>{_cells("td", values)}</tr>' for name, *values in rows]
        lines.append("</tbody></table></div>")
    return [*lines, *(f"<p>{escape(sentence)}</p>" for sentence in section.said), "</section>"]


def _facts(rows: Iterable[tuple[str, str]]) -> list[str]:
    return ['<dl class="facts">', *(f"<div><dt>{escape(name)}</dt><dd>{escape(value)}</dd></div>" for name, value in rows), "</dl>"]


def _pairs(rows: Iterable[tuple[str, str]]) -> list[str]:
    """A table of two columns."""
    return ['<div class="wide"><table class="plain"><tbody>', *(f"<tr>{_cells('td', row)}</tr>" for row in rows), "</tbody></table></div>"]


def _cells(tag: str, texts: Iterable[str]) -> str:
    return "".join(f"<{tag}>{escape(text)}</{tag}>" for text in texts)


def _picture(caption: str, data: bytes, wide: bool = False) -> str:
    caption, source = escape(caption), base64.b64encode(data).decode("ascii")
    image = f'<img alt="{caption}" src="data:image/png;base64,{source}">'
    image = f'<div class="wide">{image}</div>' if wide else image
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


def _judged(report: Report) -> list[str]:
    """What the metrics say."""
    first = next(iter(report.metrics.values()))
    counted = what_counted(first, report.frames).replace("cm2", "cm\N{SUPERSCRIPT TWO}")
    counted = counted if report.frames is None else f"Numbers are {counted}."
    best = "<strong>Highlighted</strong>: the best of each row." if len(report.metrics) > 1 else ""
    return [
        "<section>",
        "<h2>How clearly, sharply and completely bone is shown</h2>",
        f"<p>{escape(counted)} {best}</p>",
        *_metrics_table(report),
        "<h3>Definitions</h3>",
        *_definitions(report),
        "</section>",
    ]


def _metrics_table(report: Report) -> list[str]:
    names = list(report.metrics)
    numbers = {name: result.to_dict() for name, result in report.metrics.items()}
    notes = {name: number for number, name in enumerate([*OF_SURFACE, *OF_VOLUME], 1)}
    headings = "".join(f'<th scope="col">{escape(name)}</th>' for name in names)
    lines = [
        '<div class="wide">',
        f'<table class="metrics" style="--volumes: {len(names)}">',
        f"<thead><tr><td></td>{headings}</tr></thead>",
    ]
    groups = {label: {f"{part}_{name}": name for name in OF_SURFACE} for part, label in PARTS.items()}
    groups["Whole volume"] = {name: name for name in OF_VOLUME}
    for label, keys in groups.items():
        heading = "All reachable bone" if label == PARTS["bone"] and report.frames is not None else label
        lines += ["<tbody>", f'<tr class="group"><th scope="rowgroup">{heading}</th><td colspan="{len(names)}"></td></tr>']
        for key, name in keys.items():
            unit = f' <span class="unit">{QUANTITIES[key].unit}</span>' if QUANTITIES[key].unit else ""
            note = f'<sup><a href="#note-{notes[name]}">{notes[name]}</a></sup>'
            best = best_of(key, report.metrics)
            cells = (_cell(cell(key, numbers[column][key]), column in best) for column in names)
            lines.append(f'<tr><th scope="row">{QUANTITIES[key].label}{unit}{note}</th>{"".join(cells)}</tr>')
        lines.append("</tbody>")
    return [*lines, "</table>", "</div>"]


def _cell(text: str, is_best: bool) -> str:
    text = DASH if text == NOT_KNOWN else text.replace("-", "\N{MINUS SIGN}")
    return f'<td class="best"><strong>{text}</strong></td>' if is_best else f"<td>{text}</td>"


def _definitions(report: Report) -> list[str]:
    quantities = [*OF_SURFACE.values(), *OF_VOLUME.values()]
    lines = [f'<li id="note-{n}"><b>{q.label}</b>. {escape(q.definition)}</li>' for n, q in enumerate(quantities, 1)]
    reachable = f"Reachable: a beam of the sweep meets the surface within {GRAZING_DEG:g}\N{DEGREE SIGN} of its normal, no bone before it. "
    parts = (
        "Everything is measured along the normals of the true surface, which comes from the segmentation. "
        f"{reachable if report.frames is not None else ''}Oblique: the best such angle is beyond {OBLIQUE_DEG:g}\N{DEGREE SIGN}. "
        "Interspinous borders: edges of spinous processes and laminae that face the next vertebra. "
        f"A dash ({DASH}): cannot be told."
    )
    return ['<ol class="notes">', *lines, "</ol>", f'<p class="notes">{escape(parts)}</p>']


def _provenance(report: Report) -> list[str]:
    facts = {**report.facts, "Software": ", ".join(f"{name} {version}" for name, version in report.versions.items())}
    lines = ["<section>", "<h2>Where this comes from</h2>", *_facts(facts.items()), '<div class="pair">']
    lines += ["<div>", "<h3>Settings</h3>", *_settings(report.settings, report.metrics), "</div>"]
    if report.inputs:
        lines += ["<div>", "<h3>Input files</h3>", *_pairs((name, _size(size)) for name, size in report.inputs), "</div>"]
    return [*lines, "</div>", "</section>"]


def _settings(settings: dict[str, Recipe], volumes: Iterable[str]) -> list[str]:
    """Each parameter once where all methods share its value, else by method; and the volumes whose settings are not known."""
    unknown = [name for name in volumes if name not in settings]
    notes = [f"<p>Not known of {escape(', '.join(unknown))}: a volume that AIFRecon did not write does not say it.</p>"] if unknown else []
    if not settings:
        return notes
    rows = [("method", ", ".join(dict.fromkeys(str(chosen.method) for chosen in settings.values())))]
    for spec in fields(Recipe):
        if spec.name == "method" or all(getattr(chosen, spec.name) is None for chosen in settings.values()):
            continue
        values = {name: _setting(getattr(chosen, spec.name), spec.metadata["unit"]) for name, chosen in settings.items()}
        shared = len(set(values.values())) == 1
        rows.append((spec.name, next(iter(values.values())) if shared else "; ".join(f"{name}: {value}" for name, value in values.items())))
    return [*_pairs(rows), *notes]


def _setting(value: object, unit: str) -> str:
    if value is None:
        return "automatic"
    if isinstance(value, bool):
        return "on" if value else "off"
    numbers = value if isinstance(value, tuple) else (value,)
    return " x ".join(f"{n:g}" if isinstance(n, int | float) else str(n) for n in numbers) + (f" {unit}" if unit else "")


def _size(size: int) -> str:
    for unit, scale in (("MB", 1e6), ("kB", 1e3)):
        if size >= scale:
            return f"{size / scale:.1f} {unit}"
    return f"{size} bytes"

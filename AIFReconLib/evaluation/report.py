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

STYLE = Path(__file__).with_name("page.css").read_text("utf-8")
"""Of every page that we write."""


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
<style>
{STYLE}</style>
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
    best = "<strong>Highlighted</strong>: the best of each row." if len(report.metrics) > 1 else ""
    return [
        "<section>",
        "<h2>How clearly, sharply and completely bone is shown</h2>",
        f"<p>{escape(f'Numbers are {counted}.')} {best}</p>",
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

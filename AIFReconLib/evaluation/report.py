"""One HTML page that shows what was measured and where it comes from, and needs nothing but itself."""

from __future__ import annotations

import base64
import platform
from collections.abc import Iterable
from dataclasses import dataclass, field, fields
from pathlib import Path

import numpy
import scipy

from .. import __version__
from ..errors import OutputError
from ..io.disk.atomic import write_text
from ..io.disk.regular_files import size_of
from ..recipe.recipe import Recipe
from .metrics import OBLIQUE_DEG
from .quantities import NOT_KNOWN, OF_SURFACE, OF_VOLUME, PARTS, QUANTITIES, BoneMetrics, achieved, best_of, cell, what_counted
from .visibility import GRAZING_DEG

DASH = "\N{EN DASH}"

STYLE = Path(__file__).with_name("page.css").read_text("utf-8")
"""Of every page that we write."""

TEMPLATE = Path(__file__).with_suffix(".html").read_text("utf-8")


@dataclass(frozen=True)
class Section:
    """A part of a page in its author's words.

    Parameters
    ----------
    rows : tuple of (str, str)
        Names and values.
    lines : tuple of str
        Sentences.
    table : tuple of tuple of str
        The first row holds the headings, the first column names.
    pictures : tuple of (str, bytes)
        Captions, and PNG or SVG files.
    """

    title: str
    rows: tuple[tuple[str, str], ...] = ()
    lines: tuple[str, ...] = ()
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
    """Names and sizes (bytes) of files and folders, for `Report.inputs`; None is passed over."""
    return tuple((path.name, size_of(path)) for path in paths if path is not None)


def write_report(path: str | Path, report: Report) -> None:
    """Write the page, completely or not at all; an OutputError where it cannot be written."""
    write_text(path, report_html(report))


def report_html(report: Report) -> str:
    """One self-contained HTML page: figure, table, definitions, provenance. The same report gives the same page."""
    try:
        from jinja2 import Environment
    except ImportError:
        raise OutputError("A page takes the Python package jinja2. Install it with: pip install jinja2") from None
    environment = Environment(autoescape=True, trim_blocks=True)
    environment.filters["uri"] = _uri
    metrics = report.metrics
    numbers = {name: result.to_dict() for name, result in metrics.items()}
    notes = {name: number for number, name in enumerate([*OF_SURFACE, *OF_VOLUME], 1)}
    labels = PARTS if report.frames is None else {**PARTS, "bone": "All bone that beams met"}
    groups = [(label, [(f"{part}_{name}", notes[name]) for name in OF_SURFACE]) for part, label in labels.items()]

    def shown(key: str, name: str) -> str:
        text = cell(key, numbers[name][key])
        return DASH if text == NOT_KNOWN else text.replace("-", "\N{MINUS SIGN}")

    page = environment.from_string(TEMPLATE).render(
        page=report,
        style=STYLE,
        summary=report.summary or (achieved(metrics, report.frames) if metrics else ""),
        counted=what_counted(next(iter(metrics.values())), report.frames).replace("cm2", "cm\N{SUPERSCRIPT TWO}") if metrics else "",
        groups=[*groups, ("Whole volume", [(name, notes[name]) for name in OF_VOLUME])],
        quantities=QUANTITIES,
        best_of=best_of,
        shown=shown,
        defined=[*OF_SURFACE.values(), *OF_VOLUME.values()],
        grazing=f"{GRAZING_DEG:g}",
        oblique=f"{OBLIQUE_DEG:g}",
        provenance=[*report.facts.items(), ("Software", ", ".join(f"{name} {version}" for name, version in report.versions.items()))],
        settings=_settings(report.settings),
        unknown=[name for name in metrics if name not in report.settings],
        inputs=[(name, _size(size)) for name, size in report.inputs],
    )
    return f"{page}\n"


def _uri(picture: bytes) -> str:
    """A PNG or SVG file as an address that holds it."""
    return f"data:image/{'svg+xml' if picture.startswith(b'<svg') else 'png'};base64,{base64.b64encode(picture).decode('ascii')}"


def _settings(settings: dict[str, Recipe]) -> list[tuple[str, str]]:
    """Each parameter once where all methods share its value, else by method."""
    if not settings:
        return []
    rows = [("method", ", ".join(dict.fromkeys(str(chosen.method) for chosen in settings.values())))]
    for spec in fields(Recipe):
        if spec.name == "method" or all(getattr(chosen, spec.name) is None for chosen in settings.values()):
            continue
        values = {name: _setting(getattr(chosen, spec.name), spec.metadata["unit"]) for name, chosen in settings.items()}
        shared = len(set(values.values())) == 1
        rows.append((spec.name, next(iter(values.values())) if shared else "; ".join(map(": ".join, values.items()))))
    return rows


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

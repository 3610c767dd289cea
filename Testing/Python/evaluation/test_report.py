"""The report: a page that stands alone, agrees with the CSV, and shows whatever it is given as text."""

from __future__ import annotations

import csv
import io
import re
import unicodedata
from dataclasses import fields, replace
from xml.etree import ElementTree

import numpy as np
import pytest

from AIFReconLib.compounding.methods.table import METHODS
from AIFReconLib.evaluation.quantities import (
    OF_SURFACE,
    OF_VOLUME,
    PARTS,
    QUANTITIES,
    BoneMetrics,
    SurfaceMetrics,
    achieved,
    best_of,
    metrics_csv,
)
from AIFReconLib.evaluation.report import Report, report_html, software_versions
from AIFReconLib.recipe.recipe import ReconstructionSettings

PNG = b"\x89PNG\r\n\x1a\nnot really"


def page_of(report) -> ElementTree.Element:
    """The page as a browser reads it; an error where something is left open."""
    return ElementTree.fromstring(re.sub(r"(<(?:meta|img)\b[^>]*)>", r"\1/>", report_html(report)))


def metrics_of(page) -> dict[str, list[str]]:
    """The cells of the metrics table: {key: [text per volume]}, read from its groups and labels."""
    found, prefixes = {}, {label: f"{part}_" for part, label in {**PARTS, "bone": "All bone that beams met"}.items()}
    for heading, *rows in page.iterfind(".//table[@class='metrics']/tbody"):
        prefix = prefixes.get(heading[0].text, "")
        keys = {quantity.label: name for name, quantity in (OF_SURFACE if prefix else OF_VOLUME).items()}
        for label, *cells in rows:
            found[prefix + keys[label.text.strip()]] = ["".join(cell.itertext()) for cell in cells]
    return found


def numbers(seed, **changes) -> BoneMetrics:
    rng = np.random.default_rng(seed)

    def part():
        return SurfaceMetrics(*(float(value) for value in rng.uniform(-1, 1, len(fields(SurfaceMetrics)))))

    return replace(BoneMetrics(part(), part(), part(), *(float(value) for value in rng.uniform(0, 9, 5))), **changes)


@pytest.fixture
def metrics():
    return {method: numbers(seed) for seed, method in enumerate(METHODS)}


@pytest.fixture
def report(metrics):
    settings = {method: ReconstructionSettings(method=method, spacing=1.0, alpha=0.1 if method == "aif" else 0.3) for method in METHODS}
    return Report(
        title="A patient",
        date="2031-02-03",
        metrics=metrics,
        frames=270,
        inputs=(("sweep.igs.mha", 12_345_678), ("ct.nrrd", 2_000)),
        facts={"Patient": "simulated, seed 4"},
        settings=settings,
        versions=software_versions(),
        figure_png=PNG,
        figure_caption="Cuts",
    )


def test_the_page_says_what_the_csv_says(report, metrics):
    rows = list(csv.DictReader(io.StringIO(metrics_csv(metrics, 270))))
    assert [row["volume"] for row in rows] == list(METHODS)
    shown_of = metrics_of(page_of(report))
    assert set(shown_of) == set(QUANTITIES)
    for key, cells in shown_of.items():
        for row, text in zip(rows, cells, strict=True):
            shown = float(text.replace("\N{MINUS SIGN}", "-").rstrip("%")) / (100 if text.endswith("%") else 1)
            digits = len(text.rstrip("%").partition(".")[2]) + (2 if text.endswith("%") else 0)
            assert shown == pytest.approx(float(row[key]), abs=0.51 * 10.0**-digits), (key, row["volume"])


def test_what_is_not_known_is_a_dash_on_the_page_and_empty_in_the_csv(report):
    unknown = replace(numbers(1), shadow_mean=float("nan"))
    page = page_of(replace(report, metrics={"a": unknown, "b": numbers(2)}))
    assert metrics_of(page)["shadow_mean"][0] == "\N{EN DASH}"
    assert next(csv.DictReader(io.StringIO(metrics_csv({"a": unknown}, 3))))["shadow_mean"] == ""


def test_a_hostile_name_is_text_and_no_markup(report):
    name = "<script>alert('x')</script>\"><img src=x onerror=y>&amp;"
    hostile = replace(
        report,
        title=name,
        date=name,
        metrics={name: numbers(1), "b": numbers(2)},
        inputs=((name, 3),),
        facts={name: name},
        settings={name: ReconstructionSettings(alpha=0.2), "b": ReconstructionSettings()},
        versions={name: name},
        figure_caption=name,
    )
    page = page_of(hostile)
    assert [each.tag for each in page.iter() if each.tag in ("script", "img")] == ["img"]
    assert name in [each.text for each in page.iter("th")]


def test_the_page_asks_for_nothing_from_elsewhere(report):
    html, asking = report_html(report), ("src", "href", "data", "action", "srcset")
    links = [value for each in page_of(report).iter() for name, value in each.items() if name in asking]
    assert [link for link in links if not link.startswith(("data:image/png;base64,", "#"))] == []
    assert re.findall(r"url\(|@import|https?:|<script|<link|javascript:", html) == []


# ---- what was achieved


def showing(coverage, cnr):
    part = SurfaceMetrics(1.0, 1.0, cnr, 0.5, 1.0, 0.0, 0.0, coverage)
    return BoneMetrics(part, part, part, 1.0, 1.0, 1.0, 0.5, 0.5)


def test_what_was_achieved_is_a_sentence_of_the_best_and_the_average(report):
    metrics = {"average": showing(0.397, 1.63), "aif": showing(0.35, 1.5), "weighted": showing(0.766, 5.81)}
    said = achieved(metrics, 270)
    assert said == (
        "weighted shows 77% of the bone that beams met, average 40%. Bone is 5.8 standard deviations brighter than the tissue "
        "before it, with average 1.6."
    )
    assert said in page_of(replace(report, metrics=metrics)).itertext()


def test_what_one_volume_achieved_is_compared_with_nothing():
    said = achieved({"mine.nrrd": showing(0.5, 2.0), "unknown.nrrd": showing(float("nan"), 1.0)}, None)
    expected = (
        "mine.nrrd shows 50% of the bone where the volume was measured. It is 2.0 standard deviations brighter than the tissue before it."
    )
    assert said == expected
    assert achieved({"a": showing(float("nan"), 1.0)}, None) == "How much bone is shown cannot be told."


# ---- which is best


@pytest.mark.parametrize(
    ("key", "values", "expected"),
    [
        ("speckle_snr", (1.0, 3.0, 2.0), "b"),
        ("shadow_mean", (9.0, 3.0, 2.0), "c"),
        ("shadow_mean", (float("nan"), 3.0, 2.0), "c"),
        ("speckle_snr", (2.001, 2.004, 1.0), "ab"),
        ("speckle_snr", (2.0, 2.0, 2.0), ""),
        ("shadow_mean", (float("nan"),) * 3, ""),
    ],
    ids=["most", "least", "a dash is never best", "equal as printed", "all equal", "nothing known"],
)
def test_the_best_are_those_that_look_best(key, values, expected):
    metrics = {name: replace(numbers(0), **{key: value}) for name, value in zip("abc", values, strict=True)}
    assert best_of(key, metrics) == set(expected)


# ---- table


@pytest.mark.parametrize("name", ["=cmd|' /C calc'!A0", "@SUM(1)", "-2+3", "+1", "\tx=1", "\uff1d1+1", " =1"])
def test_a_name_is_no_formula_in_a_spreadsheet(metrics, name):
    (first, *_) = metrics.values()
    (row,) = csv.DictReader(io.StringIO(metrics_csv({name: first}, 3)))
    assert not unicodedata.normalize("NFKC", row["volume"]).strip().startswith(tuple("=@-+"))
    # Numbers stay numbers
    assert float(row["shadow_mean"]) == pytest.approx(first.to_dict()["shadow_mean"], rel=1e-5)

"""The study's numbers as a page of tables."""

from __future__ import annotations

from collections.abc import Iterable

from AIFReconLib.compounding.methods.table import COMPARED_METHODS, is_own_method

from .method_cases import (
    BOTH,
    CONTROLLED,
    GRAY_SHADOWS,
    MISREGISTRATIONS,
    MULTI_FRAMES,
    OF_MULTI,
    OURS,
    PLAIN,
    REFERENCES,
    SIGMA,
    SINGLE_FRAMES,
    SPACING,
    WITHOUT_BONE,
    Row,
)
from .patients import Spread, spread_of, table_head, table_line

COLUMNS = (
    ("CNR", "bone_cnr", 1),
    ("CNR oblique", "oblique_cnr", 1),
    ("detect.", "bone_detectability", 1),
    ("coverage %", "bone_coverage", 100),
    ("coverage oblique %", "oblique_coverage", 100),
    ("interspinous %", "interspinous_coverage", 100),
    ("thickness mm", "bone_thickness", 1),
    ("off mm", "bone_localization_error", 1),
    ("shadow", "shadow_mean", 1),
    ("speckle SNR", "speckle_snr", 1),
)

WRONG = ("CT of another patient", "CT one level off", "CT lacks a process")

PROCESS = ("right CT, that process", "CT lacks it, that process", "no process, right CT", "no process, CT shows one")


def study_page(rows: list[Row]) -> str:
    """The tables of the study as Markdown.

    Parameters
    ----------
    rows : list of Row
        Of all patients.
    """
    patients = len({row.seed for row in rows})
    multi = {"scan": "multi-angle", "condition": "exact"}
    average = ("average (any CT)", {**multi, "method": PLAIN})
    sections = {
        "Exact poses and CT, multi-angle": _exact(rows, "multi-angle"),
        "Exact poses and CT, single-angle": _exact(rows, "single-angle"),
        "On the bone that average and weighted both show": _table(
            rows,
            [
                (f"{scan}, {method}", {"scan": scan, "condition": BOTH, "method": method})
                for scan in ("multi-angle", "single-angle")
                for method in (PLAIN, OURS)
            ],
        ),
        "Single against multi-angle, on the bone that multi-angle reaches": _table(
            rows,
            [(f"single-angle, {method}", {"scan": OF_MULTI, "method": method}) for method in (PLAIN, OURS)]
            + [(f"multi-angle, {m}", {**multi, "method": m, "direction": d}) for m, d in ((PLAIN, ""), (OURS, "gradient"))],
        ),
        "A misregistered CT": _table(
            rows,
            [average]
            + [
                (f"{condition}, {method}", {**multi, "condition": condition, "method": method, "direction": "gradient"})
                for condition in ("exact", *MISREGISTRATIONS)
                for method in COMPARED_METHODS[1:]
            ]
            + [
                (f"{condition}, {_called(method)}", {**multi, "condition": condition, "method": method})
                for condition in ("exact", *MISREGISTRATIONS)
                for method in _own(rows, "CT 1 mm off")
            ],
        ),
        "Tracker noise of 0.5 mm and 1 degree": _table(
            rows,
            [
                (_called(method), {**multi, "condition": "tracker noise", "method": method})
                for method in (*COMPARED_METHODS, *_own(rows, "tracker noise"))
            ],
        ),
        "Shadows that are gray, as real ones are": _table(
            rows,
            [
                (f"{condition}, {_called(row.method)}", {**multi, "condition": condition, "method": row.method, "direction": row.direction})
                for row in {row.method: row for row in rows if row.condition == GRAY_SHADOWS}.values()
                for condition in ("exact", GRAY_SHADOWS)
            ],
        ),
        "A wrong CT": _table(rows, [average, *_conditions(WRONG, CONTROLLED)]),
        "One spinous process that the CT lacks, or shows where there is none": _table(rows, _conditions(PROCESS, (PLAIN, *CONTROLLED))),
    }
    head = (
        f"{patients} simulated patients; medians, with quartiles in brackets. Multi-angle: {MULTI_FRAMES} frames in nine passes; "
        f"single-angle: {SINGLE_FRAMES} frames in one. Voxels of {SPACING:g} mm, bone map of {SIGMA:g} mm. The last table is measured on "
        "the surface of one process alone: where the scan has none, whatever is covered is false bone."
    )
    return "\n\n".join([head, *(f"### {title}\n\n{table}" for title, table in sections.items())]) + "\n"


def _called(method: str) -> str:
    """What a method is called in a table: one of others by its words."""
    return next((words for words, name in REFERENCES.items() if name == method), method)


def _own(rows: list[Row], condition: str) -> list[str]:
    """The methods of one's own, and of others, that were tried in a condition."""
    return list(dict.fromkeys(row.method for row in rows if row.condition == condition and is_own_method(row.method)))


def _conditions(conditions: Iterable[str], methods: Iterable[str]) -> list[tuple[str, dict[str, str]]]:
    return [(f"{condition}, {method}", {"condition": condition, "method": method}) for condition in conditions for method in methods]


def _exact(rows: list[Row], scan: str) -> str:
    wanted = {"scan": scan, "condition": "exact"}
    lines = [(method, {**wanted, "method": method, "direction": ""}) for method in WITHOUT_BONE]
    for method in COMPARED_METHODS[1:]:
        lines += [(f"{method}, {d}", {**wanted, "method": method, "direction": d}) for d in ("gradient", "surface")]
    lines += [(_called(method), {**wanted, "method": method}) for method in _own(rows, "exact")]
    return _table(rows, lines)


def _table(rows: list[Row], lines: Iterable[tuple[str, dict[str, str]]]) -> str:
    text = table_head(label for label, _, _ in COLUMNS)
    text += [table_line(name, (_cell(spread_of(rows, metric, **wanted), scale) for _, metric, scale in COLUMNS)) for name, wanted in lines]
    return "\n".join(text)


def _cell(spread: Spread, scale: float) -> str:
    if spread.median != spread.median:
        return "-"
    form = ".0f" if scale == 100 else ".2f"
    low, median, high = (format(scale * value, form) for value in (spread.low, spread.median, spread.high))
    return f"{median} [{low}, {high}]"


SHORT = ("CNR", "CNR oblique", "coverage %", "coverage oblique %", "interspinous %", "thickness mm", "off mm", "speckle SNR")
"""Columns of the tables in docs/study.md, which have medians alone."""

OF_WRONG = SHORT[:5]


def in_the_pages(rows: list[Row]) -> dict[str, str]:
    """What docs/study.md and the README show, by the names of the files in docs/measured."""
    multi = {"scan": "multi-angle", "condition": "exact"}
    lines = [(method, {**multi, "method": method, "direction": ""}) for method in WITHOUT_BONE]
    lines += [(method, {**multi, "method": method, "direction": "gradient"}) for method in COMPARED_METHODS[1:]]
    lines += [(_called(method), {**multi, "method": method}) for method in REFERENCES.values()]
    single = {"scan": "single-angle", "condition": "exact"}
    lines += [(f"one angle only: {m}", {**single, "method": m, "direction": d}) for m, d in ((PLAIN, ""), (OURS, "gradient"))]
    ours = {"scan": "multi-angle", "method": OURS}
    wrong = [("right CT", {**ours, "condition": "exact", "direction": "gradient"})]
    wrong += [(name, {**ours, "condition": name, "direction": "gradient"}) for name in MISREGISTRATIONS]
    wrong += [(name, {**ours, "condition": name}) for name in (*WRONG, "tracker noise", GRAY_SHADOWS)]
    wrong.append(("average, which asks no CT", {**multi, "method": PLAIN}))
    process = [
        (name, [{"condition": name, "method": method} for method in (PLAIN, "aif-compensated", OURS)])
        for name in PROCESS
        if name != "no process, right CT"
    ]
    return {
        "study-proof": _proof(rows, multi),
        "study-methods": _medians(rows, lines, SHORT),
        "study-wrong-ct": _medians(rows, wrong, OF_WRONG),
        "study-process": "\n".join(
            [
                *table_head([PLAIN, "aif-compensated", OURS]),
                *(table_line(name, (_median(rows, "bone_coverage", 100, each) for each in methods)) for name, methods in process),
            ]
        ),
    }


def _proof(rows: list[Row], multi: dict[str, str]) -> str:
    shown = [_median(rows, "bone_coverage", 100, {**multi, "method": m, "direction": d}) for m, d in ((OURS, "gradient"), (PLAIN, ""))]
    patients = len({row.seed for row in rows})
    return f"On {patients} simulated patients `{OURS}` shows {shown[0]}% of the bone that beams reach, the plain average {shown[1]}%."


def _medians(rows: list[Row], lines: Iterable[tuple[str, dict[str, str]]], wanted: tuple[str, ...]) -> str:
    columns = [column for column in COLUMNS if column[0] in wanted]
    text = table_head(label for label, _, _ in columns)
    text += [table_line(name, (_median(rows, metric, scale, each) for _, metric, scale in columns)) for name, each in lines]
    return "\n".join(text)


def _median(rows: list[Row], metric: str, scale: float, wanted: dict[str, str]) -> str:
    return _cell(spread_of(rows, metric, **wanted), scale).partition(" ")[0]

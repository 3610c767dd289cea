"""The study's numbers as tables."""

from __future__ import annotations

from collections.abc import Iterable

from measured import table

from AIFReconLib.compounding.methods.table import METHODS, is_own_method

from .method_cases import (
    KINDS,
    LEVEL,
    MULTI_FRAMES,
    NO_BONE,
    NOISE,
    ONE_ANGLE,
    OTHER,
    OURS,
    PAPER,
    PHANTOM,
    PLAIN,
    SHAPES,
    SHIFTS,
    SPACING,
    WITHOUT_CT,
    Row,
)
from .patients import quartiles

COLUMNS = (
    ("CNR", "bone_cnr", 1),
    ("CNR oblique", "oblique_cnr", 1),
    ("coverage %", "bone_coverage", 100),
    ("coverage oblique %", "oblique_coverage", 100),
    ("interspinous %", "interspinous_coverage", 100),
    ("precision %", "precision", 100),
    ("blocked called free %", "lines_called_free", 100),
    ("thickness mm", "bone_thickness", 1),
    ("off mm", "bone_localization_error", 1),
    ("speckle SNR", "speckle_snr", 1),
)

RIGHT = "right CT"
OF_WRONG = tuple(column for column in COLUMNS if column[1] in ("bone_cnr", "bone_coverage", "precision", "lines_called_free"))


def study_page(rows: list[Row]) -> str:
    """The tables of the pages as Markdown, medians with quartiles."""
    head = f"{MULTI_FRAMES} frames in nine passes, voxels of {SPACING:g} mm; medians, with quartiles in brackets."
    return "\n\n".join([head, *(f"## {title}\n\n{table}" for title, table in _tables(rows, _quartiles).items())]) + "\n"


def in_the_pages(rows: list[Row]) -> dict[str, str]:
    """What docs/study.md and the README show, by the names of the files in docs/measured."""
    return {"study-proof": _proof(rows), **_tables(rows, _median)}


def _tables(rows: list[Row], cell) -> dict[str, str]:
    return {
        "study-methods": _of_methods(rows, SHAPES, cell),
        "study-methods-phantom": _of_methods(rows, PHANTOM, cell),
        "study-wrong-ct": _of_wrong(rows, SHAPES, cell),
        "study-no-bone": _of_nothing(rows, cell),
    }


def _of_methods(rows: list[Row], kind: str, cell) -> str:
    own = dict.fromkeys(row.method for row in rows if is_own_method(row.method))
    lines = [(method, {"condition": RIGHT, "method": method}) for method in (*METHODS, WITHOUT_CT, *own)]
    lines += [(f"{ONE_ANGLE}: {method}", {"condition": ONE_ANGLE, "method": method}) for method in (PLAIN, OURS)]
    return _table(rows, kind, lines, COLUMNS, cell)


def _of_wrong(rows: list[Row], kind: str, cell) -> str:
    lines = [
        (f"{condition}, {method}", {"condition": condition, "method": method})
        for condition in (RIGHT, *SHIFTS, LEVEL, OTHER)
        for method in (PAPER, OURS)
    ]
    lines += [(f"{NOISE}, {method}", {"condition": NOISE, "method": method}) for method in (PLAIN, OURS)]
    lines.append((f"{PLAIN}, which asks no CT", {"condition": RIGHT, "method": PLAIN}))
    return _table(rows, kind, lines, OF_WRONG, cell)


def _of_nothing(rows: list[Row], cell) -> str:
    def cells(method: str) -> Iterable[str]:
        return (cell(quartiles(rows, "bone_coverage", kind=kind, condition=NO_BONE, method=method), 100) for kind in KINDS)

    return table(("", *KINDS), ([method, *cells(method)] for method in (PLAIN, PAPER, OURS)))


def _proof(rows: list[Row]) -> str:
    spreads = (quartiles(rows, "bone_coverage", kind=SHAPES, condition=RIGHT, method=method) for method in (OURS, WITHOUT_CT, PLAIN))
    shown = [_median(spread, 100) for spread in spreads]
    patients = len({row.seed for row in rows if row.kind == SHAPES})
    return (
        f"In {patients} simulated patients of real shape `{OURS}` shows {shown[0]}% of the bone that beams reach, "
        f"without a CT {shown[1]}%, the plain average {shown[2]}%."
    )


def _table(rows: list[Row], kind: str, lines: Iterable[tuple[str, dict[str, str]]], columns, cell) -> str:
    def cells(wanted: dict[str, str]) -> Iterable[str]:
        return (cell(quartiles(rows, metric, kind=kind, **wanted), scale) for _, metric, scale in columns)

    return table(["", *(label for label, _, _ in columns)], ([name, *cells(wanted)] for name, wanted in lines))


def _quartiles(spread: list[float], scale: float) -> str:
    low, median, high = (format(scale * value, ".0f" if scale == 100 else ".2f") for value in spread)
    return "-" if median == "nan" else f"{median} [{low}, {high}]"


def _median(spread: list[float], scale: float) -> str:
    return _quartiles(spread, scale).partition(" ")[0]

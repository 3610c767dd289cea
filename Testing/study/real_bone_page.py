"""The numbers of the study on real bone as a page of tables."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from AIFReconLib.compounding.methods.average import AVERAGE
from AIFReconLib.compounding.methods.table import BONE_METHODS

from .patients import table_head, table_line
from .real_bone_cases import ALL, CHOOSING, HOLE_LIMIT, SHIFTS, SIGMA, SPACING, TURNS, WIDTHS, Row
from .real_bone_measures import BRIGHT, ELSEWHERE, INCIDENCES

SOURCE = (
    "Ultrasound and CT: the example record of UltraBones100k (Wu, Cavalcanti, Seibold and others), published under "
    "[CC BY 4.0](https://creativecommons.org/licenses/by/4.0/); reconstructed here, which changed the images."
)
COLUMNS = (
    ("CNR", "bone_cnr", ".2f"),
    ("CNR oblique", "oblique_cnr", ".2f"),
    ("coverage %", "bone_coverage", ".1%"),
    ("coverage oblique %", "oblique_coverage", ".1%"),
    ("thickness mm", "bone_thickness", ".2f"),
    ("off mm", "bone_localization_error", ".2f"),
    ("shadow", "shadow_mean", ".1f"),
    ("speckle SNR", "speckle_snr", ".2f"),
    (f"on bone above {BRIGHT}", f"precision_{BRIGHT}", ".1%"),
    ("inside it", f"inside_{BRIGHT}", ".1%"),
    ("outside", f"outside_{BRIGHT}", ".1%"),
)
MISPLACED = ("CNR", "CNR oblique", "coverage %", "coverage oblique %", "off mm", f"on bone above {BRIGHT}")
IN_PLACE = "CT in place"
METHODS = (AVERAGE.name, *BONE_METHODS)
OURS = "weighted"
SHOWN = (120, 150, BRIGHT, 210)


def real_bone_page(rows: list[Row], angles: str = "") -> str:
    """The tables as Markdown; `angles` is that of `angle_tables`."""
    sections = {
        "CT in place, all frames": _table(COLUMNS, [(row.method, row) for row in rows if _exact(row)]),
        "CT in place, single passes": _table(
            COLUMNS, [(f"{row.frames}, {row.method}", row) for row in rows if row.condition == IN_PLACE and row.frames != ALL]
        ),
        "By the best angle of incidence": _by_incidence(rows),
        "Bright voxels": _bright(rows),
        "Width of the bone map": _table(
            COLUMNS,
            [
                (f"{_width(row)}, {row.method}", row)
                for sigma in sorted({*WIDTHS, SIGMA})
                for row in rows
                if row.condition == IN_PLACE and row.frames == ALL and row.sigma == sigma
            ],
        ),
        "A misplaced CT": _misplaced(rows),
        **({"Real bone by the angle, and its shadow": angles} if angles else {}),
    }
    head = (
        f"Voxels of {SPACING:g} mm, holes to {HOLE_LIMIT:g} mm, bone map of {SIGMA:g} mm where nothing else is said, of "
        "weighted by how well CT and sweep agree. Of the voxels above "
        "a gray level within 8 mm of the bone, so many lie within 1.5 mm of its surface, deeper inside it, and farther outside. "
        f"confidence-weighted, incidence-weighted and largest contrast are methods of others (`reference_methods.py`). {SOURCE}"
    )
    return "\n\n".join([head, *(f"### {title}\n\n{table}" for title, table in sections.items())]) + "\n"


def _exact(row: Row) -> bool:
    return row.condition == IN_PLACE and row.frames == ALL and row.sigma in (0.0, SIGMA)


def _width(row: Row) -> str:
    """The width of a row's bone map; `RealBone` lets weighted choose it where nothing else is tried."""
    return "chosen by itself" if row.method in CHOOSING and row.sigma == SIGMA else f"{row.sigma:g} mm"


def _table(columns: Iterable[tuple[str, str, str]], lines: Iterable[tuple[str, Row]]) -> str:
    columns = tuple(columns)
    text = [table_line(name, (_cell(row.metrics[metric], form) for _, metric, form in columns)) for name, row in lines]
    return "\n".join([*table_head(label for label, _, _ in columns), *text])


def _by_incidence(rows: list[Row]) -> str:
    bins = [f"{low} to {high}" for low, high in pairwise(INCIDENCES)]
    text = table_head(bins)
    exact = [row for row in rows if _exact(row)]
    text.append(table_line("cm², of bone reached", (_cell(exact[0].metrics[f"bone_area_{low}"] / 100, ".1f") for low in INCIDENCES[:-1])))
    for label, metric, form in (COLUMNS[2], COLUMNS[0], COLUMNS[4], COLUMNS[5]):
        for row in exact:
            if row.method in METHODS:
                cells = (_cell(row.metrics[f"{metric}_{low}"], form) for low in INCIDENCES[:-1])
                text.append(table_line(f"{label}, {row.method}", cells))
    return "\n".join(text)


def _bright(rows: list[Row]) -> str:
    text = table_head(f"{what} {level}" for level in SHOWN for what in ("on bone above", "of bone shown above"))
    for row in rows:
        if _exact(row):
            numbers = (row.metrics[f"{what}_{level}"] for level in SHOWN for what in ("precision", "shown"))
            text.append(table_line(row.method, (_cell(number, ".1%") for number in numbers)))
    return "\n".join(text)


def _misplaced(rows: list[Row]) -> str:
    """Means over the directions; of false bone beyond average's the mean and the worst."""
    columns = [each for each in COLUMNS if each[0] in MISPLACED]
    text = table_head([*(label for label, _, _ in columns), "false bone", "beyond average's", "at worst"])
    for error in _errors():
        of_error = [row for row in rows if row.condition.startswith(f"CT {error}")]
        for method in METHODS:
            some = [row for row in of_error if row.method == method]
            most = _beyond(rows, some)
            cells = [_cell(float(np.mean([row.metrics[metric] for row in some])), form) for _, metric, form in columns]
            false = float(np.nanmean([row.metrics["false_bone"] for row in some])) if most[0] == most[0] else float("nan")
            text.append(table_line(f"{error}, {method}", [*cells, *(_cell(each, ".1%") for each in (false, *most))]))
    return "\n".join([*text, "", f"False bone: bright where the misplaced CT expects bone {ELSEWHERE:g} mm or more from where it is."])


def _cell(number: float, form: str) -> str:
    return "-" if number != number else format(number, form)


SHORT = tuple(each for each in COLUMNS if each[0] not in ("speckle SNR", "outside"))
OF_WRONG = ("CNR", "coverage %", "coverage oblique %", f"on bone above {BRIGHT}")


def in_the_pages(rows: list[Row]) -> dict[str, str]:
    """What docs/real-bone.md and the README show, by the names of the files in docs/measured."""
    exact = [row for row in rows if _exact(row)]
    bins = [f"{low} to {high} degrees" for low, high in pairwise(INCIDENCES)]
    angles = [table_line("cm², reached", (_cell(exact[0].metrics[f"bone_area_{low}"] / 100, ".1f") for low in INCIDENCES[:-1]))]
    for row in exact:
        if row.method in (AVERAGE.name, "aif-compensated", OURS):
            cells = (_cell(row.metrics[f"bone_coverage_{low}"], ".0%") for low in INCIDENCES[:-1])
            angles.append(table_line(f"coverage, {row.method}", cells))
    shown = {row.method: _cell(row.metrics["bone_coverage"], ".0%") for row in exact}
    return {
        "real-bone-proof": f"On one real bone, a cadaver's fibula, it is {shown[OURS]} and {shown[AVERAGE.name]}.",
        "real-bone-methods": _table(SHORT, [(row.method, row) for row in exact]),
        "real-bone-angles": "\n".join([*table_head(bins), *angles]),
        "real-bone-wrong-ct": _wrong_ct(rows, exact),
    }


def _wrong_ct(rows: list[Row], exact: list[Row]) -> str:
    """`weighted` with the CT in wrong places, means over the directions; false bone beyond average's on the mean and at worst."""
    columns = [each for each in COLUMNS if each[0] in OF_WRONG]
    text = table_head([*(label for label, _, _ in columns), "false bone beyond average's", "at worst"])
    for row in exact:
        if row.method in (AVERAGE.name, OURS):
            name = "right CT" if row.method == OURS else "average, which asks no CT"
            text.append(table_line(name, [*(_cell(row.metrics[metric], form) for _, metric, form in columns), "", ""]))
    for error in _errors():
        some = [row for row in rows if row.condition.startswith(f"CT {error}") and row.method == OURS]
        cells = [_cell(float(np.mean([row.metrics[metric] for row in some])), form) for _, metric, form in columns]
        text.append(table_line(error, [*cells, *(_cell(each, ".1%") for each in _beyond(rows, some))]))
    return "\n".join(text)


def _errors() -> list[str]:
    """The wrong places, as conditions name them."""
    return [*(f"{mm:g} mm" for mm in SHIFTS), *(f"{degrees:g} degrees" for degrees in TURNS)]


def _beyond(rows: list[Row], some: list[Row]) -> tuple[float, float]:
    """False bone of these rows beyond that of average in their conditions: mean and most; NaN where there can be none."""
    average = {row.condition: row.metrics["false_bone"] for row in rows if row.method == AVERAGE.name and row.condition != IN_PLACE}
    beyond = np.array([row.metrics["false_bone"] - average[row.condition] for row in some])
    return (float(np.nanmean(beyond)), float(np.nanmax(beyond))) if np.isfinite(beyond).any() else (float("nan"),) * 2

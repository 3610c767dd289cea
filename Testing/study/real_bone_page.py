"""The numbers of the study on real bone as a page of tables."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from AIFReconLib.compounding.methods.average import AVERAGE

from .patients import table_head, table_line
from .real_bone_cases import IN_PLACE, SHIFTS, TURNS, Row
from .real_bone_measures import BRIGHT, INCIDENCES

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
    (f"on bone above {BRIGHT}", f"precision_{BRIGHT}", ".1%"),
    ("inside it", f"inside_{BRIGHT}", ".1%"),
)
OURS = "weighted"
OF_WRONG = ("CNR", "coverage %", "coverage oblique %", f"on bone above {BRIGHT}")


def real_bone_page(rows: list[Row], angles: str) -> str:
    """The tables as Markdown; `angles` is that of `angle_tables`."""
    tables = in_the_pages(rows)
    sections = {
        "The right CT": tables["real-bone-methods"],
        "By the best angle of incidence": tables["real-bone-angles"],
        "A misplaced CT": tables["real-bone-wrong-ct"],
        "Real bone by the angle, and its shadow": angles,
    }
    return "\n\n".join([SOURCE, *(f"### {title}\n\n{table}" for title, table in sections.items())]) + "\n"


def _methods(exact: list[Row]) -> str:
    lines = [table_line(row.method, (_cell(row.metrics[metric], form) for _, metric, form in COLUMNS)) for row in exact]
    return "\n".join([*table_head(label for label, _, _ in COLUMNS), *lines])


def _cell(number: float, form: str) -> str:
    return "-" if number != number else format(number, form)


def in_the_pages(rows: list[Row]) -> dict[str, str]:
    """What docs/real-bone.md and the README show, by the names of the files in docs/measured."""
    exact = [row for row in rows if row.condition == IN_PLACE]
    bins = [f"{low} to {high} degrees" for low, high in pairwise(INCIDENCES)]
    angles = [table_line("cm², reached", (_cell(exact[0].metrics[f"bone_area_{low}"] / 100, ".1f") for low in INCIDENCES[:-1]))]
    for row in exact:
        if row.method in (AVERAGE.name, "aif-compensated", OURS):
            cells = (_cell(row.metrics[f"bone_coverage_{low}"], ".0%") for low in INCIDENCES[:-1])
            angles.append(table_line(f"coverage, {row.method}", cells))
    shown = {row.method: _cell(row.metrics["bone_coverage"], ".0%") for row in exact}
    return {
        "real-bone-proof": f"On one real bone, a cadaver's fibula, it is {shown[OURS]} and {shown[AVERAGE.name]}.",
        "real-bone-methods": _methods(exact),
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

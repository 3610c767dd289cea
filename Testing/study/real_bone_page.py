"""The numbers of the study on real bone as a page of tables."""

from __future__ import annotations

from collections.abc import Container
from itertools import pairwise

import numpy as np
from measured import shown, table

from AIFReconLib.compounding.methods.average import AVERAGE

from .real_bone_cases import IN_PLACE, SHIFTS, TURNS, Row
from .real_bone_measures import BRIGHT, INCIDENCES

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
HEAD = [label for label, _, _ in COLUMNS]
OURS = "weighted"
OF_WRONG = ("CNR", "coverage %", "coverage oblique %", f"on bone above {BRIGHT}")


def in_the_pages(rows: list[Row]) -> dict[str, str]:
    """What docs/real-bone.md and the README show, by the names of the files in docs/measured."""
    exact = [row for row in rows if row.condition == IN_PLACE]
    areas = (shown(exact[0].metrics[f"bone_area_{low}"] / 100, ".1f") for low in INCIDENCES[:-1])
    covered = [row for row in exact if row.method in (AVERAGE.name, "aif-compensated", OURS)]
    angles = (
        [f"coverage, {row.method}", *(shown(row.metrics[f"bone_coverage_{low}"], ".0%") for low in INCIDENCES[:-1])] for row in covered
    )
    known = {row.method: shown(row.metrics["bone_coverage"], ".0%") for row in exact}
    return {
        "real-bone-proof": f"On one real bone, a cadaver's fibula, it is {known[OURS]} and {known[AVERAGE.name]}.",
        "real-bone-methods": table(["", *HEAD], ([row.method, *_cells([row])] for row in exact)),
        "real-bone-angles": table(
            ["", *(f"{low} to {high} degrees" for low, high in pairwise(INCIDENCES))], [["cm², reached", *areas], *angles]
        ),
        "real-bone-wrong-ct": _wrong_ct(rows, exact),
    }


def _cells(rows: list[Row], labels: Container[str] = HEAD) -> list[str]:
    """The means over rows."""
    return [shown(float(np.mean([row.metrics[metric] for row in rows])), form) for label, metric, form in COLUMNS if label in labels]


def _wrong_ct(rows: list[Row], exact: list[Row]) -> str:
    """`weighted` with the CT in wrong places, means over the directions; false bone beyond average's on the mean and at worst."""
    names = {OURS: "right CT", AVERAGE.name: "average, which asks no CT"}
    lines = [[names[row.method], *_cells([row], OF_WRONG), "", ""] for row in exact if row.method in names]
    for error in (*(f"{mm:g} mm" for mm in SHIFTS), *(f"{degrees:g} degrees" for degrees in TURNS)):
        some = [row for row in rows if row.condition.startswith(f"CT {error}") and row.method == OURS]
        lines.append([error, *_cells(some, OF_WRONG), *(shown(each, ".1%") for each in _beyond(rows, some))])
    return table(["", *OF_WRONG, "false bone beyond average's", "at worst"], lines)


def _beyond(rows: list[Row], some: list[Row]) -> tuple[float, float]:
    """False bone of these rows beyond that of average in their conditions: mean and most; NaN where there can be none."""
    average = {row.condition: row.metrics["false_bone"] for row in rows if row.method == AVERAGE.name and row.condition != IN_PLACE}
    beyond = np.array([row.metrics["false_bone"] - average[row.condition] for row in some])
    return (float(np.nanmean(beyond)), float(np.nanmax(beyond))) if np.isfinite(beyond).any() else (float("nan"),) * 2

"""The numbers that tell how a volume shows bone: what they are called, how they are printed and judged in tables, files and reports.

Computed in `metrics`, which names where they come from.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
import unicodedata
from collections.abc import Collection, Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

NOT_KNOWN = "-"

NEAR = 1.5
"""mm to either side of the surface within which bone must respond."""

TISSUE = (3.0, 8.0)
"""mm before the surface where the tissue is that bone is compared with."""

STANDS_OUT = 3.5
"""Standard deviations of gray within the tissue before the points by which a response must exceed the mean of its own tissue. Where
there is no bone, under 1% of points do so in log-compressed speckle, about 3% in normal noise independent in every voxel."""

SPECKLE_BLOCK = 5.0
"""mm. Side of the cubes in which speckle is measured, small against changes of the tissue."""

SPECKLE_FROM_BONE = 5.0
"""mm that those cubes keep from bone."""

SHADOW_FROM_SURFACE = 3.0
"""mm that shadow keeps from any bone surface, so that the response itself is not counted."""


@dataclass(frozen=True)
class SurfaceMetrics:
    """What one part of the bone surface looks like. Means over points are weighted by area; NaN where nothing can be told.

    Parameters
    ----------
    area : float, mm^2
        Of the part that lies within the volume, measured or not.
    contrast : float, gray levels
        Mean response of bone, the maximum of each profile within 1.5 mm of the surface, less the mean of the tissue 3 to 8 mm before it.
    cnr : float
        Contrast over the standard deviation of that tissue. A maximum lies above a mean: where there is no bone, speckle alone
        gives about 1, and a shadow without an echo less, down to below 0.
    detectability : float, 0 to 1
        Probability that a point's response exceeds the maximum of an equally wide window (3 to 6, 4 to 7 and 5 to 8 mm) of the tissue
        before it. One half is chance, as in speckle without bone; no monotone change of gray levels changes it.
    thickness : float, mm
        Median, over covered points, of the profile's full width at half maximum, the half being between peak and local tissue.
    localization_bias, localization_error : float, mm
        Mean and mean absolute distance of the peak from the surface, over covered points; positive: before it, toward the probe.
    coverage : float, 0 to 1
        Part of the area that is covered: its response is a peak within 1.5 mm of the surface, not the slope of something
        farther, and exceeds the mean of the tissue before it by 3.5 standard deviations of gray within such tissue. Places not
        measured are not covered.
    """

    area: float
    contrast: float
    cnr: float
    detectability: float
    thickness: float
    localization_bias: float
    localization_error: float
    coverage: float


@dataclass(frozen=True)
class BoneMetrics:
    """What a volume shows of bone.

    Parameters
    ----------
    bone : SurfaceMetrics
        All bone that a beam of the sweep met; without a sweep all bone where the volume was measured.
    oblique : SurfaceMetrics
        The part of it whose best angle of incidence is beyond 45 degrees; nothing without a sweep.
    interspinous : SurfaceMetrics
        The part of it that bounds the interspinous gaps; its coverage is the interspinous visibility.
    shadow_mean, shadow_std : float, gray levels
        Where no beam could reach, 3 mm and more from any bone surface: inside bone and, with a sweep, behind it. Noise and clutter.
    speckle_snr : float
        Mean over standard deviation of gray levels in 5 mm cubes of soft tissue away from bone and skin, the median of the cubes.
        1.91 for the amplitudes of fully developed speckle; other values after log compression; averaging raises it.
    lines_area, lines_called_free : float, 0 to 1
        How well the brightest voxel on a straight line from the skin to the canal tells free lines from those that bone blocks: the area
        under the curve, and the share of the blocked ones that look as free as nine in ten free ones do (`evaluation/lines.py`). NaN
        without a sweep, which tells where the skin is, or where labels show no canal.
    """

    bone: SurfaceMetrics
    oblique: SurfaceMetrics
    interspinous: SurfaceMetrics
    shadow_mean: float
    shadow_std: float
    speckle_snr: float
    lines_area: float
    lines_called_free: float

    def to_dict(self) -> dict[str, float]:
        """All numbers by name, those of the parts with the part's name before them: ``oblique_coverage``."""
        flat: dict[str, float] = {}
        for name, value in asdict(self).items():
            flat.update({f"{name}_{key}": number for key, number in value.items()} if isinstance(value, dict) else {name: value})
        return flat


@dataclass(frozen=True)
class _Quantity:
    """One number of `BoneMetrics`: its name, how it is printed and judged, and what it is in a sentence.

    Parameters
    ----------
    label, form, unit : str
        `form` as Python's `format` takes it; a percentage carries its unit itself.
    best : "most", "least", "nearest 0" or ""
    """

    label: str
    form: str
    unit: str
    best: str
    definition: str

    @property
    def digits(self) -> int:
        """After the point, of the number as it is kept: two more for a percentage, which is kept as a share."""
        [digits] = re.findall(r"\.(\d+)", self.form)
        return int(digits) + (2 if self.form.endswith("%") else 0)


_NUMBERS = {
    "near": f"{NEAR:g}",
    "tissue": f"{TISSUE[0]:g} to {TISSUE[1]:g}",
    "stands_out": f"{STANDS_OUT:g}",
    "block": f"{SPECKLE_BLOCK:g}",
    "from_bone": f"{SPECKLE_FROM_BONE:g}",
    "from_surface": f"{SHADOW_FROM_SURFACE:g}",
}
"""In the definitions."""


def _told(part: str) -> dict[str, _Quantity]:
    rows: dict[str, list[str]] = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))[part]
    return {name: _Quantity(row[0], row[1], row[2], row[3], row[4].format(**_NUMBERS)) for name, row in rows.items()}


OF_SURFACE, OF_VOLUME = _told("of_surface"), _told("of_volume")
"""Of each part of the surface, by name in `SurfaceMetrics`, and of the whole volume, by name in `BoneMetrics`, in the order of the page."""

PARTS = {"bone": "All bone", "oblique": "Oblique bone", "interspinous": "Interspinous borders"}

QUANTITIES = {f"{part}_{name}": quantity for part in PARTS for name, quantity in OF_SURFACE.items()} | OF_VOLUME
"""Every number of `BoneMetrics.to_dict` by its key, in the order of the page."""

HEADINGS = {
    "bone_cnr": "CNR",
    "oblique_cnr": "oblique CNR",
    "bone_detectability": "detectability",
    "bone_coverage": "coverage",
    "oblique_coverage": "oblique coverage",
    "interspinous_coverage": "interspinous",
    "bone_thickness": "thickness mm",
    "bone_localization_error": "localization error mm",
    "lines_called_free": "blocked called free",
    "shadow_mean": "shadow mean gray level",
    "speckle_snr": "speckle SNR",
}
"""The numbers worth a line on a terminal, and what they are called there."""


def cell(key: str, value: float) -> str:
    """A number of `BoneMetrics.to_dict` as tables show it; a dash where it is not known."""
    return NOT_KNOWN if math.isnan(value) else format(value, QUANTITIES[key].form)


def table(metrics: dict[str, BoneMetrics], keys: Iterable[str] = HEADINGS) -> list[list[str]]:
    """Rows of words for a terminal: a line of headings, then one of numbers for each volume."""
    keys = list(keys)
    rows = [[name, *(cell(key, result.to_dict()[key]) for key in keys)] for name, result in metrics.items()]
    return [["", *(HEADINGS[key] for key in keys)], *rows]


def spreadsheet_cell(value: object) -> object:
    """A value as a spreadsheet takes it: six digits; words that it would take for a formula are marked as words."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, str):
        words = " ".join(value.split())
        # Some take the wide characters of East Asia for the narrow ones
        return f"'{words}" if unicodedata.normalize("NFKC", words).startswith(("=", "+", "-", "@")) else words
    return value


OWN_BONE, OTHER_BONE = "the bone that weighted it", "other bone"
"""What a volume was measured against, in the column `yardstick` of a table."""


def metrics_csv(metrics: dict[str, BoneMetrics], frames: int | None, own_bone: Collection[str] = ()) -> str:
    """Every number of every volume, a line each under a line of headings; what is not known is left empty.

    Notes
    -----
    Columns are `volume`, `reachability` ("sweep", or "unknown" without `frames`), `yardstick` (whether it is the bone that weighted it, as
    that of those in `own_bone`) and the keys of `BoneMetrics.to_dict`; six digits.
    """
    reachability = "unknown" if frames is None else "sweep"
    numbers = {name: result.to_dict() for name, result in metrics.items()}
    head = ["volume", "reachability", "yardstick", *next(iter(numbers.values()))]
    told = {name: OWN_BONE if name in own_bone else OTHER_BONE for name in numbers}
    return csv_text([head, *([name, reachability, told[name], *row.values()] for name, row in numbers.items())])


def csv_text(rows: Iterable[Iterable[object]]) -> str:
    """Rows as a spreadsheet takes them; what is not known is left empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([spreadsheet_cell(cell) if cell == cell else "" for cell in row] for row in rows)
    return text.getvalue()


def what_counted(result: BoneMetrics, frames: int | None) -> str:
    """Which bone the numbers are of, in a line."""
    area = result.bone.area / 100
    if frames is None:
        return f"of all {area:.1f} cm2 of bone surface where the volume was measured, whether a beam met it or not"
    return (
        f"of the {area:.1f} cm2 of bone surface that beams of the {frames} frames met "
        f"({result.oblique.area / 100:.1f} cm2 oblique, {result.interspinous.area / 100:.1f} cm2 at interspinous borders)"
    )


HARDLY = 0.15
"""Share of the bone, shown by the best volume, below which it is hardly that of the volumes: of plain averages it is 0.3 and more."""

OBLIQUE = "oblique: bone that beams hit at more than 45 degrees at best"
IN_WORDS = (
    "CNR, contrast-to-noise ratio: by how many standard deviations bone is brighter than the tissue before it",
    OBLIQUE,
    "coverage: share of the bone that beams met that stands out from the tissue before it",
)
"""What the lines of a terminal's table mean."""


def hardly_shown(metrics: Iterable[BoneMetrics]) -> str | None:
    """A sentence where none of the volumes shows more than a little of the bone that they are measured against."""
    best = max((result.bone.coverage for result in metrics), default=math.nan)
    if not best < HARDLY:
        return None
    return f"WARNING: Hardly any of this bone is seen ({best:.0%}). Is it of another patient, or does it lie elsewhere?"


def achieved(metrics: dict[str, BoneMetrics], frames: int | None, against: str = "average") -> str:
    """What came out, in a sentence or two: the volume that shows most bone, and beside it the plain average.

    Parameters
    ----------
    metrics : dict of str to BoneMetrics
        By the name of the volume or method; those that are not known tell nothing.
    frames : int or None
        Of the sweep that decides which bone counts; None: no sweep is known.
    against : str
        What is compared with; where it is not there, the volume that shows least.
    """
    known = {name: result.bone for name, result in metrics.items() if not math.isnan(result.bone.coverage + result.bone.cnr)}
    if not known:
        return "How much bone is shown cannot be told."
    most = max(known, key=lambda name: known[name].coverage)
    other = against if against in known else min(known, key=lambda name: known[name].coverage)
    which = "the bone where the volume was measured" if frames is None else "the bone that beams met"
    shows = f"{most} shows {known[most].coverage:.0%} of {which}"
    if other == most:
        return f"{shows}. It is {known[most].cnr:.1f} standard deviations brighter than the tissue before it."
    return (
        f"{shows}, {other} {known[other].coverage:.0%}. Bone is {known[most].cnr:.1f} standard deviations brighter than the tissue "
        f"before it, with {other} {known[other].cnr:.1f}."
    )


def best_of(key: str, metrics: dict[str, BoneMetrics]) -> set[str]:
    """Which volumes have the best number, as printed; nobody where all are equal, alone or not judged."""
    values = {name: result.to_dict()[key] for name, result in metrics.items()}
    known = {name: value for name, value in values.items() if not math.isnan(value)}
    rank = {"most": lambda v: -v, "least": lambda v: v, "nearest 0": abs}.get(QUANTITIES[key].best)
    if rank is None or not known:
        return set()
    # Ranked as printed, so that a difference which cannot be seen does not decide
    shown = {name: rank(float(cell(key, value).rstrip("%"))) for name, value in known.items()}
    best = {name for name, value in shown.items() if value == min(shown.values())}
    return set() if len(best) == len(metrics) else best

"""What volumes of many cases show: mean and spread, and paired differences with a confidence interval by the bootstrap over cases."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import FileFormatError, SettingsError
from ..io.disk.small_files import read_bytes
from ..message import listed
from .quantities import HEADINGS, NOT_KNOWN, OWN_BONE, QUANTITIES, csv_text

LEVEL, DRAWS, FEW, FEWEST = 0.95, 10_000, 10, 5
"""Of the confidence intervals: their level, how many times cases are drawn anew, how many cases are enough, and
the fewest of which one is told: of three it would be smallest and largest difference."""

MOST_BYTES = 2**28


def _rows(text: str) -> list[dict[str, str]]:
    """The rows of a table; of one that a spreadsheet of another country has saved, too."""
    headings = text.partition("\n")[0]
    rows = csv.DictReader(io.StringIO(text), delimiter=";" if headings.count(";") > headings.count(",") else ",")
    return list(rows) or [{}]  # a table without rows is none


@dataclass(frozen=True)
class CaseNumbers:
    """Numbers of many cases.

    Parameters
    ----------
    numbers : dict of str to dict of str to dict of str to float
        By volume or method, case, and key of `QUANTITIES`.
    volumes : dict of str to dict of str to Path
        By volume or method, and case.
    own_bone : set of str
        Volumes that were measured against the bone that weighted their frames.
    agreement : dict of str to float
        By case with a CT: the share of the bone echoes of its sweep that lie on its bone.
    registered : set of str
        Cases whose CT was placed by its sweep.
    notes : list of str
        What is doubtful about them.
    """

    numbers: dict[str, dict[str, dict[str, float]]] = field(default_factory=dict)
    volumes: dict[str, dict[str, Path]] = field(default_factory=dict)
    own_bone: set[str] = field(default_factory=set)
    agreement: dict[str, float] = field(default_factory=dict)
    registered: set[str] = field(default_factory=set)
    notes: list[str] = field(default_factory=list)

    @classmethod
    def read(cls, tables: Mapping[str, Path]) -> CaseNumbers:
        """Those in tables of `batch`, with a row for each case and method, or of `evaluate`, each of the case that it is named after.

        Raises FileFormatError when one is no such table.
        """
        found = cls()
        for name, path in tables.items():
            text = read_bytes(path, MOST_BYTES, FileFormatError).decode("utf-8-sig", errors="replace")
            try:
                for row in _rows(text):
                    found._take(row, name, path)
            except (KeyError, ValueError, csv.Error):
                raise FileFormatError(f"{path}: it is no table of numbers as evaluate or batch write it. Give one.") from None
        return found

    def _take(self, row: Mapping[str, str], name: str, path: Path) -> None:
        volume, case = row.get("method") or row["volume"], row.get("case") or name
        numbers = {key: float(row[key].replace(",", ".")) for key in QUANTITIES if row.get(key)}
        known = self.numbers.setdefault(volume, {})
        if not numbers:
            self.notes.append(f"Left out, as it has no numbers: {volume} of {case}.")
            return
        if case in known:
            self.notes.append(f"WARNING: {volume} of {case} stands there twice; that of {path} counts. Give each case a name of its own.")
        known[case] = numbers
        if row.get("registration_agreement"):
            self.agreement[case] = float(row["registration_agreement"].replace(",", "."))
            self.registered.update({case} if row.get("registered") else set())
        doubt = f"{case}: {row.get('notes')}"
        if "WARNING" in doubt and doubt not in self.notes:
            self.notes.append(doubt)
        self.volumes.setdefault(volume, {})[case] = path.parent / row["volume"]
        self.own_bone.update({volume} if row.get("yardstick") == OWN_BONE else set())

    def registration_in_words(self) -> str:
        """How the CTs were placed, and how well they lie on their sweeps."""
        if not (shares := list(self.agreement.values())):
            return ""
        placed = f"In {len(self.registered)} cases the CT was registered to its sweep [1]" if self.registered else "The CTs lie as given"
        return f"{placed}; {np.mean(shares):.0%} of the bone echoes lay on its bone (mean of {len(shares)} cases; least {min(shares):.0%})."

    def reference(self, against: str | None) -> str:
        """The volume that others are compared with: the one that is asked for, else the average, else the first."""
        named = {name.removesuffix(".nrrd"): name for name in self.numbers}
        if against is None:
            return named.get("average", next(iter(self.numbers)))
        if against.removesuffix(".nrrd") not in named:
            raise SettingsError(f"Input against must be one of {listed(self.numbers)}; got {against}.")
        return named[against.removesuffix(".nrrd")]

    def summary(self, key: str, volume: str, against: str) -> tuple[int, float, float, int, float, float, float]:
        """Of one number: cases, mean and standard deviation; paired cases, mean difference, and the ends of its confidence interval."""
        mine, others = ({case: row[key] for case, row in self.numbers[name].items() if key in row} for name in (volume, against))
        values = np.array(list(mine.values()))
        pairs = np.array([value - others[case] for case, value in mine.items() if case in others])
        mean, spread = (values.mean() if len(values) else np.nan), (values.std(ddof=1) if len(values) > 1 else np.nan)
        if len(pairs) < FEWEST or volume == against:
            return len(values), mean, spread, len(pairs), (pairs.mean() if len(pairs) else np.nan), np.nan, np.nan
        drawn = np.random.default_rng(0).integers(0, len(pairs), (DRAWS, len(pairs)))
        low, high = np.quantile(pairs[drawn].mean(axis=1), [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
        return len(values), mean, spread, len(pairs), pairs.mean(), low, high

    def tables(self, against: str) -> tuple[list[list[str]], list[list[str]]]:
        """Mean and standard deviation, and paired differences, of every volume: rows of words for a terminal."""
        means, differences = [["", *self.numbers]], [["", *(name for name in self.numbers if name != against)]]
        for key, heading in HEADINGS.items():
            form = QUANTITIES[key].form
            of = {name: self.summary(key, name, against) for name in self.numbers}
            means.append([heading, *(f"{s[1]:{form}} \N{PLUS-MINUS SIGN} {s[2]:{form}}" if s[0] > 1 else NOT_KNOWN for s in of.values())])
            # Of shares in points: "+5%" could be a twentieth more
            scale, heading, form = (100, f"{heading}, points", ".1f") if form.endswith("%") else (1, heading, form)
            compared = ([f"{scale * value:+{form}}" for value in s[4:]] if s[3] > 1 else None for name, s in of.items() if name != against)
            told = (NOT_KNOWN if d is None else f"{d[0]} [{d[1]}, {d[2]}]".replace(" [+nan, +nan]", "") for d in compared)
            differences.append([heading, *told])
        return means, differences

    def csv(self, against: str) -> str:
        """Every number of every volume, a line each; areas in mm2, shares from 0 to 1."""
        names = ("cases", "mean", "standard_deviation", "paired_cases", "mean_difference", "confidence_low", "confidence_high")
        rows: list[list[object]] = [["volume", "quantity", "unit", "against", *names]]
        for volume in self.numbers:
            for key, quantity in QUANTITIES.items():
                unit = quantity.unit.replace("\N{SUPERSCRIPT TWO}", "2") or ("share" if quantity.form.endswith("%") else "")
                rows.append([volume, key, unit, against, *self.summary(key, volume, against)])
        return csv_text(rows)

"""When each pose was taken: seconds from columns in any unit, in parts, or as the hour of the day."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....arrays import Floats
from ....errors import SettingsError
from ....message import listed, shorten
from ....remedies import NAME_THE_COLUMNS, TIME_UNIT
from ...sequence.decoded_images import library
from .headings import LONG_TIMES, RECEIVED, TIME, TIMES, Column
from .sheet import Cells, has_none, is_number

_SINCE_1970 = (("ns", 6e17, 1e19), ("us", 1e14, 1e16), ("ms", 1e11, 1e13), ("s", 1e8, 1e10))
"""Times since 1970 tell their unit: those of the years 1973 to 2286, in ns since 1989 (below are the 100 ns of Windows)."""

SLOWEST, FASTEST = 2.0, 1e-4
"""s between poses that no tracker takes, in the median."""


@dataclass(frozen=True)
class Times:
    """Times in s, or None where there are none; and in words what they are of."""

    seconds: Floats | None
    told: tuple[str, ...] = ()


def times_of(columns: dict[int, Column], cells: Cells, unit: str | None) -> Times:
    """The times of rows, of the columns of one tool by their place; `unit` as the user says.

    Raises SettingsError when two columns can be the time, or the unit cannot be told.
    """
    found = {place: column for place, column in columns.items() if column.role == TIME}
    found = found or {place: column for place, column in columns.items() if column.role == RECEIVED}
    if not found or not len(cells):
        return Times(None)
    known = {**LONG_TIMES, **TIMES}
    parts = {place: column.unit for place, column in found.items()}
    if len(found) > 1 and (len(set(parts.values())) < len(found) or None in parts.values() or unit is not None):
        names = listed(f"{column.heading} (column {place + 1})" for place, column in found.items())
        raise SettingsError(f"{len(found)} columns can be the time: {names}.", NAME_THE_COLUMNS)
    if len(found) > 1:
        seconds = sum(cells.numbers(place, "time") * known[part] for place, part in parts.items() if part is not None)
        return _checked(np.asarray(seconds), f"time: {' + '.join(column.heading for column in found.values())}", unit, None)
    ((place, column),) = found.items()
    if not cells.are_numbers(place):
        return _checked(_clock(cells.words(place), column), f"time: {column.heading}, by date or hour", None, None)
    numbers = cells.numbers(place, "time")
    unit = unit or column.unit
    if unit is not None:
        return _checked(numbers * known[unit], f"time: {column.heading} in {unit}", unit, None)
    largest = float(np.nanmax(np.abs(numbers))) if np.isfinite(numbers).any() else 0.0
    unit = next((name for name, low, high in _SINCE_1970 if low <= largest < high), None)
    told = f"time: {column.heading}" + (f" in {unit}, by its size" if unit not in (None, "s") else "")
    return _checked(numbers * known[unit or "s"], told, unit, column.heading)


def _clock(words: list[str], column: Column) -> Floats:
    """Seconds of dates, or of hours of a day."""
    pandas = library("pandas", "Tables of poses")
    plain = [None if has_none(word) else word.replace(",", ".").replace("/", "-") for word in words]
    try:
        if any(word and "-" in word for word in plain):
            since = pandas.to_datetime(pandas.Series(plain), format="ISO8601", utc=True) - pandas.Timestamp(0, tz="UTC")
        else:
            wrong = next((word for word in plain if word and word.count(":") != 2), None)
            if wrong is not None:
                raise ValueError
            since = pandas.to_timedelta(pandas.Series(plain))
    except ValueError:
        other = next((word for word in words if not has_none(word) and not is_number(word)), words[0])
        raise SettingsError(
            f"The time (column {column.heading}) must be a number, a date as 2026-01-31 12:30:15.05 or an hour as 12:30:15.05; "
            f"got {shorten(other)!r}.",
            NAME_THE_COLUMNS,
        ) from None
    found = np.asarray(since.dt.total_seconds().to_numpy(), np.float64)
    known = found[np.isfinite(found)]
    if len(known) and np.ptp(known) > 43200.0 and known.max() < 86400.0:
        found = np.where(found < 43200.0, found + 86400.0, found)  # over midnight
    return found


def _checked(seconds: Floats, told: str, unit: str | None, heading: str | None) -> Times:
    """Times, unless no tracker takes poses so; `heading` where nothing says the unit."""
    finite = np.unique(seconds[np.isfinite(seconds)])
    if unit is None and heading is not None and len(finite) > 2:
        step = float(np.median(np.diff(finite)))
        if step > SLOWEST or step < FASTEST:
            likely = next((name for name in ("ms", "us", "ns") if FASTEST <= step * TIMES[name] <= SLOWEST), "s")
            raise SettingsError(
                f"The unit of the times (column {heading}) is not known: in seconds, poses would be {step:g} s apart.",
                TIME_UNIT,
                unit=likely,
            )
    missing = int((~np.isfinite(seconds)).sum())
    if missing:
        return Times(None, (f"{told}: not used, {missing} of {len(seconds)} rows have none",))
    return Times(seconds, (told,))

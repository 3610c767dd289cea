"""When each pose was taken: seconds from columns in any unit, in parts, or as the hour of the day."""

from __future__ import annotations

import numpy as np

from ....arrays import Floats
from ....errors import FileFormatError, SettingsError
from ....message import listed, shorten
from ....remedies import NAME_THE_COLUMNS, TIME_UNIT
from ...sequence.decoded_images import library
from .headings import LONG_TIMES, TIME, TIMES, Column
from .sheet import Sheet, has_none, is_number

_SINCE_1970 = (("ns", 6e17, 1e19), ("us", 1e14, 1e16), ("ms", 1e11, 1e13), ("s", 1e8, 1e10))
"""Times since 1970 tell their unit: those of the years 1973 to 2286, in ns since 1989 (below are the 100 ns of Windows)."""

SLOWEST, FASTEST = 2.0, 1e-4
"""s between poses that no tracker takes, in the median."""

_HALF_A_DAY = 43200.0


def times_of(columns: dict[int, Column], sheet: Sheet, unit: str | None) -> tuple[Floats | None, list[str]]:
    """The times of rows in s, of the columns of one tool by their place, None where there are none; and in words what they are of.

    `unit` is as the user says. Raises SettingsError when two columns can be the time, or the unit cannot be told.
    """
    found = {place: column for place, column in columns.items() if column.role == TIME}
    if not found or not len(sheet):
        return None, []
    known = {**LONG_TIMES, **TIMES}
    parts = {place: column.unit for place, column in found.items()}
    if len(found) > 1 and (len(set(parts.values())) < len(found) or None in parts.values() or unit is not None):
        names = listed(f"{column.heading} (column {place + 1})" for place, column in found.items())
        raise SettingsError(f"{len(found)} columns can be the time: {names}.", NAME_THE_COLUMNS)
    told = f"time: {' + '.join(column.heading for column in found.values())}"
    place, column = next(iter(found.items()))
    if len(found) > 1:
        seconds = np.sum([sheet.numbers(place, "time") * known[str(part)] for place, part in parts.items()], axis=0)
    else:
        try:
            numbers, named = sheet.numbers(place, "time"), unit or column.unit
            largest = float(np.abs(numbers).max(initial=0.0, where=np.isfinite(numbers)))
            by_size = next((name for name, low, high in _SINCE_1970 if low <= largest < high), None)
            seconds = numbers * known[named or by_size or "s"]
            told += f" in {named}" if named else f" in {by_size}, by its size" if by_size not in (None, "s") else ""
            if not named and not by_size:
                _require_a_trackers_rate(seconds, column.heading)
        except FileFormatError:
            seconds, told = _clock(sheet.words(place), column), f"{told}, by date or hour"
    missing = int((~np.isfinite(seconds)).sum())
    return (None, [f"{told}: not used, {missing} of {len(seconds)} rows have none"]) if missing else (seconds, [told])


def _clock(words: list[str], column: Column) -> Floats:
    """Seconds of dates, or of hours of a day."""
    pandas = library("pandas", "Tables of poses")
    plain = pandas.Series([None if has_none(word) else word.replace(",", ".").replace("/", "-") for word in words])
    try:
        if plain.str.contains("-").any():
            since = pandas.to_datetime(plain, format="ISO8601", utc=True) - pandas.Timestamp(0, tz="UTC")
        elif (plain.dropna().str.count(":") == 2).all():
            since = pandas.to_timedelta(plain)
        else:
            raise ValueError
    except ValueError:
        other = next(word for word in words if not has_none(word) and not is_number(word))
        must = "must be a number, a date as 2026-01-31 12:30:15.05 or an hour as 12:30:15.05"
        raise SettingsError(f"The time (column {column.heading}) {must}; got {shorten(other)!r}.", NAME_THE_COLUMNS) from None
    found: Floats = since.dt.total_seconds().to_numpy(np.float64)
    known = found[np.isfinite(found)]
    if len(known) and np.ptp(known) > _HALF_A_DAY and known.max() < 2 * _HALF_A_DAY:
        found = np.where(found < _HALF_A_DAY, found + 2 * _HALF_A_DAY, found)  # over midnight
    return found


def _require_a_trackers_rate(seconds: Floats, heading: str) -> None:
    """Raise SettingsError where no tracker takes poses so, if times that do not say their unit are in seconds."""
    steps = np.diff(np.unique(seconds[np.isfinite(seconds)]))
    step = float(np.median(steps)) if len(steps) > 1 else FASTEST
    if not FASTEST <= step <= SLOWEST:
        likely = next((name for name in ("ms", "us", "ns") if FASTEST <= step * TIMES[name] <= SLOWEST), "s")
        told = f"The unit of the times (column {heading}) is not known: in seconds, poses would be {step:g} s apart."
        raise SettingsError(told, TIME_UNIT, unit=likely)

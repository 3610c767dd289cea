"""How a live scan goes, on one line of the terminal."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TextIO

import numpy as np

from ..live.session.session import SCOUTING, LiveSession
from ..live.session.statistics import LiveStatistics
from .console import TerminalLine, show
from .remedies import in_options

TERMINAL_INTERVAL, LINE_INTERVAL = 0.2, 5.0
"""s between two status lines, on a terminal and elsewhere."""


class StatusLine(TerminalLine):
    """One line that tells how the scan goes: redrawn on a terminal, a new line now and then elsewhere."""

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic):
        super().__init__(stream)
        self._clock, self._interval = clock, TERMINAL_INTERVAL if self.is_terminal else LINE_INTERVAL
        self._last = -self._interval
        self._told: str | None = None

    def show(self, session: LiveSession) -> None:
        """Draw the line, unless it was drawn a moment ago; before it, once, what is wrong with the stream."""
        now = self._clock()
        if now - self._last < self._interval:
            return
        self._last = now
        trouble = session.statistics.trouble
        if trouble and trouble != self._told:
            self.say(in_options(trouble))
        self._told = trouble
        self.draw(status_text(session.statistics, session.scouted))

    def say(self, text: str) -> None:
        """A line of its own that stays."""
        self.clear()
        show(self.stream, " ".join(text.split()) + "\n")


def status_text(statistics: LiveStatistics, scouted: int = 0) -> str:
    """Connection, tracking, rate, latency, and where the frames went, in one line."""
    parts = [f"{statistics.frame_rate:4.1f} frames/s", statistics.tracking]
    if statistics.connection != "connected":
        parts.insert(0, statistics.connection)
    if statistics.phase == SCOUTING:
        parts.append(f"scouting, {scouted} frames")
    else:
        latency = "" if np.isnan(statistics.latency_p50) else f", {1000 * statistics.latency_p50:.0f} ms"
        parts.append(f"{statistics.inserted} inserted{latency}, {statistics.frames_skipped} skipped")
    if statistics.recorded or statistics.recording_failure:
        parts.append("recording stopped" if statistics.recording_failure else f"{statistics.recorded} recorded")
    return "  ".join(parts)

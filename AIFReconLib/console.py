"""What a terminal shows: a progress bar while something runs, and aligned columns."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable
from typing import TextIO

from .progress import Progress

BAR_WIDTH = 30
REFRESH_S = 0.1


class ProgressBar:
    """A `Progress` function that draws a bar on a terminal and nothing elsewhere; use it in a `with` block."""

    def __init__(self, stream: TextIO | None = None):
        self._stream = stream or sys.stderr
        self._shown = self._stream.isatty()
        self._last = 0.0
        self._width = 0

    def __enter__(self) -> Progress:
        return self._draw

    def __exit__(self, *_) -> None:
        self.clear()

    def clear(self) -> None:
        """Take the bar off the line, so that other text can follow."""
        if self._width:
            self._stream.write("\r" + " " * self._width + "\r")
            self._stream.flush()
            self._width = 0

    def _draw(self, fraction: float, message: str) -> bool:
        now = time.monotonic()
        if self._shown and (now - self._last >= REFRESH_S or fraction >= 1.0):
            self._last = now
            filled = round(BAR_WIDTH * fraction)
            text = f"[{'#' * filled}{'.' * (BAR_WIDTH - filled)}] {100 * fraction:3.0f}%  {message}"
            self._stream.write("\r" + text.ljust(self._width))
            self._stream.flush()
            self._width = len(text)
        return True


def columns(rows: Iterable[Iterable[str]], indent: str = "  ") -> str:
    """Rows of words as aligned columns, one line each."""
    rows = [[str(cell) for cell in row] for row in rows]
    widths = [max((len(row[c]) for row in rows if c < len(row)), default=0) for c in range(max(map(len, rows), default=0))]
    return "\n".join((indent + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))).rstrip() for row in rows)

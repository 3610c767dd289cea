"""What a terminal shows: a progress bar while something runs, and aligned columns."""

from __future__ import annotations

import contextlib
import os
import re
import shlex
import shutil
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import TextIO

from ..progress import Progress
from .guard import open_descriptors

BAR_WIDTH = 30
REFRESH_S = 0.1


_COMMANDS = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]|(?<=[^\r])\r(?=[^\r\n])")
"""What commands a terminal, or turns text around; a line may still be drawn anew."""


def plain(text: str) -> str:
    """Text without what a terminal would obey instead of showing it: names come from files."""
    return _COMMANDS.sub("?", text)


class PlainStream:
    """A stream to which nothing but plain text is written; else as the stream itself."""

    def __init__(self, stream: TextIO):
        self._stream = stream

    def __getattr__(self, name: str) -> object:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write text, plain."""
        return self._stream.write(plain(text))


def prepare_streams() -> None:
    """Make sure that there are standard streams, that they take every character, and show it.

    Notes
    -----
    Whatever another library prints would go into a file that has got the number of a closed stream. A name that a
    stream cannot spell, as in an old locale, is shown with escapes.
    """
    open_descriptors()
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 (open as long as the program runs)
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
        if not isinstance(getattr(sys, name), PlainStream):
            setattr(sys, name, PlainStream(getattr(sys, name)))


def not_loaded(error: BaseException) -> str:
    """What to say where a library, or a part of one, cannot be loaded."""
    return f"A library cannot be loaded ({' '.join(str(error).split())}). Install AIFRecon again, or give the program more memory."


def program() -> str:
    """How this program was called, to begin a command that can be copied: ``aifrecon``, or ``.venv/bin/python -m AIFReconLib``."""
    called = Path(sys.argv[0])
    package = __name__.partition(".")[0]
    if called.name == "__main__.py" and called.parent.name == package:
        return f"{_typed(Path(sys.executable))} -m {package}"
    if called.stem == "aifrecon" and shutil.which("aifrecon") is None:
        return _typed(called)
    return "aifrecon"


def shell_words(words: Iterable[str]) -> str:
    """A command as one would type it here."""
    words = list(words)
    return shlex.join(words) if os.name == "posix" else " ".join(f'"{word}"' if " " in word else word for word in words)


def _typed(path: Path) -> str:
    """A path as one would type it here."""
    with contextlib.suppress(ValueError):
        path = path.absolute().relative_to(Path.cwd())
    return shlex.quote(str(path)) if os.name == "posix" else f'"{path}"' if " " in str(path) else str(path)


def show(stream: TextIO, text: str) -> None:
    """Write `text` now; without effect where nobody can see it any more, because what it accompanies must go on."""
    with contextlib.suppress(OSError):
        stream.write(text)
        stream.flush()


class ProgressBar:
    """A `Progress` function that draws a bar on a terminal and nothing elsewhere; use it in a `with` block."""

    def __init__(self, stream: TextIO | None = None):
        self._stream = stream or sys.stderr
        self._shown = self._stream.isatty()
        self._last = 0.0
        self._width = 0

    def __enter__(self) -> Progress:
        return self._draw

    def __exit__(self, *_: object) -> None:
        self.clear()

    def clear(self) -> None:
        """Take the bar off the line, so that other text can follow."""
        if self._width:
            show(self._stream, "\r" + " " * self._width + "\r")
            self._width = 0

    def _draw(self, fraction: float, message: str) -> bool:
        now = time.monotonic()
        if self._shown and (now - self._last >= REFRESH_S or fraction >= 1.0):
            self._last = now
            filled = round(BAR_WIDTH * fraction)
            text = f"[{'#' * filled}{'.' * (BAR_WIDTH - filled)}] {100 * fraction:3.0f}%  {message}"
            show(self._stream, "\r" + text.ljust(self._width))
            self._width = len(text)
        return True


def real_path(path: Path) -> Path:
    """The path without links; one that leads in a circle stays as it is."""
    return Path(os.path.realpath(path))

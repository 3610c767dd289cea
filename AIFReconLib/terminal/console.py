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


class _PlainStream:
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
        if not isinstance(getattr(sys, name), _PlainStream):
            setattr(sys, name, _PlainStream(getattr(sys, name)))


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


def command_line(words: Iterable[str]) -> str:
    """A command of this program as one would type it here."""
    words = list(words)
    typed = shlex.join(words) if os.name == "posix" else " ".join(f'"{word}"' if " " in word else word for word in words)
    return f"{program()} {typed}"


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


class TerminalLine:
    """A line of a stream that is drawn anew in its place; where that is no terminal, each drawing is a line of its own."""

    def __init__(self, stream: TextIO | None = None):
        self.stream = stream or sys.stderr
        self.is_terminal = self.stream.isatty()
        self._width = 0

    def draw(self, text: str) -> None:
        """Show `text` in its place."""
        show(self.stream, "\r" + text.ljust(self._width) if self.is_terminal else text + "\n")
        self._width = len(text) if self.is_terminal else 0

    def clear(self) -> None:
        """Take it off, so that other text can follow."""
        if self._width:
            show(self.stream, "\r" + " " * self._width + "\r")
            self._width = 0


class ProgressBar(TerminalLine):
    """A `Progress` function that draws a bar on a terminal and nothing elsewhere; use it in a `with` block."""

    _last = 0.0

    def __enter__(self) -> Progress:
        return self._report

    def __exit__(self, *_: object) -> None:
        self.clear()

    def _report(self, fraction: float, message: str) -> bool:
        now = time.monotonic()
        if self.is_terminal and (now - self._last >= REFRESH_S or fraction >= 1.0):
            self._last = now
            filled = round(BAR_WIDTH * fraction)
            self.draw(f"[{'#' * filled}{'.' * (BAR_WIDTH - filled)}] {100 * fraction:3.0f}%  {message}")
        return True

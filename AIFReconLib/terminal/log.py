"""What `--verbose` shows and `--log` keeps: what the library notes while a command runs, and why it failed."""

from __future__ import annotations

import contextlib
import logging
import os
import shlex
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from .. import __version__
from ..errors import OutputError
from ..io.disk.atomic import check_writable
from ..message import one_line
from .console import plain, show

if TYPE_CHECKING:
    from .arguments import Options

FIRST_WORDS = "AIFRecon log"
"""Of every log. A file that begins otherwise is something else, to which nothing may be appended."""


class _PlainFormatter(logging.Formatter):
    """What a terminal would obey is not in a log either."""

    def format(self, record: logging.LogRecord) -> str:
        """A record as text."""
        return plain(super().format(record))


_LINE = _PlainFormatter("%(asctime)s %(levelname)s [%(threadName)s] %(name)s: %(message)s")


@contextlib.contextmanager
def quiet_as_asked(asked: Options) -> Iterator[None]:
    """Within the block nothing is printed where --quiet asks for that; what ends the block is said outside it."""
    if not asked.quiet:
        yield
        return
    with open(os.devnull, "w", encoding="utf-8") as nowhere, contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
        yield


@contextlib.contextmanager
def logging_as_asked(asked: Options, words: list[str]) -> Iterator[None]:
    """Within the block the library's log goes where the options say; why the block ends is noted too.

    Raises OutputError when the log cannot be written, or its file is something else.

    Parameters
    ----------
    asked : Options
        Of the command.
    words : list of str
        As they were given, for the log's first line.
    """
    logger = logging.getLogger(__package__.partition(".")[0])
    # What files contradict themselves in concerns everybody
    shown, level = (logger, logging.INFO) if asked.verbose else (logger.getChild("io"), logging.WARNING)
    handlers: list[tuple[logging.Logger, logging.Handler]] = [(shown, _Terminal(level))]
    if asked.log is not None:
        kept = _log_file(asked.log)
        handlers += [(logger, kept), (logging.getLogger("py.warnings"), kept)]
    level, propagate = logger.level, logger.propagate
    if asked.verbose or asked.log is not None:
        logger.setLevel(logging.DEBUG if asked.log is not None else logging.INFO)
        # A program around ours, as a test, may show everything that it gets
        logger.propagate = False
    for where, handler in handlers:
        where.addHandler(handler)
    # What packages warn of with lines of their source is for the log
    logging.captureWarnings(True)
    try:
        logger.debug("AIFRecon %s: aifrecon %s", __version__, one_line(shlex.join(words)))
        yield
        logger.debug("done")
    except BaseException as error:
        logger.debug("ended by %s", type(error).__name__, exc_info=True)
        raise
    finally:
        logging.captureWarnings(False)
        logger.setLevel(level)
        logger.propagate = propagate
        for where, handler in handlers:
            where.removeHandler(handler)
            handler.close()


def _log_file(path: Path) -> logging.Handler:
    """The file, opened behind what it holds already."""
    check_writable(path)
    try:
        begins = b""
        if path.exists():
            with open(path, "rb") as file:
                begins = file.read(len(FIRST_WORDS))
        if begins not in (b"", FIRST_WORDS.encode()):
            raise OutputError(f"Cannot log to {path}: it is there and is no log. Choose another name for --log.")
        handler = _LogFile(path, encoding="utf-8", errors="backslashreplace")
        if not begins and handler.stream is not None:
            handler.stream.write(f"{FIRST_WORDS}\n")
            handler.flush()
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(f"Cannot log to {path}: {error.strerror or str(error)}. Choose another name for --log.") from None
    handler.setLevel(logging.DEBUG)
    handler.setFormatter(_LINE)
    return handler


class _LogFile(logging.FileHandler):
    """A file that lacks what the disk does not take."""

    def handleError(self, record: logging.LogRecord) -> None:
        """Nothing: the work goes on."""

    def close(self) -> None:
        """Close the file; what a full disk does not take is lost."""
        with contextlib.suppress(OSError):
            super().close()


class _Terminal(logging.Handler):
    """Lines on standard error, over a progress bar that may stand there."""

    def emit(self, record: logging.LogRecord) -> None:
        """Show the message; details of errors are for the log file."""
        text = " ".join(record.getMessage().split())
        if sys.stderr.isatty():
            text = "\r" + text.ljust(shutil.get_terminal_size().columns - 1)
        show(sys.stderr, text + "\n")

"""The command line: one parser, one place where errors become a line and an exit code.

Exit codes: 0 success; 1 a registration or calibration that is not sure, and is not written, a sequence that `info` says cannot be
reconstructed, or cases of a `batch` that are not done; 2 wrong arguments or input; but for `info` with one line on standard error that
says what is wrong and what to do; 130 interrupted (143 by SIGTERM, 129 by a terminal that was closed).
Whatever fails, no file is left half-written.
"""

from __future__ import annotations

import argparse
import contextlib
import errno
import os
import sys
from collections.abc import Collection, Iterable, Sequence
from importlib import import_module
from types import ModuleType

from .. import __version__
from ..errors import AIFReconError, OperationCanceled, RegistrationRefused
from ..message import one_line
from ..terminal.console import not_loaded, prepare_streams
from ..terminal.guard import last_opened
from ..terminal.log import add_log_options, logging_as_asked, quiet_as_asked
from ..terminal.one_line_parser import BAD_INPUT, OneLineParser
from ..terminal.remedies import in_options
from ..terminal.signals import OrderlyEnd, orderly_end

COMMANDS = {
    "demo": ("demo", "simulate a lumbar scan, reconstruct it with every method, measure and draw it"),
    "reconstruct": ("reconstruct", "turn a recorded sweep into a volume"),
    "preview": ("preview", "draw a volume: three cuts through its bone and a projection"),
    "compare": ("compare", "draw volumes side by side, in one figure for a paper"),
    "register": ("register", "find where a CT belongs on a sweep"),
    "start-calibration": ("start_calibration", "write a first calibration of a probe by a ruler"),
    "calibrate": ("calibrate", "check a calibration by the scan itself, or find a better one"),
    "coverage": ("coverage", "say which bone a sweep has met, and how squarely"),
    "plan": ("plan", "say which passes will show the borders of the interspinous gaps, or other bone"),
    "paths": ("paths", "find straight lines from the skin to a target past the bone that a volume shows; research only"),
    "batch": ("batch", "reconstruct, register and measure all cases of a table"),
    "bone-map": ("bone_map", "make a bone probability map from a segmentation"),
    "info": ("info", "say what a sequence holds and what is missing"),
    "import": ("import_frames", "make a sequence from images and a file of poses"),
    "convert": ("convert", "write a recording in another format, cut, renamed or mended"),
    "live": ("live", "reconstruct while scanning, from an OpenIGTLink server"),
    "replay": ("replay", "serve a recording over OpenIGTLink as Plus would"),
    "evaluate": ("evaluate", "measure how well volumes show bone"),
    "simulate": ("simulate", "make a simulated lumbar spine, its CT and a tracked sweep"),
    "benchmark": ("benchmark", "measure whether this machine keeps up with a live scan"),
}
"""All commands in the order of the help: the file of each in this folder, and what it is for."""

SUCCESS, REFUSED = 0, 1

_OF_PRINTING = (errno.ENOSPC, errno.EIO)
"""Errors of a full disk or a terminal that is gone. Those of our files come as `OutputError`, and commands print last."""

_INTERRUPTED = "Interrupted. No file is left half-written."

_NO_MEMORY = (
    "There is not enough memory. End other programs, or use a larger --spacing, a smaller part of the image (--clip-px) or of the sweep."
)


def named(words: Sequence[str]) -> tuple[str, ...]:
    """The commands whose options must be known to understand these words: the one that is named, if any."""
    return tuple(word for word in words if word in COMMANDS)[:1]


def load(names: Iterable[str] = COMMANDS) -> list[ModuleType]:
    """The files of these commands, with the libraries that they need: so long takes the start of the program."""
    return [import_module(f".{COMMANDS[name][0]}", __package__) for name in names]


def build_parser(names: Collection[str] = COMMANDS) -> argparse.ArgumentParser:
    """The parser of these commands; the others are known by their names only."""
    parser = OneLineParser(
        prog="aifrecon",
        description="3D ultrasound of the spine from tracked 2D frames, weighted by the angle of incidence to bone. "
        "Research software, not a medical device.",
        epilog="'aifrecon COMMAND --help' tells what a command takes. 'aifrecon demo' shows the whole on a simulated patient.",
    )
    parser.add_argument("--version", action="version", version=f"aifrecon {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=OneLineParser)
    for name, (_file, purpose) in COMMANDS.items():
        if name in names:
            load([name])[0].add_to(commands)
        else:
            commands.add_parser(name, help=purpose)
    for each in commands.choices.values():
        add_log_options(each)
    return parser


def main(argv: list[str] | None = None) -> int:
    """Run the command line, of the process by default; the answer is the exit code: 0, 1, 2, or 128 and the signal that ended it."""
    if "_ARGCOMPLETE" in os.environ:
        # A shell asks how a line may go on; this ends the program
        import_module("argcomplete").autocomplete(build_parser())
    prepare_streams()
    words = sys.argv[1:] if argv is None else argv
    try:
        arguments = build_parser(named(words)).parse_args(words or ["--help"])
    except SystemExit as stop:  # argparse has printed help, the version or its one line
        return int(stop.code or 0)
    except AIFReconError as error:  # of a settings file, which options are read from
        return _fail(in_options(error), BAD_INPUT)
    end, code = OrderlyEnd(), SUCCESS
    try:
        with orderly_end(end), quiet_as_asked(arguments), logging_as_asked(arguments, words):
            code = arguments.run(arguments)
    except (KeyboardInterrupt, OperationCanceled):
        return _fail(_INTERRUPTED, end.exit_code)
    except RegistrationRefused as refusal:
        return _fail(in_options(refusal), REFUSED)
    except AIFReconError as error:
        return _fail(in_options(error), BAD_INPUT)
    except MemoryError:
        return _fail(_NO_MEMORY + last_opened(), BAD_INPUT)
    except ImportError as error:
        # Libraries load their parts when they are first named
        return _fail(_INTERRUPTED, end.exit_code) if end.told else _fail(not_loaded(error), BAD_INPUT)
    except BrokenPipeError:
        pass  # whoever read the output has gone, as `head` does
    except RuntimeError as error:
        # Of a lock that the interrupt kept from being taken
        if isinstance(error.__context__, KeyboardInterrupt):
            return _fail(_INTERRUPTED, end.exit_code)
        # The interpreter has no class for a limit on threads
        if "start new thread" not in str(error):
            raise
        return _fail("The system allows no more threads. End other programs, or raise the limit (ulimit -u).", BAD_INPUT)
    except OSError as error:
        if error.errno in _OF_PRINTING and not error.filename:
            return _not_printed(error)
        where = f"{error.filename}: " if error.filename else ""
        return _fail(f"{where}{error.strerror or error}. Check that the file exists and may be used.", BAD_INPUT)
    return _print_the_rest() or code or SUCCESS


def _print_the_rest() -> int:
    """Put out what is still in the buffer."""
    try:
        sys.stdout.flush()
        return SUCCESS
    except OSError as error:
        # The interpreter must not try again at its end
        with contextlib.suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):
            return SUCCESS
        return _not_printed(error)


def _not_printed(error: OSError) -> int:
    return _fail(f"The result cannot be printed ({error.strerror}). Print it elsewhere; files that were asked for are written.", BAD_INPUT)


def _fail(message: str, code: int) -> int:
    with contextlib.suppress(OSError):
        print(f"aifrecon: {one_line(' '.join(message.split()))}", file=sys.stderr, flush=True)
    return code

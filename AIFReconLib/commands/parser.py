"""The command line: one parser, one place where errors become a line and an exit code.

Exit codes: 0 success; 1 a registration or calibration that is not sure, and is not written, a sequence that `info` says cannot be
reconstructed, or cases of a `batch` that are not done; 2 wrong arguments or input; but for `info` with one line on standard error that
says what is wrong and what to do; 130 interrupted (143 by SIGTERM, 129 by a terminal that was closed).
Whatever fails, no file is left half-written.
"""

from __future__ import annotations

import argparse
import contextlib
import difflib
import errno
import json
import os
import sys
from collections.abc import Iterable, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, get_type_hints

from .. import __version__
from ..errors import AIFReconError, OperationCanceled, RegistrationRefused
from ..message import LONGEST_QUOTE, one_line, shorten
from ..terminal.console import not_loaded, prepare_streams
from ..terminal.guard import BAD_INPUT, last_opened
from ..terminal.log import logging_as_asked, quiet_as_asked
from ..terminal.refusing import RefusingParser, WrongArguments
from ..terminal.remedies import in_options
from ..terminal.signals import INTERRUPTED, OrderlyEnd, orderly_end

if TYPE_CHECKING:
    from ..terminal.arguments import OneLineParser, Options

COMMANDS: dict[str, tuple[str, str]] = json.loads(Path(__file__).with_name("commands.json").read_text("utf-8"))
"""All commands in the order of the help: the file of each in this folder, and what it is for."""

SUCCESS, REFUSED = 0, 1

_OF_PRINTING = (errno.ENOSPC, errno.EIO)
"""Errors of a full disk or a terminal that is gone. Those of our files come as `OutputError`, and commands print last."""

_NO_MEMORY = (
    "There is not enough memory. End other programs, or use a larger --spacing, a smaller part of the image (--clip-px) or of the sweep."
)


def named(words: Sequence[str]) -> tuple[str, ...]:
    """The command that is named, if any."""
    return tuple(words[:1]) if words and words[0] in COMMANDS else ()


def load(names: Iterable[str] = COMMANDS) -> list[ModuleType]:
    """The files of these commands, with the libraries that they need: so long takes the start of the program."""
    return [import_module(f".{COMMANDS[name][0]}", __package__) for name in names]


def options_of(name: str) -> type[Options]:
    """What the function of a command is asked by."""
    options: type[Options] = get_type_hints(load([name])[0].run)["asked"]
    return options


def parser_of(name: str) -> OneLineParser:
    """The parser of a command."""
    from ..terminal.arguments import OneLineParser

    return OneLineParser(options_of(name), f"aifrecon {name}")


def build_parser() -> argparse.ArgumentParser:
    """The parser of what stands before a command, with the names of all commands."""
    parser = RefusingParser(
        prog="aifrecon",
        description="3D ultrasound of the spine from tracked 2D frames, weighted by the angle of incidence to bone. "
        "Research software, not a medical device.",
        epilog="'aifrecon COMMAND --help' tells what a command takes. 'aifrecon demo' shows the whole on a simulated patient.",
    )
    parser.add_argument("--version", action="version", version=f"aifrecon {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=RefusingParser)
    for name, (_file, purpose) in COMMANDS.items():
        commands.add_parser(name, help=purpose)
    return parser


def main(argv: list[str] | None = None) -> int:
    """Run the command line, of the process by default; the answer is the exit code: 0, 1, 2, or 128 and the signal that ended it."""
    prepare_streams()
    words = sys.argv[1:] if argv is None else argv
    prog = " ".join(["aifrecon", *named(words)])
    try:
        if not named(words):
            _without_command(words)
        asked = parser_of(words[0]).parse(words[1:])
    except SystemExit as stop:  # help or the version is printed
        return int(stop.code or 0)
    except WrongArguments as wrong:
        return _fail(f"{one_line(shorten(str(wrong), LONGEST_QUOTE))}. See {prog} --help.", BAD_INPUT, prog)
    except AIFReconError as error:  # of a settings file, which options are read from
        return _fail(in_options(error), BAD_INPUT)
    from ..terminal.outputs import check_outputs

    end, code = OrderlyEnd(), SUCCESS
    try:
        with orderly_end(end), quiet_as_asked(asked), logging_as_asked(asked, words):
            check_outputs(asked)
            code = load(named(words))[0].run(asked)
    except (KeyboardInterrupt, OperationCanceled):
        return _fail(INTERRUPTED, end.exit_code)
    except RegistrationRefused as refusal:
        return _fail(in_options(refusal), REFUSED)
    except AIFReconError as error:
        return _fail(in_options(error), BAD_INPUT)
    except MemoryError:
        return _fail(_NO_MEMORY + last_opened(), BAD_INPUT)
    except ImportError as error:
        # Libraries load their parts when they are first named
        return _fail(INTERRUPTED, end.exit_code) if end.told else _fail(not_loaded(error), BAD_INPUT)
    except BrokenPipeError:
        pass  # whoever read the output has gone, as `head` does
    except RuntimeError as error:
        # Of a lock that the interrupt kept from being taken
        if isinstance(error.__context__, KeyboardInterrupt):
            return _fail(INTERRUPTED, end.exit_code)
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


def _without_command(words: Sequence[str]) -> None:
    """Show help or the version, or say what is wrong with the words."""
    if words and not words[0].startswith("-"):
        near = difflib.get_close_matches(words[0], COMMANDS, n=1)
        raise WrongArguments(f"there is no command {words[0]}{f', perhaps {near[0]} is meant' if near else ''}")
    build_parser().parse_args(words or ["--help"])


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


def _fail(message: str, code: int, prog: str = "aifrecon") -> int:
    with contextlib.suppress(OSError):
        print(f"{prog}: {one_line(' '.join(message.split()))}", file=sys.stderr, flush=True)
    return code

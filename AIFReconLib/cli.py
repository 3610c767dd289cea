"""The command line: one parser, one place where errors become a line and an exit code.

Exit codes: 0 success; 2 wrong arguments or input, with one line on standard error that says what is wrong and what to do; 130
interrupted. Whatever fails, no file is left half-written.
"""

from __future__ import annotations

import argparse
import os
import sys
from typing import NoReturn

from . import __version__
from .commands import benchmark, bone_map, convert, demo, evaluate, import_frames, info, live, reconstruct, replay, simulate, study
from .errors import AIFReconError, OperationCanceled

COMMANDS = (demo, reconstruct, bone_map, info, import_frames, convert, live, replay, evaluate, simulate, benchmark, study)

SUCCESS, BAD_INPUT, INTERRUPTED = 0, 2, 130


class OneLineParser(argparse.ArgumentParser):
    """Reports wrong arguments in one line, like every other error."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and where help is, and exit."""
        self.exit(BAD_INPUT, f"{self.prog}: {message}. See {self.prog} --help.\n")


def build_parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    parser = OneLineParser(
        prog="aifrecon",
        description="3D ultrasound of the spine from tracked 2D frames, weighted by the angle of incidence to bone. "
        "Research software, not a medical device.",
        epilog="'aifrecon COMMAND --help' tells what a command takes. 'aifrecon demo' shows the whole on a simulated patient.",
    )
    parser.add_argument("--version", action="version", version=f"aifrecon {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=OneLineParser)
    for command in COMMANDS:
        command.add_to(commands)
    return parser


def main(argv: list[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv : list of str or None
        Arguments; those of the process by default.

    Returns
    -------
    code : int
        0, 2 or 130.
    """
    try:
        arguments = build_parser().parse_args(argv)
    except SystemExit as stop:  # argparse has printed help, the version or its one line
        return int(stop.code or 0)
    try:
        arguments.run(arguments)
        sys.stdout.flush()
    except (KeyboardInterrupt, OperationCanceled):
        return _fail("Interrupted. No file is left half-written.", INTERRUPTED)
    except AIFReconError as error:
        return _fail(str(error), BAD_INPUT)
    except MemoryError:
        return _fail("Not enough memory. Use a larger --spacing, or a smaller part of the image (--clip-px).", BAD_INPUT)
    except BrokenPipeError:
        # Whoever read the output has gone, as `head` does; the interpreter must not try to flush it again
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return SUCCESS
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return _fail(f"{where}{error.strerror or error}. Check that the file exists and may be used.", BAD_INPUT)
    return SUCCESS


def _fail(message: str, code: int) -> int:
    print(f"aifrecon: {' '.join(message.split())}", file=sys.stderr)
    return code

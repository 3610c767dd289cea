"""`python -m AIFReconLib` and `aifrecon`: the command line, and the moment before it, in which the libraries are loaded."""

from __future__ import annotations

import os
import sys

from .machine.processes import CONNECTION, ENVIRONMENT
from .terminal.signals import INTERRUPTED, OrderlyEnd, orderly_end

UNGUARDED = ("live",)
"""Commands that work in this very process: nothing may stand between a recording and who ends it."""


def main() -> int:
    """Load and run the command line.

    Returns
    -------
    code : int
        As `cli.main`; 2 where the libraries cannot be loaded, 128 and the number of the signal when one came before they were.
    """
    if _wants_guard(sys.argv[1:]):
        from .terminal.guard import guarded

        code = guarded()
        if code is not None:
            return code
    end = OrderlyEnd()
    try:
        with orderly_end(end):
            if CONNECTION in os.environ:
                from .terminal.guard import under_guard

                under_guard()
            for name, value in ENVIRONMENT.items():
                os.environ.setdefault(name, value)
            from .commands.parser import load, named
            from .commands.parser import main as run

            load(named(sys.argv[1:]))
    except KeyboardInterrupt:
        end.told = True
    except MemoryError:
        return _fail("There is not enough memory to start. End other programs.", 2)
    except Exception as error:
        if not end.told:
            if not isinstance(error, (ImportError, OSError)):
                raise
            from .terminal.console import not_loaded

            return _fail(not_loaded(error), 2)
    # An interrupt may come out of an import as another error, or not at all
    if end.told:
        return _fail(INTERRUPTED, end.exit_code)
    try:
        return run()
    except KeyboardInterrupt:  # before a command had begun, or when it was just over
        return _fail(INTERRUPTED, 130)


def _wants_guard(words: list[str]) -> bool:
    """Whether a process of its own is to do what the command line asks for: it can be started again, and is no mere question."""
    is_whole = bool(words) and sys.orig_argv[-len(words) :] == words
    is_question = not words or words[0].startswith("-") or not {"-h", "--help"}.isdisjoint(words)
    return is_whole and not is_question and words[0] not in UNGUARDED and CONNECTION not in os.environ


def _fail(message: str, code: int) -> int:
    if sys.stderr is not None:
        print(f"aifrecon: {message}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())

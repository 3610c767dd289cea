"""`python -m AIFReconLib` and `aifrecon`: the command line, and the moment before it, in which the libraries are loaded."""

from __future__ import annotations

import os
import sys

from .machine.processes import CONNECTION, ENVIRONMENT
from .terminal.signals import OrderlyEnd, orderly_end

LEAST_ADDRESS_SPACE = 800 * 2**20
"""Bytes that loading the libraries takes. With less, some of them end the program in words of their own, or wait forever."""

UNGUARDED = ("live",)
"""Commands that work in this very process: nothing may stand between a recording and who ends it."""

_INTERRUPTED = "Interrupted. No file is left half-written."


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
            if problem := _too_little_address_space():
                return _fail(problem, 2)
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
        return _fail(_INTERRUPTED, end.exit_code)
    try:
        return run()
    except KeyboardInterrupt:  # before a command had begun, or when it was just over
        return _fail(_INTERRUPTED, 130)


def _wants_guard(words: list[str]) -> bool:
    """Whether a process of its own is to do what the command line asks for: it can be started again, and is no mere question."""
    is_whole = bool(words) and sys.orig_argv[-len(words) :] == words
    is_question = not words or words[0].startswith("-") or not {"-h", "--help"}.isdisjoint(words) or "_ARGCOMPLETE" in os.environ
    return is_whole and not is_question and words[0] not in UNGUARDED and CONNECTION not in os.environ


def _too_little_address_space() -> str:
    """Why the libraries cannot be loaded, if so."""
    space = _address_space()
    if space >= LEAST_ADDRESS_SPACE:
        return ""
    least, given = LEAST_ADDRESS_SPACE // 2**20, int(space) // 2**20
    return f"The program may use {given} MiB of address space and needs {least} to start. Raise the limit (ulimit -v)."


def _address_space() -> float:
    """Bytes that the process may map, where the system limits that."""
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        return float("inf") if limit == resource.RLIM_INFINITY else limit
    except ImportError:  # Windows
        return float("inf")


def _fail(message: str, code: int) -> int:
    if sys.stderr is not None:
        print(f"aifrecon: {message}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())

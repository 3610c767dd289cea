"""Runs AIFRecon's self tests on the host, alone in one process: those of the module's file and Testing/Slicer/*Test.py.

    python Testing/host/run_self_tests.py [-k WORD ...]

The exit status is 0 when all passed, 1 when one failed, 2 when the host cannot run here or the tests cannot be loaded.
A test that hangs ends the run after LONGEST seconds: its name is the last one printed, and every thread says where it is.
"""

from __future__ import annotations

import argparse
import faulthandler
import sys
import unittest
from pathlib import Path
from typing import Any, cast

TESTING = Path(__file__).resolve().parents[1]
LONGEST = 400
"""Seconds that one test may take: the longest takes some ten alone."""

sys.path.insert(0, str(TESTING))
from host import SlicerHost, missing, runHost  # noqa: E402 - the folder must be known first


def all_cases(suite):
    """The single tests of a suite."""
    for each in suite:
        if isinstance(each, unittest.TestSuite):
            yield from all_cases(each)
        else:
            yield each


def collect(host, module: Path, folder: Path) -> list[unittest.TestCase]:
    """Every test of the module's test class and of the test files in a folder."""
    loader = unittest.defaultTestLoader
    host.start(module)
    python = sys.modules[module.stem]
    cases = list(all_cases(loader.loadTestsFromTestCase(getattr(python, f"{module.stem}Test"))))
    sys.path.insert(0, str(folder))
    for path in sorted(folder.glob("*Test.py")) if folder.is_dir() else []:
        cases += all_cases(loader.loadTestsFromName(path.stem))
    return cases


class Result(unittest.TextTestResult):
    """Resets the host before every test and says which slots failed during one."""

    host: SlicerHost

    def startTest(self, test):
        faulthandler.dump_traceback_later(LONGEST, exit=True)
        self.host.reset()
        self._files = self._saved()
        super().startTest(test)

    def stopTest(self, test):
        """Names exceptions that stayed in slots, and fails a test that leaves files where the user's are.

        A test may have meant the exceptions, so only a failed assertion is a failure.
        """
        super().stopTest(test)
        left = self._saved() - self._files
        if left:
            self.addFailure(test, (AssertionError, AssertionError(f"Left among the user's files: {', '.join(sorted(left))}"), None))
        for error in self.host.take_slot_errors():
            self.stream.writeln(f"  (raised in a slot: {type(error).__name__}: {error})")
            if isinstance(error, AssertionError):
                self.addFailure(test, (type(error), error, error.__traceback__))

    def _saved(self) -> set[str]:
        return {path.name for path in self.host.documents.iterdir()}


def main(arguments=None) -> int:
    """Runs the tests; returns the exit status."""
    parser = argparse.ArgumentParser(description="Run the module's self tests on the host.")
    parser.add_argument("--module", type=Path, default=TESTING.parent / "AIFRecon" / "AIFRecon.py", help="the scripted module")
    parser.add_argument("--tests", type=Path, default=TESTING / "Slicer", help="folder of further test files, *Test.py")
    parser.add_argument("-k", metavar="WORD", nargs="+", default=[""], help="only tests whose name contains one of these words")
    options = parser.parse_args(arguments)
    if reason := missing():
        print(f"The self tests cannot run here: {reason}.", file=sys.stderr)
        return 2
    host = runHost(testing=True)
    try:
        cases = collect(host, options.module.resolve(), options.tests.resolve())
    except Exception as error:
        print(f"The self tests cannot be loaded: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    cases = [case for case in cases if any(word in case.id() for word in options.k)]
    if not cases:
        print("There is no such test.")
        return 2
    Result.host = host
    outcome = unittest.TextTestRunner(stream=sys.stdout, verbosity=2, resultclass=cast(Any, Result)).run(unittest.TestSuite(cases))
    host.close()
    return 0 if outcome.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())

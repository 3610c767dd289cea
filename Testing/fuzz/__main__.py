"""`make fuzz`: shares a time out among the targets, each in a process of its own, and says what was run and found.

    python Testing/fuzz --seconds 600

The exit code is 1 when anything was found. hypothesis makes a finding as small as it can; it lies in a folder beside a text that says
what was wrong. Mend the library, and add the input to Testing/Python/tools/test_fuzz_findings.py.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

TESTING = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTING.parent), str(TESTING), str(TESTING / "Python"), str(TESTING / "Python" / "compounding")]

from AIFReconLib.machine.processes import start_python  # noqa: E402
from fuzz.damage import damage_for  # noqa: E402
from fuzz.targets import TARGETS, Target  # noqa: E402

HANG = 600.0
"""s beyond its time after which a target hangs; a finding is made small for five minutes at most."""


def fuzz(targets: Iterable[Target], seconds: float) -> int:
    """Fuzz each of these for so long; the answer is how many broke."""
    found = 0
    for target in targets:
        folder = Path(tempfile.mkdtemp(prefix=f"aifrecon-fuzz-{target.name}-"))
        with open(folder / "finding.txt", "wb") as file:
            process, connection = start_python(damage_for, target, seconds, folder, stderr=file.fileno())
        try:
            if not connection.poll(seconds + HANG):
                raise EOFError
            read, accepted = connection.recv()
            process.wait()
            print(f"{target.name:24s} {read:8d} inputs, {accepted:8d} of them accepted", flush=True)
        except EOFError:
            found += 1
            process.kill()
            print(f"FINDING {target.name}: the process ended with {process.wait()}; see {folder}", flush=True)
    return found


def main() -> int:
    """Fuzz the targets in turn."""
    parser = argparse.ArgumentParser(description="Fuzz the ways into the library.")
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=f"default: all of {', '.join(TARGETS)}")
    parser.add_argument("--seconds", type=float, default=600.0, help="for all targets together (default: %(default)g)")
    arguments = parser.parse_args()
    names = arguments.targets or list(TARGETS)
    found = fuzz([TARGETS[name] for name in names], arguments.seconds / len(names))
    print(f"{found} findings")
    return min(found, 1)


if __name__ == "__main__":
    sys.exit(main())

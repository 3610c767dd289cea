"""All faults, one kind after the other, for a given time: `make faults`.

    python -m faults --seconds 3600
    python -m faults --seconds 60 "live recording"

Linux, best as root. Words choose cases by their names. The exit code is 1 when anything was lost.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

TESTING = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTING.parent), str(TESTING / "Python")]

from measured import keep  # noqa: E402

from faults.kills import CASES  # noqa: E402
from faults.ledger import Ledger  # noqa: E402


def main() -> int:
    """Run, and print the table."""
    parser = argparse.ArgumentParser(prog="python -m faults", description=__doc__.splitlines()[0])
    parser.add_argument("words", nargs="*", metavar="WORDS", help="only cases with one of these in their name (default: all)")
    parser.add_argument("--seconds", type=float, default=3600.0, metavar="S", help="time for all of them (default: %(default)g)")
    parser.add_argument("--pages", action="store_true", help="also renew docs/measured, and the pages that show it")
    arguments = parser.parse_args()
    words = arguments.words or [""]
    ledger = Ledger()
    ledger.run([case for case in CASES if any(word in f"{case.fault}: {case.where}" for word in words)], arguments.seconds)
    print(ledger.markdown(), *(f"LOST {what} ({count} times)" for what, count in ledger.lost.items()), sep="\n")
    if arguments.pages and not arguments.words:
        keep({"faults": ledger.markdown()}, "make faults")
    return 1 if ledger.lost else 0


if __name__ == "__main__":
    sys.exit(main())

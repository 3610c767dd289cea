"""All faults, one kind after the other, for a given time: `make faults`.

    python -m faults --seconds 3600 --markdown faults.md
    python -m faults --only kill places

Linux. As root it also mounts small disks that fill up and disks that fail. The exit code is 1 when anything was lost.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

TESTING = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTING.parent), str(TESTING / "Python")]

from measured import keep  # noqa: E402

from faults import changing, endings, killing, places, workers, writers  # noqa: E402
from faults.commands import COMMANDS, CONVERT, LONG_COMMANDS  # noqa: E402
from faults.ledger import Ledger  # noqa: E402
from faults.readers import READERS  # noqa: E402

KINDS = {
    "places": lambda ledger: places.run(ledger, writers.WRITERS),
    "changing": changing.run,
    "endings": endings.run,
    "kill": lambda ledger: killing.run(ledger, writers.WRITERS + writers.RECORDINGS, COMMANDS + LONG_COMMANDS),
    # Last: what forks must not have had threads
    "worker": workers.run,
}

QUICK = {
    "places": lambda ledger: places.run(ledger, (writers.VOLUMES[2],), each=3),
    "changing": lambda ledger: changing.run(ledger, READERS[:1], moments=3, places=2),
    "endings": lambda ledger: endings.run(ledger, (CONVERT,), endings.SURROUNDINGS[2:5], trials=2),
    "kill": lambda ledger: killing.run(ledger, (writers.SEQUENCES[-1], writers.RECORDINGS[1]), (CONVERT,), 12, 2),
    "worker": lambda ledger: workers.run(ledger, trials=3),
}
"""The same with few kinds of files, a few times each: to see that it all works."""


def main() -> int:
    """Run, and print the table."""
    parser = argparse.ArgumentParser(prog="python -m faults", description=__doc__.splitlines()[0])
    parser.add_argument(
        "--seconds", type=float, default=3600.0, metavar="S", help="time in which kinds of faults are begun (default: 3600)"
    )
    parser.add_argument("--only", nargs="+", choices=tuple(KINDS), default=tuple(KINDS), help="these kinds (default: all)")
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="also write the table here, after every entry")
    parser.add_argument("--pages", action="store_true", help="also renew docs/measured, and the pages that show it")
    parser.add_argument("--quick", action="store_true", help="only a few of each, in seconds")
    arguments = parser.parse_args()
    if arguments.pages and (arguments.quick or len(arguments.only) < len(KINDS)):
        parser.error("the pages are of whole runs: leave out --quick and --only, or --pages")
    ledger = Ledger(arguments.seconds, arguments.markdown)
    for kind in arguments.only:
        (QUICK if arguments.quick else KINDS)[kind](ledger)
    print(ledger.markdown())
    if arguments.markdown:
        arguments.markdown.write_text(ledger.markdown(), encoding="utf-8")
    if arguments.pages:
        keep(ledger.in_the_pages(), "make faults")
    return 1 if ledger.lost else 0


if __name__ == "__main__":
    sys.exit(main())

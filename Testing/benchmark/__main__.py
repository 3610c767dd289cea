"""Starts the benchmark, ``python Testing/benchmark``; a word behind it names another one.

``commands``: of whole commands; ``live``: of a live session; ``spine``: of a large sweep, from file to file.
"""

import sys
from importlib import import_module
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[level]) for level in (1, 2)]

OTHERS = ("commands", "live", "spine")

if __name__ == "__main__":
    words = sys.argv[1:]
    name, rest = (words[0], words[1:]) if words[:1] and words[0] in OTHERS else ("speed", words)
    raise SystemExit(import_module(f"benchmark.{name}").main(rest))

"""Starts the benchmark, ``python Testing/benchmark``; with ``live`` behind it, that of a live session."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[level]) for level in (1, 2)]

if __name__ == "__main__":
    from benchmark import live, speed

    words = sys.argv[1:]
    if words[:1] == ["live"]:
        live.main(words[1:])
    else:
        raise SystemExit(speed.main(words))

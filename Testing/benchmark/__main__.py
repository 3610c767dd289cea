"""Starts the benchmark, ``python Testing/benchmark``; behind it ``live``: of a live session, or ``large``: of a large box."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[level]) for level in (1, 2)]

if __name__ == "__main__":
    from benchmark import large, live, speed

    words = sys.argv[1:]
    if words[:1] == ["live"]:
        live.main(words[1:])
    elif words[:1] == ["large"]:
        large.main(words[1:])
    else:
        raise SystemExit(speed.main(words))

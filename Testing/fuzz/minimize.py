"""The smallest set of inputs that reaches every line that many inputs reach: what `corpus.zip` holds.

    python Testing/fuzz/minimize.py [TARGET ...] [--from FOLDER] [--damaged N]

Each target's inputs are its seeds, the corpus as it is, those in FOLDER/TARGET (as `run.py --corpus FOLDER` leaves them) and N damaged
ones. The smallest come first, and one is kept if it reaches a line of the library that no kept one does.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
import warnings
from pathlib import Path

TESTING = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTING), str(TESTING.parent)]

LARGEST_INPUT = 9000
"""Bytes; but a seed is kept whatever its size."""
LIBRARY = str(TESTING.parent / "AIFReconLib")


def reached(run) -> set[tuple[str, int]]:
    """The lines of the library that run while `run` does."""
    lines: set[tuple[str, int]] = set()

    def in_function(frame, event, _):
        lines.add((frame.f_code.co_filename, frame.f_lineno))
        return in_function

    def enter(frame, event, _):
        return in_function if frame.f_code.co_filename.startswith(LIBRARY) else None

    before = sys.gettrace()
    sys.settrace(enter)
    try:
        run()
    finally:
        sys.settrace(before)
    return lines


def smallest_set(target, inputs: list[bytes], folder: Path) -> list[bytes]:
    """Those of `inputs`, smallest first, that reach a line which none before does."""
    from fuzz.target import check

    known: set[tuple[str, int]] = set()
    kept = []
    for data in sorted(set(inputs), key=lambda data: (len(data), data)):
        lines = reached(lambda data=data: check(target, data, folder))
        if not lines <= known:
            known |= lines
            kept.append(data)
    return kept


def main() -> int:
    """Rewrite the corpus of the targets."""
    from fuzz.corpus import read_corpus, write_corpus
    from fuzz.mutation import mutate
    from fuzz.registry import TARGETS

    parser = argparse.ArgumentParser(description="Rewrite the corpus.")
    parser.add_argument("targets", nargs="*", metavar="TARGET")
    parser.add_argument("--from", type=Path, dest="more", metavar="FOLDER")
    parser.add_argument("--damaged", type=int, default=1500, metavar="N")
    arguments = parser.parse_args()
    warnings.simplefilter("error")
    corpus = read_corpus()
    for name in arguments.targets or TARGETS:
        target = TARGETS[name]
        seeds = target.seeds()
        more = sorted((arguments.more / name).glob("*")) if arguments.more else []
        found = [*corpus.get(name, []), *(path.read_bytes() for path in more)]
        rng = random.Random(0)
        damaged = [mutate(rng.choice(seeds), rng, target.words, seeds) for _ in range(arguments.damaged)]
        small = [data for data in (*found, *damaged) if len(data) <= LARGEST_INPUT]
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            (folder / "data.raw").write_bytes(bytes(range(24)) * 3)
            kept = smallest_set(target, [*seeds, *small], folder)
        corpus[name] = kept
        write_corpus({name: inputs for name, inputs in corpus.items() if name in TARGETS})
        print(f"{name}: {len(kept)} of {len(set(small)) + len(seeds)} inputs, {sum(map(len, kept))} bytes", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())

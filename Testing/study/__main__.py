"""Starts a study, ``python Testing/study NAME --output DIR``; without a name it lists them.

A study is a file here whose ``main(arguments)`` returns the exit status; its first line says what it asks.
"""

import importlib
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

STUDIES = ("methods", "registration", "calibration", "guidance", "paths", "real_bone", "ct_bone", "looks", "motion")


def main(words: list[str]) -> int:
    """Run the study of this name."""
    if words and words[0] in STUDIES:
        return importlib.import_module(f"study.{words[0]}").main(words[1:])
    print(f"usage: python Testing/study {{{','.join(STUDIES)}}} --output DIR", file=sys.stderr)
    return 2


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))

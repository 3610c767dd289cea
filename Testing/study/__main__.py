"""Starts a study, ``python Testing/study NAME --output DIR``; without a name it lists them.

A study is a file here that has a `STUDY`; its first line says what it asks.
"""

import importlib
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

STUDIES = ("methods", "registration", "calibration", "guidance", "paths", "real_bone", "ct_bone", "looks", "motion")


def main(words: list[str]) -> int:
    """Run the study of this name."""
    if words and words[0] in STUDIES:
        module = importlib.import_module(f"study.{words[0]}")
        return module.main(words[1:]) if words[0] == "real_bone" else module.STUDY.run(words[0], module.__doc__, words[1:])
    print(f"usage: python Testing/study {{{','.join(STUDIES)}}} --output DIR", file=sys.stderr)
    return 2


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))

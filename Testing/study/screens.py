"""Is the probe told rightly from recordings of a scanner's screen? 200 made ones, and others that show no probe that could be told."""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path

import numpy as np

from AIFReconLib.errors import BeamGeometryError
from AIFReconLib.imaging.detection import DetectedImaging, detect_imaging
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.terminal.console import ProgressBar

from .screen_cases import Screen, decoy, screen

RIGHT, REFUSED, WRONG = "right", "refused", "wrong"
LARGEST_ANGLE_ERROR, LARGEST_APEX_ERROR = 1.0, 0.5
"""Degrees; mm."""

LEAST_KEPT, MOST_BESIDE = 0.85, 0.04
"""Part of the lit ultrasound that must be kept, and of the kept pixels that may be none."""


def main(words: list[str]) -> int:
    """Run and print; the answer is the exit status."""
    parser = argparse.ArgumentParser(prog="python Testing/study screens", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder for a table of all screens")
    parser.add_argument("--screens", type=int, default=200, metavar="N", help="how many (default: %(default)s)")
    parser.add_argument("--decoys", type=int, default=40, metavar="N", help="how many that show no probe (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="number of the first (default: %(default)s)")
    arguments = parser.parse_args(words)
    rows, total = [], arguments.screens + arguments.decoys
    counts: dict[str, Counter[str]] = {"screens": Counter(), "decoys": Counter()}
    with ProgressBar() as progress:
        for number in range(total):
            progress(number / total, "Looking at screens")
            group, make = ("screens", screen) if number < arguments.screens else ("decoys", decoy)
            seed = arguments.first + (number if number < arguments.screens else number - arguments.screens)
            made = make(seed)
            answer, words_ = judged(made)
            counts[group][answer] += 1
            rows.append(f"{group},{seed},{made.kind},{'; '.join(made.features)},{answer},{words_}")
            if answer != (RIGHT if group == "screens" else REFUSED):
                print(rows[-1])
    for group, count in counts.items():
        print(f"{group}: " + ", ".join(f"{count[answer]} {answer}" for answer in (RIGHT, REFUSED, WRONG)))
    if arguments.output:
        arguments.output.mkdir(parents=True, exist_ok=True)
        write_text(arguments.output / "screens.csv", "\n".join(["group,seed,kind,features,answer,words", *rows]) + "\n")
    return 0


def judged(made: Screen) -> tuple[str, str]:
    """Whether a screen is told rightly, and by how much not."""
    try:
        found = detect_imaging(made.images, made.spacing)
    except BeamGeometryError as error:
        return REFUSED, str(error).replace(",", ";")
    return judged_finding(made, found)


def judged_finding(made: Screen, found: DetectedImaging) -> tuple[str, str]:
    """The same, of what was found."""
    rows, columns = made.inside.shape
    kept = found.region.mask(columns, rows)
    share, beside = (made.lit & kept).sum() / made.lit.sum(), (kept & ~made.inside).sum() / kept.sum()
    words = f"keeps {share:.3f} of it and {beside:.3f} of others"
    right = found.probe.kind == made.probe and share >= LEAST_KEPT and beside <= MOST_BESIDE
    if found.probe.kind == made.probe and made.apex is not None:
        assert found.region.fan is not None
        apex = float(np.hypot(*(np.subtract(found.probe.apex, made.apex) * made.spacing)))
        angle = float(np.abs(np.subtract(found.region.fan.angles_deg, made.angles)).max())
        right = right and apex <= LARGEST_APEX_ERROR and angle <= LARGEST_ANGLE_ERROR
        words = f"apex off by {apex:.2f} mm; angles by {angle:.2f} degrees; {words}"
    return (RIGHT if right else WRONG), f"{found.probe.kind}; {words}"

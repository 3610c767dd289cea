"""The module's own way, for as long as asked: its panel, with an image node of the scene as the source, on the host.

    python Testing/soak scene --minutes 5

The panel runs without the Slicer application; see `Testing/host`. A simulated minute is 1200 updates of the image node, as fast as they
are taken. The exit status is 1 when an update is not accounted for, or nodes, observers or threads grow.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

import psutil

from .stream import RATE

REPOSITORY = Path(__file__).resolve().parents[2]


def main(argv: list[str]) -> int:
    """Run it, print what was there now and then."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=5.0, metavar="M", help="simulated time (default: %(default)g)")
    arguments = parser.parse_args(argv)
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    from host import missing, runHost

    if reason := missing():
        print(f"The panel cannot run here: {reason}.", file=sys.stderr)
        return 2
    host = runHost(testing=True)
    host.start(REPOSITORY / "AIFRecon" / "AIFRecon.py")
    host.open("AIFRecon")
    sys.path.insert(0, str(REPOSITORY / "Testing" / "Slicer"))
    import liveSceneSoak
    import slicer

    soak = liveSceneSoak.begin(slicer.modules.AIFReconWidget)
    print(" ".join(f"{name:>9}" for name in ("frames", "nodes", "observers", "threads", "blocks", "MiB")), flush=True)

    def report(look) -> None:
        if look.frames % 600 == 0:
            numbers = (look.frames, look.nodes, look.observers, look.threads, look.blocks)
            print(" ".join(f"{number:9d}" for number in numbers) + f" {psutil.Process().memory_info().rss / 2**20:9.1f}", flush=True)

    looks = soak.run(round(60 * RATE * arguments.minutes), report)
    live = soak.live._live
    soak.live.onStop()
    statistics = live.statistics
    host.close()
    findings = []
    if soak.updates != statistics.frames_received + statistics.dropped_images:
        findings.append(f"{soak.updates} updates, but {statistics}")
    if statistics.frames_received != statistics.inserted + statistics.frames_skipped:
        findings.append(f"frames are missing: {statistics}")
    settled = looks[len(looks) // 4 :]
    for name in ("nodes", "observers", "threads"):
        seen = {getattr(look, name) for look in settled}
        if len(seen) > 1:
            findings.append(f"{name} vary: {sorted(seen)}")
    print(f"{soak.updates} updates = {statistics.frames_received} frames + {statistics.dropped_images} replaced before they were taken")
    print(f"{statistics.frames_received} frames = {statistics.inserted} inserted + {statistics.skipped}")
    print("\n".join(f"FINDING: {finding}" for finding in findings) or "nothing grows")
    return 1 if findings else 0

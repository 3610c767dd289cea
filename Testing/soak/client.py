"""The soak test: a live session against the faulty server, then the accounts.

    python Testing/soak                            an hour of simulated time, recorded, and the recording read back
    python Testing/soak --minutes 1 --seed 7       a short one; a seed gives the same faults in the same order

The stream's time stamps run an hour at 20 frames/s; on the wall it takes a sixth of that. Every limit of the client (stalls, pauses between
attempts to connect) is by the wall's clock, as is the length of the server's stalls and absences. The exit status is 1 when an account
does not add up, an image differs from the one that was sent, or something grows.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil
from benchmark.live import plate

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.imaging.beams import LINEAR, ProbeGeometry
from AIFReconLib.imaging.extent import grid_around_sweep
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.session.statistics import LiveStatistics
from AIFReconLib.live.wire.client import OpenIGTLinkClient
from AIFReconLib.live.wire.messages import ImageMessage
from AIFReconLib.machine.processes import start_python
from AIFReconLib.recipe.recipe import ReconstructionSettings

from . import server as stream
from .server import AGAIN, DESTROYED, FOREIGN, UNUSABLE, WHOLE, serve

SNAPSHOT_EVERY = 1.0
"""s on the wall."""

DEADLINE = 1200.0
"""s in which the last frames must arrive and be worked on."""

SETTLING = 10
"""Simulated minutes after which nothing may grow any more: engines are compiled and every buffer has reached its size by then."""

MOST = {"MiB": (16.0, 100.0), "blocks": (50_000.0, np.inf), "threads": (np.inf, 1), "files": (np.inf, 4)}
"""By how much each may rise in a simulated hour, and by how much it may vary. A connection that is being made is a file for a moment."""


class Tap(OpenIGTLinkClient):
    """The client under test; notes which images it hands on, and whether each is, pixel for pixel, one that was sent."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.taken = self.strangers = 0
        self.seen: set[int] = set()

    def get(self, timeout=None):
        """The next message, looked at on its way."""
        message = super().get(timeout)
        if isinstance(message, ImageMessage):
            self.taken += 1
            number = stream.number_of(message.image)
            if number is not None:
                self.seen.add(number)
            elif message.device == stream.DEVICE and (message.image != 7).any():
                self.strangers += 1
        return message


@dataclass
class Outcome:
    """What a soak test found."""

    fates: Counter[str]
    faults: Counter[str]
    statistics: LiveStatistics
    wall: float
    findings: list[str] = field(default_factory=list)


def soak(seed: int, minutes: float, record: Path, report: Callable[[str], None] = lambda line: None) -> Outcome:
    """Reconstruct to the end of the stream, and draw up the accounts; `report` is told a line every simulated minute."""
    process, server = start_python(serve, seed, minutes)
    client = Tap("127.0.0.1", server.recv())
    session = LiveSession(client, **imaging(), record=record)
    samples: list[dict[str, float]] = []
    began, looked, told = time.monotonic(), 0.0, None
    try:
        session.prepare()
        session.start()
        while told is None and session.error is None:
            if server.poll(0.01):
                came = server.recv()
                if isinstance(came, int):
                    samples.append({"minute": came, **look()})
                    report(" ".join(f"{name} {value:.0f}" for name, value in samples[-1].items()) + f"; {session.statistics}")
                else:
                    told = came
            if time.monotonic() - looked > SNAPSHOT_EVERY:
                looked = time.monotonic()
                session.snapshot()
        # What the server has sent may still lie with the operating system, of which no count of the client knows
        end = time.monotonic() + DEADLINE
        while told and session.error is None and time.monotonic() < end:
            if told[0][-1][0] in client.seen and not under_way(client, session):
                break
            time.sleep(0.01)
    finally:
        session.stop()
        process.kill()
        process.wait()
    if told is None:
        raise SystemExit(f"The server was not heard to the end; session: {session.error}; {session.statistics}")
    notes, faults = told
    fates = Counter(fate for _number, _fault, fate in notes)
    findings = [*unequal(fates, client, session), *growth(samples), *strange(notes, client)]
    if session.error is not None:
        findings.append(f"the session failed: {session.error}")
    findings += judged_recording(session, record, client.seen)
    return Outcome(fates, faults, session.statistics, time.monotonic() - began, findings)


def under_way(client: Tap, session: LiveSession) -> int:
    """Images that the client has received and nobody has worked on yet."""
    counted, frames = client.statistics, session.statistics
    out = frames.inserted + frames.frames_skipped + frames.repeated + frames.other_images + counted.refused + counted.dropped_images
    return counted.count("IMAGE") - out


def imaging() -> dict:
    """What a session needs to reconstruct the scan, as its keyword arguments."""
    poses = np.stack([stream.image_to_reference(number) for number in range(len(stream.scan()))])
    region = ImageRegion(ClipRectangle((0.0, 0.0), (stream.COLUMNS - 1.0, stream.ROWS - 1.0)))
    return {
        "settings": ReconstructionSettings(method="aif-compensated", **imaging_fields(region, ProbeGeometry(LINEAR))),
        "bone": BoneMap.from_labels(plate(), sigma_mm=4.0),
        "grid": grid_around_sweep(poses, (stream.COLUMNS, stream.ROWS), region, (1.0,) * 3),
    }


# ---- accounts


def unequal(fates: Counter[str], client: Tap, session: LiveSession) -> list[str]:
    """Frames in = frames inserted + frames accounted for: what must add up once the stream is over, and does not."""
    counted, frames = client.statistics, session.statistics
    images = counted.count("IMAGE")
    told = frames.frames_received + frames.repeated + frames.other_images
    whole = fates[WHOLE] + fates[AGAIN] + fates[FOREIGN]
    out = frames.inserted + frames.frames_skipped + frames.waiting
    equations = (
        ("image messages sent = destroyed on the wire + arrived", fates.total(), fates[DESTROYED] + images),
        ("messages that make no sense: sent = refused", fates[UNUSABLE], counted.refused),
        ("images of the other device: sent = arrived", fates[FOREIGN], counted.count("IMAGE", stream.OTHER_DEVICE)),
        ("images that arrived = frames + again + of others + refused + dropped", images, told + counted.refused + frames.dropped_images),
        ("images sent whole = taken + dropped", whole, client.taken + counted.dropped_images),
        ("frames = inserted + skipped by reason + waiting", frames.frames_received, out),
        ("frames that wait = none", frames.waiting, 0),
        ("frames = recorded", frames.frames_received, frames.recorded),
    )
    return [f"{says}: {left} = {right} is broken" for says, left, right in equations if left != right]


def strange(notes: list[tuple[int, str, str]], client: Tap) -> list[str]:
    """Images that were handed on and never sent, or destroyed; whole ones that came to nobody and were not dropped with a count."""
    found = []
    if client.strangers:
        found.append(f"{client.strangers} images were handed on that were never sent")
    if spoiled := client.seen & {number for number, _fault, fate in notes if fate == DESTROYED}:
        found.append(f"{len(spoiled)} images were handed on that were destroyed on the wire")
    missing = Counter(
        fault for number, fault, fate in notes if fate == WHOLE and number not in client.seen and fault != "another size of image"
    )
    if missing.total() > (dropped := client.statistics.dropped_images):
        found.append(f"{missing.total()} whole frames came to nobody, and only {dropped} were dropped with a count ({dict(missing)})")
    return found


def judged_recording(session: LiveSession, record: Path, seen: set[int]) -> list[str]:
    """What is wrong with the recording; read as anyone would."""
    if session.recording_failure:
        return [session.recording_failure]
    recorded = read_sequence(record)
    found = {stream.number_of(np.asarray(recorded.images[place])) for place in range(len(recorded))} - {None}
    problems = []
    if len(recorded) != session.statistics.frames_received:
        problems.append(f"the recording has {len(recorded)} frames of {session.statistics.frames_received}")
    if found != seen:
        problems.append(f"the recording lacks {len(seen - found)} images that arrived, and has {len(found - seen)} others")
    return problems


# ---- growth


def look() -> dict[str, float]:
    """What this process holds: resident memory, once the allocator has given back what it keeps, blocks of Python's, threads, files."""
    gc.collect()
    with suppress(OSError, AttributeError):
        ctypes.CDLL("libc.so.6").malloc_trim(0)
    own = psutil.Process()
    threads = []
    for _ in range(5):  # insertion and snapshots have helpers that live for a moment
        threads.append(own.num_threads())
        time.sleep(0.01)
    files = own.num_fds() if hasattr(own, "num_fds") else 0
    return {"MiB": own.memory_info().rss / 2**20, "blocks": sys.getallocatedblocks(), "threads": min(threads), "files": files}


def growth(samples: list[dict[str, float]]) -> list[str]:
    """What grows after `SETTLING` minutes, by a line that is fitted to it; nothing with too few samples for one."""
    settled = [sample for sample in samples if sample["minute"] >= SETTLING]
    if len(settled) < 5:
        return []
    hours = [sample["minute"] / 60.0 for sample in settled]
    found = []
    for name, (slope, range_) in MOST.items():
        values = [sample[name] for sample in settled]
        if np.polyfit(hours, values, 1)[0] > slope or max(values) - min(values) > range_:
            found.append(f"not flat: {name} go from {values[0]:.0f} to {values[-1]:.0f}, between {min(values):.0f} and {max(values):.0f}")
    return found


def main() -> int:
    """Run it, print what was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="of the faults (default: %(default)s)")
    parser.add_argument("--minutes", type=float, default=60.0, metavar="M", help="simulated time (default: %(default)g)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        outcome = soak(arguments.seed, arguments.minutes, Path(folder) / "scan.mhd", report=lambda line: print(line, flush=True))
    print(f"in {outcome.wall:.0f} s: {dict(outcome.faults)}; images {dict(outcome.fates)}; {outcome.statistics}")
    print("\n".join(f"FINDING: {finding}" for finding in outcome.findings) or "all accounts add up, nothing grows")
    return 1 if outcome.findings else 0

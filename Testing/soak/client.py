"""The soak test: a live session against the faulty server, then the accounts.

    python Testing/soak                            an hour of simulated time, as fast as this machine keeps up
    python Testing/soak --record                   also recorded, and the recording read back
    python Testing/soak --minutes 1 --seed 7       a short one; a seed gives the same faults in the same order

The stream's time stamps run an hour at 20 frames/s. The wall's clock runs as fast as the client keeps up, and every limit of the client
(stalls, pauses between attempts to connect, patience) is by the wall's clock, as is the length of the server's stalls and absences.
The exit status is 1 when an account does not add up, an image differs from the one that was sent, or something grows.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from benchmark.live import plate

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.imaging.beams import LINEAR, ProbeGeometry
from AIFReconLib.imaging.extent import grid_around_sweep
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.session.snapshots import SnapshotMaker
from AIFReconLib.live.session.statistics import LiveStatistics
from AIFReconLib.live.wire.client import OpenIGTLinkClient
from AIFReconLib.live.wire.messages import ImageMessage
from AIFReconLib.live.wire.sources import StreamStatistics
from AIFReconLib.recipe.recipe import ReconstructionSettings

from . import stream
from .accounts import Equation, equations
from .growth import Growth, Sample, growth, look
from .ledger import read_ledger

HOLD_ABOVE, GO_BELOW = 30, 10
"""Frames under way in the client at which the server is asked to hold, and to go on."""

LOOKED = 0.01
SNAPSHOT_EVERY = 1.0
"""s on the wall."""

DEADLINE = 1200.0
"""s in which the last frames must arrive and be worked on."""


class Tap(OpenIGTLinkClient):
    """The client under test; notes which images it hands on, and whether each is, pixel for pixel, one that was sent."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.taken = 0
        self.seen = bytearray(1)
        self.strangers = 0

    def get(self, timeout=None):
        """The next message, looked at on its way."""
        message = super().get(timeout)
        if isinstance(message, ImageMessage):
            self._look_at(message)
        return message

    def has_seen(self, number: int) -> bool:
        """Whether the image of this number was handed on."""
        return number < len(self.seen) and bool(self.seen[number])

    def _look_at(self, message: ImageMessage) -> None:
        self.taken += 1
        number = stream.number_of(message.image)
        if number is not None:
            if number >= len(self.seen):
                self.seen.extend(bytes(number + 1000 - len(self.seen)))
            self.seen[number] = 1
        elif message.device == stream.DEVICE and (message.image != 7).any():
            self.strangers += 1


@dataclass
class Outcome:
    """What a soak test found."""

    told: dict
    equations: list[Equation]
    samples: list[Sample]
    growth: Growth | None
    statistics: LiveStatistics
    stream: StreamStatistics
    wall: float
    findings: list[str] = field(default_factory=list)


class Server:
    """The faulty server in a process of its own."""

    def __init__(self, seed: int, minutes: float, ledger: Path, on_minute: Callable[[int], None]):
        command = [sys.executable, str(Path(__file__).parent), "serve", "--seed", str(seed), "--minutes", str(minutes)]
        self._process = subprocess.Popen([*command, "--ledger", str(ledger)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self._on_minute = on_minute
        self._held = False
        self.told: dict = {}
        self.over = threading.Event()
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._orders, self._words = self._process.stdin, self._process.stdout
        self.port = json.loads(self._words.readline())["port"]
        self._reader = threading.Thread(target=self._read, name="server's words", daemon=True)
        self._reader.start()

    def _read(self) -> None:
        for line in self._words:
            told = json.loads(line)
            if "minute" in told:
                self._on_minute(told["minute"])
            else:
                self.told = told
                break
        self.over.set()

    def steer(self, under_way: int) -> None:
        """Ask it to hold while the client has much to do."""
        if (under_way > HOLD_ABOVE) != self._held and not (GO_BELOW <= under_way <= HOLD_ABOVE):
            self._held = under_way > HOLD_ABOVE
            with suppress(BrokenPipeError):  # it has ended, and says why on its other pipe
                self._orders.write("hold\n" if self._held else "go\n")
                self._orders.flush()

    def end(self) -> None:
        """End the process, whatever it is doing."""
        with suppress(BrokenPipeError):
            self._orders.close()
        try:
            self._process.wait(10.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._words.close()


def under_way(client: Tap, session: LiveSession) -> int:
    """Images that the client has received and nobody has worked on yet."""
    counted, frames = client.statistics, session.statistics
    out = frames.inserted + frames.frames_skipped + frames.repeated + frames.other_images + counted.refused + counted.dropped_images
    return counted.count("IMAGE") - out


def soak(
    seed: int,
    minutes: float,
    ledger: Path,
    *,
    record: Path | None = None,
    engine: str = "auto",
    report: Callable[[str], None] = lambda line: None,
) -> Outcome:
    """Reconstruct to the end of the stream, and draw up the accounts.

    Parameters
    ----------
    seed : int
    minutes : float
        Of simulated time.
    ledger : Path
        Where the server writes what it did to each frame.
    record : Path or None
        Also record, and read the recording back.
    engine : str
    report : function (str) -> None
        Told a line every simulated minute.
    """
    samples: list[Sample] = []
    began = time.monotonic()
    ready = threading.Event()

    def on_minute(minute: int) -> None:
        ready.wait()
        samples.append(look(minute, time.monotonic() - began))
        sample, frames = samples[-1], session.statistics
        report(
            f"{minute:4d} {sample.wall:7.0f} {frames.frames_received:8d} {frames.inserted:8d} {frames.frames_skipped:8d} "
            f"{sample.memory_mib:9.1f} {sample.blocks:8d} {sample.threads:4d} {sample.files:4d}"
        )

    server = Server(seed, minutes, ledger, on_minute)
    client = Tap("127.0.0.1", server.port)
    session = LiveSession(client, **imaging(engine), record=record)
    snapshots = SnapshotMaker(session)
    try:
        session.prepare()
        session.start()
        ready.set()
        looked = 0.0
        while not server.over.wait(LOOKED) and session.error is None:
            server.steer(under_way(client, session))
            if time.monotonic() - looked > SNAPSHOT_EVERY:
                looked = time.monotonic()
                snapshots.take()
                snapshots.request()
        # What the server has sent may still lie with the operating system, of which no count of the client knows
        last, end = server.told.get("last", 0), time.monotonic() + DEADLINE
        while (not client.has_seen(last) or under_way(client, session)) and session.error is None and time.monotonic() < end:
            time.sleep(LOOKED)
    finally:
        ready.set()
        snapshots.stop()
        session.stop()
        server.end()
    return _judge(server, client, session, samples, ledger, record, time.monotonic() - began)


def imaging(engine: str = "auto") -> dict:
    """What a session needs to reconstruct the scan, as its keyword arguments."""
    poses = np.stack([stream.image_to_reference(number) for number in range(len(stream.scan()))])
    region = ImageRegion(ClipRectangle((0.0, 0.0), (stream.COLUMNS - 1.0, stream.ROWS - 1.0)))
    grid = grid_around_sweep(poses, (stream.COLUMNS, stream.ROWS), region, (1.0,) * 3)
    settings = ReconstructionSettings(method="aif-compensated", engine=engine, **imaging_fields(region, ProbeGeometry(LINEAR)))
    return {
        "settings": settings,
        "bone": BoneMap.from_labels(plate(), sigma_mm=4.0),
        "grid": grid,
    }


def _judge(server: Server, client: Tap, session: LiveSession, samples, ledger: Path, record: Path | None, wall: float) -> Outcome:
    """The accounts, the growth, and in words whatever is not as it must be."""
    if "fates" not in server.told:
        raise SystemExit(f"The server ended early: {server.told or 'without a word'}; session: {session.error}; {session.statistics}")
    accounts = equations(server.told, client, session, client.taken)
    grown = growth(samples)
    findings = [str(account) for account in accounts if not account.holds]
    if client.strangers:
        findings.append(f"{client.strangers} images were handed on that were never sent")
    whole, destroyed = read_ledger(ledger)
    seen = {number for number, value in enumerate(client.seen) if value}
    if seen & destroyed:
        findings.append(f"{len(seen & destroyed)} images were handed on that were destroyed on the wire")
    if missing := lost(whole, seen, client.statistics.dropped_images):
        findings.append(missing)
    if session.error is not None:
        findings.append(f"the session failed: {session.error}")
    if grown is not None and not grown.is_flat:
        findings.append(f"not flat: {grown}")
    if record is not None:
        findings += _judge_recording(session, record, seen)
    return Outcome(server.told, accounts, samples, grown, session.statistics, client.statistics, wall, findings)


def lost(whole: dict[int, str], seen: set[int], dropped: int) -> str | None:
    """Frames that went out whole, came to nobody, and were not dropped with a count; in words, by the fault they met."""
    missing = [fault for number, fault in whole.items() if number not in seen and fault != "another size"]
    if len(missing) <= dropped:
        return None
    kinds = ", ".join(f"{fault}: {missing.count(fault)}" for fault in sorted(set(missing)))
    return f"{len(missing)} whole frames came to nobody, and only {dropped} were dropped with a count ({kinds})"


def _judge_recording(session: LiveSession, record: Path, seen: set[int]) -> list[str]:
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


def describe(outcome: Outcome) -> str:
    """The accounts as text."""
    told, frames, counted = outcome.told, outcome.statistics, outcome.stream
    lines = ["", "what the server did                 times  images: whole  destroyed  again  unusable  foreign"]
    by_fault: dict[str, dict[str, int]] = {}
    for fault, fate, count in told["by_fault"]:
        by_fault.setdefault(fault, {})[fate] = count
    for fault, fates in by_fault.items():
        numbers = " ".join(f"{fates.get(fate, 0):9d}" for fate in ("whole", "destroyed", "again", "unusable", "foreign"))
        lines.append(f"{fault:34} {told['faults'].get(fault, 0):6d}  {numbers}")
    lines += [
        "",
        f"simulated {told['simulated_s']:.0f} s in {outcome.wall:.0f} s; {told['connections']} connections",
        f"frames received {frames.frames_received}, inserted {frames.inserted}, skipped {frames.frames_skipped}, again {frames.repeated}",
        *(f"  {count:7d}  {reason}" for reason, count in frames.skipped.items()),
        f"messages dropped {counted.dropped}, of them images {counted.dropped_images}; wrong checksums {counted.damaged}; "
        f"refused {counted.refused}; reconnections {counted.reconnects}",
        *map(str, outcome.equations),
        f"growth: {outcome.growth}",
        *(f"FINDING: {finding}" for finding in outcome.findings),
        "all accounts add up, nothing grows" if not outcome.findings else "",
    ]
    return "\n".join(lines)


def main(argv: list[str]) -> int:
    """Run it, print what was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="of the faults (default: %(default)s)")
    parser.add_argument("--minutes", type=float, default=60.0, metavar="M", help="simulated time (default: %(default)g)")
    parser.add_argument("--record", action="store_true", help="also record, and read the recording back; takes 1 GB for a while")
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--ledger", type=Path, metavar="FILE", help="keep what the server did to each frame")
    arguments = parser.parse_args(argv)
    names = ("min", "wall s", "frames", "inserted", "skipped", "MiB", "blocks", "thr", "fds")
    print(" ".join(f"{name:>{width}}" for name, width in zip(names, (4, 7, 8, 8, 8, 9, 8, 4, 4))), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        ledger = arguments.ledger or Path(folder) / "ledger.txt"
        outcome = soak(
            arguments.seed,
            arguments.minutes,
            ledger,
            record=Path(folder) / "scan.mhd" if arguments.record else None,
            engine=arguments.engine,
            report=lambda line: print(line, flush=True),
        )
    print(describe(outcome))
    return 1 if outcome.findings else 0

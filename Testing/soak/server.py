"""The server of the soak test, a process of its own: it streams an hour of a scan and fails at random, by a seed.

    python Testing/soak serve --seed 1 --minutes 60 --ledger ledger.txt

Standard output tells the port, every simulated minute, and at the end what was sent. Standard input takes the lines ``hold`` and ``go`` (a
clock that runs fast must not run ahead of the client, except in a burst) and ``end``, or its end.
"""

from __future__ import annotations

import argparse
import json
import sys
import threading
import time
from collections import deque
from pathlib import Path

import numpy as np

from . import stream
from .faults import FAULTS, burst
from .ledger import FATES, WHOLE, Ledger
from .line import Line, LineBroken

FRAMES_BETWEEN_FAULTS = 60.0
"""On average."""

FEW = 10
"""Frames between the faults of the first round."""

BEGINNING = 1_700_000_000.0
"""s since 1970: the time of the first frame. The stream's clock has nothing to do with that on the wall."""

REMEMBERED = 20
HELD_AT_MOST = 600.0


class FaultyServer:
    """Streams frames, plain ones and spoiled ones.

    Parameters
    ----------
    seed : int
    minutes : float
        Of simulated time.
    ledger : Ledger
    """

    def __init__(self, seed: int, minutes: float, ledger: Ledger):
        self.random = np.random.default_rng(seed)
        self.ledger = ledger
        self.line = Line()
        self.version = 2
        self.clock_offset = 0.0
        self.heeds_client = True
        self.recent: deque[tuple[int, float]] = deque(maxlen=REMEMBERED)
        self.go = threading.Event()
        self.go.set()
        self._frames = 0
        self._elapsed = 0.0
        self._until = 60.0 * minutes
        self._minute = 0

    # ---- what faults are made of

    def next_time(self) -> float:
        """The time stamp that the next frame will have, s since 1970."""
        return BEGINNING + self._elapsed + self.clock_offset

    def next_frame(self, fault: str | None = None) -> tuple[int, float]:
        """Number and time stamp of the next frame; the simulated time goes on by a frame."""
        if fault:
            self.ledger.happened(fault)
        number, time_ = self._frames, self.next_time()
        self._frames += 1
        self._advance(1.0 / stream.RATE)
        return number, time_

    def frame(self, fault: str | None = None, time_: float | None = None) -> None:
        """Send the next frame whole; with another time than its own where one is given."""
        number, its_time = self.next_frame(fault)
        self.send_whole(number, its_time if time_ is None else time_, fault or "plain")

    def send_whole(self, number: int, time_: float, fault: str) -> None:
        """Send a frame: its image, then its transforms."""
        if self.heeds_client and not self.go.wait(HELD_AT_MOST):
            raise LineBroken(f"the client asked to hold for {HELD_AT_MOST:g} s")
        messages = [stream.image_message(number, time_, self.version), *stream.transform_messages(number, time_, self.version)]
        self.line.send(b"".join(messages))
        self.ledger.note(number, fault, WHOLE)
        self.recent.append((number, time_))

    def pause(self, seconds: tuple[float, float]) -> None:
        """Send nothing for a while within these limits; the simulated time goes on as the wall's does."""
        self.sleep(float(self.random.uniform(*seconds)))

    def sleep(self, seconds: float) -> None:
        """Wait so many s, by both clocks."""
        time.sleep(seconds)
        self._advance(seconds)

    # ---- the hour

    def stream(self) -> None:
        """All of it, then the clean end of the connection."""
        names, weights = list(FAULTS), np.array(list(FAULTS.values()))
        # Every fault once, so that each has been seen and every buffer has its size early; then at random
        first = [burst, *(fault for fault in FAULTS if fault is not burst)]
        until_fault = self._gap()
        while self._elapsed < self._until or first:
            if not self.line.is_open:
                self.version = int(self.random.choice([1, 2, 2]))
                self.line.accept()
            if until_fault:
                self.frame()
                until_fault -= 1
            else:
                fault = first.pop(0) if first else names[self.random.choice(len(names), p=weights / weights.sum())]
                fault(self)
                until_fault = self._gap() if not first else FEW
        if not self.line.is_open:
            self.line.accept()
        # A last frame, so that no message that was begun by a fault stays open
        self.frame()
        self.line.hang_up()

    def _gap(self) -> int:
        return int(self.random.exponential(FRAMES_BETWEEN_FAULTS))

    def _advance(self, seconds: float) -> None:
        self._elapsed += seconds
        if self._elapsed >= 60.0 * (self._minute + 1):
            self._minute = int(self._elapsed // 60.0)
            say({"minute": self._minute})

    def told(self) -> dict:
        """What was sent: image messages by fate, and by fault and fate; the number of the last; faults; connections."""
        return {
            "last": self._frames - 1,
            "fates": {fate: self.ledger.total(fate) for fate in FATES},
            "by_fault": [[*key, count] for key, count in sorted(self.ledger.fates.items())],
            "faults": dict(self.ledger.faults),
            "connections": self.line.connections,
            "simulated_s": self._elapsed,
        }


def say(what: dict) -> None:
    """A line to the process that started this one."""
    print(json.dumps(what), flush=True)


def listen_to_parent(server: FaultyServer) -> None:
    """Take ``hold`` and ``go`` until the end."""
    for line in sys.stdin:
        if line.strip() == "end":
            break
        (server.go.clear if line.strip() == "hold" else server.go.set)()


def main(argv: list[str]) -> int:
    """Stream, and wait to be ended."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--ledger", type=Path)
    arguments = parser.parse_args(argv)
    server = FaultyServer(arguments.seed, arguments.minutes, Ledger(arguments.ledger))
    listener = threading.Thread(target=listen_to_parent, args=(server,), daemon=True)
    listener.start()
    say({"port": server.line.port})
    try:
        server.stream()
    except LineBroken as error:
        say({"broken": str(error)})
        return 1
    server.ledger.close()
    say(server.told())
    listener.join()
    return 0

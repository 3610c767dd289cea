"""The images of a simulated scan, each drawn on its own: further processes may take their share, and the images are the same."""

from __future__ import annotations

import math
import pickle
import subprocess
import sys
from collections.abc import Generator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from ..arrays import Bytes, Matrix
from ..machine.processes import Process, start_python
from .phased_array import PhasedArray
from .ultrasound import UltrasoundEffects, UltrasoundTarget, simulate_frame

FEWEST = 20
"""Images for which it is worth while to start a process."""


@dataclass(frozen=True, eq=False)
class Images:
    """What a probe sees of a target at poses (frames, 4, 4) probe_to_reference in mm. Every frame has random numbers of its own."""

    target: UltrasoundTarget
    probe: PhasedArray
    probe_to_reference: Matrix
    seed: int
    effects: UltrasoundEffects | None

    def image(self, frame: int) -> Bytes:
        """One image, (rows, columns) uint8."""
        rng = np.random.default_rng([self.seed, 31, frame])
        return simulate_frame(self.target, self.probe, self.probe_to_reference[frame], rng, self.effects)

    def drawn(self, processes: int = 1) -> Generator[Bytes]:
        """All, in their order; this process draws every so manieth, and what one that failed leaves out."""
        frames = len(self.probe_to_reference)
        processes = max(min(processes, frames // FEWEST), 1)
        others = [_start(self, range(first, frames, processes)) for first in range(1, processes)]
        try:
            for frame in range(frames):
                other = others[frame % processes - 1] if frame % processes else None
                yield self.image(frame) if other is None else self._from(other, frame)
        finally:
            for other in filter(None, others):
                other.kill()
                other.communicate()

    def _from(self, other: Process, frame: int) -> Bytes:
        """The next image of another process; it draws its images in their order, and waits until they are read."""
        shape = self.probe.rows, self.probe.columns
        drawn = other.stdout.read(math.prod(shape)) if other.stdout else b""
        return np.frombuffer(drawn, np.uint8).reshape(shape) if len(drawn) == math.prod(shape) else self.image(frame)


def _start(images: Images, frames: range) -> Process | None:
    """A process that draws these; None where the system starts none."""
    try:
        process = start_python(__name__, draw.__name__, stream=subprocess.PIPE)
    except OSError:
        return None
    # It may have ended before it was told what to do: then nothing comes of it
    with suppress(OSError):
        if process.stdin:
            pickle.dump((images, frames), process.stdin)
            process.stdin.flush()
    return process


def draw() -> None:
    """Read from the process that started this one what to draw, and write it; when that one has ended, so does this."""
    images, frames = pickle.load(sys.stdin.buffer)
    with suppress(BrokenPipeError):
        for frame in frames:
            sys.stdout.buffer.write(images.image(frame).tobytes())
            sys.stdout.buffer.flush()

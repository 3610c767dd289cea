"""The images of a simulated scan, each drawn on its own: further processes may take their share, and the images are the same."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from subprocess import Popen

import numpy as np

from ..arrays import Bytes, Matrix
from ..machine.processes import start_python
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
                yield self.image(frame) if other is None else self._from(other[1], frame)
        finally:
            for process, connection in filter(None, others):
                process.kill()
                process.wait()
                connection.close()

    def _from(self, other: Connection, frame: int) -> Bytes:
        """The next image of another process, which draws its images in their order."""
        try:
            image: Bytes = other.recv()
            return image
        except (EOFError, OSError):
            return self.image(frame)


def _start(images: Images, frames: range) -> tuple[Popen[bytes], Connection] | None:
    """A process that draws these; None where the system starts none."""
    try:
        return start_python(draw, images, frames)
    except OSError:
        return None


def draw(connection: Connection, images: Images, frames: range) -> None:
    """Draw these for the process that started this one; when that one has ended, so does this."""
    with suppress(OSError):
        for frame in frames:
            connection.send(images.image(frame))

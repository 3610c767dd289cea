"""How fast the machine itself computes while `walkInSlicer.py` measures: what else runs on it, or beside it on the same host, is heard.

A process of its own does a small fixed piece of work over and over, and tells when and how long it computed. What the piece takes beside a
stall, as a multiple of what it takes at best, is how many times as slow the machine was then. Two cores that are both at work, as they are
in a scan, take some 1.6 times as long where they share one core of the host.
"""

import contextlib
import os
import shutil
import subprocess
import time

EVERY, SUMS = 0.01, 2000
"""s between two pieces of work, and how large one is: less than one percent of a core."""

AT_BEST = 0.05
"""Share of the pieces that are taken for those of a machine that is left alone."""

DISTURBED = 2.0
"""How many times as slow as at best the machine is where what was measured says more about it than about the application."""


class Machine:
    """The pieces of work that were done so far: (when, s computed) in the order of time; `time.monotonic` is that of all processes."""

    def __init__(self):
        self.pieces: list[tuple[float, float]] = []

    def slowed(self, begin: float, end: float) -> float:
        """How many times as long as at best a piece took between two times, on the mean; 1 where none was done."""
        inside = [took for when, took in self.pieces if begin <= when <= end]
        if not inside:
            return 1.0
        best = sorted(took for _when, took in self.pieces)[int(AT_BEST * len(self.pieces))]
        return sum(inside) / len(inside) / best


@contextlib.contextmanager
def watchedMachine(log):
    """Gives a `Machine`, which knows its pieces when this ends. `log` is a file for them."""
    machine = Machine()
    python = shutil.which("PythonSlicer") or shutil.which("python3")
    with open(log, "w", encoding="utf-8") as told:
        process = subprocess.Popen([python, __file__], stdout=told)
        try:
            yield machine
        finally:
            process.terminate()
            process.wait()
    lines = [line.split() for line in log.read_text(encoding="utf-8").splitlines()]
    # The last line may be cut short
    machine.pieces = [(float(line[0]), float(line[1])) for line in lines if len(line) == 2][:-1]


def work() -> None:
    """Do pieces of work as long as the application lives: one that was killed does not end it."""
    application = os.getppid()
    while os.getppid() == application:
        when, before = time.monotonic(), time.thread_time()
        sum(number * number for number in range(SUMS))
        print(f"{when:.4f} {time.thread_time() - before:.7f}", flush=True)
        time.sleep(EVERY)


if __name__ == "__main__":
    work()

"""What a benchmark found, as rows to print, as Markdown and as JSON."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from AIFReconLib.commands.benchmark import busy_warning

HEADING = ("", "engine", "threads", "voxel", "ns/pixel", "frames/s", "x yardstick", "bytes/voxel", "seconds")


@dataclass(frozen=True)
class Timing:
    """One row of the table. Seconds are the median over the repeats, ns are per pixel of the image."""

    what: str
    engine: str
    threads: int
    spacing_mm: float | None
    seconds: float
    ns_per_pixel: float | None = None
    frames_per_second: float | None = None
    times_yardstick: float | None = None
    bytes_per_voxel: int | None = None


@dataclass(frozen=True)
class BenchmarkResult:
    """All timings of one run and the machine they were taken on."""

    machine: str
    version: str
    frames: int
    repeats: int
    busy: float
    timings: tuple[Timing, ...]

    def to_dict(self) -> dict:
        """For JSON."""
        return asdict(self)

    def rows(self) -> list[tuple[str, ...]]:
        """The table, heading first."""
        return [HEADING, *(_cells(timing) for timing in self.timings)]

    def heading(self) -> str:
        """What was measured, and where."""
        text = (
            f"{self.machine}\nAIFRecon {self.version}; {self.frames} frames of 640 x 480, 0.2 mm pixels, 30 degree fan; "
            f"medians of {self.repeats}"
        )
        return "\n".join(filter(None, (text, busy_warning(self.busy))))

    def markdown(self) -> str:
        """The table for a document."""
        rows = self.rows()
        lines = ["| " + " | ".join(row) + " |" for row in rows]
        lines.insert(1, "|" + "|".join([" --- "] * len(HEADING)) + "|")
        return self.heading().replace("\n", "  \n") + "\n\n" + "\n".join(lines) + "\n"


def _cells(t: Timing) -> tuple[str, ...]:
    def number(value, form: str) -> str:
        return "" if value is None else format(value, form)

    return (
        t.what,
        t.engine,
        str(t.threads),
        "" if t.spacing_mm is None else f"{t.spacing_mm:g} mm",
        number(t.ns_per_pixel, ".2f"),
        number(t.frames_per_second, ".0f"),
        number(t.times_yardstick, ".1f"),
        number(t.bytes_per_voxel, "d"),
        f"{t.seconds:.3f}",
    )

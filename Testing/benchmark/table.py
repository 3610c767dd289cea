"""What a benchmark found, as Markdown."""

from __future__ import annotations

from dataclasses import dataclass

from AIFReconLib.workflows.benchmark import busy_warning


@dataclass(frozen=True)
class Timing:
    """One row of the table. Seconds are the median over the repeats, ns are per pixel of the image."""

    what: str
    engine: str
    threads: int
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

    def heading(self) -> str:
        """What was measured, and where."""
        text = (
            f"{self.machine}\nAIFRecon {self.version}; {self.frames} frames of 640 x 480, 0.2 mm pixels, 30 degree fan; "
            f"medians of {self.repeats}"
        )
        return "\n".join(filter(None, (text, busy_warning(self.busy))))

    def in_the_pages(self) -> dict[str, str]:
        """Tables by the names of the files in docs/measured: methods, and the rest."""
        methods: dict[str, dict[tuple[str, bool], Timing]] = {}
        for timing in self.timings:
            if timing.ns_per_pixel is not None:
                methods.setdefault(timing.what, {})[timing.engine, timing.threads > 1] = timing
        lines = [
            "| | numpy, frames/s | numba, 1 thread | numba, all threads | ns a pixel | x plain loop | bytes a voxel |",
            "|---|---|---|---|---|---|---|",
        ]
        for what, timed in methods.items():
            best = timed.get(("numba", True)) or timed.get(("numba", False)) or timed["numpy", False]
            speeds = (timed.get(each) for each in (("numpy", False), ("numba", False), ("numba", True)))
            cells = [_shown(each.frames_per_second if each else None, ".0f") for each in speeds]
            cells += [_shown(best.ns_per_pixel, ".1f"), _shown(best.times_yardstick, ".1f"), _shown(best.bytes_per_voxel, "d")]
            lines.append(f"| {what} | " + " | ".join(cells) + " |")
        steps = ["| | engine | threads | seconds | frames/s |", "|---|---|---|---|---|"]
        for timing in self.timings:
            if timing.ns_per_pixel is None:
                speed = timing.frames_per_second if timing.seconds and timing.what.startswith("reading") else None
                steps.append(f"| {timing.what} | {timing.engine} | {timing.threads} | {timing.seconds:.2f} | {_shown(speed, '.0f')} |")
        return {"speed-methods": "\n".join(lines), "speed-steps": "\n".join(steps)}

    def text(self) -> str:
        """What was measured, and where."""
        return "\n\n".join([self.heading(), *self.in_the_pages().values()])


def _shown(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)

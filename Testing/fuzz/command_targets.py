"""Targets that run the command line in this process: damaged options, and damaged sweeps through whole commands."""

from __future__ import annotations

import contextlib
import io
from functools import partial
from pathlib import Path

from AIFReconLib.commands.info import NOT_READY
from AIFReconLib.commands.parser import SUCCESS, main
from AIFReconLib.terminal.guard import BAD_INPUT

from . import seeds
from .file_targets import METAIMAGE_WORDS
from .target import Target

OPTION_WORDS = (
    b"--spacing --method --clip-px --apex-px --fan-angles-deg --fan-radius-px --probe sector linear average maximum weighted --hole-limit "
    b"--skip --alpha --beta --reference Image Probe --image-to-reference ImageToReference --time-offset --orientation UF MN --grid-like "
    b"--speed-of-sound --output-type uint8 float32 --engine numpy --bone-from-sweep --longest-gap --frames --every --crop --rename A=B "
    b"--transform-sequence --calibration --json --help info convert reconstruct evaluate bone-map"
).split()


class Refused(Exception):
    """The command ended with its exit code for bad input; the text is its one line."""


def run_command(arguments: list[str]) -> None:
    """Run `aifrecon`; nothing but success, and refusal in one line, may come out."""
    output, errors = io.TextIOWrapper(io.BytesIO(), "utf-8"), io.TextIOWrapper(io.BytesIO(), "utf-8", errors="backslashreplace")
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
        code = main(arguments)
    errors.flush()
    said = errors.buffer.getvalue().decode("utf-8")
    if code == BAD_INPUT:
        assert said.endswith("\n"), said
        raise Refused(said[:-1])
    expected = (SUCCESS, NOT_READY) if arguments[0] == "info" else (SUCCESS,)
    assert said == ""
    assert code in expected


def _sweep(path: Path) -> Path:
    """A good sweep beside the input."""
    sweep = path.with_name("good.mha")
    if not sweep.exists():
        sweep.write_bytes(seeds.metaimage())
    return sweep


def _run_options(path: Path) -> None:
    """The first line is the command, every other one an option or a value."""
    words = path.read_text("utf-8", errors="replace").split("\n")
    # Options that would write elsewhere, listen, or work for minutes are not fuzzing's business
    if words[0] not in ("reconstruct", "info", "convert") or any(
        word.startswith(("--score", "--hits", "--mask", "--cosine", "--s=", "--thr", "--j", "--report")) for word in words
    ):
        raise Refused("not a command for this target")
    words = [word for word in words[1:] if word]
    output = path.with_name("out.mha")
    ends = {"reconstruct": ["--output", str(output)], "convert": [], "info": []}
    command = path.read_text("utf-8", errors="replace").split("\n")[0]
    files = [str(_sweep(path)), *([str(output)] if command == "convert" else [])]
    run_command([command, *words, *ends[command], "--", *files])


def _run_on_sweep(command: str, path: Path) -> None:
    run_command([command, str(path), *(["--output", str(path.with_name("volume.mha"))] if command == "reconstruct" else [])])


def _option_seeds() -> list[bytes]:
    lines = (
        "reconstruct --spacing 0.5 --method average --hole-limit 1",
        "reconstruct --spacing 0.5 1 2 --clip-px 1 1 3 2 --output-type float32 --skip 2",
        "reconstruct --spacing 1 --probe sector --apex-px 3 -4 --fan-angles-deg -40 40 --fan-radius-px 2 9",
        "reconstruct --spacing 1 --method aif --bone-from-sweep --alpha 0.1 --beta 0.1",
        "reconstruct --spacing 1 --image-to-reference ImageToReference --reference Reference --speed-of-sound 1480",
        "info --json --time-offset 0.05 --longest-gap 1 --orientation UF",
        "convert --frames 0 1 --every 1 --crop 1 1 3 2 --rename ImageToReference=ImageToTracker --orientation MN",
    )
    return [line.replace(" ", "\n").encode() for line in lines]


COMMANDS = (
    Target("command-options", "options.txt", _run_options, _option_seeds, errors=(Refused,), words=OPTION_WORDS),
    *(
        Target(
            f"command-{name}",
            "sweep.mha",
            partial(_run_on_sweep, name),
            seeds.metaimage_sequences,
            errors=(Refused,),
            words=METAIMAGE_WORDS,
        )
        for name in ("info", "reconstruct")
    ),
)

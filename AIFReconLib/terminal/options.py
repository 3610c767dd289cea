"""Arguments that several commands share beside those of a recipe; and outputs that must not replace inputs."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import TypeAlias

from ..errors import AIFReconError, OutputError
from ..evaluation.visibility import BEAM_THICKNESS
from ..io.metafile.opening import data_files
from ..io.plus.configuration import read_plus_configuration
from ..io.volume.files import sidecar_of
from .one_line_parser import OneLineParser

Commands: TypeAlias = "argparse._SubParsersAction[OneLineParser]"
"""What a command adds itself to."""


def add_placing_options(group: argparse._ActionsContainer) -> None:
    """How a CT is laid on a sweep, and when the answer is taken."""
    group.add_argument("--per-segment", action="store_true", help="let each label move on its own: the spine has bent since the CT")
    group.add_argument("--level", type=int, metavar="N", help="write the place N levels higher (negative: lower) than the best one")
    group.add_argument("--accept", action="store_true", help="write the best place even if it is ambiguous or does not agree")


def add_beam_option(group: argparse._ActionsContainer) -> None:
    """How wide beams are where the bone that they reach is looked for."""
    group.add_argument(
        "--beam-thickness",
        type=float,
        default=BEAM_THICKNESS,
        metavar="MM",
        help="width of the beams across the image plane (default: %(default)g)",
    )


def refuse_to_overwrite(outputs: list[Path | None], inputs: list[Path | None]) -> None:
    """Stop before work begins when an output is an input, or two outputs are one file.

    What an input names is an input too, a header's data file and a configuration's importance mask, and so is each file of a folder.
    """
    given = [path for path in inputs if path is not None]
    seen = {as_compared(file): "an input" for path in given for file in [real_path(path), *data_files(path), *_importance_mask(path)]}
    folders = {as_compared(real_path(path)) for path in given if path.is_dir()}
    for path in outputs:
        if path is None:
            continue
        for name, file in {as_compared(file): file for file in [real_path(path), *_companions(path)]}.items():
            within = file.exists() and any(as_compared(parent) in folders for parent in file.parents)
            if name in seen or within:
                raise OutputError(f"{path} would overwrite {seen.get(name, 'an input')} ({file.name}). Choose another name.")
            seen[name] = "another output"


def _importance_mask(path: Path) -> list[Path]:
    """The mask that a Plus configuration names, without links; nothing for other files."""
    try:
        mask = read_plus_configuration(path).importance_mask if path.suffix.lower() == ".xml" else None
    except AIFReconError:
        return []
    return [real_path(mask)] if mask is not None else []


def real_path(path: Path) -> Path:
    """The path without links; one that leads in a circle stays as it is."""
    return Path(os.path.realpath(path))


def as_compared(path: Path) -> str:
    """A name as the disk compares it: on Windows and macOS Sweep.mha is sweep.mha."""
    return str(path).casefold() if sys.platform in ("win32", "darwin") else str(path)


def _companions(path: Path) -> list[Path]:
    """What is written beside `path`: a .mhd header has its voxels in a .raw or .zraw file, NIfTI what its header has no room for."""
    if path.name.lower().endswith((".nii", ".nii.gz")):
        return [sidecar_of(real_path(path))]
    return [real_path(path).with_suffix(suffix) for suffix in (".raw", ".zraw")] if path.suffix.lower() == ".mhd" else []

"""Arguments on how a recorded sequence is to be read, which every command that reads one shares."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from ..errors import SettingsError
from ..inspection.offset_estimate import estimate_time_offset
from ..io.sequence.files import read_sequence
from ..recipe.recipe import AUTOMATIC
from ..sweep.frames import TrackedSequence
from ..sweep.poses import ends_of, sweep_poses
from ..sweep.time_offset import with_time_offset
from .one_line_parser import TakingAction
from .recipe_options import add_imaging_options, add_setting, number_or, recipe_from

OF_A_RECORDING = ("orientation", "time_offset", "longest_gap")
"""How a recording is read, which a live scan is not."""


class NamedFileAction(TakingAction):
    """NAME=FILE, as often as wanted; collected in a dict."""

    def taken(self, given: str, before: dict[str, Path] | None) -> dict[str, Path]:
        """Those before, and one more."""
        name, equals, file = (word.strip() for word in given.partition("="))
        if not (equals and name and file):
            raise argparse.ArgumentError(self, f"takes NAME=FILE, as in ImageToReference=Transform.seq.mha, got {given!r}")
        if name in (before or {}):
            raise argparse.ArgumentError(self, f"{name} is given twice")
        return {**(before or {}), name: Path(file)}


def add_tracking_options(parser: argparse.ArgumentParser, several: bool = False) -> None:
    """Configuration, or one for each of several sequences, and frames of reference."""
    tracking = parser.add_argument_group("tracking")
    meaning = "Plus configuration: calibration, region, spacing"
    if several:
        meaning += "; of several sequences once, or once for each"
    tracking.add_argument("--config", type=Path, action="append" if several else "store", metavar="PLUS.xml", help=meaning)
    for name in ("image_to_reference", "reference"):
        add_setting(tracking, name)


def add_sequence_options(parser: argparse.ArgumentParser) -> None:
    """What a file does not say, or says wrongly: transforms beside it, orientation, time offset."""
    reading = parser.add_argument_group("recording", "what the file does not say, or says wrongly")
    reading.add_argument(
        "--transform-sequence",
        action=NamedFileAction,
        metavar="NAME=FILE",
        help="Slicer's sequence of a transform that belongs to the images, e.g. ImageToReference=Transform.seq.mha; may be repeated",
    )
    for name in OF_A_RECORDING:
        add_setting(reading, name)
    offset = reading._option_string_actions["--time-offset"]
    offset.type, offset.help = number_or(AUTOMATIC), f"{offset.help}; {AUTOMATIC}: find it in the sweep and apply it"


def add_sweep_options(parser: argparse.ArgumentParser, several: bool = True) -> None:
    """All that says how a recorded sweep is read: where its frames lie, what its file leaves open, what its images show."""
    add_tracking_options(parser, several)
    add_sequence_options(parser)
    add_imaging_options(parser)


def of_each(arguments: argparse.Namespace, paths: Sequence[Path]) -> list[argparse.Namespace]:
    """The arguments for each of several sequences, with the sequence's own configuration where there is one for each.

    Raises SettingsError when configurations are neither one nor one for each, or transforms of one sequence are given for several.
    """
    configs = arguments.config or [None]
    if len(configs) not in (1, len(paths)):
        raise SettingsError(
            f"--config is given {len(configs)} times for {len(paths)} sequence(s). Give it once, or once for each in their order."
        )
    if len(paths) > 1 and getattr(arguments, "transform_sequence", None):
        raise SettingsError(
            f"--transform-sequence belongs to one sequence, and {len(paths)} are given. Make one file of each pair with aifrecon convert."
        )
    configs = configs * len(paths) if len(configs) == 1 else configs
    each = [
        argparse.Namespace(**{**vars(arguments), "sequence": path, "config": config}) for path, config in zip(paths, configs, strict=True)
    ]
    _find_time_offset(each, arguments)
    return each


def _find_time_offset(each: Sequence[argparse.Namespace], arguments: argparse.Namespace) -> None:
    """Where it is to be found, put the time offset of the first sequence that tells it into all of these.

    Raises SettingsError where none tells.
    """
    if getattr(arguments, "time_offset", None) != AUTOMATIC:
        return
    for one in (*each, arguments):
        one.time_offset = None
    for one in each:
        sequence, asked = sequence_from(one), recipe_from(one)
        found = estimate_time_offset(sequence, sweep_poses(sequence, asked.image_to_reference, asked.reference))
        if found.time_offset is not None:
            break
    else:
        raise SettingsError(f"{sequence.name}: {found.to_text()}", "Give {time_offset:S}, or leave it out.")
    for one in (*each, arguments):
        one.time_offset = found.time_offset if found.out_of_step else 0.0


def sequence_from(arguments: argparse.Namespace) -> TrackedSequence:
    """The sequence that the options ask for: `arguments.sequence`, with its configuration, paired transforms and time offset."""
    _find_time_offset([arguments], arguments)
    recipe = recipe_from(arguments)
    sequence = read_sequence(
        arguments.sequence,
        config=arguments.config,
        orientation=recipe.orientation,
        transform_sequences=arguments.transform_sequence,
        longest_gap=recipe.longest_gap,
        image_frame=ends_of(recipe.image_to_reference).source if recipe.image_to_reference else None,
    )
    return with_time_offset(sequence, recipe.time_offset, recipe.longest_gap)


def sequence_inputs(arguments: argparse.Namespace) -> list[Path | None]:
    """The files that `sequence_from` reads, which no output may overwrite."""
    return [arguments.sequence, arguments.config, *(arguments.transform_sequence or {}).values()]

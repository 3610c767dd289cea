"""How recorded sequences are read: what the options say of them, and the sequences themselves."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, ClassVar

from ..errors import SettingsError
from ..inspection.offset_estimate import estimate_time_offset
from ..io.sequence.files import read_sequence
from ..message import message_of
from ..recipe.recipe import AUTOMATIC
from ..sweep.frames import TrackedSequence
from ..sweep.poses import ends_of, sweep_poses
from ..sweep.time_offset import with_time_offset
from .arguments import Names, Options, Settings, number_or, pair, path, reading
from .labels_options import PlacedLabelsOptions

OF_A_RECORDING = ("orientation", "time_offset", "longest_gap")
"""How a recording is read, which a live scan is not."""


class _ConfigurationOptions(Options):
    """tracking

    Parameters
    ----------
    config : PLUS.xml
        Plus configuration: calibration, region, spacing; of several sequences once, or once for each
    """

    config: list[Path] = []


class TrackingOptions(_ConfigurationOptions):
    """tracking"""

    SETTINGS: ClassVar[Settings] = ("image_to_reference", "reference")


def _named_file(text: str) -> tuple[str, Path]:
    name, file = pair(text)
    return name, path(file)


class RecordingOptions(_ConfigurationOptions):
    """recording: what the file does not say, or says wrongly

    Parameters
    ----------
    transform_sequence : NAME=FILE
        Slicer's sequence of a transform that belongs to the images, e.g. ImageToReference=Transform.seq.mha; may be repeated
    time_offset : S
        add this to the images' time stamps, as Plus's LocalTimeOffsetSec of the image device does, and interpolate the poses (negative:
        images come late; positive: poses do) [s] (default: 0); auto: find it in the sweep and apply it
    """

    transform_sequence: Annotated[list[tuple[str, Path]], reading(_named_file, "NAME=FILE, as in ImageToReference=Transform.seq.mha")] = []
    time_offset: Annotated[float | str, number_or(AUTOMATIC)] | None = None

    SETTINGS: ClassVar[Settings] = ("orientation", "longest_gap")


class ImageOptions(Options):
    """image: what the image shows; default: the configuration's, else recognized by the black surround"""

    SETTINGS: ClassVar[Settings] = ("probe", "apex_px", "clip_px", "fan_angles_deg", "fan_radius_px")


class SweepOptions(TrackingOptions, RecordingOptions, ImageOptions):
    """All that says how recorded sweeps are read."""


class SequencesOptions(PlacedLabelsOptions, SweepOptions):
    """sweeps

    Parameters
    ----------
    sequences : SEQUENCE
        tracked frames, e.g. sweep.igs.mha; one or more sweeps in one Reference
    """

    sequences: tuple[Path, ...]

    WORDS: ClassVar[Names] = ("sequences",)


def configured(asked: _ConfigurationOptions, paths: Sequence[Path]) -> list[tuple[Path, Path | None]]:
    """Each of several sequences with its configuration.

    Raises SettingsError when configurations are neither one nor one for each, or transforms of one sequence are given for several.
    """
    configs: list[Path | None] = [*asked.config] or [None]
    if len(configs) not in (1, len(paths)):
        raise SettingsError(
            f"--config is given {len(configs)} times for {len(paths)} sequence(s). Give it once, or once for each in their order."
        )
    if len(paths) > 1 and getattr(asked, "transform_sequence", None):
        raise SettingsError(
            f"--transform-sequence belongs to one sequence, and {len(paths)} are given. Make one file of each pair with aifrecon convert."
        )
    return list(zip(paths, configs * len(paths) if len(configs) == 1 else configs, strict=True))


def sequences_from(asked: RecordingOptions, paths: Sequence[Path]) -> list[TrackedSequence]:
    """The sequences, with their configurations, paired transforms and time offset; one that is to be found is put into `asked`.

    Raises SettingsError where that is not told by any of them.
    """
    recipe = asked.recipe
    sequences = [
        read_sequence(
            path,
            config=config,
            orientation=recipe.orientation,
            transform_sequences=dict(asked.transform_sequence),
            longest_gap=recipe.longest_gap,
            image_frame=ends_of(recipe.image_to_reference).source if recipe.image_to_reference else None,
        )
        for path, config in configured(asked, paths)
    ]
    if asked.time_offset == AUTOMATIC:
        asked.time_offset = _time_offset(asked, sequences)
    return [with_time_offset(sequence, asked.recipe.time_offset, recipe.longest_gap) for sequence in sequences]


def _time_offset(asked: RecordingOptions, sequences: Sequence[TrackedSequence]) -> float:
    """The time offset of the first sequence that tells it; 0 where that is in step."""
    recipe = asked.recipe
    for sequence in sequences:
        found = estimate_time_offset(sequence, sweep_poses(sequence, recipe.image_to_reference, recipe.reference))
        if found.time_offset is not None:
            return found.time_offset if found.out_of_step else 0.0
    told = message_of(found.to_text())
    raise SettingsError(f"{sequence.name}: {told}", told if told.advice else "Give {time_offset:S}, or leave it out.")


def sequence_inputs(asked: RecordingOptions, paths: Sequence[Path]) -> list[Path]:
    """The files that `sequences_from` reads."""
    return [*paths, *asked.config, *(file for _, file in asked.transform_sequence)]

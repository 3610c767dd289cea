"""`aifrecon convert`: a recording in another format, cut, decimated, renamed, or mended where its orientation or calibration was wrong."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..arrays import Matrix
from ..errors import SettingsError, TransformError
from ..geometry.transform_graph import TransformName
from ..io.foreign.calibration import read_calibration
from ..io.metafile.metafile import FORMER_LAST_LINE, UNFINISHED
from ..io.sequence.files import IMAGE_FRAME
from ..io.sequence.writer import SUFFIXES, check_sequence_name, write_sequence
from ..io.transform.files import read_transform
from ..recipe.recipe import AUTOMATIC
from ..sweep.edits import (
    corrected,
    crop,
    inverted,
    mirrored,
    recalibrate,
    rename,
    select_frames,
    with_configured_transforms,
)
from ..sweep.frames import TrackedSequence
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, refuse_to_overwrite
from ..terminal.recipe_options import add_setting
from ..terminal.remedies import in_options
from ..terminal.sequence_options import add_sequence_options, sequence_from
from ..workflows.reconstruct import mended

EXAMPLE = """examples:
  aifrecon convert sweep.igs.mha sweep.nrrd
  aifrecon convert long.igs.mha short.igs.mha --frames 100 499 --every 2 --crop 80 20 640 480 --config PlusDeviceSet.xml
  aifrecon convert mirrored.igs.mha right.igs.mha --orientation UF
  aifrecon convert old.igs.mha mended.igs.mha --calibration new/PlusDeviceSet.xml --wrong-calibration old/PlusDeviceSet.xml
  aifrecon convert sweep.igs.mha mended.igs.mha --correction correction.tfm --time-offset 0.045
  aifrecon convert breathed.igs.mha mended.igs.mha --motion auto --config PlusDeviceSet.xml
  aifrecon convert Image.seq.nrrd sweep.igs.mha --transform-sequence ImageToReference=Transform.seq.mha"""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "convert",
        description="Write a tracked sequence as .mha, .mhd or .nrrd. Images and fields stay as they are, but for what the options change.",
        examples=EXAMPLE,
    )
    parser.add_argument("sequence", type=Path, metavar="IN", help="tracked frames, e.g. sweep.igs.mha")
    parser.add_argument("output", type=Path, metavar="OUT", help=f"where to write ({', '.join(SUFFIXES)})")
    parser.add_argument("--compress", action=argparse.BooleanOptionalAction, default=True, help="compress the images (default: yes)")
    parser.add_argument("--config", type=Path, metavar="PLUS.xml", help="also write this configuration's transforms into the file")
    add_sequence_options(parser)
    part = parser.add_argument_group("part")
    part.add_argument("--frames", type=int, nargs=2, metavar=("A", "B"), help="frames A to B, both included, counted from 0")
    part.add_argument("--every", type=int, default=1, metavar="N", help="every Nth of them")
    part.add_argument(
        "--crop", type=int, nargs=4, metavar=("X", "Y", "W", "H"), help="this rectangle of the image, in pixels (MF); poses move along"
    )
    names = parser.add_argument_group("transforms")
    names.add_argument(
        "--rename",
        action="append",
        default=[],
        metavar="A=B",
        help="a transform (ProbeToTracker=NeedleToTracker) or a frame; may be repeated",
    )
    names.add_argument(
        "--calibration",
        metavar="[NAME=]FILE",
        help="put this calibration in the place of the recorded one: Plus configuration, Slicer transform or 16 numbers (ImageToProbe)",
    )
    names.add_argument(
        "--wrong-calibration", metavar="[NAME=]FILE", help="the calibration that recorded transforms such as ImageToReference include"
    )
    names.add_argument("--correction", type=Path, metavar="FILE.tfm", help="correct the image plane as aifrecon calibrate found it")
    names.add_argument("--scale", type=float, nargs=2, metavar=("X", "Y"), help="times the size of a pixel across and along")
    names.add_argument("--invert", metavar="NAME", help="take a transform for its inverse, e.g. ProbeToTracker")
    add_setting(part, "motion")
    part.add_argument("--mirror", action="store_true", help="turn the images left to right; poses stay")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, change, write, and say what was done."""
    check_sequence_name(arguments.output)
    refuse_to_overwrite(arguments, "output")
    sequence = changed(sequence_from(arguments), arguments)
    with ProgressBar() as progress:
        if arguments.motion == AUTOMATIC:
            before = len(sequence.notes)
            sequence = mended(sequence, progress=progress)
            sequence = replace(sequence, fields={**sequence.fields, "AIFRecon_motion": " ".join(sequence.notes[before:])})
        write_sequence(sequence, arguments.output, arguments.compress, progress)
    columns, rows = sequence.frame_size
    lines = [f"{len(sequence)} frames of {columns} x {rows} pixels", *map(in_options, sequence.notes), f"wrote {arguments.output}"]
    print("\n  ".join(lines))


def changed(sequence: TrackedSequence, arguments: argparse.Namespace) -> TrackedSequence:
    """The sequence with everything done to it that the options ask for: names first, then calibration, part and frames."""
    # What is written is complete; the mark would keep readers from saying that it is damaged when it is
    sequence = replace(sequence, fields={key: value for key, value in sequence.fields.items() if key not in (UNFINISHED, FORMER_LAST_LINE)})
    sequence = rename(with_configured_transforms(sequence), dict(_pair(text) for text in arguments.rename))
    if arguments.calibration:
        name, matrix = _calibration(arguments.calibration)
        wrong = _calibration(arguments.wrong_calibration)[1] if arguments.wrong_calibration else None
        sequence = recalibrate(sequence, name, matrix, wrong)
    elif arguments.wrong_calibration:
        raise SettingsError("--wrong-calibration says what to take out. Say with --calibration what to put in its place.")
    sequence = _mended(sequence, arguments)
    first, last = arguments.frames or (0, len(sequence) - 1)
    sequence = select_frames(sequence, first, last, arguments.every)
    if not arguments.crop:
        return sequence
    x, y, width, height = arguments.crop
    return crop(sequence, x, y, width, height, sequence.configuration.image_frame or IMAGE_FRAME)


def _mended(sequence: TrackedSequence, arguments: argparse.Namespace) -> TrackedSequence:
    """The sequence with what was recorded wrongly put right, in the order in which `calibrate` names it."""
    image = sequence.configuration.image_frame or IMAGE_FRAME
    if arguments.mirror:
        sequence = mirrored(sequence)
    if arguments.invert:
        sequence = inverted(sequence, TransformName.parse(arguments.invert))
    if arguments.scale:
        if min(arguments.scale) <= 0 or not np.isfinite(arguments.scale).all():
            raise SettingsError(f"--scale must be two numbers above 0, as in --scale 1 1.02; got {arguments.scale}.")
        sequence = corrected(sequence, np.diag([*arguments.scale, 1.0, 1.0]), image)
    if arguments.correction:
        sequence = corrected(sequence, read_transform(arguments.correction), image)
    return sequence


def _pair(text: str) -> tuple[str, str]:
    old, equals, new = (word.strip() for word in text.partition("="))
    if not (old and equals and new):
        raise SettingsError(f"Input rename must be A=B, as in ProbeToTracker=NeedleToTracker; got {text!r}.")
    return old, new


def _named_file(text: str) -> tuple[TransformName | None, Path]:
    """``ImageToProbe=FILE`` or ``FILE``."""
    word, equals, file = text.partition("=")
    if not equals:
        return None, Path(text)
    try:
        return TransformName.parse(word.strip()), Path(file.strip())
    except TransformError:
        return None, Path(text)


def _calibration(text: str) -> tuple[TransformName, Matrix]:
    name, path = _named_file(text)
    return read_calibration(path, name)

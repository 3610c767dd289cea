"""`aifrecon convert`: a recording in another format, cut, decimated, renamed, or mended where its orientation or calibration was wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np

from ..arrays import Matrix
from ..errors import SettingsError
from ..geometry.transform_graph import TransformName
from ..io.foreign.calibration import read_calibration
from ..io.metafile.metafile import UNFINISHED
from ..io.sequence.files import IMAGE_FRAME
from ..io.sequence.writer import check_sequence_name, write_sequence
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
from ..terminal.arguments import Names, Output, Settings, pair, reading
from ..terminal.console import ProgressBar
from ..terminal.outputs import tell
from ..terminal.sequence_options import RecordingOptions, sequences_from
from ..workflows.reconstruct import mended


class _ConvertOptions(RecordingOptions):
    """Write a tracked sequence as .mha, .mhd or .nrrd. Images and fields stay as they are, but for what the options change.

    Parameters
    ----------
    sequence : IN
        tracked frames, e.g. sweep.igs.mha
    output : OUT
        where to write (.mha, .mhd, .nrrd)
    compress
        compress the images (default: yes)
    config : PLUS.xml
        also write this configuration's transforms into the file
    frames : A B
        frames A to B, both included, counted from 0
    every : N
        every Nth of them
    crop : X Y W H
        this rectangle of the image, in pixels (MF); poses move along
    rename : A=B
        a transform (ProbeToTracker=NeedleToTracker) or a frame; may be repeated
    calibration : [NAME=]FILE
        put this calibration in the place of the recorded one: Plus configuration, Slicer transform or 16 numbers (ImageToProbe)
    wrong_calibration : [NAME=]FILE
        the calibration that recorded transforms such as ImageToReference include
    correction : FILE.tfm
        correct the image plane as aifrecon calibrate found it
    scale : X Y
        times the size of a pixel across and along
    invert : NAME
        take a transform for its inverse, e.g. ProbeToTracker
    mirror
        turn the images left to right; poses stay

    Examples
    --------
      aifrecon convert sweep.igs.mha sweep.nrrd
      aifrecon convert long.igs.mha short.igs.mha --frames 100 499 --every 2 --crop 80 20 640 480 --config PlusDeviceSet.xml
      aifrecon convert mirrored.igs.mha right.igs.mha --orientation UF
      aifrecon convert old.igs.mha mended.igs.mha --calibration new/PlusDeviceSet.xml --wrong-calibration old/PlusDeviceSet.xml
      aifrecon convert sweep.igs.mha mended.igs.mha --correction correction.tfm --time-offset 0.045
      aifrecon convert breathed.igs.mha mended.igs.mha --motion auto --config PlusDeviceSet.xml
      aifrecon convert Image.seq.nrrd sweep.igs.mha --transform-sequence ImageToReference=Transform.seq.mha
    """

    sequence: Path
    output: Output
    compress: bool = True
    config: list[Path] = []
    frames: tuple[int, int] | None = None
    every: int = 1
    crop: tuple[int, int, int, int] | None = None
    rename: Annotated[list[tuple[str, str]], reading(pair, "A=B, as in ProbeToTracker=NeedleToTracker")] = []
    calibration: str | None = None
    wrong_calibration: str | None = None
    correction: Path | None = None
    scale: tuple[float, float] | None = None
    invert: str | None = None
    mirror: bool = False

    WORDS: ClassVar[Names] = ("sequence", "output")
    SETTINGS: ClassVar[Settings] = ("motion",)


def run(asked: _ConvertOptions) -> None:
    """Read, change, write, and say what was done."""
    check_sequence_name(asked.output)
    sequence = changed(sequences_from(asked, [asked.sequence])[0], asked)
    with ProgressBar() as progress:
        if asked.motion == AUTOMATIC:
            before = len(sequence.notes)
            sequence = mended(sequence, progress=progress)
            sequence = replace(sequence, fields={**sequence.fields, "AIFRecon_motion": " ".join(sequence.notes[before:])})
        write_sequence(sequence, asked.output, asked.compress, progress)
    columns, rows = sequence.frame_size
    tell(f"{len(sequence)} frames of {columns} x {rows} pixels", sequence.notes, [asked.output])


def changed(sequence: TrackedSequence, asked: _ConvertOptions) -> TrackedSequence:
    """The sequence with everything done to it that the options ask for: names first, then calibration, part and frames."""
    # What is written is complete; the mark would keep readers from saying that it is damaged when it is
    sequence = replace(sequence, fields={key: value for key, value in sequence.fields.items() if key != UNFINISHED})
    sequence = rename(with_configured_transforms(sequence), dict(asked.rename))
    if asked.calibration:
        name, matrix = _calibration(asked.calibration)
        wrong = _calibration(asked.wrong_calibration)[1] if asked.wrong_calibration else None
        sequence = recalibrate(sequence, name, matrix, wrong)
    elif asked.wrong_calibration:
        raise SettingsError("--wrong-calibration says what to take out. Say with --calibration what to put in its place.")
    sequence = _mended(sequence, asked)
    first, last = asked.frames or (0, len(sequence) - 1)
    sequence = select_frames(sequence, first, last, asked.every)
    if not asked.crop:
        return sequence
    x, y, width, height = asked.crop
    return crop(sequence, x, y, width, height, sequence.configuration.image_frame or IMAGE_FRAME)


def _mended(sequence: TrackedSequence, asked: _ConvertOptions) -> TrackedSequence:
    """The sequence with what was recorded wrongly put right, in the order in which `calibrate` names it."""
    image = sequence.configuration.image_frame or IMAGE_FRAME
    if asked.mirror:
        sequence = mirrored(sequence)
    if asked.invert:
        sequence = inverted(sequence, TransformName.parse(asked.invert))
    if asked.scale:
        if min(asked.scale) <= 0 or not np.isfinite(asked.scale).all():
            raise SettingsError(f"--scale must be two numbers above 0, as in --scale 1 1.02; got {list(asked.scale)}.")
        sequence = corrected(sequence, np.diag([*asked.scale, 1.0, 1.0]), image)
    if asked.correction:
        sequence = corrected(sequence, read_transform(asked.correction), image)
    return sequence


def _calibration(text: str) -> tuple[TransformName, Matrix]:
    name, _, file = text.rpartition("=")
    return read_calibration(Path(file.strip()), TransformName.parse(name.strip()) if name else None)

"""`aifrecon import`: images and poses from anywhere become a tracked sequence."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

from ..inspection.imported import check_import, import_files
from ..io.disk.atomic import write_text
from ..io.foreign.importing import REFERENCE_FRAME
from ..io.foreign.options import RULES, ImportOptions
from ..io.sequence.writer import check_sequence_name, write_sequence
from ..recipe.rules import Rule
from ..terminal.arguments import Names, Options, Output, Settings
from ..terminal.console import ProgressBar, program
from ..terminal.outputs import check_outputs, tell


class _ImportedOptions(Options):
    """Write a tracked sequence from images (PNG, JPEG, TIFF, BMP, DICOM, video, .npy) and poses (CSV, TXT, JSON). Prints how everything
    was understood, and draws the sweep for a check.

    Parameters
    ----------
    images : IMAGES
        files or a folder, in natural order (2 before 10)
    poses : FILE
        one pose per image, or with times or names of images
    output : SEQUENCE
        where to write (.mha, .mhd, .nrrd)
    transform : NAME
        what the poses are, direction included: ImageToTracker, ProbeToTracker, or an inverse such as TrackerToProbe
    drawing : FILE.svg
        where to draw the sweep (default: beside the output)
    compress
        compress the images (default: yes)

    Examples
    --------
      aifrecon import frames/ --poses poses.csv --transform ImageToTracker --spacing 0.1 0.1 --output sweep.igs.mha
      aifrecon import sweep.mp4 --poses tracker.txt --columns "time x y z qx qy qz qw" --units m \\
          --transform ProbeToTracker --calibration ImageToProbe.tfm --output sweep.igs.mha
      aifrecon import images.npy --poses poses.json --transform TrackerToImage --spacing 0.2 0.2 --rate 20 --output sweep.nrrd
    """

    images: tuple[Path, ...]
    poses: Path
    output: Output
    transform: str
    drawing: Output | None = None
    compress: bool = True

    WORDS: ClassVar[Names] = ("images",)
    SETTINGS: ClassVar[Settings] = tuple(RULES)
    RULES: ClassVar[Mapping[str, Rule]] = RULES


def run(asked: _ImportedOptions) -> None:
    """Read, pair, write, draw, and say how everything was understood."""
    check_sequence_name(asked.output)
    options = ImportOptions(**{name: getattr(asked, name) for name in RULES if getattr(asked, name) is not None})
    asked.drawing = drawing = asked.drawing or Output(asked.output.with_name(asked.output.name.split(".")[0] + "-sweep.svg"))
    check_outputs(asked)
    imported = import_files(asked.images, asked.poses, options)
    with ProgressBar() as progress:
        write_sequence(imported.sequence, asked.output, asked.compress, progress)
    seen = check_import(imported, asked.output.name)
    lines = [*imported.understood, *seen.lines]
    if seen.drawing is not None:
        option = "" if seen.reference == REFERENCE_FRAME else f" --reference {seen.reference}"
        lines.append(f"to reconstruct: {program()} reconstruct {asked.output.name}{option} --output volume.nrrd")
        write_text(drawing, seen.drawing.to_svg())
        lines.append(f"drew {drawing}")
    tell("Understood:", lines, [asked.output])

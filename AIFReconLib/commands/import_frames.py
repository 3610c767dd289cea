"""`aifrecon import`: images and poses from anywhere become a tracked sequence."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..inspection.imported import check_import, import_files
from ..io.disk.atomic import check_writable, write_text
from ..io.foreign.importing import REFERENCE_FRAME
from ..io.foreign.options import RULES, ImportOptions
from ..io.sequence.writer import SUFFIXES, check_sequence_name, write_sequence
from ..terminal.console import ProgressBar, program
from ..terminal.options import Commands, refuse_to_overwrite
from ..terminal.recipe_options import add_setting
from ..terminal.remedies import in_options

GROUPS = {
    "poses": (
        *("columns", "tool", "reference_tool", "time_offset", "quaternion_order", "euler_order", "angle_unit", "units", "time_unit"),
        *("status_ok", "column_major", "sure"),
    ),
    "image": ("spacing", "image_origin_px", "calibration", "calibration_unit", "orientation", "rate", "times"),
    "mechanism": ("mechanism",),
}
"""The options by what they are about."""

EXAMPLE = """examples:
  aifrecon import frames/ --poses poses.csv --transform ImageToTracker --spacing 0.1 0.1 --output sweep.igs.mha
  aifrecon import sweep.mp4 --poses tracker.txt --columns "time x y z qx qy qz qw" --units m \\
      --transform ProbeToTracker --calibration ImageToProbe.tfm --output sweep.igs.mha
  aifrecon import images.npy --poses poses.json --transform TrackerToImage --spacing 0.2 0.2 --rate 20 --output sweep.nrrd"""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "import",
        description="Write a tracked sequence from images (PNG, JPEG, TIFF, BMP, DICOM, video, .npy) and poses (CSV, TXT, JSON).\n"
        "Prints how everything was understood, and draws the sweep for a check.",
        examples=EXAMPLE,
    )
    parser.add_argument("images", type=Path, nargs="+", metavar="IMAGES", help="files or a folder, in natural order (2 before 10)")
    parser.add_argument("--poses", type=Path, required=True, metavar="FILE", help="one pose per image, or with times or names of images")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="SEQUENCE", help=f"where to write ({', '.join(SUFFIXES)})")
    add_setting(parser, "transform", rules=RULES)
    parser._option_string_actions["--transform"].required = True
    for title, names in GROUPS.items():
        group = parser.add_argument_group(title)
        for name in names:
            add_setting(group, name, rules=RULES)
    output = parser.add_argument_group("output")
    output.add_argument("--drawing", type=Path, metavar="FILE.svg", help="where to draw the sweep (default: beside the output)")
    output.add_argument("--compress", action=argparse.BooleanOptionalAction, default=True, help="compress the images (default: yes)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, pair, write, draw, and say how everything was understood."""
    check_sequence_name(arguments.output)
    drawing = arguments.drawing or arguments.output.with_name(arguments.output.name.split(".")[0] + "-sweep.svg")
    options = ImportOptions(**{name: getattr(arguments, name) for name in RULES if getattr(arguments, name) is not None})
    refuse_to_overwrite(arguments, "output", "drawing", more=[drawing])
    check_writable(drawing)
    imported = import_files(arguments.images, arguments.poses, options)
    with ProgressBar() as progress:
        write_sequence(imported.sequence, arguments.output, arguments.compress, progress)
    seen = check_import(imported, arguments.output.name)
    lines = [*map(in_options, (*imported.understood, *seen.lines))]
    if seen.drawing is not None:
        option = "" if seen.reference == REFERENCE_FRAME else f" --reference {seen.reference}"
        lines.append(f"to reconstruct: {program()} reconstruct {arguments.output.name}{option} --output volume.nrrd")
        write_text(drawing, seen.drawing.to_svg())
        lines.append(f"drew {drawing}")
    print("\n".join(["Understood:", *(f"  {line}" for line in lines), f"  wrote {arguments.output}"]))

"""`aifrecon compare`: several volumes side by side, in one figure for a paper or a screen."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from ..errors import GeometryError, SettingsError
from ..evaluation.figures import ComparisonFigure, require_matplotlib
from ..evaluation.likeness import why_unlike
from ..evaluation.preview import middle_of_bone
from ..io.disk.atomic import check_writable
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import read_volume
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, add_labels_options, labels_from, place_from, refuse_to_overwrite
from ..terminal.remedies import in_options
from .evaluate import unique_names

SUFFIXES = (".png", ".pdf", ".svg")

EXAMPLE = """example:
  aifrecon compare average.nrrd weighted.nrrd --ct ct.nrrd --bone-labels lumbar.nrrd --bone-transform CTToReference.tfm \\
      --names average weighted --white --output figure.pdf"""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "compare",
        description="Draw the same axial, sagittal and coronal cuts of several volumes side by side, with one gray scale, the patient's "
        "right on the left: beside the CT with the outline of its bone, where these are given.",
        examples=EXAMPLE,
    )
    parser.add_argument("volumes", type=Path, nargs="+", metavar="VOLUME", help="reconstructions; the first says how much is shown")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE", help="where to draw: a .png, .pdf or .svg")
    parser.add_argument("--names", nargs="+", metavar="NAME", help="what is written above the volumes (default: the files' names)")
    parser.add_argument(
        "--at", type=float, nargs=3, metavar=("R", "A", "S"), help="mm where the cuts meet (default: the middle of the bone that shows)"
    )
    parser.add_argument("--window", type=float, nargs=2, metavar=("BLACK", "WHITE"), help="gray levels shown black and white")
    parser.add_argument("--white", action="store_true", help="on white, for a paper")
    parser.add_argument("--title", default="", help="written above all")
    add_labels_options(parser.add_argument_group("bone", "its outline is drawn, and says where to cut; a CT is shown beside"))
    parser.add_argument("--bone-transform", type=Path, metavar="FILE", help="transform CT -> Reference of both; default: none needed")
    parser.add_argument("--mask", type=Path, metavar="MASK", help="0 where nothing was scanned")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, draw, write."""
    refuse_to_overwrite(arguments, "output")
    if arguments.output.suffix.lower() not in SUFFIXES:
        raise SettingsError(f"{arguments.output}: a figure is a PNG, PDF or SVG. Choose a name that ends with .png, .pdf or .svg.")
    check_writable(arguments.output)
    require_matplotlib()
    paths = unique_names(arguments.volumes)
    names = arguments.names or list(paths)
    if len(names) != len(paths) or len({*names}) != len(names):
        raise SettingsError(f"Input --names must be {len(paths)} different names, one for each volume; got {' '.join(names)}.")
    if arguments.window and not arguments.window[0] < arguments.window[1]:
        raise SettingsError("Input --window must be BLACK and WHITE, the smaller first.")
    with ProgressBar() as progress:
        progress(0.0, "Reading")
        volumes = {name: read_volume(path) for name, path in zip(names, paths.values(), strict=True)}
        first = volumes[names[0]]
        mask = read_volume(arguments.mask) if arguments.mask else None
        place = place_from(arguments)
        given = labels_from(arguments, progress)
        labels = None if given is None else given.told_by(first.grid, place).placed_by(place)
        doubts = [words for name in names[1:] if (words := why_unlike(first, names[0], volumes[name], name))]
        ct = read_ct(arguments.ct).placed_by(place) if arguments.ct else None
        center = arguments.at
        if center is None:
            center = middle_of_bone(first, first.array != 0, labels)
        _require_within(first.grid.corners(), center, arguments.volumes[0])
        progress(0.6, "Drawing")
        window = tuple(arguments.window) if arguments.window else None
        ComparisonFigure(volumes, center, ct, labels, mask, arguments.title, window, arguments.white).write(arguments.output)
    notes = [*doubts, *(() if given is None else given.notes)]
    print("\n  ".join([f"wrote {arguments.output}", *map(in_options, notes)]))


def _require_within(corners: np.ndarray, center: np.ndarray, path: Path) -> None:
    """Return if the cuts go through the first volume."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    if not ((low <= center) & (center <= high)).all():
        box = ", ".join(f"{a:.0f} to {b:.0f}" for a, b in zip(low, high, strict=True))
        raise GeometryError(f"{path}: the cuts do not go through it. It fills {box} mm (R, A, S). Give a place within as --at R A S.")

"""`aifrecon preview`: a look at a volume, as a picture; and what `reconstruct` and `live` need to draw the same."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from ..arrays import Matrix
from ..compounding.state import Reconstruction
from ..errors import GeometryError, SettingsError
from ..evaluation.figures import require_matplotlib
from ..evaluation.preview import preview
from ..geometry.labels import Labels
from ..geometry.volume import Volume
from ..io.disk.atomic import check_writable
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import read_volume
from ..message import Sentence
from ..remedies import PLACE_THE_CT
from ..sweep.poses import SweepPoses
from ..terminal.console import ProgressBar, program, shell_words
from ..terminal.options import Commands, add_labels_options, labels_from, names_labels, place_from, refuse_to_overwrite
from ..terminal.remedies import in_options


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "preview",
        description="Draw axial, sagittal and coronal cuts through the middle of the bone, the patient's right on the left as in Slicer, "
        "and the bone from the probe's side. Without labels or a CT nothing tells how the patient lies: cuts then go across x, y and z.",
    )
    parser.add_argument("volume", type=Path, metavar="VOLUME", help="a reconstruction")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE.png", help="where to draw")
    add_labels_options(parser.add_argument_group("bone", "its outline is drawn, and says where to cut; a CT is shown beside"))
    parser.add_argument("--bone-transform", type=Path, metavar="FILE", help="transform CT -> Reference of both; default: none needed")
    parser.add_argument("--patient", action="store_true", help="Reference lies as the patient does (RAS), also without labels or a CT")
    parser.add_argument("--mask", type=Path, metavar="MASK", help="0 where nothing was scanned (default: where the volume is 0)")
    parser.set_defaults(run=run)


def add_preview_option(group: argparse._ActionsContainer) -> None:
    """Declare --preview."""
    group.add_argument("--preview", type=Path, metavar="FILE.png", help="also draw cuts through the bone (needs matplotlib)")


def check_preview(path: Path | None) -> None:
    """Return if a preview can be drawn to `path`; to be asked before a long computation."""
    if path is None:
        return
    if path.suffix.lower() != ".png":
        raise SettingsError(f"{path}: a preview is a PNG picture. Choose a name that ends with .png.")
    check_writable(path)
    require_matplotlib()


def run(arguments: argparse.Namespace) -> None:
    """Read, draw, write."""
    if arguments.labels and not arguments.bone_labels and Path(arguments.labels).exists():
        # What --bone-labels was called here once
        arguments.bone_labels, arguments.labels = [Path(arguments.labels)], None
    refuse_to_overwrite(arguments, "output")
    check_preview(arguments.output)
    if arguments.bone_transform and not (arguments.bone_labels or arguments.ct):
        raise SettingsError("--bone-transform places labels or a CT, and there are none. Give --bone-labels or --ct.")
    with ProgressBar() as progress:
        progress(0.0, f"Reading {arguments.volume.name}")
        volume = read_volume(arguments.volume)
        mask = read_volume(arguments.mask) if arguments.mask else None
        if mask is not None and not mask.grid.matches(volume.grid):
            raise GeometryError(f"{arguments.mask}: must have the voxels of {arguments.volume}. Give its own mask.")
        given, place = labels_from(arguments, progress), place_from(arguments)
        if given is not None:
            given = _in_sight(given, volume, place)
        labels = None if given is None else given.placed_by(place)
        ct = read_ct(arguments.ct).placed_by(place) if arguments.ct else None
        progress(0.5, "Drawing")
        preview(volume, mask, labels, ct, arguments.volume.name, patient=arguments.patient or None).write(arguments.output)
    print("\n  ".join([f"wrote {arguments.output}", *map(in_options, () if given is None else given.notes)]))


def _in_sight(labels: Labels, volume: Volume, place: Matrix | None) -> Labels:
    """The labels in the space in which the volume shows them, with a warning where it shows none."""
    labels = labels.told_by(volume.grid, place)
    if labels.share_within(volume.grid, place):
        return labels
    return replace(labels, notes=(*labels.notes, Sentence("WARNING: None of the bone lies in the volume.", PLACE_THE_CT)))


def write_preview(
    result: Reconstruction, arguments: argparse.Namespace, labels: Volume | None, poses: SweepPoses | None = None
) -> list[Path]:
    """Draw what --preview asks for, with labels in Reference, else as seen from where the probe was; the answer is the file, if any."""
    if not arguments.preview:
        return []
    title = f"{arguments.output.name}: {result.method}, {result.frames_inserted} frames"
    # Rows of an image run away from the probe
    beam = None if poses is None or labels is not None else poses.image_to_reference[poses.usable, :3, 1].mean(axis=0)
    preview(result.intensity, result.mask, labels, title=title, score=result.score, beam=beam).write(arguments.preview)
    return [arguments.preview]


def how_to_look(arguments: argparse.Namespace) -> list[str]:
    """The line that says how to see what was written; none where no one reads it, or where it was drawn already."""
    if arguments.preview or not sys.stdout.isatty():
        return []
    words = ["preview", str(arguments.output)]
    if names_labels(arguments):
        words += [word for path in arguments.bone_labels or [] for word in ("--bone-labels", str(path))]
        for option in ("labels", "ct", "bone_above", "bone_space", "bone_unit", "bone_transform"):
            given = getattr(arguments, option, None)
            words += [f"--{option.replace('_', '-')}", str(given)] if given else []
    words += ["--output", str(arguments.output.with_name(arguments.output.name.partition(".")[0] + ".png"))]
    return [f"to look at it: {program()} {shell_words(words)}"]

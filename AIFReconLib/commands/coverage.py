"""`aifrecon coverage`: which bone a sweep has met, and how squarely."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from ..errors import SettingsError
from ..guidance.coverage import Coverage, coverage
from ..guidance.mesh import ColoredBone, bone_mesh, met_on_mesh
from ..io.disk.atomic import write_text
from ..io.volume.surfaces import check_labels_surface_path, check_surface_path, write_surface
from ..progress import part
from ..recipe.recipe import AUTOMATIC
from ..registration.labeled_bone import LabeledBone
from ..terminal.console import ProgressBar
from ..terminal.options import (
    Commands,
    add_beam_option,
    add_labels_options,
    check_files,
    labels_from,
    place_from,
    refuse_to_overwrite,
)
from ..terminal.recipe_options import add_setting, recipe_from
from ..terminal.remedies import in_options
from ..terminal.sequence_options import add_sweep_options, of_each, sequence_from
from ..workflows.reconstruct import mended

EXAMPLE = """examples:
  aifrecon coverage sweep.igs.mha --config PlusDeviceSet.xml --bone-labels lumbar.nrrd --bone-transform CTToReference.tfm
  aifrecon coverage sweep.igs.mha --config PlusDeviceSet.xml

Shares are of the bone that a probe on the back can reach at all. 'aifrecon plan' says which passes would show more."""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "coverage",
        description="Tell from poses, images and a registered CT's segmentation how much of each bone the beams hit, at which angles, and "
        "what a reconstruction will show of it. Without a CT: of the surface that echoes show, and of where it may go on.",
        examples=EXAMPLE,
    )
    parser.add_argument("sequences", type=Path, nargs="+", metavar="SEQUENCE", help="tracked frames, one or more sweeps in one Reference")
    add_placed_labels_options(parser)
    result = parser.add_argument_group("result")
    result.add_argument(
        "--surface", type=Path, metavar="FILE.vtp", help="also write the bone's surface, with best cosine and frames at its points"
    )
    result.add_argument("-o", "--output", "--report", dest="report", type=Path, metavar="FILE.json", help="also write the table as JSON")
    add_beam_option(result)
    add_sweep_options(parser)
    add_setting(parser, "motion")
    parser.show_first("bone_labels", "ct", "bone_transform", "config", "surface", "report", "quiet")
    parser.set_defaults(run=run)


def add_placed_labels_options(parser: argparse.ArgumentParser) -> None:
    """Labels, and where they belong."""
    add_labels_options(parser)
    parser.add_argument(
        "--bone-transform", type=Path, metavar="FILE", help="transform CT -> Reference as Slicer saves it; default: none needed"
    )


def run(arguments: argparse.Namespace) -> None:
    """Read, follow the beams, say what was met."""
    each = of_each(arguments, arguments.sequences)
    refuse_to_overwrite(arguments, "surface", "report")
    if arguments.surface:
        check = check_labels_surface_path if arguments.bone_labels or arguments.ct else check_surface_path
        check(arguments.surface)
    check_files(arguments.report)
    with ProgressBar() as progress:
        labels, placed = labels_from(arguments, part(progress, 0.0, 0.05)), place_from(arguments)
        if labels is None and placed is not None:
            raise SettingsError("A transform places the CT's bone, and there is none. Give --bone-labels or --ct, or no --bone-transform.")
        sequences, recipe = [sequence_from(one) for one in each], recipe_from(arguments)
        bone = None if labels is None else LabeledBone(labels, placed, sequences, recipe)
        labels = None if bone is None else bone.labels
        if recipe.motion == AUTOMATIC:
            sequences = [mended(sequences, bone, recipe)]
        found = coverage(
            sequences,
            labels,
            placed,
            recipe=recipe,
            thickness=arguments.beam_thickness,
            progress=part(progress, 0.05, 0.95),
        )
        written = _write(arguments, found)
    notes = [*(labels.notes if labels is not None else ()), *found.notes, *(f"wrote {path}" for path in written)]
    print("\n".join([*found.lines(), *(f"  {in_options(note)}" for note in notes)]))


def _write(arguments: argparse.Namespace, found: Coverage) -> list[Path]:
    written = []
    if arguments.surface:
        bone = found.met.bone
        mesh = bone_mesh(bone.distance) if bone.is_of_ct else ColoredBone.of(bone).mesh
        write_surface(arguments.surface, mesh.points_reference, mesh.triangles, **met_on_mesh(mesh, found.met))
        written.append(arguments.surface)
    if arguments.report:
        write_text(arguments.report, json.dumps(found.to_dict(), indent=2) + "\n")
        written.append(arguments.report)
    return written

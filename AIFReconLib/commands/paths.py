"""`aifrecon paths`: where a straight line from the skin reaches a target past the bone that a volume shows."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from ..arrays import Floats
from ..errors import OutputError, SettingsError
from ..geometry.transforms import LPS_FROM_RAS, transform_points
from ..io.disk.atomic import write_text
from ..io.sequence.files import read_sequence
from ..io.volume.files import read_volume
from ..io.volume.models import LPS, MODEL_SUFFIXES, RAS, read_model
from ..io.volume.surfaces import check_surface_path
from ..paths.free_paths import CONE_DEG, MARGIN, WITHIN, FreePaths, free_paths
from ..paths.path_export import markups, paths_figure, write_skin_map
from ..progress import part
from ..sweep.frames import TrackedSequence
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, check_files, labels_from, place_from, refuse_to_overwrite
from ..terminal.recipe_options import add_imaging_options, recipe_from
from ..terminal.remedies import in_options
from ..terminal.sequence_options import add_tracking_options, of_each
from .coverage import add_placed_labels_options
from .preview import check_preview

EXAMPLE = """examples:
  aifrecon paths volume.nrrd --mask mask.nrrd --score score.nrrd --target L3-L4 --bone-labels lumbar.nrrd \\
      --bone-transform CTToReference.tfm --sweep sweep.igs.mha --config PlusDeviceSet.xml --output paths.mrk.json

Research only: not for guiding a needle. What was not seen is not called free; that needs --mask, and --score of the method weighted."""

MARKUPS = ".mrk.json"


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "paths",
        description="Find straight lines from the skin to a target that meet no bone that a volume shows: how far each keeps from it, "
        "how much of it was seen, and the best one of each window. Research only.",
        examples=EXAMPLE,
    )
    parser.add_argument("volume", type=Path, metavar="VOLUME", help="a reconstructed volume")
    parser.add_argument("--mask", type=Path, metavar="VOLUME", help="0 where nothing was measured (default: where the volume is 0)")
    parser.add_argument("--score", type=Path, metavar="VOLUME", help="of the method weighted: tells what lies in the shadow of bone")
    parser.add_argument(
        "--target",
        nargs="+",
        required=True,
        metavar="WHERE",
        help="L3-L4: the canal between two labels; or X Y Z in Reference (RAS)",
    )
    add_placed_labels_options(parser)
    skin = parser.add_argument_group("skin", "where lines begin: one of these")
    skin.add_argument("--sweep", type=Path, nargs="+", default=[], metavar="SEQUENCE", help="where the probe's face was in these sweeps")
    skin.add_argument("--skin", type=Path, metavar="FILE", help="a surface in Reference: .stl, .ply, .obj, .vtp or .vtk")
    lines = parser.add_argument_group("lines")
    lines.add_argument("--within", type=float, default=WITHIN, metavar="MM", help="of the target they end (default: %(default)g)")
    lines.add_argument(
        "--cone-deg",
        type=float,
        default=CONE_DEG,
        metavar="DEG",
        help="largest angle to the shortest way to the target (default: %(default)g)",
    )
    lines.add_argument(
        "--margin",
        type=float,
        default=MARGIN,
        metavar="MM",
        help="taken off each distance from bone, beside half a voxel, for calibration and registration (default: %(default)g)",
    )
    result = parser.add_argument_group("result")
    result.add_argument("-o", "--output", type=Path, required=True, metavar="PATHS.mrk.json", help="the lines, for Slicer's markups")
    result.add_argument("--skin-map", type=Path, metavar="FILE.vtp", help="also write the skin: blocked, not seen, tight or free")
    result.add_argument("--report", type=Path, metavar="FILE.json", help="also write all numbers, for aifrecon plan --unseen")
    result.add_argument("--preview", type=Path, metavar="FILE.png", help="also draw slices along the best line, and the skin")
    add_tracking_options(parser, several=True)
    add_imaging_options(parser)
    parser.show_first("bone_labels", "bone_transform", "sweep", "skin", "config", "mask", "score", "preview", "quiet")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, look along the lines, write, and say what was found."""
    outputs = [arguments.output, arguments.skin_map, arguments.report, arguments.preview]
    refuse_to_overwrite(arguments, "output", "skin_map", "report", "preview")
    if not arguments.output.name.lower().endswith(MARKUPS):
        raise OutputError(f"Cannot write {arguments.output}: Slicer's markups end in {MARKUPS}. Choose another name.")
    if bool(arguments.sweep) == bool(arguments.skin):
        raise SettingsError("Where the skin is must be given, once. Give --sweep SEQUENCE, whose probe was on it, or --skin FILE.")
    target = _target(arguments.target)
    check_files(arguments.output, arguments.report)
    if arguments.skin_map:
        check_surface_path(arguments.skin_map)
    check_preview(arguments.preview)
    with ProgressBar() as progress:
        volume = read_volume(arguments.volume)
        mask, score = (read_volume(path) if path else None for path in (arguments.mask, arguments.score))
        placed = place_from(arguments)
        labels = labels_from(arguments, part(progress, 0.0, 0.2))
        labels = None if labels is None else labels.told_by(volume.grid, placed)
        recipe, rest = recipe_from(arguments), part(progress, 0.2, 0.95)
        found = free_paths(
            volume,
            target,
            _skin(arguments),
            labels,
            placed,
            mask=mask,
            score=score,
            margin=arguments.margin,
            within=arguments.within,
            cone_deg=arguments.cone_deg,
            recipe=recipe,
            progress=rest,
        )
        if arguments.preview:
            paths_figure(arguments.preview, volume, found)
        _write(arguments, found)
    notes = [*(labels.notes if labels is not None else ()), *(f"wrote {path}" for path in outputs if path)]
    print("\n".join([*found.text(in_options), *(f"  {in_options(note)}" for note in notes)]))


def _target(words: list[str]) -> str | list[float]:
    """A level, or a point."""
    if len(words) == 1:
        return words[0]
    try:
        point = [float(word) for word in words]
    except ValueError:
        point = []
    if len(point) != 3:
        raise SettingsError(f"Input --target must be two labels as in L3-L4, or a point X Y Z in mm; got {' '.join(words)!r}.")
    return point


def _skin(arguments: argparse.Namespace) -> list[TrackedSequence] | Floats:
    if not arguments.skin:
        return [read_sequence(one.sequence, config=one.config) for one in of_each(arguments, arguments.sweep)]
    if arguments.skin.suffix.lower() not in MODEL_SUFFIXES:
        raise SettingsError(f"Input --skin must be a surface, {', '.join(MODEL_SUFFIXES)}; got {arguments.skin.name}.")
    model = read_model(arguments.skin, arguments.bone_unit)
    # As Slicer does, what does not say its space is in LPS
    is_ras = (model.space or arguments.bone_space or LPS).lower() == RAS.lower()
    return model.points if is_ras else transform_points(LPS_FROM_RAS, model.points)


def _write(arguments: argparse.Namespace, found: FreePaths) -> None:
    write_text(arguments.output, json.dumps(markups(found), indent=1) + "\n")
    if arguments.skin_map:
        write_skin_map(arguments.skin_map, found)
    if arguments.report:
        write_text(arguments.report, json.dumps(found.to_dict(), indent=2) + "\n")

"""`aifrecon bone-map`: the probability map alone."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..compounding.methods.aif import AIF
from ..compounding.methods.table import DEFAULT_METHOD_WITH_BONE
from ..errors import SettingsError
from ..io.volume.files import check_volume_path
from ..progress import part
from ..recipe.recipe import AUTOMATIC
from ..registration.labeled_bone import LabeledBone
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, add_labels_options, refuse_to_overwrite, required_labels
from ..terminal.recipe_options import recipe_from
from ..terminal.reconstruction_options import add_width_options
from ..terminal.remedies import in_options


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "bone-map",
        description="Make a bone probability map, to look at or to reuse with --bone-probability. Without a width it is that of weighted "
        "where CT and sweep were not compared; with one, that of the paper's methods.",
    )
    parser.add_argument(
        "given",
        type=Path,
        nargs="?",
        metavar="LABELS",
        help="segmentation of the CT: a volume, a model, or a folder of masks",
    )
    add_labels_options(parser)
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="VOLUME", help="where to write (.nrrd, .mha, .mhd, .nii, .nii.gz)"
    )
    add_width_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, smooth, write."""
    if arguments.given is not None:
        arguments.bone_labels = [arguments.given, *(arguments.bone_labels or [])]
    refuse_to_overwrite(arguments, "output")
    check_volume_path(arguments.output)
    if arguments.bone_sigma_mm == AUTOMATIC:
        raise SettingsError("--bone-sigma-mm auto compares the CT with a sweep, and there is none. Give a number.")
    with ProgressBar() as progress:
        labels = required_labels(arguments, part(progress, 0.0, 0.3))
        # The paper's map where its width is given, else that of the default method
        method = DEFAULT_METHOD_WITH_BONE if arguments.bone_sigma_voxels is None and arguments.bone_sigma_mm is None else AIF.name
        bone = LabeledBone(labels, recipe=recipe_from(arguments)).map(method, part(progress, 0.3, 1.0))
        bone.probability.write(arguments.output)
    size = " x ".join(str(n) for n in bone.probability.grid.size)
    lines = [
        f"bone probability on {size} voxels around the labels, 0 elsewhere",
        ", ".join(f"{name.removeprefix('bone_').replace('_', ' ')} {value:g}" for name, value in bone.made.items()),
        *map(in_options, labels.notes),
        f"wrote {arguments.output}",
    ]
    print("\n  ".join(lines))

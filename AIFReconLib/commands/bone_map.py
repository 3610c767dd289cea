"""`aifrecon bone-map`: the probability map alone."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..bone.map import BoneMap
from ..bone.widths import SIGMA_VOXELS
from ..errors import SettingsError
from ..io.volume.files import check_volume_path, read_labels
from ..recipe.recipe import AUTOMATIC
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, refuse_to_overwrite
from ..terminal.reconstruction_options import add_width_options


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "bone-map",
        help="make a bone probability map from a segmentation",
        description="Make the bone probability map that the reconstruction would use, to look at or to reuse with --bone-probability.",
    )
    parser.add_argument("labels", type=Path, metavar="LABELS", help="segmentation of the CT; any label above 0 is bone")
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="VOLUME", help="where to write (.nrrd, .mha, .mhd, .nii, .nii.gz)"
    )
    add_width_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, smooth, write."""
    refuse_to_overwrite([arguments.output], [arguments.labels])
    check_volume_path(arguments.output)
    if arguments.bone_sigma_mm == AUTOMATIC:
        raise SettingsError("--bone-sigma-mm auto compares the CT with a sweep, and there is none. Give a number.")
    voxels = SIGMA_VOXELS if arguments.bone_sigma_voxels is None else arguments.bone_sigma_voxels
    with ProgressBar() as progress:
        bone = BoneMap.from_labels(read_labels(arguments.labels), voxels, arguments.bone_sigma_mm, progress=progress)
        bone.probability.write(arguments.output)
    size = " x ".join(str(n) for n in bone.probability.grid.size)
    print(f"bone probability on {size} voxels around the labels, 0 elsewhere\n  wrote {arguments.output}")

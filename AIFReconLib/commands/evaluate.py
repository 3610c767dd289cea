"""`aifrecon evaluate`: how clearly, sharply and completely volumes show bone."""

from __future__ import annotations

import argparse
import csv
import io
import math
from pathlib import Path

from ..console import ProgressBar, columns
from ..errors import GeometryError, SettingsError
from ..evaluation.metrics import BoneMetrics, evaluate
from ..evaluation.visibility import BEAM_THICKNESS, SweepBeams, bone_truth
from ..io.atomic import check_writable, write_text
from ..io.sequence_files import read_sequence
from ..io.volume_files import read_labels, read_transform, read_volume
from ..poses import sweep_poses
from ..progress import part
from ..reconstruct import resolve_imaging
from .options import add_imaging_options, imaging_from, refuse_to_overwrite
from .reconstruct import add_tracking_options

EXAMPLE = """examples:
  aifrecon evaluate average.nrrd weighted.nrrd --bone lumbar.nrrd --bone-transform CTToReference.tfm \\
      --sweep sweep.igs.mha --config PlusDeviceSet.xml --csv metrics.csv

Volumes are to be compared under one sweep: it decides which bone counts. To compare sweeps, give the one that saw more for both."""

TABLE = {
    "CNR": ("bone_cnr", ".2f"),
    "oblique CNR": ("oblique_cnr", ".2f"),
    "detectability": ("bone_detectability", ".2f"),
    "coverage": ("bone_coverage", ".1%"),
    "oblique coverage": ("oblique_coverage", ".1%"),
    "interspinous": ("interspinous_coverage", ".1%"),
    "thickness mm": ("bone_thickness", ".2f"),
    "off by mm": ("bone_localization_error", ".2f"),
    "shadow": ("shadow_mean", ".1f"),
    "speckle SNR": ("speckle_snr", ".2f"),
}
"""Headings of the table, and what stands under them."""


def add_to(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "evaluate",
        help="measure how well volumes show bone",
        description="Measure volumes against the surface of a registered segmentation: contrast and CNR of bone, its thickness and "
        "place, the share of the surface that is visible, also of oblique bone and at the interspinous gaps, noise and speckle.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("volumes", type=Path, nargs="+", metavar="VOLUME", help="reconstructed volumes, one row each")
    parser.add_argument(
        "--bone", type=Path, required=True, metavar="LABELS", help="true segmentation; any label above 0 is bone, one label per vertebra"
    )
    parser.add_argument(
        "--bone-transform", type=Path, metavar="FILE", help="transform CT -> Reference as Slicer saves it; default: none needed"
    )
    parser.add_argument("--mask", type=Path, metavar="VOLUME", help="0 where nothing was measured (default: where a volume is 0)")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="also write every number here")
    sweep = parser.add_argument_group("sweep", "decides which bone the beams could reach; without one all bone in the volume counts")
    sweep.add_argument("--sweep", type=Path, metavar="SEQUENCE", help="tracked frames that the volumes were made from")
    sweep.add_argument(
        "--beam-thickness",
        type=float,
        default=BEAM_THICKNESS,
        metavar="MM",
        help="width of the beam across the image plane (default: %(default)g)",
    )
    add_tracking_options(parser)
    add_imaging_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, measure, print, write."""
    inputs = [*arguments.volumes, arguments.bone, arguments.bone_transform, arguments.mask, arguments.sweep, arguments.config]
    refuse_to_overwrite([arguments.csv], inputs)
    if arguments.csv:
        check_writable(arguments.csv)
    if not (math.isfinite(arguments.beam_thickness) and arguments.beam_thickness > 0):
        raise SettingsError(f"Input --beam-thickness must be positive mm; got {arguments.beam_thickness:g}.")
    if arguments.config and not arguments.sweep:
        raise SettingsError("--config describes a sweep, and there is none. Give --sweep SEQUENCE.")
    results: list[BoneMetrics] = []
    with ProgressBar() as progress:
        beams = _beams(arguments) if arguments.sweep else None
        labels = read_labels(arguments.bone)
        if arguments.bone_transform:
            labels = labels.placed_by(read_transform(arguments.bone_transform))
        mask = read_volume(arguments.mask) if arguments.mask else None
        truth = bone_truth(labels, beams, progress=part(progress, 0.05, 0.6))
        for number, path in enumerate(arguments.volumes):
            progress(0.6 + 0.4 * number / len(arguments.volumes), f"Measuring {path.name}")
            volume = read_volume(path)
            try:
                results.append(evaluate(volume, truth, mask))
            except GeometryError as error:
                raise GeometryError(f"{path}: {error}") from None
            if results[-1].bone.area == 0:
                reached = "that the sweep reaches " if beams else ""
                raise GeometryError(f"{path}: no bone surface {reached}lies where it was measured. Check --bone-transform and the files.")
    names = _names(arguments.volumes)
    heading = ["", *TABLE]
    print(columns([heading, *([name, *_cells(result)] for name, result in zip(names, results))]))
    print(f"\n  {_what_counted(results[0], beams)}")
    if arguments.csv:
        write_text(arguments.csv, _csv(names, results, "sweep" if beams else "unknown"))
        print(f"  wrote {arguments.csv}")


def _beams(arguments: argparse.Namespace) -> SweepBeams:
    sequence = read_sequence(arguments.sweep, config=arguments.config)
    poses = sweep_poses(sequence, arguments.image_to_reference, arguments.reference)
    usable = poses.require_usable(sequence.name)
    imaging = resolve_imaging(sequence, poses, True, *imaging_from(arguments, sequence))
    return SweepBeams(
        poses.image_to_reference[usable], sequence.frame_size, imaging.probe, imaging.region, thickness=arguments.beam_thickness
    )


def _names(paths: list[Path]) -> list[str]:
    """File names, or whole paths where two are called the same."""
    names = [path.name for path in paths]
    return names if len(set(names)) == len(names) else [str(path) for path in paths]


def _cells(result: BoneMetrics) -> list[str]:
    numbers = result.to_dict()
    return ["-" if math.isnan(numbers[key]) else format(numbers[key], form) for key, form in TABLE.values()]


def _what_counted(result: BoneMetrics, beams: SweepBeams | None) -> str:
    """Which bone the numbers are of, in a line."""
    area = result.bone.area / 100
    if beams is None:
        return (
            f"Reachability is unknown without --sweep: all {area:.1f} cm2 of bone surface where the volume was measured count, "
            "also what no beam could reach."
        )
    return (
        f"of the {area:.1f} cm2 of bone surface that the {len(beams.image_to_reference)} frames could reach "
        f"({result.oblique.area / 100:.1f} cm2 oblique, {result.interspinous.area / 100:.1f} cm2 at interspinous gaps)"
    )


def _csv(names: list[str], results: list[BoneMetrics], reachability: str) -> str:
    """One line per volume under a line of headings; what is not known is left empty."""
    rows = [{"volume": name, "reachability": reachability, **result.to_dict()} for name, result in zip(names, results)]
    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=list(rows[0]), lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({key: _csv_cell(value) for key, value in row.items()})
    return text.getvalue()


def _csv_cell(value: str | float) -> str:
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else f"{value:.6g}"

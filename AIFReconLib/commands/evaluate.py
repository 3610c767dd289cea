"""`aifrecon evaluate`: how clearly, sharply and completely volumes show bone."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable
from datetime import date
from pathlib import Path

from ..errors import GeometryError, SettingsError
from ..evaluation.cases import FEW, LEVEL, CaseNumbers
from ..evaluation.figures import ComparisonFigure, require_matplotlib, within_spinous_process
from ..evaluation.metrics import evaluate
from ..evaluation.paragraph import methods_paragraph
from ..evaluation.quantities import BoneMetrics, achieved, metrics_csv, table, what_counted
from ..evaluation.report import Report, file_sizes, software_versions, write_report
from ..evaluation.visibility import SweepBeams, bone_truth
from ..geometry.volume import Volume
from ..io.disk.atomic import write_text
from ..io.sequence.files import read_sequence
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import read_volume
from ..message import columns, listed
from ..progress import part
from ..provenance.record import made_by, weighted_by
from ..provenance.settings_files import made_with
from ..sweep.multi_sweep import joined
from ..terminal.console import ProgressBar, real_path
from ..terminal.options import (
    Commands,
    add_beam_option,
    add_labels_options,
    check_files,
    labels_inputs,
    place_from,
    refuse_to_overwrite,
    required_labels,
)
from ..terminal.recipe_options import add_imaging_options, recipe_from
from ..terminal.remedies import in_options
from ..terminal.sequence_options import add_tracking_options, of_each

OWN = (
    "Weighted by the bone that is also the yardstick: {}. What is wrong with that bone, or with its place, does not show. Another "
    "segmentation (--bone, or the column bone of batch) tells more."
)

EXAMPLE = """examples:
  aifrecon evaluate average.nrrd weighted.nrrd --bone lumbar.nrrd --bone-transform CTToReference.tfm \\
      --sweep sweep.igs.mha --config PlusDeviceSet.xml --csv metrics.csv --ct ct.nrrd --report report.html
  aifrecon evaluate results/results.csv --against average --csv summary.csv

Volumes are to be compared under one sweep: it decides which bone counts. To compare sweeps, give the one that saw more for both."""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "evaluate",
        description="Measure volumes against the surface of a registered segmentation: contrast and contrast-to-noise ratio (CNR) of "
        "bone, its thickness and place, the share of the surface that is visible, also of oblique bone and at the interspinous gaps, "
        "noise and speckle.",
        examples=EXAMPLE,
    )
    parser.add_argument(
        "volumes",
        type=Path,
        nargs="+",
        metavar="VOLUME",
        help="reconstructed volumes, one row each; or tables of many cases (.csv), as this command and batch write them",
    )
    add_labels_options(parser, None, "--bone", "--bone-labels", several=False)
    parser.add_argument(
        "--bone-transform", type=Path, metavar="FILE", help="transform CT -> Reference as Slicer saves it; default: none needed"
    )
    parser.add_argument("--mask", type=Path, metavar="VOLUME", help="0 where nothing was measured (default: where a volume is 0)")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="also write every number here")
    parser.add_argument("--against", metavar="NAME", help="of many cases: what others are compared with (default: average, else the first)")
    parser.add_argument("--methods", type=Path, metavar="FILE.txt", help="also write a paragraph for the methods section of a paper")
    parser.add_argument("--report", type=Path, metavar="FILE.html", help="also write a page with numbers, definitions and provenance")
    sweep = parser.add_argument_group("sweep", "decides which bone the beams could reach; without one all bone in the volume counts")
    sweep.add_argument(
        "--sweep",
        type=Path,
        nargs="+",
        default=[],
        metavar="SEQUENCE",
        help="frames that the volumes were made from, one or more sweeps",
    )
    add_beam_option(sweep)
    add_tracking_options(parser, several=True)
    add_imaging_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, measure, print, write."""
    are_tables = {path.suffix.lower() == ".csv" for path in arguments.volumes}
    if len(are_tables) > 1 or (True in are_tables and (arguments.report or labels_inputs(arguments) or arguments.sweep)):
        raise SettingsError("Tables (.csv) hold numbers of many cases. Give them without volumes, --bone, --ct, --sweep and --report.")
    if True in are_tables:
        _over_cases(arguments)
        return
    of_sweep = [*arguments.sweep, *(arguments.config or [])]
    inputs = [*arguments.volumes, *labels_inputs(arguments), arguments.bone_transform, arguments.mask, *of_sweep]
    outputs = [path for path in (arguments.csv, arguments.report, arguments.methods) if path]
    refuse_to_overwrite(arguments, "csv", "report", "methods")
    check_files(*outputs)
    if not (math.isfinite(arguments.beam_thickness) and arguments.beam_thickness > 0):
        raise SettingsError(f"Input --beam-thickness must be positive mm; got {arguments.beam_thickness:g}.")
    if arguments.config and not arguments.sweep:
        raise SettingsError("--config describes a sweep, and there is none. Give --sweep SEQUENCE.")
    if arguments.ct and arguments.report:
        require_matplotlib()
    results: dict[str, BoneMetrics] = {}
    made: dict[str, dict[str, object]] = {}
    own_bone: list[str] = []
    shown: dict[str, Volume] = {}
    with ProgressBar() as progress:
        beams = _beams(arguments) if arguments.sweep else None
        to_reference = place_from(arguments)
        given = required_labels(arguments, part(progress, 0.0, 0.05)).told_by(read_volume(arguments.volumes[0]).grid, to_reference)
        labels = given.placed_by(to_reference)
        mask = read_volume(arguments.mask) if arguments.mask else None
        truth = bone_truth(labels, beams, progress=part(progress, 0.05, 0.6))
        for number, (name, path) in enumerate(unique_names(arguments.volumes).items()):
            progress(0.6 + 0.3 * number / len(arguments.volumes), f"Measuring {path.name}")
            volume = read_volume(path)
            made[name] = made_by(volume)
            own_bone += [name] if weighted_by(volume, labels_inputs(arguments)) else []
            try:
                results[name] = evaluate(volume, truth, mask)
            except GeometryError as error:
                raise GeometryError(f"{path}: {error}") from None
            if results[name].bone.area == 0:
                if beams:
                    raise GeometryError(
                        f"{path}: no bone surface that the sweep reaches lies where it was measured. Check --bone-transform and the files."
                    )
                raise GeometryError(f"{path}: no bone surface lies where it was measured. Check --bone-transform and the files.")
            if arguments.ct and arguments.report:
                shown[name] = volume
        figure = None
        if arguments.ct and arguments.report:
            progress(0.9, "Drawing")
            ct = read_ct(arguments.ct).placed_by(to_reference)
            center = within_spinous_process(truth.surface, next(iter(shown.values())).grid)
            figure = ComparisonFigure(shown, center, ct, labels, mask).png()
    frames = len(beams.image_to_reference) if beams else None
    # Before anything is printed, which can fail: whoever reads it may go away
    if arguments.csv:
        write_text(arguments.csv, metrics_csv(results, frames))
    if arguments.report:
        write_report(arguments.report, _report(arguments, results, frames, inputs, figure))
    if arguments.methods:
        counted = what_counted(next(iter(results.values())), frames)
        told = f"They were measured against {_bone(arguments)} (registration: {_place(arguments)}). Numbers are {counted.rstrip('.')}."
        write_text(arguments.methods, methods_paragraph(made, told, own_bone))
    print(columns(table(results)))
    print(f"\n  {achieved(results, frames)}")
    print(f"\n  {what_counted(next(iter(results.values())), frames)}" + ("" if beams else " Give --sweep to count only what it reached."))
    if own_bone:
        print(f"  {OWN.format(listed(own_bone))}")
    if mask is None:
        print("  Measured where a volume is not 0. batch and the panel measure where frames entered or gaps were filled, as with --mask.")
    for line in (*map(in_options, given.notes), *(f"wrote {path}" for path in outputs)):
        print(f"  {line}")


def _over_cases(arguments: argparse.Namespace) -> None:
    """The same of tables of many cases: means, spreads and paired differences."""
    refuse_to_overwrite(arguments, "csv", "methods")
    check_files(arguments.csv, arguments.methods)
    found = CaseNumbers.read(unique_names(arguments.volumes))
    against = found.reference(arguments.against)
    means, differences = found.tables(against)
    cases = len({case for rows in found.numbers.values() for case in rows})
    if cases < 2:
        raise SettingsError("The tables hold one case. Give those of several, or the volumes themselves.")
    print(f"{cases} cases: mean \N{PLUS-MINUS SIGN} standard deviation\n{columns(means)}")
    print(f"\nminus {against}: mean of paired differences [{LEVEL:.0%} confidence interval, bootstrap over cases]\n{columns(differences)}")
    if cases < FEW:
        print(f"\n  Of fewer than {FEW} cases such intervals are too narrow.")
    if found.own_bone:
        print(f"\n  {OWN.format(listed(sorted(found.own_bone)))}")
    if arguments.csv:
        write_text(arguments.csv, found.csv(against))
    if arguments.methods:
        made = {name: made_by(read_volume(path)) if path.is_file() else {} for name, path in found.volumes.items()}
        first = ", ".join(dict.fromkeys(path.parent.name for path in found.volumes.values()))
        told = f"Settings are those of {first}: widths, limits and boxes that are found differ from case to case."
        write_text(arguments.methods, methods_paragraph(made, told if any(made.values()) else "", sorted(found.own_bone), cases))
    for path in filter(None, (arguments.csv, arguments.methods)):
        print(f"  wrote {path}")


def _bone(arguments: argparse.Namespace) -> str:
    return listed(path.name for path in arguments.bone_labels or [arguments.ct])


def _place(arguments: argparse.Namespace) -> str:
    return arguments.bone_transform.name if arguments.bone_transform else "none needed"


def unique_names(paths: Iterable[Path]) -> dict[str, Path]:
    """Paths by short names that tell them apart: the file's, with as many of its folders as that takes."""
    named: dict[str, Path] = {}
    full = [(path, real_path(path).parts[1:]) for path in paths]
    for path, parts in full:
        same = [other for _, other in full if other != parts]
        length = next((n for n in range(1, len(parts)) if all(other[-n:] != parts[-n:] for other in same)), len(parts))
        name = "/".join(parts[-length:])
        copy = sum(other == path or real_path(other) == real_path(path) for other in named.values())
        named[f"{name} ({copy + 1})" if copy else name] = path
    return named


def _beams(arguments: argparse.Namespace) -> SweepBeams:
    sequence = joined(read_sequence(one.sequence, config=one.config) for one in of_each(arguments, arguments.sweep))
    return SweepBeams.of_sequence(sequence, recipe_from(arguments), arguments.beam_thickness)


def _report(
    arguments: argparse.Namespace, results: dict[str, BoneMetrics], frames: int | None, inputs: list[Path | None], figure: bytes | None
) -> Report:
    facts = {
        "Bone": _bone(arguments),
        "Registration": _place(arguments),
    }
    facts["Measured"] = f"where {arguments.mask.name} is not 0" if arguments.mask else "where a volume is not 0"
    if frames is not None:
        facts["Sweep"] = f"{', '.join(path.name for path in arguments.sweep)}, {frames} frames with a pose"
        facts["Beam"] = f"{arguments.beam_thickness:g} mm across the image plane"
    return Report(
        title="How well volumes show bone",
        date=date.today().isoformat(),
        metrics=results,
        frames=frames,
        inputs=file_sizes(inputs),
        facts=facts,
        settings={name: made for name, path in unique_names(arguments.volumes).items() if (made := made_with(path)) is not None},
        versions=software_versions(),
        figure_png=figure,
        figure_caption="Cuts through a spinous process: the CT with its segmentation outlined, and the volumes."
        + (" Blue: not scanned." if arguments.mask else ""),
    )

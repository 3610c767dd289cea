"""`aifrecon calibrate`: a calibration from the scan itself or from a phantom, checked and written where it is used."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from .. import __version__
from ..calibration.calibration import as_report, calibrate, findings
from ..calibration.check import check_calibration
from ..calibration.crossing import calibrate_by_crossing, crossing_findings, crossing_report
from ..calibration.echoes import Mending
from ..calibration.nwire import PHANTOM, calibrate_on_wires, wire_findings, wire_report
from ..errors import OutputError, RegistrationRefused, SettingsError
from ..geometry.transform_graph import TransformName
from ..io.disk.atomic import write_text
from ..io.plus.calibration import write_calibrated
from ..io.plus.configuration import read_plus_configuration
from ..io.plus.phantom import read_wire_phantom
from ..io.transform.files import HDF5_SUFFIXES, TEXT_SUFFIXES, read_transform, write_transform
from ..message import said
from ..progress import part
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import JoinedImages
from ..sweep.poses import chain_ends
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, add_labels_options, check_files, labels_from, names_labels, refuse_to_overwrite
from ..terminal.recipe_options import recipe_from
from ..terminal.remedies import in_options
from ..terminal.sequence_options import add_sweep_options, of_each, sequence_from

EXAMPLE = """examples:
  aifrecon calibrate sweep.igs.mha --config PlusDeviceSet.xml --bone-labels lumbar.nrrd --check
  aifrecon calibrate sweep.igs.mha --config PlusDeviceSet.xml --bone-labels lumbar.nrrd --output Calibrated.xml --preview calibrated.png
  aifrecon calibrate wires.igs.mha --phantom PlusDeviceSet.xml --output Calibrated.xml

Exit code 1: the sweep does not tell, and nothing is written but --report. The delay alone: aifrecon info."""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "calibrate",
        description="Find image to probe, pixel size and delay with which the bone echoes of all angles lie on a CT's bone; without a CT, "
        "image to probe and delay with which they lie on one surface.",
        examples=EXAMPLE,
    )
    parser.add_argument("sequences", type=Path, nargs="+", metavar="SEQUENCE", help="tracked frames, one or more sweeps of one calibration")
    parser.add_argument(
        "--phantom",
        type=Path,
        metavar="PLUS.xml",
        help="the sweeps show the N-wire phantom that this configuration describes, and no bone; also the default of --config",
    )
    add_labels_options(parser)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="where to write: the configuration (.xml), or a correction for aifrecon convert (.tfm)",
    )
    what.add_argument("--check", action="store_true", help="only say what is probably wrong, if anything is")
    parser.add_argument(
        "--bone-transform",
        type=Path,
        metavar="START",
        help="CT -> Reference to start from; default: look for it, unless it lies on the sweep",
    )
    parser.add_argument("--report", type=Path, metavar="FILE.json", help="also write numbers, for the log book")
    parser.add_argument("--preview", type=Path, metavar="FILE.png", help="also draw the echoes before and after")
    add_sweep_options(parser)
    parser.show_first("output", "check", "config", "bone_labels", "ct", "phantom", "preview", "quiet")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, check or calibrate, write, and say how sure it is."""
    if arguments.phantom and not arguments.config:
        arguments.config = [arguments.phantom]
    each = of_each(arguments, arguments.sequences)
    refuse_to_overwrite(arguments, "output", "report", "preview")
    check_files(arguments.output, arguments.report, arguments.preview)
    _check_output(arguments)
    if arguments.phantom:
        _run_on_wires(arguments, each)
        return
    start = read_transform(arguments.bone_transform) if arguments.bone_transform else None
    with ProgressBar() as progress:
        labels = labels_from(arguments, part(progress, 0.0, 0.05))
        sequences, recipe = [sequence_from(one) for one in each], recipe_from(arguments)
        if arguments.check:
            lines = check_calibration(sequences, labels, start, recipe=recipe, progress=part(progress, 0.05, 1.0))
            print("\n  ".join(map(in_options, lines)))
            return
        name = _calibrated(sequences, arguments.image_to_reference) if arguments.output.suffix.lower() == ".xml" else None
        if labels is None:
            crossed = calibrate_by_crossing(sequences, recipe=recipe, progress=part(progress, 0.05, 0.95))
            found: Mending = crossed
            lines, facts, placed = crossing_findings(crossed), crossing_report(crossed), crossed.placed_echoes
            titles = f"before: {crossed.before:.2f} mm between angles", f"after: {crossed.after:.2f} mm"
        else:
            found = laid = calibrate(sequences, labels, start, recipe=recipe, progress=part(progress, 0.05, 0.95))
            lines, facts, placed = findings(laid), as_report(laid), laid.echoes_on_bone
            titles = f"before: {laid.before.sentence()}", f"after: {laid.after.sentence()}"
        if arguments.preview:
            from ..evaluation.registration_figure import calibration_figure

            calibration_figure(arguments.preview, placed, found.echoes.angles[found.echoes.frames], titles, labels)
    if found.accepted:
        _write(arguments, found, sequences, name)
    _tell(arguments, sequences, lines, facts, found.said)


def _run_on_wires(arguments: argparse.Namespace, each: list[argparse.Namespace]) -> None:
    """The same for a phantom of N-wires."""
    if arguments.check or arguments.bone_transform or names_labels(arguments) or arguments.output.suffix.lower() != ".xml":
        raise SettingsError("With --phantom a calibration is found from wires alone. Give --output FILE.xml, and no --check, CT or labels.")
    wires = read_wire_phantom(arguments.phantom)
    described = read_plus_configuration(arguments.phantom).transforms
    place = {name: sample for name, sample in described.items() if PHANTOM in (name.source, name.target)}
    with ProgressBar() as progress:
        sequences = []
        for sequence in map(sequence_from, each):
            known = sequence.configuration.transforms
            more = {} if any(PHANTOM in (name.source, name.target) for name in known) else place
            sequences.append(replace(sequence, configuration=replace(sequence.configuration, transforms={**known, **more})))
        found = calibrate_on_wires(sequences, wires, name=arguments.image_to_reference, progress=part(progress, 0.0, 0.95))
        if arguments.preview:
            from ..evaluation.registration_figure import wire_figure

            shown = found.frames[np.linspace(0, len(found.frames.numbers) - 1, 3).round().astype(int)]
            stack = JoinedImages([sequence.images for sequence in sequences])
            images = [stack[int(number)] for number in shown.numbers]
            points, expected = (one.reshape(len(images), -1, 2) for one in (shown.points, shown.expected(found.image_to_probe)))
            wire_figure(arguments.preview, images, points, expected, wire_findings(found)[1])
    if found.accepted:
        write_calibrated(arguments.config[0], arguments.output, found.name, found.image_to_probe, _note(sequences))
    _tell(arguments, sequences, wire_findings(found), wire_report(found, wires), found.said)


def _tell(
    arguments: argparse.Namespace, sequences: list[TrackedSequence], lines: list[str], facts: dict[str, object], refusal: str | None
) -> None:
    """Write the report, say what was found and written, and why no calibration is, if so."""
    written = [arguments.preview] if arguments.preview else []
    written += [] if refusal is not None else [arguments.output]
    if arguments.report:
        facts = {"sequences": [sequence.name for sequence in sequences], "version": __version__, **facts}
        write_text(arguments.report, json.dumps(facts, indent=2) + "\n")
        written.append(arguments.report)
    print("\n  ".join([*map(in_options, lines), *(f"wrote {path}" for path in written)]))
    if refusal is not None:
        raise RegistrationRefused(f"No calibration is written. {refusal}", said(refusal))


def _check_output(arguments: argparse.Namespace) -> None:
    """Return if the output can hold a calibration; asked before the long work."""
    if not arguments.output:
        return
    suffix = arguments.output.suffix.lower()
    if suffix not in (".xml", *TEXT_SUFFIXES, *HDF5_SUFFIXES):
        raise OutputError(f"Cannot write {arguments.output}: its name must end in .xml or .tfm. Choose another.")
    if suffix == ".xml" and len(arguments.config or []) != 1:
        raise SettingsError("A configuration is written from the one that is given. Give it with --config, or write a .tfm.")


def _calibrated(sequences: list[TrackedSequence], image_to_reference: str | None) -> TransformName:
    """The transform of the configuration that is to be replaced."""
    wanted, _ = chain_ends(sequences[0].configuration, image_to_reference, None)
    names = [name for name in sequences[0].configured() if name.source == wanted.source]
    if len(names) != 1:
        raise SettingsError(
            f"{sequences[0].name}: the calibration is not in the configuration but in the recording. Write a .tfm and give it to "
            "aifrecon convert --correction."
        )
    return names[0]


def _write(arguments: argparse.Namespace, found: Mending, sequences: list[TrackedSequence], name: TransformName | None) -> None:
    if name is None:
        write_transform(found.image_correction, arguments.output)
        return
    old = np.asarray(sequences[0].configured()[name].matrix)
    write_calibrated(arguments.config[0], arguments.output, name, found.mended(old), _note(sequences))


def _note(sequences: list[TrackedSequence]) -> str:
    return f"aifrecon {__version__}, by {', '.join(sequence.name for sequence in sequences)}"

"""`aifrecon calibrate`: a calibration from the scan itself or from a phantom, checked and written where it is used."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from ..calibration.check import check_calibration
from ..errors import OutputError, SettingsError
from ..io.disk.atomic import write_text
from ..io.transform.files import HDF5_SUFFIXES, TEXT_SUFFIXES
from ..progress import part
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, add_labels_options, check_files, labels_from, names_labels, place_from, refuse_to_overwrite
from ..terminal.recipe_options import recipe_from
from ..terminal.remedies import in_options
from ..terminal.sequence_options import add_sweep_options, of_each, sequence_from
from ..workflows.calibrate import calibration_of, calibration_on_wires

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
    with ProgressBar() as progress:
        start, labels = place_from(arguments), labels_from(arguments, part(progress, 0.0, 0.05))
        sequences, recipe, rest = [sequence_from(one) for one in each], recipe_from(arguments), part(progress, 0.05, 0.95)
        if arguments.check:
            lines = check_calibration(sequences, labels, start, recipe=recipe, progress=rest)
            print("\n  ".join(map(in_options, lines)))
            return
        if arguments.phantom:
            done = calibration_on_wires(sequences, arguments.phantom, arguments.image_to_reference, rest)
        else:
            done = calibration_of(sequences, labels, start, recipe, arguments.output.suffix.lower() == ".xml", rest)
        if arguments.preview:
            done.draw(arguments.preview)
    written = [arguments.preview] if arguments.preview else []
    if done.found.accepted:
        done.write(arguments.output, arguments.config or [])
        written.append(arguments.output)
    if arguments.report:
        write_text(arguments.report, json.dumps(done.report, indent=2) + "\n")
        written.append(arguments.report)
    print("\n  ".join([*map(in_options, done.lines), *(f"wrote {path}" for path in written)]))
    done.require_accepted()


def _check_output(arguments: argparse.Namespace) -> None:
    """Return if the output can hold a calibration; asked before the long work."""
    if arguments.phantom and (
        arguments.check or arguments.bone_transform or names_labels(arguments) or arguments.output.suffix.lower() != ".xml"
    ):
        raise SettingsError("With --phantom a calibration is found from wires alone. Give --output FILE.xml, and no --check, CT or labels.")
    if not arguments.output:
        return
    suffix = arguments.output.suffix.lower()
    if suffix not in (".xml", *TEXT_SUFFIXES, *HDF5_SUFFIXES):
        raise OutputError(f"Cannot write {arguments.output}: its name must end in .xml or .tfm. Choose another.")
    if suffix == ".xml" and len(arguments.config or []) != 1:
        raise SettingsError("A configuration is written from the one that is given. Give it with --config, or write a .tfm.")

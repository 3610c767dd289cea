"""`aifrecon calibrate`: a calibration from the scan itself or from a phantom, checked and written where it is used."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from ..calibration.check import check_calibration
from ..errors import OutputError, SettingsError
from ..io.transform.files import HDF5_SUFFIXES, TEXT_SUFFIXES
from ..progress import part
from ..terminal.arguments import Names, Output, Rivals
from ..terminal.console import ProgressBar
from ..terminal.labels_options import labels_from, names_labels, place_from
from ..terminal.outputs import tell, write_json
from ..terminal.sequence_options import SequencesOptions, sequences_from
from ..workflows.calibrate import calibration_of, calibration_on_wires


class _CalibrateOptions(SequencesOptions):
    """Find image to probe, pixel size and delay with which the bone echoes of all angles lie on a CT's bone; without a CT, image to probe
    and delay with which they lie on one surface.

    Parameters
    ----------
    phantom : PLUS.xml
        the sweeps show the N-wire phantom that this configuration describes, and no bone; also the default of --config
    output : FILE
        where to write: the configuration (.xml), or a correction for aifrecon convert (.tfm)
    check
        only say what is probably wrong, if anything is
    bone_transform : START
        CT -> Reference to start from; default: look for it, unless it lies on the sweep
    report : FILE.json
        also write numbers, for the log book
    preview : FILE.png
        also draw the echoes before and after

    Examples
    --------
      aifrecon calibrate sweep.igs.mha --config PlusDeviceSet.xml --bone-labels lumbar.nrrd --check
      aifrecon calibrate sweep.igs.mha --config PlusDeviceSet.xml --bone-labels lumbar.nrrd --output Calibrated.xml --preview calibrated.png
      aifrecon calibrate wires.igs.mha --phantom PlusDeviceSet.xml --output Calibrated.xml

    Exit code 1: the sweep does not tell, and nothing is written but --report. The delay alone: aifrecon info.
    """

    phantom: Path | None = None
    output: Output
    check: bool = False
    bone_transform: Path | None = None
    report: Output | None = None
    preview: Output | None = None

    RIVALS: ClassVar[Rivals] = (("output", "check"),)
    FIRST: ClassVar[Names] = ("output", "check", "config", "bone_labels", "ct", "phantom", "preview", "quiet")


def run(asked: _CalibrateOptions) -> None:
    """Read, check or calibrate, write, and say how sure it is."""
    if asked.phantom and not asked.config:
        asked.config = [asked.phantom]
    _check_output(asked)
    with ProgressBar() as progress:
        start, labels = place_from(asked), labels_from(asked, part(progress, 0.0, 0.05))
        sequences = sequences_from(asked, asked.sequences)
        recipe, rest = asked.recipe, part(progress, 0.05, 0.95)
        if asked.check:
            first, *others = check_calibration(sequences, labels, start, recipe=recipe, progress=rest)
            tell(first, others)
            return
        if asked.phantom:
            done = calibration_on_wires(sequences, asked.phantom, asked.image_to_reference, rest)
        else:
            done = calibration_of(sequences, labels, start, recipe, asked.output.suffix.lower() == ".xml", rest)
        if asked.preview:
            done.draw(asked.preview)
    if done.found.accepted:
        done.write(asked.output, asked.config)
    write_json(asked.report, done.report)
    first, *others = done.lines
    tell(first, others, [asked.preview, asked.output if done.found.accepted else None, asked.report])
    done.require_accepted()


def _check_output(asked: _CalibrateOptions) -> None:
    """Return if the output can hold a calibration; asked before the long work."""
    if asked.phantom and (asked.check or asked.bone_transform or names_labels(asked) or asked.output.suffix.lower() != ".xml"):
        raise SettingsError("With --phantom a calibration is found from wires alone. Give --output FILE.xml, and no --check, CT or labels.")
    if not asked.output:
        return
    suffix = asked.output.suffix.lower()
    if suffix not in (".xml", *TEXT_SUFFIXES, *HDF5_SUFFIXES):
        raise OutputError(f"Cannot write {asked.output}: its name must end in .xml or .tfm. Choose another.")
    if suffix == ".xml" and len(asked.config) != 1:
        raise SettingsError("A configuration is written from the one that is given. Give it with --config, or write a .tfm.")

"""The library's messages in the user's language and the panel's words: they name options, which a user of the panel has never seen."""

import contextlib
import re

from slicer.i18n import tr as _
from slicer.i18n import translate

from AIFReconLib.errors import AIFReconError, OperationCanceled
from AIFReconLib.message import Message, said, translated

LIBRARY_CONTEXT = "AIFReconLib"
"""Where translations of the library's sentences are looked up; `make translations` lists them there."""

_SENTENCES = {
    "{sequence}: no frame falls into the volume ({reasons}). "
    "Check its box (--grid-like, or the configuration's OutputOrigin and OutputExtent) and --reference.": lambda: _(
        "{sequence}: no frame falls into the volume ({reasons}). Check the region, and the transforms of the sweep."
    ),
    "The recording has no transforms at all: was a tracker connected? "
    "Slicer saves transforms as sequences of their own; give them with --transform-sequence NAME=FILE.": lambda: _(
        "The recording has no transforms at all: was a tracker connected? "
        "Slicer saves transforms as sequences of their own: load them too, and put the images under them."
    ),
    "Choose another frame to reconstruct in with --reference, one of: {frames}.": lambda: _(
        "Its transforms lead to {frames}: put the one that leads farthest under a transform to the world, named for both."
    ),
    "{sequence}: {paths}. They differ by {gap:.3g} mm in frame {number}. "
    "Say which one is right, as in --image-to-reference {chain}.": lambda: _(
        "{sequence}: {paths}. They differ by {gap:.3g} mm in frame {number}. Remove one of their transforms."
    ),
    "{key} must be positive; got {text!r}. The file holds no image: record or export it again, or, "
    "if it is Slicer's sequence of a transform, give it with the images as --transform-sequence NAME=FILE.": lambda: _(
        "{key} must be positive; got {text!r}. The file holds no image: record or export it again, or, "
        "if it is Slicer's sequence of a transform, load it with Slicer's own Add Data."
    ),
    "UltrasoundImageOrientation must be MF, MN, UF or UN; got {code!r}: whoever wrote the file did not know it. "
    "Look which side of the images is marked and say it with aifrecon convert --orientation: a wrong code mirrors the anatomy.": lambda: _(
        "UltrasoundImageOrientation must be MF, MN, UF or UN; got {code!r}: whoever wrote the file did not know it. "
        "Look which side of the images is marked and choose it as “Stored pixels”: a wrong code mirrors the anatomy."
    ),
    "{path}: its suffix must be one of {suffixes}. Give a MetaImage or NRRD file; aifrecon import makes one of pictures, DICOM "
    "or video.": lambda: _(
        "{path}: its suffix must be one of {suffixes}. Choose a MetaImage or NRRD file; the command line makes one of pictures, "
        "DICOM or video."
    ),
    "WARNING: {warning} See aifrecon register.": lambda: _("Warning: {warning} Place the CT on the sweep."),
    "{sentence} {warning} Start nearer with --bone-transform, give --per-segment if the spine has bent, or take it as it is "
    "with --accept.": lambda: _(
        "{sentence} {warning} Move the CT nearer, by hand or by landmarks, and try again; or take one of the places below as it is."
    ),
    "Only {best:.0%} of all echoes agree in the place that fits most closely, and {most:.0%} in one that fits too roughly. "
    "Check that CT and sweep are of one patient, start nearer with --bone-transform, or take it as it is with --accept.": lambda: _(
        "No place fits well: {best:.0%} of all echoes agree in the place that fits most closely, and {most:.0%} in one that fits too "
        "roughly. Check that CT and sweep are of one patient, and move the CT nearer; or take one of the places below."
    ),
    "The CT fits nearly as well {where}: {other:.0%} of all echoes agree there, {best:.0%} here. "
    "Compare the alternatives in --report, then choose one with --level N, or take the best with --accept.": lambda: _(
        "The place of the CT is not sure. It fits nearly as well {where}: {other:.0%} of all echoes agree there, {best:.0%} in the best "
        "place. Choose one of the places below, press “Move CT there”, and compare."
    ),
    "{path}: labels must be whole numbers; got fractions or NaN. If these are bone probabilities, give them as "
    "--bone-probability.": lambda: _(
        "{path}: labels must be whole numbers; got fractions or NaN. If these are bone probabilities, choose them as a scalar volume."
    ),
    "{name}: predictions of {got} pixels do not fit frames of {frames}. "
    "Say with --bone-frames-px X Y W H which rectangle of the frame they cover.": lambda: _(
        "{name}: predictions of {got} pixels do not fit frames of {frames}. Select what the AI model has said of this sweep, in its size."
    ),
    "Give the calibration (for example {name}) with --config PlusDeviceSet.xml.": lambda: _(
        "The calibration of the probe (for example {name}) is missing: open the recording again, together with its Plus configuration "
        "(.xml)."
    ),
    "Give the missing link with --config PlusDeviceSet.xml.": lambda: _(
        "A link is missing: open the recording again, together with its Plus configuration (.xml)."
    ),
    "Warning: the bone map does not overlap the volume, so incidence weights nothing. "
    "Check the registration of the CT (--bone-transform).": lambda: _(
        "Warning: the CT's bone does not lie where the sweep is, so nothing is enhanced. Place the CT on the sweep."
    ),
    "No pass of this probe would show more of {target}. Check that --bone-transform places the labels where the patient was.": lambda: _(
        "No pass of this probe would show more of {target}. Check that the CT is placed on the sweep."
    ),
    "{sweeps}: {count} bone echoes, bright with darkness behind them, are too few to place a CT by; {fewest} are needed. "
    "Check that the sweep shows bone, and --probe and --clip-px.": lambda: _(
        "{sweeps}: {count} bone echoes, bright with darkness behind them, are too few to place the CT; {fewest} are needed. "
        "Choose a sweep that shows more bone, or check “Probe” and “Clip rectangle” (Settings, “Image and probe”)."
    ),
    "The directions of the beams are not known. Give --probe linear, or --probe sector with --apex-px COLUMN ROW.": lambda: _(
        "The directions of the beams are not known. In Settings, “Image and probe”, set “Probe” to “Linear”, or to “Sector, with this "
        "apex”."
    ),
    "The probe cannot be told from the images: {why}. Give --probe linear, or --probe sector with --apex-px COLUMN ROW; "
    "a configuration with ScanConversion serves too.": lambda: _(
        "The shape of the probe cannot be told from the images: {why}. In Settings, “Image and probe”, set “Probe” to “Linear”, or to "
        "“Sector, with this apex”."
    ),
    "Bone is looked for along the beams, whose directions are not known. "
    "Give --probe linear, or --probe sector with --apex-px COLUMN ROW.": lambda: _(
        "Bone is looked for along the beams, whose directions are not known. In Settings, “Image and probe”, set “Probe” to “Linear”, or "
        "to “Sector, with this apex”."
    ),
    "Method {method} needs the direction of the beams. Give --probe linear, or --probe sector with --apex-px COLUMN ROW.": lambda: _(
        "Method {method} needs the direction of the beams. In Settings, “Image and probe”, set “Probe” to “Linear”, or to “Sector, with "
        "this apex”."
    ),
    "A speed of sound needs the direction of the beams. Give --probe linear, or --probe sector with --apex-px COLUMN ROW.": lambda: _(
        "A speed of sound needs the direction of the beams. In Settings, “Image and probe”, set “Probe” to “Linear”, or to “Sector, with "
        "this apex”."
    ),
    "A linear probe has no apex. Give --probe sector with --apex-px COLUMN ROW.": lambda: _(
        "A linear probe has no apex. In Settings, “Image and probe”, set “Probe” to “Sector, with this apex”."
    ),
    "The configurations of {first} and {other} name different probes. Give --probe for all, or reconstruct them one by one.": lambda: _(
        "The configurations of {first} and {other} name different probes. Set “Probe” for all of them (Settings, “Image and probe”), or "
        "reconstruct them one by one."
    ),
    "A spacing of {spacing:g} mm would fit.": lambda: _("A “Voxel size” of {spacing:g} mm would fit (Settings)."),
    "No spacing would fit: free some memory.": lambda: _(
        "No voxel size would fit: close other programs, or choose a smaller box (Settings, “Where”)."
    ),
    "Input labels must have bone that a probe on the back can reach; got none. Was the right segmentation chosen?": lambda: _(
        "The chosen segmentation must have bone that a probe on the back can reach; it has none. Was the right one chosen?"
    ),
    "Input labels must have voxels above 0; got none. Was the right segmentation chosen?": lambda: _(
        "The chosen segmentation is empty. Was the right one chosen?"
    ),
    "Input labels must leave voxels that are not bone; got bone everywhere. Was the right segmentation chosen?": lambda: _(
        "The chosen segmentation is bone everywhere. Was the right one chosen?"
    ),
    "Input labels must have voxels above 0 and voxels of 0; got only one kind. Was the right segmentation chosen?": lambda: _(
        "The chosen segmentation is all bone, or has none. Was the right one chosen?"
    ),
    "The sweep spans {spans} mm, which no scan does. Are its poses in mm and in the right frame?": lambda: _(
        "The sweep spans {spans} mm, which no scan of a patient does. Check the tracking and the calibration of this recording."
    ),
    "Predictions must be one sequence for each sweep; got {predictions} for {sweeps}. "
    "Give --bone-frames once for each, in their order.": lambda: _(
        "The output of the AI model belongs to one sweep; got {predictions} for {sweeps}. Leave the others out."
    ),
}
"""What the panel says in the place of sentences whose advice is about files and options that it does not have; looked up when asked for,
for Slicer's `tr` reads files at every call."""


def inPanelWords(message, names: dict[int, str] | None = None) -> str:
    """A message of the library, translated, with every option that the panel has replaced by what it is called there.

    Parameters
    ----------
    message : Message, AIFReconError or str
        A plain str has lost what it was made of: it stays in English.
    names : dict of int to str or None
        What labels of bone are called, which the library knows by their numbers alone.
    """
    if names:
        message = _withNames(message, names)

    def sentence(template: str) -> str:
        own = _SENTENCES.get(template)
        return translate(LIBRARY_CONTEXT, template) if own is None else own()

    text = str(translated(message, sentence))

    def word(found) -> str:
        shown = _words().get(found["option"])
        return found[0] if shown is None else f"\N{LEFT DOUBLE QUOTATION MARK}{shown}\N{RIGHT DOUBLE QUOTATION MARK}"

    return re.sub(r"(?P<option>--[a-z][a-z-]*)(?: [A-Z][A-Z0-9]*\b)*", word, text)


def _withNames(value, names: dict[int, str]):
    """A message with the names of labels in the place of their numbers."""
    value = said(value) if isinstance(value, AIFReconError) else value
    if not isinstance(value, Message) or not value.values:
        return value
    if value.template == "label {label}":
        label = value.values["label"]
        return names.get(label, value) if isinstance(label, int) else value
    return type(value)(value.template, **{name: _withNames(each, names) for name, each in value.values.items()})


@contextlib.contextmanager
def errorsInPanelWords():
    """Errors of the library leave the block in the panel's words; a cancel as it is."""
    try:
        yield
    except OperationCanceled:
        raise
    except AIFReconError as error:
        raise type(error)(inPanelWords(error)) from error


def _words() -> dict:
    return {
        "--apex-px": _("Apex"),
        "--bone-from-sweep": _("The echoes themselves"),
        "--bone-labels": _("Bone of CT"),
        "--bone-probability": _("Bone of CT"),
        "--bone-transform": _("Place CT on sweep"),
        "--clip-px": _("Clip rectangle"),
        "--config": _("Calibration"),
        "--fan-angles-deg": _("Fan angles"),
        "--fan-radius-px": _("Fan radii"),
        "--grid-like": _("Where"),
        "--hole-limit": _("Fill gaps up to"),
        "--importance-mask": _("Pixel weights"),
        "--intensity-maximum": _("Brightest value"),
        "--longest-gap": _("Longest gap"),
        "--method": _("Method"),
        "--orientation": _("Stored pixels"),
        "--output-type": _("Voxel type"),
        "--probe": _("Probe"),
        "--skip": _("Every N-th frame"),
        "--spacing": _("Voxel size"),
        "--speed-of-sound": _("Speed of sound"),
        "--time-offset": _("Time offset"),
    }

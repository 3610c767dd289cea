"""What the panel says of each of the library's remedies, in the words on its controls."""

import functools
import re

from slicer.i18n import tr as _

from AIFReconLib.io.foreign.options import ASKED
from AIFReconLib.message import advised
from AIFReconLib.remedies import Remedy


def inPanelWords(sentence) -> str:
    """A sentence or an error of the library, and what to do about it in the panel."""
    return advised(sentence, remedies())


def withNames(text: str, names: dict[int, str]) -> str:
    """A text with the names of bones in the place of the numbers of their labels."""
    return re.sub(r"\blabel (\d+)\b", lambda found: names.get(int(found[1]), found[0]), text)


@functools.cache
def remedies() -> dict[Remedy, str]:
    """The words, made when first asked for: Slicer's `tr` reads files."""
    probe = _("In Settings, “Image and probe”, set “Probe” to “Linear”, or to “Sector, with this apex”.")
    commandLine = _("The command line can do this: aifrecon {command} --help.")
    converted = commandLine.replace("{command}", "convert")
    return {
        Remedy.NAME_THE_PROBE: probe,
        Remedy.ONE_PROBE_FOR_ALL: _("Set “Probe” for all of them (Settings, “Image and probe”), or reconstruct them one by one."),
        Remedy.ONE_CLIP_FOR_ALL: _("Set “Clip rectangle” for all of them (Settings, “Image and probe”), or reconstruct them one by one."),
        Remedy.CLIP_AS_RECOGNIZED: _("Recognized: {x}, {y}, {width}, {height}. Press “As recognized” (Settings, “Image and probe”)."),
        Remedy.WHOLE_FAN: _("Set both “Fan angles” and “Fan radii”."),
        Remedy.BONE_OF_CT: _("Choose the “Bone of CT”, or no bone."),
        Remedy.TAKE_AS_LABELS: _("Divide it by its largest possible value, or choose labels as “Bone of CT”."),
        Remedy.TAKE_AS_PROBABILITY: _("If these are bone probabilities, choose them as a scalar volume."),
        Remedy.TAKE_AS_CT: _("If this is a CT, press Bone from CT."),
        Remedy.HOUNSFIELD: _("Load the CT as the scanner's DICOM files have it."),
        Remedy.SAY_WHERE_BONE_IS: _("Choose who says where bone is, or another method."),
        Remedy.CHOOSE_LABELS: _("Choose the segments that are bone."),
        Remedy.MODEL_UNIT: _("Export the model in mm."),
        Remedy.PREDICTIONS_FOR_EACH: _("The output of the AI model belongs to one sweep: leave the others out."),
        Remedy.PREDICTED_RECTANGLE: _("Select what the AI model has said of this sweep, in its size."),
        Remedy.PLACE_THE_CT: _("Place the CT on the sweep."),
        Remedy.REGISTER: _("Place the CT on the sweep."),
        Remedy.START_NEARER: _("Check that CT and sweep are of one patient, and move the CT nearer; or take one of the places below."),
        Remedy.START_NEARER_OR_PIECES: _(
            "Move the CT nearer, by hand or by landmarks, and try again; or take one of the places below as it is."
        ),
        Remedy.CHOOSE_A_PLACE: _("The place is not sure: choose one of the places below, press “Move CT there”, and compare."),
        Remedy.CHECK_PROBE_AND_CLIP: _(
            "Choose a sweep that shows more bone, or check “Probe” and “Clip rectangle” (Settings, “Image and probe”)."
        ),
        Remedy.CALIBRATE: _("Press “Calibrate on this sweep”; aifrecon calibrate --help says more."),
        Remedy.CHECK_CALIBRATION: _("Check that both are of one bone, and place the CT on the sweep first."),
        Remedy.STEP: _("Add {offset} s to “Time offset” (Settings, “Reading a recording”), and load the recording again."),
        Remedy.MIRROR: _("The images are to be turned left to right."),
        Remedy.SCALE: _("The size of a pixel is to be multiplied by {across} across and {along} along."),
        Remedy.AIM_AT_A_POINT: _("Choose “a point” as “Target”, and place it."),
        Remedy.INVERT: _("The inverse of {name} is to be taken."),
        Remedy.BRIGHTEST_VALUE: _("Set “Brightest value” (Settings)."),
        Remedy.FLOAT_OUTPUT: _("Set “Stored as” to float32 (Settings)."),
        Remedy.HOLE_LIMIT: _("Set “Fill gaps up to” (Settings)."),
        Remedy.IMPORT_THE_METHOD: _("Choose another “Method”."),
        Remedy.SMALLER_SKIP: _("Use a smaller “Every N-th frame” (Settings)."),
        Remedy.CHECK_THE_BOX: _("Check the region, and the transforms of the sweep."),
        Remedy.COARSER: _("A “Voxel size” of {spacing:g} mm would fit (Settings)."),
        Remedy.FREE_MEMORY: _("No voxel size would fit: close other programs, or choose a smaller box (Settings, “Where”)."),
        Remedy.TRANSFORM_SEQUENCES: _("Slicer saves transforms as sequences of their own: load them too, and put the images under them."),
        Remedy.CALIBRATION: _(
            "The calibration of the probe (for example {example}) is missing: open the recording again, together with its Plus "
            "configuration (.xml)."
        ),
        Remedy.MISSING_LINK: _("Open the recording again, together with its Plus configuration (.xml)."),
        Remedy.OTHER_REFERENCE: _(
            "Its transforms lead to {frames}: put the one that leads farthest under a transform to the world, named for both."
        ),
        Remedy.WHICH_CHAIN: _("Remove one of their transforms."),
        Remedy.ORIENTATION: _(
            "Look which side of the images is marked and choose it as “Stored pixels”: a wrong code mirrors the anatomy."
        ),
        Remedy.IMPORT_IT: _("Choose a MetaImage or NRRD file, or press “Import...”."),
        Remedy.OPEN_IT: _("It is read as it is: choose it as the recording."),
        **dict.fromkeys((Remedy.CALIBRATION_FILE, Remedy.WRONG_CALIBRATION), converted),
        Remedy.REPLAY_RATE: commandLine.replace("{command}", "replay"),
        **dict.fromkeys(ASKED, _("Answer the question below, and press “Check”.")),
        **dict.fromkeys((Remedy.NO_PIXEL_SIZE, Remedy.NO_TOOL, Remedy.NO_MARKER), _("Leave it open below, and press “Check”.")),
        **dict.fromkeys(
            (Remedy.UNITS, Remedy.CALIBRATION_UNIT, Remedy.SURE),
            _("If it is another unit, or right as it is, say so below, and press “Check”."),
        ),
        Remedy.NO_CALIBRATION: _("Leave “Calibration” empty."),
        Remedy.NAME_THE_CALIBRATION: _("Choose another “Calibration”."),
        Remedy.WHERE_THE_IMAGE_LIES: _("Choose the “Calibration”; or answer below, if the axes of the image are those of {frame}."),
        Remedy.TIME_OFFSET: _("If the images began later than the poses, say below by how much."),
        Remedy.IMAGE_RATE: _("If images were taken at a steady rate, say it below, and press “Check”."),
        Remedy.NO_TIME_OFFSET: _("Set “Time offset” to 0, or record the sweep with time stamps."),
    }

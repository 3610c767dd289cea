"""What the terminal says of each remedy, in options of the command line."""

from __future__ import annotations

import re

from ..message import advised
from ..remedies import Remedy

IN_OPTIONS = {
    Remedy.NAME_THE_PROBE: "Give --probe linear, or --probe sector with --apex-px COLUMN ROW.",
    Remedy.ONE_PROBE_FOR_ALL: "Give --probe for all, or reconstruct them one by one.",
    Remedy.ONE_CLIP_FOR_ALL: "Give --clip-px X Y W H for all, or reconstruct them one by one.",
    Remedy.CLIP_AS_RECOGNIZED: "Recognized: --clip-px {x} {y} {width} {height}.",
    Remedy.WHOLE_FAN: "Give both --fan-angles-deg A B and --fan-radius-px R0 R1.",
    Remedy.BONE_OF_CT: "Give --bone-labels, or no bone.",
    Remedy.TAKE_AS_LABELS: "Divide it by its largest possible value, or give labels with --bone-labels.",
    Remedy.TAKE_AS_PROBABILITY: "If these are bone probabilities, give them as --bone-probability.",
    Remedy.TAKE_AS_CT: "If this is a CT, give it as --ct.",
    Remedy.HOUNSFIELD: "Give the CT as the scanner's DICOM files have it.",
    Remedy.SAY_WHERE_BONE_IS: "Give --bone-labels or --ct, or --bone-from-sweep for what the echoes show, or choose --method average.",
    Remedy.CHOOSE_LABELS: "Say which labels are bone with --labels.",
    Remedy.MODEL_UNIT: "Say with --bone-unit what it is in: mm, cm, m or in.",
    Remedy.PREDICTIONS_FOR_EACH: "Give --bone-frames once for each, in their order.",
    Remedy.PREDICTED_RECTANGLE: "Say with --bone-frames-px X Y W H which rectangle of the frame they cover.",
    Remedy.PLACE_THE_CT: "Check the registration of the CT (--bone-transform).",
    Remedy.REGISTER: "See aifrecon register.",
    Remedy.START_NEARER: (
        "Check that CT and sweep are of one patient, start nearer with --bone-transform, or take it as it is with --accept."
    ),
    Remedy.START_NEARER_OR_PIECES: (
        "Start nearer with --bone-transform, give --per-segment if the spine has bent, or take it as it is with --accept."
    ),
    Remedy.CHOOSE_A_PLACE: ("Compare the alternatives in --report, then choose one with --level N, or take the best with --accept."),
    Remedy.CHECK_PROBE_AND_CLIP: "Check that the sweep shows bone, and --probe and --clip-px.",
    Remedy.CALIBRATE: "See aifrecon calibrate, or repeat the calibration.",
    Remedy.CHECK_CALIBRATION: "Check that both are of one bone; aifrecon calibrate --check looks for mirrored images and the like.",
    Remedy.STEP: "Mend recordings with aifrecon convert --time-offset {offset}.",
    Remedy.MIRROR: "Mend recordings with aifrecon convert --mirror.",
    Remedy.SCALE: "Mend recordings with aifrecon convert --scale {across} {along}.",
    Remedy.AIM_AT_A_POINT: "Give --target as a point X Y Z.",
    Remedy.INVERT: "Mend recordings with aifrecon convert --invert {name}.",
    Remedy.BRIGHTEST_VALUE: "Give their brightest value with --intensity-maximum.",
    Remedy.FLOAT_OUTPUT: "Use --output-type float32.",
    Remedy.HOLE_LIMIT: "Give --hole-limit MM.",
    Remedy.IMPORT_THE_METHOD: "Name it with --method, or choose one of {methods}.",
    Remedy.SMALLER_SKIP: "Use a smaller --skip.",
    Remedy.CHECK_THE_BOX: "Check its box (--grid-like, or the configuration's OutputOrigin and OutputExtent) and --reference.",
    Remedy.COARSER: "A spacing of {spacing:g} mm would fit.",
    Remedy.FREE_MEMORY: "No spacing would fit: free some memory.",
    Remedy.TRANSFORM_SEQUENCES: ("Slicer saves transforms as sequences of their own; give them with --transform-sequence NAME=FILE."),
    Remedy.CALIBRATION: "Give the calibration (for example {example}) with --config PlusDeviceSet.xml.",
    Remedy.MISSING_LINK: "Give the missing link with --config PlusDeviceSet.xml.",
    Remedy.OTHER_REFERENCE: "Choose another frame to reconstruct in with --reference, one of: {frames}.",
    Remedy.WHICH_CHAIN: "Say which one is right, as in --image-to-reference {chain}.",
    Remedy.ORIENTATION: (
        "Look which side of the images is marked and say it with aifrecon convert --orientation: a wrong code mirrors the anatomy."
    ),
    Remedy.NO_TIME_OFFSET: "Leave out --time-offset, or record the sweep with time stamps.",
    Remedy.IMPORT_IT: "Give a MetaImage or NRRD file; aifrecon import makes one of pictures, DICOM or video.",
    Remedy.OPEN_IT: "It is read as it is: give it to aifrecon info or aifrecon reconstruct.",
    Remedy.CALIBRATION_FILE: "Give it with --config PlusDeviceSet.xml or --calibration FILE.",
    Remedy.WRONG_CALIBRATION: "Give that too, with --wrong-calibration FILE.",
    Remedy.REPLAY_RATE: "Give the rate to replay it at (--rate).",
    Remedy.NAME_THE_CALIBRATION: "Name it, as in --calibration {example}=FILE.",
    Remedy.NO_CALIBRATION: "Leave out --calibration.",
    Remedy.PIXEL_SIZE: "Give --spacing X Y in mm.",
    Remedy.CALIBRATION_UNIT: "If the calibration is in another unit, give --calibration-unit, as m; if it is right, --sure.",
    Remedy.NO_PIXEL_SIZE: "Leave out --spacing and --image-origin-px{or_calibration}.",
    Remedy.WHERE_THE_IMAGE_LIES: (
        "Give --calibration FILE; or both --spacing and --image-origin-px, if the axes of the image are those of {frame}."
    ),
    Remedy.NAME_THE_COLUMNS: 'Name the columns, as in --columns "time x y z qx qy qz qw", - for those that are not used.',
    Remedy.NO_IMAGE_COLUMN: "Leave out that column (--columns, with -).",
    Remedy.QUATERNION_ORDER: "Give --quaternion-order xyzw or wxyz.",
    Remedy.EULER_ORDER: (
        "Give --euler-order with the axes in the order in which the turns are applied: "
        "xyz about fixed axes, ZYX about the axes that turn along; or vector, for a rotation vector (axis times angle), "
        "as robots of UR and Vicon write."
    ),
    Remedy.COLUMN_MAJOR: "Where matrices are written column by column, give --column-major.",
    Remedy.UNITS: "If they are in {unit}, give --units{choice}.",
    Remedy.ANGLE_UNIT: "Give --angle-unit deg or rad.",
    Remedy.TIME_UNIT: "Give --time-unit, for example {unit}.",
    Remedy.WHICH_TOOL: 'Give the one that holds the image, for example --tool "{tool}".',
    Remedy.NO_TOOL: "Leave out --tool.",
    Remedy.GOOD_STATUS: 'Give the words that mean a valid pose, for example --status-ok "{word}".',
    Remedy.ROWS_OR_COLUMNS: "Give --column-major or --no-column-major.",
    Remedy.TIME_OFFSET: "If the images began S seconds after the poses, give --time-offset S.",
    Remedy.IMAGE_RATE: "If images were taken at a steady rate, give --rate HZ.",
    Remedy.NO_MARKER: "Leave out --reference-tool.",
    Remedy.SURE: "If it is right as it is, give --sure.",
}
"""A command's options, as they are typed."""


def in_options(sentence: object) -> str:
    """A sentence or an error, and what to do about it, for the terminal."""
    return advised(sentence, IN_OPTIONS)


def in_columns(sentence: object) -> str:
    """The same for who fills in the table of a batch, whose columns are named as the options."""
    command, option = r"(?P<command>pip install .*|aifrecon [a-z][^.,;]*)", r"(?<![\w-])--(?P<option>[a-z][a-z-]*)"
    return re.sub(f"{command}|{option}", lambda found: found["command"] or found["option"].replace("-", "_"), in_options(sentence))

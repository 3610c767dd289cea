"""What can be done about what is wrong, by name: the library names a remedy, each door says it in its own words.

The words for the terminal are in `terminal/remedies.py`, those of the panel in the module's `AIFReconScene/panelWords.py`.
"""

from __future__ import annotations

from enum import Enum, auto


class Remedy(Enum):
    """What to do. Names in braces in a door's words are details that come with the sentence."""

    NAME_THE_PROBE = auto()
    ONE_PROBE_FOR_ALL = auto()
    ONE_CLIP_FOR_ALL = auto()
    CLIP_AS_RECOGNIZED = auto()
    WHOLE_FAN = auto()

    BONE_OF_CT = auto()
    SAY_WHERE_BONE_IS = auto()
    TAKE_AS_LABELS = auto()
    TAKE_AS_PROBABILITY = auto()
    TAKE_AS_CT = auto()
    HOUNSFIELD = auto()
    CHOOSE_LABELS = auto()
    MODEL_UNIT = auto()
    PREDICTIONS_FOR_EACH = auto()
    PREDICTED_RECTANGLE = auto()
    PLACE_THE_CT = auto()
    REGISTER = auto()
    START_NEARER = auto()
    START_NEARER_OR_PIECES = auto()
    CHOOSE_A_PLACE = auto()
    CHECK_PROBE_AND_CLIP = auto()
    CALIBRATE = auto()
    CHECK_CALIBRATION = auto()
    STEP = auto()
    MIRROR = auto()
    INVERT = auto()
    SCALE = auto()
    AIM_AT_A_POINT = auto()

    BRIGHTEST_VALUE = auto()
    FLOAT_OUTPUT = auto()
    HOLE_LIMIT = auto()
    IMPORT_THE_METHOD = auto()
    SMALLER_SKIP = auto()
    CHECK_THE_BOX = auto()
    COARSER = auto()
    FREE_MEMORY = auto()

    TRANSFORM_SEQUENCES = auto()
    CALIBRATION = auto()
    MISSING_LINK = auto()
    OTHER_REFERENCE = auto()
    WHICH_CHAIN = auto()
    ORIENTATION = auto()
    NO_TIME_OFFSET = auto()
    IMPORT_IT = auto()
    OPEN_IT = auto()

    CALIBRATION_FILE = auto()
    WRONG_CALIBRATION = auto()
    REPLAY_RATE = auto()
    NAME_THE_CALIBRATION = auto()
    NO_CALIBRATION = auto()
    PIXEL_SIZE = auto()
    NO_PIXEL_SIZE = auto()
    CALIBRATION_UNIT = auto()
    WHERE_THE_IMAGE_LIES = auto()
    NAME_THE_COLUMNS = auto()
    NO_IMAGE_COLUMN = auto()
    QUATERNION_ORDER = auto()
    EULER_ORDER = auto()
    COLUMN_MAJOR = auto()
    UNITS = auto()
    ANGLE_UNIT = auto()
    TIME_UNIT = auto()
    WHICH_TOOL = auto()
    NO_TOOL = auto()
    GOOD_STATUS = auto()
    ROWS_OR_COLUMNS = auto()
    TIME_OFFSET = auto()
    IMAGE_RATE = auto()
    NO_MARKER = auto()
    SURE = auto()


IN_PYTHON = {
    Remedy.NAME_THE_PROBE: (
        'Give probe="linear", or probe="sector" with apex_px=(column, row), in the recipe; or a ProbeGeometry to a Reconstructor.'
    ),
    Remedy.ONE_PROBE_FOR_ALL: "Give probe for all, or reconstruct them one by one.",
    Remedy.ONE_CLIP_FOR_ALL: "Give clip_px=(x, y, width, height) for all, or reconstruct them one by one.",
    Remedy.CLIP_AS_RECOGNIZED: "Recognized: clip_px=({x}, {y}, {width}, {height}).",
    Remedy.WHOLE_FAN: "Give both fan_angles_deg and fan_radius_px.",
    Remedy.BONE_OF_CT: "Give bone=BoneMap.from_labels(...), or no bone.",
    Remedy.TAKE_AS_LABELS: "Divide it by its largest possible value, or give labels to BoneMap.from_labels.",
    Remedy.TAKE_AS_PROBABILITY: "If these are bone probabilities, give them to BoneMap.from_probability.",
    Remedy.TAKE_AS_CT: "If this is a CT, give it to labels_from_ct.",
    Remedy.HOUNSFIELD: "Give the CT as the scanner's DICOM files have it, or say which values are bone with labels_from_ct(ct, above=...).",
    Remedy.SAY_WHERE_BONE_IS: 'Give bone, or bone_from_sweep=True for what the echoes show, or choose method="average".',
    Remedy.CHOOSE_LABELS: "Say which labels are bone with read_labels(path, labels=...).",
    Remedy.MODEL_UNIT: 'Say what it is in: unit="mm", "cm", "m" or "in".',
    Remedy.PREDICTIONS_FOR_EACH: "Give one for each, in their order.",
    Remedy.PREDICTED_RECTANGLE: "Say with rectangle=(x, y, width, height) which rectangle of the frame they cover.",
    Remedy.PLACE_THE_CT: "Check the transform of the CT.",
    Remedy.REGISTER: "See register.",
    Remedy.START_NEARER: "Check that CT and sweep are of one patient, give a start nearer to it, or use its transform as it is.",
    Remedy.START_NEARER_OR_PIECES: "Give a start nearer to it, one for each piece if the spine has bent, or use its transform as it is.",
    Remedy.CHOOSE_A_PLACE: "Compare the alternatives, then choose one by level, or use its transform.",
    Remedy.CHECK_PROBE_AND_CLIP: "Check that the sweep shows bone, and probe and clip_px.",
    Remedy.CALIBRATE: "See calibrate, or repeat the calibration.",
    Remedy.CHECK_CALIBRATION: "Check that both are of one bone; check_calibration looks for mirrored images and the like.",
    Remedy.STEP: "Mend recordings with with_time_offset(sequence, {offset}).",
    Remedy.MIRROR: "Turn the images with sweep.edits.mirrored(sequence), or read it with the right orientation=.",
    Remedy.SCALE: "Mend recordings with sweep.edits.corrected(sequence, D), D diagonal: {across}, {along}, 1, 1.",
    Remedy.AIM_AT_A_POINT: "Give the target as a point X Y Z.",
    Remedy.INVERT: "Mend recordings with sweep.edits.inverted(sequence, {name}).",
    Remedy.BRIGHTEST_VALUE: "Give their brightest value as intensity_maximum.",
    Remedy.FLOAT_OUTPUT: 'Use output_type="float32".',
    Remedy.HOLE_LIMIT: "Give hole_limit in mm.",
    Remedy.IMPORT_THE_METHOD: "Import {module} first, or choose one of {methods}.",
    Remedy.SMALLER_SKIP: "Use a smaller skip.",
    Remedy.CHECK_THE_BOX: "Check its box (grid, or the configuration's OutputOrigin and OutputExtent) and reference.",
    Remedy.COARSER: "A spacing of {spacing:g} mm would fit.",
    Remedy.FREE_MEMORY: "No spacing would fit: free some memory.",
    Remedy.TRANSFORM_SEQUENCES: (
        "Slicer saves transforms as sequences of their own: read_sequence(path, transform_sequences={{name: file}})."
    ),
    Remedy.CALIBRATION: 'Give the calibration (for example {example}): read_sequence(path, config="PlusDeviceSet.xml").',
    Remedy.MISSING_LINK: 'Give the missing link: read_sequence(path, config="PlusDeviceSet.xml").',
    Remedy.OTHER_REFERENCE: "Choose another frame to reconstruct in as reference, one of: {frames}.",
    Remedy.WHICH_CHAIN: 'Say which one is right, as in image_to_reference="{chain}".',
    Remedy.ORIENTATION: "Look which side of the images is marked and say it as orientation: a wrong code mirrors the anatomy.",
    Remedy.NO_TIME_OFFSET: "Leave out time_offset, or record the sweep with time stamps.",
    Remedy.IMPORT_IT: "Give a MetaImage or NRRD file; import_sequence makes one of pictures, DICOM or video.",
    Remedy.OPEN_IT: "It is read as it is: read_sequence(path).",
    Remedy.CALIBRATION_FILE: 'Give it with read_sequence(path, config="PlusDeviceSet.xml"), or as calibration.',
    Remedy.WRONG_CALIBRATION: "Give that too, as wrong.",
    Remedy.REPLAY_RATE: "Give the rate to replay it at.",
    Remedy.NAME_THE_CALIBRATION: "Name it, for example {example}.",
    Remedy.NO_CALIBRATION: "Leave out the calibration.",
    Remedy.PIXEL_SIZE: "Give spacing in mm, (x, y).",
    Remedy.NO_PIXEL_SIZE: "Leave out spacing and origin_px{or_calibration}.",
    Remedy.CALIBRATION_UNIT: "If the calibration is in another unit, give calibration_unit, as m; if it is right, sure=True.",
    Remedy.WHERE_THE_IMAGE_LIES: ("Give a calibration; or both spacing and origin_px, if the axes of the image are those of {frame}."),
    Remedy.NAME_THE_COLUMNS: 'Name the columns, as in columns="time x y z qx qy qz qw", - for those that are not used.',
    Remedy.NO_IMAGE_COLUMN: "Leave out that column (columns, with -).",
    Remedy.QUATERNION_ORDER: "Give quaternion_order, xyzw or wxyz.",
    Remedy.EULER_ORDER: (
        "Give euler_order with the axes in the order in which the turns are applied: xyz about fixed axes, ZYX about axes that turn along; "
        "or vector, for a rotation vector (axis times angle), as robots of UR and Vicon write."
    ),
    Remedy.COLUMN_MAJOR: "Where matrices are written column by column, give column_major=True.",
    Remedy.UNITS: "If they are in {unit}, give units{choice}.",
    Remedy.ANGLE_UNIT: "Give angle_unit, deg or rad.",
    Remedy.TIME_UNIT: 'Give time_unit, as in time_unit="{unit}".',
    Remedy.WHICH_TOOL: 'Give the one that holds the image, as in tool="{tool}".',
    Remedy.NO_TOOL: "Leave out tool.",
    Remedy.GOOD_STATUS: 'Give the words that mean a valid pose, as in good_statuses=("{word}",).',
    Remedy.ROWS_OR_COLUMNS: "Give column_major, True or False.",
    Remedy.TIME_OFFSET: "If the images began S seconds after the poses, give time_offset=S.",
    Remedy.IMAGE_RATE: "If images were taken at a steady rate, give rate, in Hz.",
    Remedy.NO_MARKER: "Leave it out.",
    Remedy.SURE: "If it is right as it is, give sure=True.",
}
"""What to do for who calls the library from Python."""

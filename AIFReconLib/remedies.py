"""Advice that several places give, as `Sentence` takes it: names of settings in braces, which each door writes in its own way."""

from __future__ import annotations

NAME_THE_PROBE = "Give {probe:linear}, or {probe:sector} with {apex_px:COLUMN ROW}."
CHECK_PROBE_AND_CLIP = "Check that the sweep shows bone, and {probe} and {clip_px}."

CHOOSE_LABELS = "Say with {labels} which labels are bone."
TAKE_AS_PROBABILITY = "If these are bone probabilities, give them as {bone_probability}."
TAKE_AS_CT = "If this is a CT, give it as {ct}."

PLACE_THE_CT = "Find the place of the CT with {register}."
START_NEARER = "Check that CT and sweep are of one patient, start nearer with {bone_transform}, or take it as it is with {accept}."

CALIBRATE_NOW = "Write a better one with {calibrate} on this sweep, and give that as {config:Calibrated.xml} from then on."
CALIBRATE = "See {calibrate}, or repeat the calibration."
CHECK_IN_PLACE = "See {calibrate}, which tells of a delay and of a wrong axis, too; {motion:auto} takes the patient's motion out."
SCAN_AGAIN = (
    "Check first that the poses are of the tool on the probe, that images and poses are in step ({time_offset}), and that a pixel has its "
    "true size (the depth). If so, scan the same bone from more angles."
)
MISSING_LINK = "Give the missing link with {config:PlusDeviceSet.xml}."
CALIBRATION_FILE = "Give it with {config:PlusDeviceSet.xml} or {calibration:FILE}."
NAME_THE_CALIBRATION = "Name it, as in {calibration:{example}=FILE}."
ADD_TIME_OFFSET = "Add {offset} s to {time_offset}, or mend recordings with {convert}; {time_offset:auto} finds and applies it in one run."

TRANSFORM_SEQUENCES = "Slicer saves transforms as sequences of their own: give them too ({transform_sequence:NAME=FILE})."
IMPORT_IT = "Give a MetaImage or NRRD file; {import} makes one of pictures, DICOM or video."

NAME_THE_COLUMNS = 'Name the columns, as in {columns:"time x y z qx qy qz qw"}, - for those that are not used.'
WHICH_TOOL = 'Give the one that holds the image, as in {tool:"{first}"}, and a marker on the patient with {reference_tool}.'
WHICH_MARKER = "If a tool of these is a marker on the patient, give it with {reference_tool}."
ANGLE_UNIT = "Give {angle_unit}: deg or rad."
TIME_UNIT = "Give {time_unit}, for example {unit}."
UNITS = "If they are in {unit}, give {units:{choice}}; if they are right, {sure}."
TIME_OFFSET = "If the images began 2 s after the poses, give {time_offset:2}; if 2 s before, -2; if they have another rate, {rate:HZ}."
SAME_MOVEMENT = "If that is one movement, give {time_offset:{offset}}; look at both, for it is right to a frame or two at best."
PIXEL_SIZE = "Give {spacing:X Y} in mm."
NO_PIXEL_SIZE = "Leave out {spacing} and {image_origin_px}{or_calibration}."
CALIBRATION_UNIT = "If the calibration is in another unit, give {calibration_unit}, as m; if it is right, {sure}."
SURE = "Is it another {tool}, or are {units} or {time_unit} others? If it is right as it is, give {sure}."

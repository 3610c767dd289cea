"""`aifrecon import`: images and poses from anywhere become a tracked sequence."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import AIFReconError, BeamGeometryError
from ..geometry.mechanism import Mechanism
from ..geometry.transform_graph import TransformName
from ..geometry.transforms import pixel_spacing
from ..imaging.detection import detect_imaging
from ..inspection.offset_estimate import estimate_time_offset
from ..inspection.sweep_drawing import draw_sweep
from ..inspection.tracking_report import tracking_report
from ..io.disk.atomic import check_writable, write_text
from ..io.foreign.calibration import read_calibration
from ..io.foreign.importing import IMAGE_FRAME, REFERENCE_FRAME, ImportSettings, import_sequence
from ..io.foreign.mechanisms import read_joint_poses, read_mechanism
from ..io.foreign.openers import open_images
from ..io.foreign.poses.files import read_poses
from ..io.foreign.poses.headings import ANGLES, LENGTHS, TIMES
from ..io.foreign.poses.rotations import QUATERNION_ORDERS, PoseFormat
from ..io.sequence.writer import SUFFIXES, check_sequence_name, write_sequence
from ..sweep.frames import TrackedSequence
from ..sweep.poses import SweepPoses, sweep_poses
from ..terminal.console import ProgressBar, program
from ..terminal.options import Commands, refuse_to_overwrite
from ..terminal.remedies import in_options

EXAMPLE = """examples:
  aifrecon import frames/ --poses poses.csv --transform ImageToTracker --spacing 0.1 0.1 --output sweep.igs.mha
  aifrecon import sweep.mp4 --poses tracker.txt --columns "time x y z qx qy qz qw" --units m \\
      --transform ProbeToTracker --calibration ImageToProbe.tfm --output sweep.igs.mha
  aifrecon import images.npy --poses poses.json --transform TrackerToImage --spacing 0.2 0.2 --rate 20 --output sweep.nrrd"""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "import",
        help="make a sequence from images and a file of poses",
        description="Write a tracked sequence from images (PNG, JPEG, TIFF, BMP, DICOM, video, .npy) and poses (CSV, TXT, JSON).\n"
        "Prints how everything was understood, and draws the sweep for a check.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("images", type=Path, nargs="+", metavar="IMAGES", help="files or a folder, in natural order (2 before 10)")
    parser.add_argument("--poses", type=Path, required=True, metavar="FILE", help="one pose per image, or with times or names of images")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="SEQUENCE", help=f"where to write ({', '.join(SUFFIXES)})")
    parser.add_argument(
        "--transform",
        required=True,
        metavar="NAME",
        help="what the poses are, direction included: ImageToTracker, ProbeToTracker, or an inverse such as TrackerToProbe",
    )
    meaning = parser.add_argument_group("poses")
    meaning.add_argument(
        "--columns", metavar="WORDS", help='names of the columns, e.g. "time x y z qw qx qy qz"; - for one that is not used'
    )
    meaning.add_argument("--tool", metavar="NAME", help="the one whose poses are taken, where the file holds several: its name or place")
    meaning.add_argument(
        "--reference-tool", metavar="NAME", help="the marker on the patient, in the same file: it becomes the frame Reference"
    )
    meaning.add_argument("--time-offset", type=float, default=0.0, metavar="S", help="how many seconds after the poses the images began")
    meaning.add_argument("--quaternion-order", choices=QUATERNION_ORDERS, help="of a quaternion whose numbers have no names")
    meaning.add_argument(
        "--euler-order",
        metavar="AXES",
        help="order of the turns: xyz about fixed axes, ZYX about axes that turn along; vector: a rotation vector",
    )
    meaning.add_argument("--angle-unit", choices=ANGLES, help="of angles (default: as the file says)")
    meaning.add_argument("--units", choices=tuple(LENGTHS), help="of lengths in the poses (default: as the file says, else mm)")
    meaning.add_argument("--time-unit", choices=tuple(TIMES), help="of times in the poses (default: as the file says, or by their size)")
    meaning.add_argument("--status-ok", nargs="+", metavar="WORD", default=[], help="words of the tracker that mean a valid pose")
    meaning.add_argument("--column-major", action=argparse.BooleanOptionalAction, help="matrices are written column by column")
    meaning.add_argument("--sure", action="store_true", help="take poses as they are where no hand moves so")
    image = parser.add_argument_group("image")
    image.add_argument("--spacing", type=float, nargs=2, metavar=("X", "Y"), help="size of a pixel in mm, where poses take millimeters")
    image.add_argument(
        "--image-origin-px", type=float, nargs=2, metavar=("COLUMN", "ROW"), help="the pixel that the poses place (default: 0 0)"
    )
    image.add_argument("--calibration", metavar="[NAME=]FILE", help="ImageToProbe: Plus configuration, Slicer transform or 16 numbers")
    image.add_argument("--orientation", default="MF", metavar="CODE", help="how the pixels run: MF, MN, UF or UN (default: %(default)s)")
    image.add_argument("--rate", type=float, metavar="HZ", help="frames per second of the images, where no file has their times")
    output = parser.add_argument_group("output")
    output.add_argument("--drawing", type=Path, metavar="FILE.svg", help="where to draw the sweep (default: beside the output)")
    output.add_argument("--compress", action=argparse.BooleanOptionalAction, default=True, help="compress the images (default: yes)")
    mechanism = parser.add_argument_group("mechanism")
    mechanism.add_argument(
        "--mechanism",
        type=Path,
        metavar="FILE",
        help="axes of what moves the probe (.toml, .json): the poses are of what they read, one column each, by their names",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, pair, write, draw, and say how everything was understood."""
    check_sequence_name(arguments.output)
    drawing = arguments.drawing or arguments.output.with_name(arguments.output.name.split(".")[0] + "-sweep.svg")
    settings, calibration_path = settings_from(arguments)
    refuse_to_overwrite([arguments.output, drawing], [*arguments.images, arguments.poses, calibration_path, arguments.mechanism])
    check_writable(drawing)
    mechanism = read_mechanism(arguments.mechanism) if arguments.mechanism else None
    poses = read_joint_poses(arguments.poses, mechanism, settings.form) if mechanism else read_poses(arguments.poses, settings.form)
    patient = read_poses(arguments.poses, replace(settings.form, tool=arguments.reference_tool)) if arguments.reference_tool else None
    sequence, understood = import_sequence(open_images(arguments.images), poses, settings, patient)
    with ProgressBar() as progress:
        write_sequence(sequence, arguments.output, arguments.compress, progress)
    lines = [*map(in_options, understood), *_check(sequence, settings.transform, drawing, arguments.output.name, mechanism)]
    print("\n".join(["Understood:", *(f"  {line}" for line in lines), f"  wrote {arguments.output}"]))


def settings_from(arguments: argparse.Namespace) -> tuple[ImportSettings, Path | None]:
    """What the options say, and the file of the calibration."""
    form = PoseFormat(
        columns=tuple(arguments.columns.replace(",", " ").split()) if arguments.columns else None,
        tool=arguments.tool,
        quaternion_order=arguments.quaternion_order,
        euler_order=arguments.euler_order,
        angle_unit=arguments.angle_unit,
        length_unit=arguments.units,
        time_unit=arguments.time_unit,
        good_statuses=tuple(arguments.status_ok),
        column_major=arguments.column_major,
    )
    transform = TransformName.parse(arguments.transform)
    calibration, path = None, None
    if arguments.calibration:
        word, equals, file = arguments.calibration.partition("=")
        path = Path(file if equals else word)
        calibration = read_calibration(path, TransformName.parse(word) if equals else _default_name(path, transform))
    settings = ImportSettings(
        transform,
        tuple(arguments.spacing) if arguments.spacing else None,
        tuple(arguments.image_origin_px) if arguments.image_origin_px else None,
        calibration,
        arguments.orientation,
        arguments.rate,
        arguments.time_offset,
        form,
        arguments.sure,
    )
    return settings, path


def _default_name(path: Path, transform: TransformName) -> TransformName | None:
    """A configuration names its transforms itself; other files hold the calibration of the probe whose poses there are."""
    if path.suffix.lower() == ".xml":
        return None
    return TransformName(IMAGE_FRAME, "Probe" if "Probe" in (transform.source, transform.target) else transform.source)


def _check(sequence: TrackedSequence, transform: TransformName, drawing: Path, name: str, mechanism: Mechanism | None) -> list[str]:
    """Facts of the sweep, and its drawing, where the images can be placed."""
    moving = {IMAGE_FRAME, *(calibration.target for calibration in sequence.transforms)}
    reference = transform.source if transform.target in moving else transform.target
    if any(REFERENCE_FRAME in (each.source, each.target) for each in sequence.records[0].transforms):
        reference = REFERENCE_FRAME
    try:
        poses = sweep_poses(sequence, reference=reference)
    except AIFReconError:
        return ["no drawing: the image cannot be placed without a calibration"]
    if not len(poses.usable):
        return ["no drawing: no frame has a valid pose"]
    try:
        seen = detect_imaging(sequence.images, pixel_spacing(poses.image_to_reference[poses.usable[0]]))
        region, probe = seen.region, f"recognized in the images, blue in the drawing: {seen.description}"
    except BeamGeometryError as error:
        region, probe = None, in_options(error)
    axes = mechanism.lines() if mechanism and reference == transform.target else []
    write_text(drawing, draw_sweep(poses.image_to_reference[poses.usable], sequence.frame_size, name, reference, axes, region))
    rows = [f"{what}: {value}" for what, value in tracking_report(sequence, poses).rows()]
    if np.isfinite(sequence.timestamps).all():
        rows.append(f"clocks: {estimate_time_offset(sequence, poses).to_text()}")
    option = "" if reference == "Reference" else f" --reference {reference}"
    next_step = f"to reconstruct: {program()} reconstruct {name}{option} --output volume.nrrd"
    return [_size(sequence, poses), probe, *rows, next_step, f"drew {drawing}"]


def _size(sequence: TrackedSequence, poses: SweepPoses) -> str:
    columns, rows = sequence.frame_size
    spacing = np.linalg.norm(poses.image_to_reference[poses.usable[0], :3, :2], axis=0)
    return f"one image is {columns * spacing[0]:.1f} x {rows * spacing[1]:.1f} mm, a pixel {spacing[0]:.4g} x {spacing[1]:.4g} mm"

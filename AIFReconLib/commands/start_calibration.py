"""`aifrecon start-calibration`: a first calibration of a probe, by a ruler."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..calibration.measured import measured_calibration
from ..errors import SettingsError
from ..io.disk.atomic import write_text
from ..terminal.console import program
from ..terminal.options import Commands, refuse_to_overwrite

ERROR = 20.0
"""mm by which a ruler may be off."""

EXAMPLE = """example: 60 mm of the depth scale take rows 40 to 440; the face is 118 mm before the marker along its -z, 4 mm beside
along its x; in the image the marked side is on the right
  aifrecon start-calibration --depth 60 40 440 --face-px 320 38 --face-mm 4 0 -118 --right x --down=-z --output Probe.xml"""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "start-calibration",
        description="Write a Plus configuration with a first ImageToProbe from what a ruler measures. It may be off by 20 mm and "
        "12 degrees: aifrecon calibrate makes it exact by a scan.",
        examples=EXAMPLE,
    )
    size = parser.add_mutually_exclusive_group(required=True)
    size.add_argument(
        "--depth",
        type=float,
        nargs=3,
        metavar=("MM", "ROW", "ROW"),
        help="a length on the depth scale, and the rows where it begins and ends",
    )
    size.add_argument("--pixel", type=float, metavar="MM", help="or the size of a pixel")
    parser.add_argument(
        "--face-px", type=float, nargs=2, required=True, metavar=("COLUMN", "ROW"), help="the middle of the probe's face in the images"
    )
    parser.add_argument(
        "--face-mm",
        type=float,
        nargs=3,
        required=True,
        metavar=("X", "Y", "Z"),
        help="the same place, measured from the marker's origin along the marker's axes",
    )
    parser.add_argument(
        "--right", required=True, metavar="AXIS", help="the marker's axis to the right of the image, as x or -x, or X,Y,Z between axes"
    )
    parser.add_argument("--down", required=True, metavar="AXIS", help="the same into the body, as in --down=-z")
    parser.add_argument("--tool", default="Probe", metavar="NAME", help="the marker's name (default: %(default)s)")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE.xml", help="where to write")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Compute, write, say what comes next."""
    refuse_to_overwrite(arguments, "output")
    output: Path = arguments.output
    if output.suffix.lower() != ".xml":
        raise SettingsError(f"{output}: a configuration is an XML file. Choose a name that ends with .xml.")
    if not arguments.tool.isidentifier():
        raise SettingsError(f"Input --tool must be letters and digits, as names of frames are; got {arguments.tool}.")
    pixel = arguments.pixel
    if pixel is None:
        length, first, last = arguments.depth
        if not last > first:
            raise SettingsError("Input --depth must be mm, the row where they begin, and a larger one where they end.")
        pixel = length / (last - first)
    matrix = measured_calibration(pixel, tuple(arguments.face_px), tuple(arguments.face_mm), arguments.right, arguments.down)
    rows = "\n".join("      " + " ".join(f"{value:.9g}" for value in row) for row in matrix.tolist())
    tool = arguments.tool[:1].upper() + arguments.tool[1:]
    write_text(
        output,
        f"""<PlusConfiguration version="2.9">
  <!-- Measured by hand: make it exact with aifrecon calibrate -->
  <CoordinateDefinitions>
    <Transform From="Image" To="{tool}" Error="{ERROR:g}" Matrix="
{rows}" />
  </CoordinateDefinitions>
</PlusConfiguration>
""",
    )
    print(f"pixels of {pixel:.4g} mm; wrote {output}")
    tools = f"--tool {tool} --reference-tool PATIENT --transform {tool}ToTracker"
    print("Next, with a sweep that sees the same bone from several angles; then again from what that writes, until no better one is found:")
    print(f"  {program()} import IMAGES --poses POSES {tools} --output sweep.igs.mha")
    print(f"  {program()} calibrate sweep.igs.mha --config {output} --output Calibrated.xml")

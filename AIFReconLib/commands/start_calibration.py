"""`aifrecon start-calibration`: a first calibration of a probe, by a ruler."""

from __future__ import annotations

from pathlib import Path

from ..calibration.measured import measured_calibration
from ..errors import SettingsError
from ..io.disk.atomic import write_text
from ..terminal.arguments import Options, Output
from ..terminal.console import program

ERROR = 20.0
"""mm by which a ruler may be off."""


class _StartCalibrationOptions(Options):
    """Write a Plus configuration with a first ImageToProbe from what a ruler measures. It may be off by 20 mm and 12 degrees: aifrecon
    calibrate makes it exact by a scan.

    Parameters
    ----------
    depth : MM ROW ROW
        a length on the depth scale, and the rows where it begins and ends
    face_px : COLUMN ROW
        the middle of the probe's face in the images
    face_mm : X Y Z
        the same place, measured from the marker's origin along the marker's axes
    right : AXIS
        the marker's axis to the right of the image, as x or -x, or X,Y,Z between axes
    down : AXIS
        the same into the body, as in --down=-z
    tool : NAME
        the marker's name
    output : FILE.xml
        where to write

    Examples
    --------
    60 mm of the depth scale take rows 40 to 440; the face is 118 mm before the marker along its
    -z, 4 mm beside along its x; in the image the marked side is on the right
      aifrecon start-calibration --depth 60 40 440 --face-px 320 38 --face-mm 4 0 -118 --right x --down=-z --output Probe.xml
    """

    depth: tuple[float, float, float]
    face_px: tuple[float, float]
    face_mm: tuple[float, float, float]
    right: str
    down: str
    tool: str = "Probe"
    output: Output


def run(asked: _StartCalibrationOptions) -> None:
    """Compute, write, say what comes next."""
    output: Path = asked.output
    if output.suffix.lower() != ".xml":
        raise SettingsError(f"{output}: a configuration is an XML file. Choose a name that ends with .xml.")
    if not asked.tool.isidentifier():
        raise SettingsError(f"Input --tool must be letters and digits, as names of frames are; got {asked.tool}.")
    length, first, last = asked.depth
    if not last > first:
        raise SettingsError("Input --depth must be mm, the row where they begin, and a larger one where they end.")
    pixel = length / (last - first)
    matrix = measured_calibration(pixel, asked.face_px, asked.face_mm, asked.right, asked.down)
    rows = "\n".join("      " + " ".join(f"{value:.9g}" for value in row) for row in matrix.tolist())
    tool = asked.tool[:1].upper() + asked.tool[1:]
    write_text(
        output,
        f"""<PlusConfiguration version="2.9">
  <!-- A matrix with an Error (mm) was measured by hand; aifrecon calibrate takes the Error out -->
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

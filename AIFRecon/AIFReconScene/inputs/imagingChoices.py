"""What the panel says of the images by hand: the shape of the probe, and which pixels are ultrasound."""

from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle

from .parameters import ProbeShape


def probeFrom(parameters):
    """The probe that the panel sets by hand; None where it leaves that to the configuration and the images."""
    if parameters.probe == ProbeShape.AUTOMATIC:
        return None
    apex = (parameters.apexColumn, parameters.apexRow) if parameters.probe == ProbeShape.SECTOR else None
    return ProbeGeometry(parameters.probe.value, apex)


def imageRegionFrom(parameters) -> dict:
    """Clip rectangle and fan that the panel sets by hand, as fields of `Inputs`; a size or radius of 0 leaves them open."""
    origin, size = (parameters.clipColumn, parameters.clipRow), (parameters.clipWidth, parameters.clipHeight)
    fan = parameters.fanLastRadius > 0
    return {
        "clip": ClipRectangle(origin, size) if 0 not in size else None,
        "fanAngles": (parameters.fanFirstAngle, parameters.fanLastAngle) if fan else None,
        "fanRadii": (parameters.fanFirstRadius, parameters.fanLastRadius) if fan else None,
    }

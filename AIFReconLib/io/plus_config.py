"""What a Plus configuration file (PlusDeviceSet_*.xml) says of the calibration, the volume and the probe."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from ..beams import LINEAR, SECTOR, ProbeGeometry
from ..errors import AIFReconError, ConfigurationError, GeometryError
from ..region import ClipRectangle, Fan, ImageRegion
from ..transform_graph import TransformName, TransformSample, TransformStatus
from ..transforms import as_matrix
from .sequence_fields import capitalized
from .text_values import capital
from .xml_attributes import Attributes
from .xml_tree import parse_xml

_METHODS = {"MEAN": "average", "LATEST": "latest", "MAXIMUM": "maximum"}
_IMPORTANCE_MASK = "IMPORTANCE_MASK"
_DEFAULT_FAN_RADIUS_STOP = 500.0


@dataclass(frozen=True, eq=False)
class PlusConfiguration:
    """The parts of a Plus configuration that concern a reconstruction.

    Parameters
    ----------
    path : Path
    transforms : dict of TransformName to TransformSample
        From CoordinateDefinitions: the calibration and other fixed relations.
    image_frame, reference_frame : str or None
        Names of the coordinate frames, None when not given.
    spacing, origin : (x, y, z) or None, mm
        Of the volume, in Reference.
    extent : 6 int or None
        First and last voxel along x, y, z.
    region : ImageRegion
        Clip rectangle and fan of the volume reconstruction, in pixels.
    probe : ProbeGeometry or None
        From ScanConversion.
    scan_region : ImageRegion or None
        The part of the image that the scan conversion fills.
    method : str or None
        How pixels are combined, in this library's words; None when not given or not supported.
    hole_filling : bool
    skip : int
        Every how many frames one is used.
    warnings : tuple of str
        What the file asks for and is not honored, one sentence each.
    """

    path: Path
    transforms: dict[TransformName, TransformSample] = field(default_factory=dict)
    image_frame: str | None = None
    reference_frame: str | None = None
    spacing: tuple[float, float, float] | None = None
    origin: tuple[float, float, float] | None = None
    extent: tuple[int, int, int, int, int, int] | None = None
    region: ImageRegion = field(default_factory=ImageRegion)
    probe: ProbeGeometry | None = None
    scan_region: ImageRegion | None = None
    method: str | None = None
    hole_filling: bool = False
    skip: int = 1
    warnings: tuple[str, ...] = ()


def read_plus_configuration(path: str | Path) -> PlusConfiguration:
    """The configuration in a file. Elements that do not concern a reconstruction are not looked at.

    Raises
    ------
    ConfigurationError
        Names the element and attribute that cannot be used.
    """
    path = Path(path)
    root = parse_xml(path)
    if root.tag != "PlusConfiguration":
        raise ConfigurationError(f"{path}: its root element must be PlusConfiguration; got {root.tag}. Give a Plus configuration file.")
    values = {"transforms": _read_transforms(path, root)}
    reconstruction = _find_reconstruction(root)
    if reconstruction is not None:
        values.update(_read_reconstruction(Attributes(path, reconstruction, "VolumeReconstruction")))
    conversion = root.find("ScanConversion")
    conversion = next(root.iter("ScanConversion"), None) if conversion is None else conversion
    if conversion is not None:
        values["probe"], values["scan_region"] = _read_scan_conversion(Attributes(path, conversion, "ScanConversion"))
    return PlusConfiguration(path=path, **values)


def _read_transforms(path: Path, root: Element) -> dict[TransformName, TransformSample]:
    transforms: dict[TransformName, TransformSample] = {}
    for number, element in enumerate(root.iterfind("CoordinateDefinitions/Transform"), start=1):
        attributes = Attributes(path, element, f"CoordinateDefinitions/Transform[{number}]")
        name = capitalized(TransformName(attributes.required_text("From"), attributes.required_text("To")))
        attributes.place = f"CoordinateDefinitions/Transform {name}"
        if name.source == name.target:
            raise attributes.failure("To", "must differ from From. Correct it.")
        for other in (name, name.inverse):
            if other in transforms:
                raise attributes.failure("To", f"states the relation that {other} states already. Remove one of the two.")
        status = TransformStatus.parse(attributes.text("Status") or "OK")
        if status is TransformStatus.OK:
            try:
                matrix = as_matrix(attributes.required_numbers(16, "Matrix"), f"transform {name}")
            except GeometryError as error:
                raise attributes.failure("Matrix", f"cannot be used. {error} Repeat the calibration, or correct it.") from error
        else:
            matrix = np.full((4, 4), np.nan)
        transforms[name] = TransformSample(matrix, status)
    return transforms


def _find_reconstruction(root: Element) -> Element | None:
    """The VolumeReconstruction element: under the root, else under a device that reconstructs volumes."""
    element = root.find("VolumeReconstruction")
    if element is not None:
        return element
    devices = (device for device in root.iter("Device") if device.get("Type") == "VirtualVolumeReconstructor")
    return next((element for device in devices for element in device.iter("VolumeReconstruction")), None)


def _read_reconstruction(attributes: Attributes) -> dict:
    """The fields of `PlusConfiguration` that VolumeReconstruction gives."""
    skip = attributes.integers(1, "SkipInterval") or (1,)
    attributes.positive(skip, "SkipInterval")
    return {
        "image_frame": capital(attributes.text("ImageCoordinateFrame") or "") or None,
        "reference_frame": capital(attributes.text("ReferenceCoordinateFrame") or "") or None,
        "spacing": attributes.positive(attributes.numbers(3, "OutputSpacing"), "OutputSpacing"),
        "origin": attributes.numbers(3, "OutputOrigin"),
        "extent": attributes.integers(6, "OutputExtent"),
        "region": ImageRegion(_read_clip(attributes), _read_fan(attributes)),
        "method": _read_method(attributes),
        "hole_filling": attributes.switch("FillHoles"),
        "skip": skip[0],
        "warnings": _not_honored(attributes),
    }


def _read_clip(attributes: Attributes) -> ClipRectangle | None:
    size = attributes.numbers(2, "ClipRectangleSize") or (0.0, 0.0)
    origin = attributes.numbers(2, "ClipRectangleOrigin") or (0.0, 0.0)
    if 0 in size:
        return None
    return _build(attributes, "ClipRectangleSize", ClipRectangle, origin, size)


def _read_fan(attributes: Attributes) -> Fan | None:
    angles = attributes.numbers(2, "FanAnglesDeg", "FanAngles") or (0.0, 0.0)
    apex = attributes.numbers(2, "FanOriginPixel", "FanOrigin") or (0.0, 0.0)
    radii = (
        attributes.number(0.0, "FanRadiusStartPixel"),
        attributes.number(_DEFAULT_FAN_RADIUS_STOP, "FanRadiusStopPixel", "FanDepth"),
    )
    if not any(angles):
        return None
    return _build(attributes, "FanAnglesDeg", Fan, apex, angles, radii)


def _read_method(attributes: Attributes) -> str | None:
    """CompoundingMode, else what the older Calculation and Compounding mean, in Plus's order of precedence."""
    mode = attributes.word("CompoundingMode", (*_METHODS, _IMPORTANCE_MASK))
    calculation = attributes.word("Calculation", ("WEIGHTED_AVERAGE", "MAXIMUM"))
    compounding = attributes.text("Compounding") and attributes.switch("Compounding")
    if mode is not None:
        return _METHODS.get(mode)
    if calculation == "MAXIMUM":
        return "maximum"
    if compounding is not None:
        return "average" if compounding else "latest"
    return "average" if calculation else None


def _not_honored(attributes: Attributes) -> tuple[str, ...]:
    """A sentence for each request that would change the volume and that this library does not carry out."""
    warnings = []

    def warn(attribute: str, instead: str) -> None:
        warnings.append(f"{attributes.place}@{attribute}={attributes.text(attribute)} is not honored: {instead}.")

    if attributes.word("Interpolation", ("NEAREST_NEIGHBOR", "LINEAR")) == "LINEAR":
        warn("Interpolation", "each pixel enters its nearest voxel")
    if attributes.word("CompoundingMode", (*_METHODS, _IMPORTANCE_MASK)) == _IMPORTANCE_MASK:
        warn("CompoundingMode", "the default method is used")
    if attributes.text("ImportanceMaskFilename"):
        warn("ImportanceMaskFilename", "all pixels count alike")
    if attributes.number(0.0, "PixelRejectionThreshold") > 0:
        warn("PixelRejectionThreshold", "dark pixels enter the volume too")
    if attributes.switch("EnableFanAnglesAutoDetect"):
        warn("EnableFanAnglesAutoDetect", "the fan angles are used as given")
    if attributes.switch("FillHoles"):
        warn("FillHoles", "give --hole-limit to fill empty voxels from the nearest measured ones")
    if attributes.text("OutputOrigin") or attributes.text("OutputExtent"):
        warn(
            "OutputOrigin" if attributes.text("OutputOrigin") else "OutputExtent",
            "the volume is the box around the sweep, or that of --grid-like",
        )
    return tuple(warnings)


def _read_scan_conversion(attributes: Attributes) -> tuple[ProbeGeometry, ImageRegion | None]:
    """The probe, and the part of the image that holds ultrasound, in MF pixels."""
    geometry = attributes.word("TransducerGeometry", ("CURVILINEAR", "LINEAR"))
    if geometry is None:
        attributes.required_text("TransducerGeometry")
    spacing = attributes.positive(attributes.required_numbers(2, "OutputImageSpacingMmPerPixel"), "OutputImageSpacingMmPerPixel")
    center = attributes.numbers(2, "TransducerCenterPixel")
    size = attributes.numbers(2, "OutputImageSizePixel")
    if center is None and size is None:
        raise attributes.failure("TransducerCenterPixel", "is missing, and OutputImageSizePixel too. Add one of them.")
    return (_read_curvilinear if geometry == "CURVILINEAR" else _read_linear)(attributes, spacing, center, size)


def _read_curvilinear(attributes: Attributes, spacing, center, size) -> tuple[ProbeGeometry, ImageRegion | None]:
    """Apex at the center of the transducer's curvature: RadiusStartMm above the middle of its face."""
    first = attributes.required_numbers(1, "RadiusStartMm")[0]
    last = attributes.required_numbers(1, "RadiusStopMm")[0]
    angles = attributes.required_numbers(1, "ThetaStartDeg") + attributes.required_numbers(1, "ThetaStopDeg")
    x, y = center or (size[0] / 2, first / spacing[1])
    apex = (x, y - first / spacing[1])
    fan = _build(attributes, "ThetaStartDeg", Fan, apex, angles, (first, last), spacing)
    return ProbeGeometry(SECTOR, apex), ImageRegion(fan=fan)


def _read_linear(attributes: Attributes, spacing, center, size) -> tuple[ProbeGeometry, ImageRegion | None]:
    """A rectangle below the transducer's face, as wide as that and as deep as the image."""
    width = attributes.positive(attributes.numbers(1, "TransducerWidthMm"), "TransducerWidthMm")
    depth = attributes.positive(attributes.numbers(1, "ImagingDepthMm"), "ImagingDepthMm")
    if width is None or depth is None:
        return ProbeGeometry(LINEAR), None
    x, y = center or (size[0] / 2, 0.0)
    size_px = (width[0] / spacing[0], depth[0] / spacing[1])
    return ProbeGeometry(LINEAR), ImageRegion(clip=ClipRectangle((x - size_px[0] / 2, y), size_px))


def _build(attributes: Attributes, attribute: str, kind, *values):
    """An object of the library from values in the file; its complaint becomes the file's."""
    try:
        return kind(*values)
    except AIFReconError as error:
        raise attributes.failure(attribute, f"cannot be used. {error}") from error

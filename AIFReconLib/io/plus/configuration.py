"""What a Plus configuration file (PlusDeviceSet_*.xml) says of the calibration, the volume and the probe."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import ConfigurationError, GeometryError
from ...geometry.transform_graph import TransformName, TransformSample, TransformStatus, capitalized
from ...geometry.transforms import as_matrix
from ...imaging.beams import LINEAR, SECTOR, ProbeGeometry
from ...imaging.region import ClipRectangle, Fan, ImageRegion
from ...sweep.configuration import NO_CONFIGURATION, PlusConfiguration
from ..disk.xml_tree import parse_xml
from .reconstruction import build, read_reconstruction
from .xml_attributes import Attributes


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
    transforms = _read_transforms(path, root)
    reconstruction = _find_reconstruction(root)
    configuration = NO_CONFIGURATION if reconstruction is None else read_reconstruction(path, reconstruction)
    configuration = replace(configuration, path=path, transforms=transforms)
    conversion = root.find("ScanConversion")
    conversion = next(root.iter("ScanConversion"), None) if conversion is None else conversion
    if conversion is not None:
        pixel, probe, region = _read_scan_conversion(Attributes(path, conversion, "ScanConversion"))
        configuration = replace(configuration, probe=probe, scan_region=region, scan_pixel=pixel)
    return configuration


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


def _read_scan_conversion(attributes: Attributes) -> tuple[tuple[float, float], ProbeGeometry, ImageRegion | None]:
    """The size of pixels, mm, the probe, and the part of the image that holds ultrasound, in MF pixels."""
    geometry = attributes.required_word("TransducerGeometry", ("CURVILINEAR", "LINEAR"))
    x, y = attributes.positive(attributes.required_numbers(2, "OutputImageSpacingMmPerPixel"), "OutputImageSpacingMmPerPixel")
    center = attributes.pair("TransducerCenterPixel")
    size = attributes.pair("OutputImageSizePixel")
    row = None
    if center is not None:
        column, row = center
    elif size is not None:
        column = size[0] / 2
    else:
        raise attributes.failure("TransducerCenterPixel", "is missing, and OutputImageSizePixel too. Add one of them.")
    read = _read_curvilinear if geometry == "CURVILINEAR" else _read_linear
    return (x, y), *read(attributes, (x, y), column, row)


def _read_curvilinear(
    attributes: Attributes, spacing: tuple[float, float], column: float, row: float | None
) -> tuple[ProbeGeometry, ImageRegion | None]:
    """Apex at the center of the transducer's curvature: RadiusStartMm above the middle of its face, (column, row)."""
    radii = attributes.required_number("RadiusStartMm"), attributes.required_number("RadiusStopMm")
    angles = attributes.required_number("ThetaStartDeg"), attributes.required_number("ThetaStopDeg")
    rows = radii[0] / spacing[1]
    apex = (column, (rows if row is None else row) - rows)
    fan = build(attributes, "ThetaStartDeg", lambda: Fan(apex, angles, radii, spacing))
    return ProbeGeometry(SECTOR, apex), ImageRegion(fan=fan)


def _read_linear(
    attributes: Attributes, spacing: tuple[float, float], column: float, row: float | None
) -> tuple[ProbeGeometry, ImageRegion | None]:
    """A rectangle below the transducer's face, as wide as that and as deep as the image."""
    width = attributes.positive(attributes.numbers(1, "TransducerWidthMm"), "TransducerWidthMm")
    depth = attributes.positive(attributes.numbers(1, "ImagingDepthMm"), "ImagingDepthMm")
    if width is None or depth is None:
        return ProbeGeometry(LINEAR), None
    size_px = (width[0] / spacing[0], depth[0] / spacing[1])
    return ProbeGeometry(LINEAR), ImageRegion(clip=ClipRectangle((column - size_px[0] / 2, row or 0.0), size_px))

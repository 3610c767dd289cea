"""What a Plus configuration file (PlusDeviceSet_*.xml) says of the calibration, the volume and the probe."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import ConfigurationError, GeometryError
from ...geometry.transform_graph import TransformName, TransformSample, TransformStatus, capitalized
from ...geometry.transforms import as_matrix
from ...imaging.beams import LINEAR, SECTOR, ProbeGeometry
from ...imaging.region import ClipRectangle, Fan, ImageRegion
from ...message import Message
from ...sweep.configuration import PlusConfiguration
from .reconstruction import build, read_reconstruction
from .xml_attributes import Attributes
from .xml_tree import parse_xml

if TYPE_CHECKING:
    pass


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
        raise ConfigurationError(
            "{path}: its root element must be PlusConfiguration; got {found}. Give a Plus configuration file.", path=path, found=root.tag
        )
    values = {"transforms": _read_transforms(path, root)}
    reconstruction = _find_reconstruction(root)
    if reconstruction is not None:
        values.update(read_reconstruction(path, reconstruction))
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
                raise attributes.failure("To", "states the relation that {other} states already. Remove one of the two.", other=other)
        status = TransformStatus.parse(attributes.text("Status") or "OK")
        if status is TransformStatus.OK:
            try:
                matrix = as_matrix(attributes.required_numbers(16, "Matrix"), Message("transform {name}", name=name))
            except GeometryError as error:
                raise attributes.failure(
                    "Matrix", "cannot be used. {problem} Repeat the calibration, or correct it.", problem=error
                ) from error
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
    fan = build(attributes, "ThetaStartDeg", Fan, apex, angles, (first, last), spacing)
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

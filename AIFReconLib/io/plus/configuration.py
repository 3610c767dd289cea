"""What a Plus configuration file (PlusDeviceSet_*.xml) says of the calibration, the volume and the probe."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import ConfigurationError
from ...geometry.transform_graph import TransformName, TransformSample, TransformStatus, capitalized
from ...geometry.transforms import as_matrix
from ...imaging.beams import LINEAR, SECTOR, ProbeGeometry
from ...imaging.region import ClipRectangle, Fan, ImageRegion
from ...sweep.configuration import NO_CONFIGURATION, SIMULATION, PlusConfiguration
from ..disk.xml_tree import parse_xml
from .reconstruction import read_reconstruction
from .xml_attributes import Attributes

ROUGH = 5.0
"""mm that a transform must say that it may be off (Plus's attribute Error) to be called measured by hand. Calibrations by a phantom say 0.1
to 2."""


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
    transforms, rough = _read_transforms(path, root)
    reconstruction = _find_reconstruction(root)
    configuration = NO_CONFIGURATION if reconstruction is None else read_reconstruction(path, reconstruction)
    told = tuple(f"{name} was measured by hand: make it exact with aifrecon calibrate before you believe a volume." for name in rough)
    warnings = (*configuration.warnings, *told)
    simulated = any(devices.get("Name") == SIMULATION for devices in root.iter("DeviceSet"))
    configuration = replace(configuration, path=path, transforms=transforms, rough=rough, simulated=simulated, warnings=warnings)
    conversion = next(chain(root.findall("ScanConversion"), root.iter("ScanConversion")), None)
    if conversion is not None:
        pixel, probe, region = _read_scan_conversion(Attributes(path, conversion, "ScanConversion"))
        configuration = replace(configuration, probe=probe, scan_region=region, scan_pixel=pixel)
    return configuration


def _read_transforms(path: Path, root: Element) -> tuple[dict[TransformName, TransformSample], tuple[TransformName, ...]]:
    """The transforms, and which of them may be off by much."""
    transforms: dict[TransformName, TransformSample] = {}
    rough = []
    for number, element in enumerate(root.iterfind("CoordinateDefinitions/Transform"), start=1):
        attributes = Attributes(path, element, f"CoordinateDefinitions/Transform[{number}]")
        name = capitalized(TransformName(attributes.text("From", required=True), attributes.text("To", required=True)))
        attributes.place = f"CoordinateDefinitions/Transform {name}"
        if name.source == name.target:
            raise attributes.failure("To", "must differ from From. Correct it.")
        for other in (name, name.inverse):
            if other in transforms:
                raise attributes.failure("To", f"states the relation that {other} states already. Remove one of the two.")
        status = TransformStatus.parse(attributes.text("Status") or "OK")
        numbers = attributes.numbers(16, "Matrix", required=True) if status is TransformStatus.OK else ()
        matrix = attributes.build("Matrix", partial(as_matrix, numbers, f"transform {name}")) if numbers else np.full((4, 4), np.nan)
        transforms[name] = TransformSample(matrix, status)
        if attributes.number("Error", default=0.0) > ROUGH:
            rough.append(name)
    return transforms, tuple(rough)


def _find_reconstruction(root: Element) -> Element | None:
    """The VolumeReconstruction element: under the root, else under a device that reconstructs volumes."""
    devices = (device for device in root.iter("Device") if device.get("Type") == "VirtualVolumeReconstructor")
    inside = (element for device in devices for element in device.iter("VolumeReconstruction"))
    return next(chain(root.findall("VolumeReconstruction"), inside), None)


def _read_scan_conversion(attributes: Attributes) -> tuple[tuple[float, float], ProbeGeometry, ImageRegion | None]:
    """The size of pixels, mm, the probe, and the part of the image that holds ultrasound, in MF pixels.

    The apex of a curved probe is the center of its curvature: RadiusStartMm above the middle of its face. Below the face of a linear one
    lies a rectangle, as wide as that and as deep as the image.
    """
    geometry = attributes.word("TransducerGeometry", ("CURVILINEAR", "LINEAR"), required=True)
    x, y = spacing = attributes.numbers(2, "OutputImageSpacingMmPerPixel", positive=True, required=True)
    center, size = attributes.numbers(2, "TransducerCenterPixel"), attributes.numbers(2, "OutputImageSizePixel")
    if center is None and size is None:
        raise attributes.failure("TransducerCenterPixel", "is missing, and OutputImageSizePixel too. Add one of them.")
    column, row = center or (size[0] / 2, None)
    if geometry == "LINEAR":
        width, depth = (attributes.number(name, positive=True) for name in ("TransducerWidthMm", "ImagingDepthMm"))
        if width is None or depth is None:
            return (x, y), ProbeGeometry(LINEAR), None
        size_px = width / x, depth / y
        return (x, y), ProbeGeometry(LINEAR), ImageRegion(clip=ClipRectangle((column - size_px[0] / 2, row or 0.0), size_px))
    start, stop, first, last = (
        attributes.number(name, required=True) for name in ("RadiusStartMm", "RadiusStopMm", "ThetaStartDeg", "ThetaStopDeg")
    )
    apex = (column, 0.0 if row is None else row - start / y)
    fan = attributes.build("ThetaStartDeg", lambda: Fan(apex, (first, last), (start, stop), spacing))
    return (x, y), ProbeGeometry(SECTOR, apex), ImageRegion(fan=fan)
